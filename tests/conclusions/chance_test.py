# SPDX-License-Identifier: GPL-3.0-or-later
"""Remarks on metrics by which chance or a constant map is as good as a model."""

import unittest
from math import nan

from support import KL, NSS, row, scores_of
from salbench.conclusions.chance import chance
from salbench.conclusions.study import Study


def remarks(rows, constant=()):
    of_constant = scores_of(list(constant), (NSS, KL)).frame
    found = chance(Study(scores_of(rows, (NSS, KL)), constant=of_constant))
    return [f"{one.dataset}, {one.metric}: {one.remark}" for one in found.itertuples()]


class Chance(unittest.TestCase):
    def test_models_passed_are_named_and_by_how_much(self):
        rows = [row("1", "", "A", .5, 1), row("1", "", "B", .2, 3), row("1", "", "HS", .1, 20), row("1", "", "RS", 0, 2)]
        self.assertEqual(remarks(rows, [row("1", "", "constant", 0, 1.5)]), [
            "meshes, kl: chance (RS) is level with or ahead of B (by 1), HS (by 18); "
            "a constant map is level with or ahead of B (by 1.5), HS (by 18.5)"])

    def test_equal_means_are_level_whatever_the_order_of_their_sums(self):
        self.assertEqual(remarks([row("1", "", "A", .1 + .2, 1), row("1", "", "RS", .3, 2)]),
                         ["meshes, nss: chance (RS) is level with or ahead of A (level)"])
        self.assertEqual(remarks([row("1", "", "A", .31, 1), row("1", "", "RS", .3, 2)]), [])

    def test_they_are_about_the_shapes_that_both_have(self):
        rows = [row("1", "", "A", .5, nan), row("2", "", "A", .5, 3), row("1", "", "RS", 0, 9), row("2", "", "RS", 0, 2.5), row("3", "", "RS", 5, 0)]
        self.assertEqual(remarks(rows), ["meshes, kl: chance (RS) is level with or ahead of A (by 0.5)"])
        self.assertEqual(remarks([row("1", "", "A", nan, nan), row("1", "", "RS", 1, 1)]), [])
        self.assertEqual(remarks([row("1", "", "A", 1, 1)]), [], "no reference")
        self.assertEqual(remarks([]), [])
