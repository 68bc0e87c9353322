# SPDX-License-Identifier: GPL-3.0-or-later
"""Figures of chosen shapes and models, and a paper in LaTeX with figures and tables as they are."""

import os
import re
import shutil
import subprocess
import unittest
from pathlib import Path

import salbench
import support
from own_export_test import CONFIG, data_set, half

PROGRAM = os.environ.get("SALBENCH_PROGRAM", "")


def size_of(svg):
    return [float(value) for value in re.search(r'width="([\d.]+)pt" height="([\d.]+)pt"', svg).groups()]


PAPER = r"""
\documentclass{article}
\usepackage[margin=2cm]{geometry}
\usepackage{booktabs,graphicx}
\pdfcompresslevel=0 \pdfobjcompresslevel=0
\begin{document}
%s
\end{document}
"""
FIGURE = r"\begin{figure}\centering\includegraphics[width=\textwidth]{%s}\caption{A figure.}\end{figure}"
TABLE = r"\begin{table}\centering\caption{A table.}\small\input{%s}\end{table}"


@unittest.skipUnless(os.access(PROGRAM, os.X_OK), "SALBENCH_PROGRAM does not name the built program")
class PaperTest(support.ReportTest):
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
        self.assertEqual(b"/Type3" in page.read_bytes(), False)
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

    @unittest.skipUnless(shutil.which("pdflatex"), "pdflatex is not installed: scripts/setup browser")
    def test_a_paper_takes_figures_and_tables_as_they_are(self):
        report = self.results.report(self.folder / "report", progress=False, viewer=False).parent
        self.drawn("own", "21", models="LS")
        figures = [next((report / "figures").glob(f"{name}-*.pdf")) for name in ("performance", "examples")]
        figures.append(self.folder / "own/figure.pdf")
        tables = [report / "data" / name for name in ("compact-meshes.tex", "means.tex")]
        floats = [FIGURE % path for path in figures] + [TABLE % path for path in tables]
        (self.folder / "paper.tex").write_text(PAPER % "\n".join(floats))
        command = ["pdflatex", "-interaction=nonstopmode", "-halt-on-error", "paper.tex"]
        done = subprocess.run(command, cwd=self.folder, capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stdout[-2000:])
        self.assertNotRegex(done.stdout, "Overfull|Warning: File|undefined")
        paper = (self.folder / "paper.pdf").read_bytes()
        self.assertEqual([b"/CIDFontType2" in paper, b"/Type3" in paper], [True, False])  # TrueType is the first

    def test_names_that_are_not_there(self):
        for wrong in ({"shapes": "99"}, {"shapes": ""}, {"models": "X"}, {"views": {"1": (0, 0)}}):
            with self.subTest(wrong), self.assertRaises(ValueError):
                self.drawn("wrong", **({"shapes": "2"} | wrong))
        self.assertFalse(Path(self.folder / "wrong").exists())
