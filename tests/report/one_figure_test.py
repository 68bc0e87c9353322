# SPDX-License-Identifier: GPL-3.0-or-later
"""A figure of chosen shapes and models, from Python as by the command."""

import os
import re
import subprocess
import unittest
from pathlib import Path

import salbench
import support
from own_export_test import CONFIG, data_set, half

PROGRAM = os.environ.get("SALBENCH_PROGRAM", "")


def size_of(svg):
    return [float(value) for value in re.search(r'width="([\d.]+)pt" height="([\d.]+)pt"', svg).groups()]


@unittest.skipUnless(os.access(PROGRAM, os.X_OK), "SALBENCH_PROGRAM does not name the built program")
class OneFigureTest(support.ReportTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        data, out = data_set(cls.folder / "data"), cls.folder / "out"
        models = {"LS": {}, "RS": {}, "MINE": half}
        cls.results = salbench.run(
            CONFIG, data=data, models=models, cache=cls.folder / "cache", out=out, progress=False
        )

    def drawn(self, name, shapes, **options):
        page = self.results.figure(self.folder / name, shapes, progress=False, **options)
        self.assertEqual(page, self.folder / name / "figure.pdf")
        self.assertNotIn(b"/Type3", page.read_bytes())
        return page.with_suffix(".svg").read_text()

    def test_a_row_per_shape_and_a_picture_per_model_from_any_side(self):
        usual = self.drawn("usual", ["21", "2"], models=["LS", "MINE"])
        one = self.drawn("one", "21", models="LS")
        for place in (0, 1):  # width, height
            self.assertGreater(size_of(usual)[place], size_of(one)[place] + 100)
        turned = self.drawn("turned", "21,2", models="LS,MINE", views={"2": (120, 40)})
        self.assertEqual(size_of(turned), size_of(usual))
        self.assertNotEqual(turned, usual)
        words = ["shapes=21,2", "models=LS,MINE", "views=2:120:40"]
        command = [PROGRAM, "report", self.folder / "out", "--to", self.folder / "by_command", "--figure"]
        subprocess.run([*command, *words, "--quiet"], check=True)
        self.assertEqual((self.folder / "by_command/figure.svg").read_text(), turned)

    def test_names_that_are_not_there(self):
        for wrong in ({"shapes": "99"}, {"shapes": ""}, {"models": "X"}, {"views": {"1": (0, 0)}}):
            with self.subTest(wrong), self.assertRaises(ValueError):
                self.drawn("wrong", **({"shapes": "2"} | wrong))
        self.assertFalse(Path(self.folder / "wrong").exists())
