# SPDX-License-Identifier: GPL-3.0-or-later
"""scripts/figures gaze in small: its tables have the form of those on the page; and the example of the page prints what stands there."""

import contextlib
import io
import re
import sys
import tempfile
import unittest
import unittest.mock
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs/gaze.md").read_text(encoding="utf-8")
sys.path.append(str(ROOT / "scripts"))

from studies import common, gaze  # noqa: E402


class Figures(unittest.TestCase):
    def test_the_page_has_the_form_of_what_is_printed(self):
        self.enterContext(unittest.mock.patch.object(gaze, "PEOPLE", 4))

        def form(text):  # heads and first cells of rows, without figures
            return [re.sub(r"\d+ x \d+|\d+ (studies|vertices|people)", "", line.split("|")[1] if " | " in line and "`" not in line else line)
                    for line in text.splitlines()]

        begin, end = common.marks("gaze")
        on_page = PAGE.partition(begin)[2].partition(end)[0]
        self.assertEqual(form(gaze.tables(200, 1)), form(on_page))

    def test_two_sheets_are_what_leaks_are_measured_on(self):
        points, faces = gaze.sheets(4, 0.1)
        front = (faces < 16).all(axis=1)
        self.assertTrue((front | (faces >= 16).all(axis=1)).all())
        self.assertAlmostEqual(float(points[:16, 2].min() - points[16:, 2].max()), 0.1)
        ups = [np.cross(points[b] - points[a], points[c] - points[a])[2] for a, b, c in faces.tolist()]
        self.assertEqual([up > 0 for up in ups], front.tolist())

    def test_the_example_prints_what_the_page_says(self):
        blocks = re.findall(r"^```(\w+)\n(.*?)^```$", PAGE, flags=re.M | re.S)
        printed, names = io.StringIO(), {"__name__": "page"}
        with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
            Path("docs").symlink_to(ROOT / "docs")
            Path("page.py").write_text("\n".join(text for language, text in blocks[:2] if language == "python"))
            with contextlib.redirect_stdout(printed):
                exec(compile(Path("page.py").read_text(), str(Path(folder, "page.py")), "exec"), names)  # noqa: S102: our own text
        self.assertEqual(printed.getvalue(), blocks[2][1])
