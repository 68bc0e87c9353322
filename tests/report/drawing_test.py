# SPDX-License-Identifier: GPL-3.0-or-later
"""A figure that is yet to be drawn has a digest of what it shows; as PDF it is what publishers take."""

import re
import unittest
import warnings
from dataclasses import dataclass

import numpy
import pandas

from salbench.pages.looks import looks_of
from salbench.report import figures, gallery, style
from salbench.report.drawing import Drawing


def draw(figure, *arguments):
    figure.subplots().plot(*arguments)


def other(figure, *arguments):
    draw(figure, *arguments)


@dataclass(frozen=True)
class Look:
    colours: dict


class Drawings(unittest.TestCase):
    def test_it_is_drawn_of_its_arguments(self):
        made = Drawing(draw, ([1, 3, 2],), (4, 3)).real()
        self.assertEqual(made.axes[0].lines[0].get_ydata().tolist(), [1, 3, 2])
        self.assertEqual(made.get_size_inches().tolist(), [4, 3])

    def test_rows_and_numbers_of_a_gallery_have_names_that_are_no_formulas(self):
        """Titles stand above the first of the rows that share them."""
        names = ("$_$0", "a$x$b", "$^")
        rows = [(name, [("Ground truth", b"", []), ("LS", b"", [("0.5", True)])]) for name in names]
        figure = Drawing(gallery.draw_gallery, (rows, ["AUC"], numpy.zeros((2, 4))), (4, 8)).real()
        figure.canvas.draw()
        self.assertEqual([text.get_text() for text in figure.axes[0].texts if text.get_ha() == "right"],
                         [text for name in names for text in (name, "AUC")])
        self.assertEqual([text.get_text() for text in figure.axes[0].texts if text.get_va() == "bottom"], ["Ground truth", "LS"])
        self.assertEqual({text.get_parse_math() for text in figure.axes[0].texts}, {False})

    def test_a_curve_of_one_point_shows_it_with_its_interval(self):
        table = pandas.DataFrame({"n": [1.0], "mean": [0.5], "ci95_low": [0.4], "ci95_high": [0.7]})
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            (axes,) = Drawing(figures.draw_human_curves, ([("AUC", table, {"LS": 0.3})], looks_of(["LS"])), (4, 3)).real().axes
        self.assertEqual(axes.get_xlim(), (0.5, 1.5))
        self.assertIn([[1, 0.4], [1, 0.7]], [line.tolist() for bars in axes.collections if hasattr(bars, "get_segments") for line in bars.get_segments()])
        self.assertEqual([line.get_xdata()[-1] - line.get_xdata()[0] for line in axes.lines], [0, 1])

    def test_a_pdf_has_no_font_of_type_3_and_a_picture_at_300_dpi(self):
        style.apply()
        from matplotlib.figure import Figure

        axes = Figure(figsize=(3, 2)).add_axes((0, 0, 1, 1))
        axes.imshow(numpy.random.default_rng(1).uniform(size=(40, 60)), aspect="auto")
        axes.set_title("a title with $x^2$")
        axes.text(5, 5, "text")
        _, pdf = style.save(axes.figure)
        self.assertEqual((b"/Type3" in pdf, b"/CIDFontType2" in pdf), (False, True))
        self.assertGreaterEqual(max(int(width) for width in re.findall(rb"/Width (\d+)", pdf)), 3 * 300 - 1)

    def test_its_digest_tells_numbers_names_size_and_function(self):
        table = pandas.DataFrame({"a": [1.0, 2.0], "b": ["x", "y"]})
        arguments = [(1, 2), (1, 2.0000001), ("1", 2), ([1, 2],), (numpy.array([1, 2]),), (numpy.array([1.0, 2]),), (table,),
                     (table.assign(b="x"),), (table.rename(columns={"a": "c"}),), (Look({"LS": "red"}),), (Look({"LS": "blue"}),), (None,), (b"1",)]
        drawings = [Drawing(draw, values, (4, 3)) for values in arguments]
        drawings += [Drawing(draw, (1, 2), (4, 3.1)), Drawing(draw, (1, 2), (4, 3), None), Drawing(other, (1, 2), (4, 3)),
                     Drawing(draw, (1, 2), (4, 3), svg_dpi=300)]
        self.assertEqual(len({one.digest() for one in drawings}), len(drawings))
        self.assertEqual(Drawing(draw, (table.copy(),), (4, 3)).digest(), Drawing(draw, (table,), (4, 3)).digest())
