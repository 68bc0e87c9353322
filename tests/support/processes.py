# SPDX-License-Identifier: GPL-3.0-or-later
"""Processes of this machine."""

import os
from pathlib import Path


def processes_with(text, file="cmdline"):
    """Numbers of the processes whose command line, or environment, has the text. One may end while it is looked at."""
    found = []
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            if os.fsencode(text) in (folder / file).read_bytes():
                found.append(folder.name)
        except OSError:
            pass
    return found
