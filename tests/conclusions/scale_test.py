# SPDX-License-Identifier: GPL-3.0-or-later
"""Models on the scale of people: places on a curve, and shares of the way from chance to people."""

import unittest

import numpy as np
from scipy import stats

from salbench.conclusions.equivalents import crossings, first_reached
from salbench.conclusions.resampling import Bootstrap, percentile_interval
from salbench.conclusions.shares import shares

INFINITY = np.inf


def reached(curve, level, higher_is_better=True):
    return first_reached(np.array([curve], dtype=float), np.array([level], dtype=float), higher_is_better)[0]


class FirstReached(unittest.TestCase):
    def test_it_is_linear_between_the_numbers(self):
        curve = [.5, .6, .65]
        self.assertAlmostEqual(reached(curve, .525), 1.25, places=14)
        self.assertEqual(reached(curve, .6), 2)
        self.assertAlmostEqual(reached(curve, .64), 2.8, places=14)

    def test_ends_of_the_curve_are_open(self):
        curve = [.5, .6, .65]
        for level, place in ((.499, -INFINITY), (.5, 1), (.65, 3), (.651, INFINITY)):
            self.assertEqual(reached(curve, level), place, level)
        self.assertEqual(reached([.5], .5), 1)

    def test_of_a_curve_that_turns_it_is_the_fewest(self):
        hill, valley, falling = [.5, .7, .6], [.6, .5, .7], [.7, .6, .5]
        self.assertAlmostEqual(reached(hill, .65), 1.75, places=14)
        self.assertEqual([reached(valley, .55), reached(falling, .65), reached(falling, .75)], [-INFINITY, -INFINITY, INFINITY])
        for curve, level, times in ((hill, .65, 2), (valley, .55, 2), (falling, .75, 0), (hill, .7, 0), ([.4, .5, .5, .6], .5, 1)):
            self.assertEqual(crossings(np.array(curve), level), times, (curve, level))

    def test_it_follows_the_direction_of_the_metric(self):
        rng = np.random.default_rng(1)
        for _ in range(200):
            curve, level = rng.normal(size=rng.integers(1, 9)), rng.normal()
            self.assertEqual(reached(curve, level), reached(-curve, -level, higher_is_better=False))
            self.assertEqual(crossings(curve, level), crossings(-curve, -level))

    def test_many_at_once_are_each_by_itself(self):
        """A slow twin: NumPy's interp from the first point that is as good on."""
        rng = np.random.default_rng(2)
        curves, levels = rng.normal(size=(300, 6)), rng.normal(size=300)
        for curve, level, place in zip(curves, levels, first_reached(curves, levels, True)):
            first = next((i for i, value in enumerate(curve) if value >= level), None)
            expected = -INFINITY if first == 0 else INFINITY if first is None else np.interp(level, curve[first - 1:first + 1], [first, first + 1])
            self.assertTrue(place == expected or abs(place - expected) < 1e-12, (curve, level))


def with_people(n, of_models, span, rng):
    """Units x (models at a share of the way from chance to people, chance, people), who differ from unit to unit."""
    chance = 3 + .1 * rng.normal(size=n)
    people = chance + span * (1 + .4 * rng.normal(size=n))
    models = [3 + span * share + .25 * abs(span) * rng.normal(size=n) for share in of_models]
    return np.column_stack([*models, chance, people])


def of_means(values, sign=1.0):
    return shares(values[..., :-2], values[..., -2:-1], values[..., -1:], sign)


def fieller(values, model):
    """The shares of which a paired t-test would not reject that the model is that share of the way ahead [fieller1954]."""
    x, y, n = values[:, model] - values[:, -2], values[:, -1] - values[:, -2], len(values)
    t = stats.t.ppf(.975, n - 1)
    (xx, xy), (_, yy) = np.cov(x, y) * t * t / n
    a, b = y.mean() ** 2 - yy, x.mean() * y.mean() - xy
    root = np.sqrt(b * b - a * (x.mean() ** 2 - xx))
    return (b - root) / a, (b + root) / a


class Shares(unittest.TestCase):
    def test_they_are_the_ratio_of_the_means(self):
        np.testing.assert_allclose(of_means(np.array([[.5, .9, .5, .7]])), [[0, 2]], atol=1e-12)

    def test_chance_is_zero_and_people_are_one_whoever_is_drawn(self):
        values = with_people(30, [0, 0], 1, np.random.default_rng(6))
        values[:, :2] = values[:, 2:]
        found = of_means(Bootstrap(1, 500).means(values))
        self.assertEqual((set(found[:, 0]), set(found[:, 1])), ({0}, {1}))

    def test_they_do_not_depend_on_the_scale_of_the_metric(self):
        means = Bootstrap(1, 500).means(with_people(25, [.5, 1.2], 1, np.random.default_rng(7)))
        np.testing.assert_allclose(of_means(means), of_means(5 - 8 * means, -1.0), atol=1e-9)

    def test_people_below_chance_leave_the_share_open_on_the_side_of_the_model(self):
        self.assertEqual(of_means(np.array([[2., 1., .5], [.5, 1., .5], [1., 1., 1.]])).tolist(), [[INFINITY], [-INFINITY], [0]])

    def test_intervals_of_normal_scores_are_fiellers(self):
        """But for the resamples: 10 000 of them know an end within some percent of the width."""
        for n in (12, 19, 60):
            values = with_people(n, [.4, 1.3], 1, np.random.default_rng(n))
            found = of_means(Bootstrap(1).means(values))
            for model in range(2):
                low, high = fieller(values, model)
                np.testing.assert_allclose(percentile_interval(found[:, model], n), (low, high), atol=.08 * (high - low))
