# SPDX-License-Identifier: GPL-3.0-or-later
"""Resamples and the intervals made of them."""

import unittest
from fractions import Fraction
from unittest import mock

import numpy as np
from scipy import stats
from support import NAN

from salbench.conclusions import resampling
from salbench.conclusions.resampling import RESAMPLES, Bootstrap, bca_interval, percentile_interval
from salbench.conclusions.samples import summarise


def skewed(units, columns=1):
    return np.exp(np.random.default_rng(6).normal(size=(units, columns)))


def rows_of(blocks):
    return np.concatenate(list(blocks))


class ResamplesTest(unittest.TestCase):
    def test_are_the_draws_that_they_have_always_been(self):  # PCG64's raw output, which no release of NumPy may change
        np.testing.assert_array_equal(rows_of(Bootstrap(2016, 2).counts(8)), [[4, 0, 0, 1, 2, 0, 0, 1], [1, 1, 1, 1, 1, 0, 2, 1]])

    def test_signs_are_all_that_there_are_or_draws_that_they_have_always_been(self):
        few = rows_of(Bootstrap(2016, 32).signs(6))
        self.assertEqual((few.shape, few[0].tolist(), few[5].tolist()), ((32, 6), [1] * 6, [-1, 1, -1, 1, 1, 1]))
        self.assertEqual(len(np.unique(np.vstack([few, -few]), axis=0)), 64)
        np.testing.assert_array_equal(rows_of(Bootstrap(2016, 3).signs(9)), [[1] * 9, [1, -1, -1, 1, 1, -1, -1, -1, -1],
                                                                     [-1, 1, -1, -1, -1, 1, 1, 1, 1]])
        many = rows_of(Bootstrap(1).signs(100))
        self.assertLess(np.abs(many.mean(axis=0)).max(), .05)  # five standard errors
        self.assertLess(np.abs(many.T.astype(float) @ many / 1e4 - np.eye(100)).max(), .055)

    def test_draw_every_unit_as_often(self):
        counts = rows_of(Bootstrap(1).counts(19))
        np.testing.assert_array_equal(counts.sum(axis=1), 19)
        drawn = counts.sum(axis=0, dtype=float)
        self.assertGreater(stats.chisquare(drawn).pvalue, 1e-4)
        self.assertAlmostEqual(counts.var(), 18 / 19, delta=.02)  # of a multinomial cell

    def test_means_are_exact_whatever_adds_them_up(self):  # and so the same with any BLAS, on any number of threads
        values = skewed(40, 3)
        bootstrap = Bootstrap(7, 50)
        step = 2.0 ** (np.ceil(np.log2(np.abs(values - values[0]).max() * 40)) - 53)
        grid = np.rint((values - values[0]) / step)
        for row, counts in zip(bootstrap.means(values), rows_of(bootstrap.counts(40))):
            for column in range(3):
                total = sum(int(c) * int(g) for c, g in zip(counts, grid[:, column]))
                self.assertEqual(row[column], float(Fraction(total) * Fraction(step)) / 40 + values[0, column])
        np.testing.assert_allclose(bootstrap.means(values), rows_of(bootstrap.counts(40)) @ values / 40, rtol=1e-11)

    def test_are_the_same_whatever_is_multiplied_at_once(self):
        values = skewed(25, 4)
        whole = Bootstrap(1, 500).means(values)
        for what in ("_ROWS", "_UNITS"):
            with mock.patch.object(resampling, what, 7):
                np.testing.assert_array_equal(Bootstrap(1, 500).means(values), whole)
        with mock.patch.object(resampling, "_MOST_KEPT", 0):
            np.testing.assert_array_equal(Bootstrap(1, 500).means(values), whole)
        for one, other in zip(Bootstrap(1, 500).means_of_each([values, skewed(9), values[:, :1]]), (whole, None, whole[:, :1])):
            if other is not None:
                np.testing.assert_allclose(one, other, rtol=1e-11)  # a sample has its own grid

    def test_equal_columns_have_equal_means_and_a_constant_its_value(self):
        values = skewed(30, 2)
        values = np.hstack([values, values[:, :1], np.full((30, 1), .1)])
        means = Bootstrap(1, 300).means(values)
        np.testing.assert_array_equal(means[:, 0], means[:, 2])
        np.testing.assert_array_equal(means[:, 3], .1)

    def test_spread_as_a_mean_does(self):
        values = skewed(200)
        sample, means = summarise(values), summarise(Bootstrap(1).means(values))
        self.assertAlmostEqual(means.mean[0], sample.mean[0], delta=4 * means.sd[0] / RESAMPLES**.5)
        self.assertAlmostEqual(means.sd[0] / (sample.sd[0] * (199 / 200) ** .5 / 200**.5), 1, delta=.03)


class BcaTest(unittest.TestCase):
    def test_levels_follow_bias_and_acceleration(self):
        # The means are 0, 0.001 ... 1, so that ends are levels; by scipy.stats.norm of 0.0027 and so on. The acceleration is +-0.0962 for
        # one value that differs from three, and 0 for even steps.
        means = np.arange(1001) / 1000
        for sample, ends in (([0, 0, 0, 1], (.0027610911511, .7864734589205)), ([0, .5, .5, .5], (.0006054872999, .8642014368306)),
                             ([.2, .4, .6, .8], (.025, .975))):
            np.testing.assert_allclose(bca_interval(np.array(sample, dtype=float), means), ends, atol=1e-9)

    def test_none_for_one_value_or_equal_ones(self):
        for sample in (np.array([.3]), np.full(9, .3)):
            np.testing.assert_array_equal(bca_interval(sample, Bootstrap(1, 100).means(sample[:, None])[:, 0]), NAN)

    def test_a_resample_with_the_mean_of_the_sample_counts_one_half(self):  # of two values, half of all are
        interval = bca_interval(np.array([.123, .7891]), Bootstrap(1).means(np.array([[.123], [.7891]]))[:, 0])
        np.testing.assert_allclose(interval, (.123, .7891), rtol=1e-9)

    def test_equals_scipy_within_the_error_of_resampling(self):
        for sample in (np.random.default_rng(7).normal(size=25), skewed(25)[:, 0]):
            low, high = bca_interval(sample, Bootstrap(1).means(sample[:, None])[:, 0])
            theirs = stats.bootstrap((sample,), np.mean, n_resamples=RESAMPLES, method="BCa", random_state=1).confidence_interval
            # Four standard errors of the difference of two quantiles at .025, of 10 000 resamples each.
            allowed = 4 * (2 * .025 * .975 / RESAMPLES) ** .5 / stats.norm.pdf(1.96) * stats.sem(sample)
            self.assertAlmostEqual(low, theirs.low, delta=allowed)
            self.assertAlmostEqual(high, theirs.high, delta=2 * allowed)  # the tail is thin there


class PercentilesTest(unittest.TestCase):
    def test_of_normal_values_are_students(self):
        values = np.random.default_rng(8).normal(size=(19, 1))
        student, means = summarise(values), Bootstrap(1).means(values)[:, 0]
        low, high = percentile_interval(means, 19)
        np.testing.assert_allclose([low, high], [student.low[0], student.high[0]], atol=.05 * (student.high[0] - student.low[0]))
        self.assertEqual(percentile_interval(np.exp(means), 19), (np.exp(low), np.exp(high)))  # and of whatever rises with it

    def test_are_as_wide_as_students_interval_of_few_values(self):
        """Resampled means of n normal values of variance 1 have the variance (n - 1) / n of the sample itself, over n."""
        for n in (6, 10, 50):
            resampled = stats.norm.ppf((np.arange(100_000) + .5) / 100_000) * np.sqrt((n - 1) / n) / np.sqrt(n)
            half = stats.t.ppf(.975, n - 1) / np.sqrt(n)
            np.testing.assert_allclose(percentile_interval(resampled, n), (-half, half), rtol=.01)

    def test_ends_may_be_infinite(self):
        values = np.full(1000, 2.0)
        values[:100] = -np.inf
        self.assertEqual(percentile_interval(values, 50), (-np.inf, 2))

    def test_none_for_few_units_equal_values_and_undefined_ones(self):
        for values, n, known in (([1, 2, 3, 4], 5, False), ([1, 2, 3, 4], 6, True), ([2, 2, 2], 6, False), ([1, NAN], 6, False), ([], 6, False)):
            self.assertEqual(not np.isnan(percentile_interval(np.array(values, dtype=float), n)[0]), known, (values, n))
