# SPDX-License-Identifier: GPL-3.0-or-later
"""Units needed to detect a difference, and detectable differences, compared with R and statsmodels."""

import unittest

import numpy as np
from statsmodels.stats.power import TTestPower

from support import row, study_of
from salbench.conclusions.power import POWER, detectable, power, power_of_paired_test, units_to_detect


def needed(*sizes, deviation=1.0):
    return units_to_detect(np.array(sizes) * deviation, np.full(len(sizes), deviation)).tolist()


class Power(unittest.TestCase):
    def test_units_are_those_of_cohens_tables(self):
        """ceiling(power.t.test(delta = d, sd = 1, power = .8, type = "paired")$n) of R 4.2, for d = .2, .5, .8, 1.5"""
        self.assertEqual(needed(.2, .5, .8, 1.5), [199, 34, 15, 6])

    def test_differences_have_the_power_that_statsmodels_says(self):
        for n in (2, 3, 5, 19, 100, 393, 4716):
            self.assertAlmostEqual(TTestPower().power(detectable(n), n, .05), POWER, places=8, msg=n)

    def test_units_and_differences_belong_together(self):
        for n in (2, 3, 10, 19, 393, 10_000, 1_000_000):
            self.assertAlmostEqual(power_of_paired_test(np.array([detectable(n) * n**.5]), np.array([float(n)]))[0], POWER, places=9)
            just, short = detectable(n) * (1 + 1e-9), detectable(n) * (1 - 1e-6)
            self.assertEqual(needed(just, deviation=.3), [n])
            self.assertEqual(needed(short, deviation=.3)[0] > n, True, n)

    def test_no_number_shows_nothing_and_two_show_everything_else(self):
        self.assertTrue(np.isnan(needed(0, 1e-9)).all())
        self.assertEqual(needed(1e9), [2])
        self.assertTrue(np.isnan(units_to_detect(np.array([1., np.nan]), np.array([0., np.nan]))).all(), "nothing varies; one unit")

    def test_power_is_that_of_repeated_samples(self):
        n, rng = 12, np.random.default_rng(1)
        samples = rng.normal(detectable(n), size=(20_000, n))
        t = samples.mean(axis=1) / samples.std(axis=1, ddof=1) * n**.5
        self.assertAlmostEqual((abs(t) > 2.200985).mean(), POWER, delta=4 * (.16 / 20_000) ** .5)  # qt(.975, 11) of R

    def test_the_table_has_a_row_per_pair(self):
        values = {"A": [1, 2, 3, 4], "B": [1, 1, 3, 3], "C": [2, 3, 4, 5]}
        found = power(study_of([row(str(i), "", model, value) for model, own in values.items() for i, value in enumerate(own)])).set_index(
            ["model_a", "model_b"])
        self.assertEqual(list(found.index), [("A", "B"), ("A", "C"), ("B", "C")])
        self.assertAlmostEqual(found["sd"][("A", "B")], 1 / 3**.5, places=14)
        self.assertAlmostEqual(found["detectable"][("A", "B")], detectable(4) / 3**.5, places=14)
        self.assertEqual(found["n_to_detect"][("A", "B")], needed(.5 * 3**.5)[0])
        self.assertTrue(found.loc[("A", "C"), ["detectable", "n_to_detect"]].isna().all(), "the difference does not vary")
