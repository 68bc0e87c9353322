# SPDX-License-Identifier: GPL-3.0-or-later
"""Figures of chosen shapes and models, and a paper in LaTeX with figures and tables as they are."""

import base64
import contextlib
import io
import re
import shutil
import subprocess
import tempfile
import unittest
import unittest.mock
from pathlib import Path

import yaml
from PIL import Image

import salbench
import support
from own_export_test import CONFIG, ITEMS, data_set, half
from salbench import __main__
from salbench.report import one_figure
from salbench.report.one_figure import wrapped
from salbench.report.report import Report
from salbench.report.results import Shown
from salbench.system.errors import InputError
from salbench.system.progress import nothing


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
        cls.data, cls.out = data_set(cls.folder / "data"), cls.folder / "out"
        models = {"LS": {}, "RS": {}, "MINE": half}
        cls.results = salbench.run(
            CONFIG, data=cls.data, models=models, cache=cls.folder / "cache", out=cls.out, progress=False
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

    def test_a_view_turns_its_mesh_whatever_row_it_is_in_and_no_scan(self):
        config = {**CONFIG, "dataset": {"layout": "schelling"}, "scan": {"step_degrees": 1}}
        out = self.folder / "scans"
        salbench.run(config, data=self.data, items=["1"], reference="items", models={"MINE": half}, cache=self.folder / "cache", out=out, progress=False)

        def cameras(names, views):
            scratch = Path(self.enterContext(tempfile.TemporaryDirectory()))
            exported = one_figure._exported(Shown(out), scratch, names, views, nothing)
            return {name: shape.picture().view_projection.tolist() for name, shape in exported.shapes.items()}

        usual, turned = cameras(("1", "1_3"), {}), cameras(("1",), {"1": (180, 60)})
        self.assertNotEqual(turned["1"], usual["1"])
        for names in (("1", "1_3"), ("1_3", "1")):
            self.assertEqual(cameras(names, {"1": (180, 60)}), {**usual, **turned})
        with self.assertRaisesRegex(InputError, "1_3"):
            cameras(("1_3",), {"1_3": (0, 0)})

    def test_a_view_keeps_the_upright_axis(self):
        for own, used in (("automatic", "z"), ("y", "y")):
            record = f"\nconfiguration:\n  scan:\n    up: y\n  picture:\n    up: {own}\n    azimuth: 35\n    elevation: 20\n"
            made = yaml.safe_load(one_figure.with_view(record, (0, 60), "z"))["configuration"]
            self.assertEqual(made, {"scan": {"up": "y"}, "picture": {"up": used, "azimuth": 0, "elevation": 60}})

    def test_its_pictures_have_the_resolution_of_print_in_both_forms(self):
        in_svg = [Image.open(io.BytesIO(base64.b64decode(data))).width for data in re.findall(r'base64,([^"]*)"', self.own)]
        in_pdf = [int(width) for width in re.findall(rb"/Width (\d+)", (self.folder / "own/figure.pdf").read_bytes())]
        for widths in (in_svg, in_pdf):
            self.assertAlmostEqual(max(widths), size_of(self.own)[0] / 72 * 300, delta=3)

    def test_chance_is_drawn_by_name_and_people_have_no_map(self):
        self.assertGreater(size_of(self.drawn("chance", "shapes=21", "models=RS,LS"))[0], size_of(self.own)[0] + 100)
        out = self.folder / "people"
        shutil.copytree(self.out, out)
        (out / "results.csv").write_text((out / "results.csv").read_text().replace(",RS,", ",HS,"))
        status, errors = support.make(out, self.folder / "none", "--figure", "shapes=21", "models=LS,HS")
        self.assertEqual((status, "HS" in errors), (2, True), errors)

    def test_a_map_that_came_matched_is_drawn_in_its_place(self):
        maps = self.folder / "maps"
        maps.mkdir()
        for item in ITEMS:
            shutil.copy(self.data / f"Distributions/{item}.val", maps)
        with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
            words = ["--data", self.data, "--models", "RS", "--maps", maps, "--name", "OWN", "--matched", "--cache", self.folder / "cache"]
            (self.folder / "run.yaml").write_text(yaml.dump(CONFIG))
            __main__.main(["run", *map(str, [self.folder / "run.yaml", *words, "--out", self.folder / "given", "--quiet"])])
        status, errors = support.make(self.folder / "given", self.folder / "matched", "--figure", "shapes=21", "models=OWN", "metrics=cc")
        self.assertEqual((status, errors), (0, ""), errors)
        self.assertEqual(size_of((self.folder / "matched/figure.svg").read_text())[0], size_of(self.own)[0])

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
