#!/usr/bin/python3 -PXutf8
# SPDX-License-Identifier: GPL-3.0-or-later
"""The program, whose reports have empty files for figures: drawing takes most of the time of a report, and tests/report looks at what is
drawn. SALBENCH_PROGRAM names the program."""

import contextlib
import os
import runpy
import sys

PROGRAM = __file__
SVG = '<svg xmlns="http://www.w3.org/2000/svg" width="8" height="8"/>\n'


def without_drawing():
    """Figures are laid out, and not drawn."""
    import unittest.mock

    return unittest.mock.patch("salbench.report.style.save", lambda _: (SVG.encode(), b""))


@contextlib.contextmanager
def without_figures():
    import unittest.mock

    with without_drawing(), unittest.mock.patch("salbench.report.drawing.Drawing.real"):
        yield


def never_drawn(words):
    """From now on in this process, where the words are those of a report."""
    if words[:1] == ["report"]:
        sys.salbench_figures = contextlib.ExitStack()  # else they are drawn again once the stack is collected
        sys.salbench_figures.enter_context(without_figures())


if __name__ == "__main__":
    never_drawn(sys.argv[1:])
    runpy.run_path(os.environ["SALBENCH_PROGRAM"], run_name="__main__")
