# SPDX-License-Identifier: GPL-3.0-or-later
"""Figures of chosen shapes and models, and a paper in LaTeX with figures and tables as they are."""

import re
import shutil
import subprocess
import unittest
import unittest.mock
from pathlib import Path

import salbench
import support
from own_export_test import CONFIG, data_set, half
from salbench.report.one_figure import wrapped
from salbench.report.report import Report


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


class PaperTest(support.ReportTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        data, cls.out = data_set(cls.folder / "data"), cls.folder / "out"
        models = {"LS": {}, "RS": {}, "MINE": half}
        cls.results = salbench.run(
            CONFIG, data=data, models=models, cache=cls.folder / "cache", out=cls.out, progress=False
        )
        cls.own = cls.drawn("own", "shapes=21", "models=LS")

    @classmethod
    def drawn(cls, name, *words):
        """A figure by the command."""
        status, errors = support.make(cls.out, cls.folder / name, "--figure", *words)
        assert (status, errors) == (0, ""), errors
        return (cls.folder / name / "figure.svg").read_text()

    def test_a_row_per_shape_and_a_picture_per_model_from_any_side(self):
        usual = self.drawn("usual", "shapes=21,1", "models=LS,MINE")
        for place in (0, 1):  # width, height
            self.assertGreater(size_of(usual)[place], size_of(self.own)[place] + 100)
        turned = self.drawn("turned", "shapes=21, 1", "models=LS, MINE", "views=1:120:40")
        swapped = self.drawn("swapped", "shapes=21,1", "models=MINE,LS")
        self.assertEqual(size_of(turned), size_of(usual))
        self.assertEqual(size_of(swapped), size_of(usual))
        self.assertNotEqual(swapped, usual)
        self.assertNotEqual(turned, usual)
        page = self.results.figure(
            self.folder / "call", [21, "1"], models="LS,MINE", views={"1": (120, 40)}, progress=False
        )
        self.assertEqual(page, self.folder / "call/figure.pdf")
        self.assertEqual(page.with_suffix(".svg").read_text(), turned)
        self.assertNotIn(b"/Type3", page.read_bytes())

    def test_wide_rows_are_wrapped(self):
        for tiles, lines in ((6, [("Mesh 1", 6)]), (7, [("Mesh 1", 4), ("", 3)]), (16, [("Mesh 1", 6), ("", 6), ("", 4)])):
            self.assertEqual([(label, len(line)) for label, line in wrapped([("Mesh 1", [None] * tiles)])], lines)

    @unittest.skipUnless(shutil.which("pdflatex"), "pdflatex is not installed: scripts/setup browser")
    def test_a_paper_takes_figures_and_tables_as_they_are(self):
        names, report = ("performance", "examples"), self.folder / "report"

        def draw_two(shop, draw=Report.draw_figures):
            shop.waiting[:] = [task for task in shop.waiting if Path(task[0]).name.startswith(names)]
            draw(shop)

        with unittest.mock.patch.object(Report, "draw_figures", draw_two):
            self.assertEqual(support.make(self.out, report, "--no-viewer"), (0, ""))
        figures = [next((report / "figures").glob(f"{name}-*.pdf")) for name in names]
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
        for words in (["shapes=99"], ["shapes="], ["shapes=1", "models=X"], ["shapes=1", "views=21:0:0"], ["shapes=1", "views=1:400:0"]):
            with self.subTest(words):
                status, errors = support.make(self.out, self.folder / "wrong", "--figure", *words)
                self.assertEqual((status, errors.count("\n"), ".yaml" in errors), (2, 1, False), errors)
        with self.assertRaises(ValueError):
            self.results.figure(self.folder / "wrong", "99", progress=False)
        self.assertFalse((self.folder / "wrong").exists())
