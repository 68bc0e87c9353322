# SPDX-License-Identifier: GPL-3.0-or-later
"""Figures as PDF are what publishers take: fonts that are embedded as TrueType, and pictures at 300 dots per inch."""

import re
import unittest

import numpy

from salbench.report import style


class Print(unittest.TestCase):
    def test_a_figure_has_no_font_of_type_3_and_a_picture_at_300_dpi(self) -> None:
        style.apply()
        from matplotlib.figure import Figure

        figure = Figure(figsize=(3, 2))
        axes = figure.add_axes((0, 0, 1, 1))
        axes.imshow(numpy.random.default_rng(1).uniform(size=(40, 60)), aspect="auto")
        axes.set_title("a title with $x^2$")
        axes.text(5, 5, "text")
        _, pdf = style.save(figure)
        self.assertNotIn(b"/Type3", pdf)
        self.assertIn(b"/CIDFontType2", pdf)
        widths = [int(width) for width in re.findall(rb"/Width (\d+)", pdf)]
        self.assertGreaterEqual(max(widths), 3 * 300 - 1)


if __name__ == "__main__":
    unittest.main()
