# SPDX-License-Identifier: GPL-3.0-or-later
"""A recorded figure is the figure that its calls make, and its key tells what it shows."""

import tempfile
import unittest
from pathlib import Path

import numpy
import pandas
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter

from salbench.report import style
from salbench.report.drawing import Drawing, Later


def recorded():
    return style.new_figure(4, 3)


def real():
    style.apply()
    return Figure(figsize=(4, 3), layout="constrained")


def panels(figure, numbers=(1, 3, 2)):
    left, right = figure.subplots(1, 2)
    line, = left.plot(pandas.Series(numbers, index=[5, 6, 7]), label="ours")
    left.legend(handles=[line], labels=["theirs"])
    for text in left.get_xticklabels():
        text.set_rotation(30)
    low, high = left.get_ylim()
    right.set_ylim(low, 2 * high)
    right.annotate("middle", (0.5, left.get_ylim()[1] / 2), xycoords=right.transAxes)
    named = figure.subplot_mosaic([["a", "b"]])
    image = named["a"].imshow(numpy.arange(6).reshape(2, 3))
    figure.colorbar(image, ax=named["b"])
    return figure


class Drawings(unittest.TestCase):
    def svg(self, figure):
        with tempfile.TemporaryDirectory() as folder:
            style.save(figure, Path(folder) / "a.svg", Path(folder) / "a.pdf")
            return (Path(folder) / "a.svg").read_bytes(), (Path(folder) / "a.pdf").read_bytes()

    def test_is_the_figure_that_the_calls_make(self):
        self.assertEqual(self.svg(panels(recorded()).real()), self.svg(panels(real())))

    def test_its_key_tells_numbers_names_and_size(self):
        keys = [panels(recorded()).key(), panels(recorded(), (1, 3, 2.0000001)).key(), panels(style.new_figure(4, 3.1)).key()]
        named = recorded()
        named.subplots().set_title("a")
        keys.append(named.key())
        self.assertNotIn(None, keys)
        self.assertEqual(len(set(keys)), 4)
        self.assertEqual(keys[0], panels(recorded()).key())

    def test_what_changes_after_the_call_is_not_drawn(self):
        numbers, figure = numpy.array([1.0, 2.0]), recorded()
        axes = figure.subplots()
        axes.plot(numbers)
        before = figure.key()
        numbers[0] = 9
        self.assertEqual(figure.key(), before)
        self.assertEqual(figure.real(axes).lines[0].get_ydata().tolist(), [1, 2])

    def test_nothing_is_drawn_for_a_key(self):
        def make():
            raise AssertionError("a figure was made")
        figure = Drawing(make, (1, 1))
        figure.subplots().plot([1, 2])
        self.assertIsNotNone(figure.key())

    def test_what_cannot_be_told_has_no_key(self):
        figure = recorded()
        figure.subplots().yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value}"))
        self.assertIsNone(figure.key())

    def test_later_arguments_are_told_by_their_content(self):
        def shown(content):
            figure = recorded()
            figure.subplots().imshow(Later(numpy.zeros, (2, 2), content=content))
            return figure
        self.assertNotEqual(shown(b"a").key(), shown(b"b").key())
        self.assertEqual(shown(b"a").real().axes[0].images[0].get_array().shape, (2, 2))


if __name__ == "__main__":
    unittest.main()
