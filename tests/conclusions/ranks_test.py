# SPDX-License-Identifier: GPL-3.0-or-later
"""Ranks, their intervals, the letters of groups, and how far rankings agree."""

import itertools
import unittest

import numpy as np
from scipy import stats
from support import NAN, apart, one, row, study_of, t_statistic

from salbench.conclusions.agreement import agreement, signs_of, tau_b
from salbench.conclusions.means import compact, overview, ranking, summary
from salbench.conclusions.ranks import compact_letters, rank_models
from salbench.conclusions.resampling import Bootstrap
from salbench.conclusions.significance import significance


def around(means, units=30, noise=.1):
    """Scores of models with these means on units that all models find equally easy or hard."""
    rng = np.random.default_rng(1)
    return rng.normal(size=(units, 1)) + np.array(means, dtype=float) + noise * rng.normal(size=(units, len(means)))


def ranked(values, higher_is_better=True):
    bootstrap = Bootstrap(1, 2000)
    return rank_models(values, bootstrap.flipped_of_each([values])[0], bootstrap.sums_of_signs(len(values)), bootstrap.means(values), higher_is_better)


class RankingTest(unittest.TestCase):
    def test_clear_differences_give_single_ranks_and_letters(self):
        for higher, ranks, letters in ((True, [3, 1, 2], ["c", "a", "b"]), (False, [1, 3, 2], ["a", "c", "b"])):
            found = ranked(around([0, 2, 1]), higher)
            for values in (found.rank, found.low, found.high):
                np.testing.assert_array_equal(values, ranks)
            self.assertEqual(found.letters, letters)
            np.testing.assert_array_equal(found.first, np.equal(ranks, 1))

    def test_models_that_do_not_differ_share_a_letter_and_their_ranks(self):
        found = ranked(around([1, 1, 0], noise=.3))
        np.testing.assert_array_equal((found.low, found.high), ([1, 1, 3], [2, 2, 3]))
        self.assertEqual(found.letters, ["a", "a", "b"])
        self.assertAlmostEqual(found.first[:2].sum(), 1)

    def test_copies_of_a_model_share_rank_and_first_place(self):
        values = around([0], 20)
        found = ranked(np.hstack([values, values]))
        self.assertEqual((list(found.rank), list(found.first), found.letters), ([1, 1], [.5, .5], ["a", "a"]))

    def test_means_that_are_equal_but_for_rounding_are_equal(self):
        values = np.array([[1, 7], [2, 3], [3, 2], [4, 1], [7, 6], [6, 4]], dtype=float)
        for rows in (values, values[::-1]):
            whole, decimals = ranked(rows), ranked(rows / 10)
            self.assertEqual((list(whole.rank), list(decimals.rank)), ([1, 1], [1, 1]))
            np.testing.assert_array_equal(decimals.first, whole.first)

    def test_fewer_than_six_units_show_means_alone(self):
        for n in range(1, 7):
            values = around([0, 2, 1], n, .001)
            found = ranked(values)
            np.testing.assert_array_equal(found.order, [1, 2, 0])
            self.assertEqual((found.letters, found.better.any()), (["c", "a", "b"], True) if n == 6 else ([""] * 3, False))
            self.assertEqual(np.isnan([*found.rank, *found.low, *found.high, *found.first]).all(), n < 6)

    def test_pairs_differ_that_all_flips_and_steps_say_differ(self):
        for trial in range(12):
            rng = np.random.default_rng([4, trial])
            n, k = 6 + trial % 4, 3 + trial % 2
            values = rng.normal(size=(n, k)) * (1 + np.arange(k)) + np.arange(k) * rng.uniform(0, 4)
            values = np.round(values) if trial % 3 == 0 else values
            better = ranked(values).better
            self.assertEqual({(a, b) for a, b in zip(*np.nonzero(np.triu(better | better.T)))}, apart(values, itertools.combinations(range(k), 2)), trial)

    def test_joint_intervals_take_flips_around_the_means_and_at_least_the_first_bound(self):
        for trial in range(4):
            values = np.random.default_rng([5, trial]).normal(size=(7, 3)) + np.arange(3) * trial
            def bound(scores):
                flips = [np.array([1, *signs])[:, None] for signs in itertools.product((1, -1), repeat=6)]
                largest = [max(abs(t_statistic((signs * scores)[:, a] - (signs * scores)[:, b]))
                               for a, b in itertools.combinations(range(3), 2)) for signs in flips]
                return sorted(largest)[int(np.ceil(.95 * len(flips))) - 1]
            self.assertAlmostEqual(ranked(values).joint, max(bound(values), bound(values - values.mean(axis=0))), places=6)

    def test_differences_that_do_not_vary_have_no_joint_interval(self):
        values = around([0], 12)
        self.assertTrue(np.isnan(ranked(np.hstack([values, values + .1])).joint))
        self.assertTrue(np.isnan(ranked(np.hstack([values, values])).bound))

    def test_the_bound_of_two_models_is_students(self):
        self.assertAlmostEqual(ranked(around([0, 0], 25, 1)).bound, stats.t.ppf(.975, 24), delta=.1)

    def test_differences_of_rounding_are_none_and_constant_ones_are_no_chance(self):
        values = around([0], 12)
        for shift, differ in ((0, False), (1e-16, False), (.1, True)):
            self.assertEqual(ranked(np.hstack([values, values * (1 + 1e-16) + shift])).better.any(), differ, shift)

    def test_the_table_has_competitors_by_rank_and_no_reference(self):
        rows = [row(item, "", model, mean + .01 * (item % (3 if model == "A" else 4)))
                for item in range(12) for model, mean in (("A", .5), ("B", .7), ("HS", .9), ("RS", .1))]
        found = ranking(study_of(rows))
        self.assertEqual(list(found["model"]), ["B", "A"])
        self.assertEqual((found["rank_high"][0], found["group"][1], found["first"][0]), (1, "b", 1))


class LettersTest(unittest.TestCase):
    def test_a_chain_overlaps(self):  # neighbours do not differ, others do
        differ = np.abs(np.subtract.outer(range(4), range(4))) > 1
        self.assertEqual(compact_letters(differ, range(4)), ["a", "ab", "bc", "c"])

    def test_no_letters_beyond_26(self):
        differ = ~np.eye(140, dtype=bool)
        self.assertEqual(set(compact_letters(differ, range(140))), {""})
        self.assertEqual(compact_letters(differ[:26, :26], range(26))[25], "z")
        rng = np.random.default_rng(3)
        random = np.triu(rng.random((140, 140)) < .5, 1)
        self.assertEqual(set(compact_letters(random | random.T, range(140))), {""})

    def test_items_share_a_letter_exactly_where_they_do_not_differ(self):
        rng = np.random.default_rng(2)
        for n in list(range(1, 9)) * 20:
            differ = np.triu(rng.random((n, n)) < .5, 1)
            differ |= differ.T
            letters = compact_letters(differ, rng.permutation(n))
            for i in range(n):
                for j in range(i):
                    self.assertEqual(set(letters[i]).isdisjoint(letters[j]), bool(differ[i, j]))


class AgreementTest(unittest.TestCase):
    def test_is_kendalls_tau_b(self):
        rng = np.random.default_rng(3)
        for models in (2, 3, 8):
            x, y = np.round(rng.normal(size=(2, 40, models)), 0 if models > 3 else 3)
            signs = [signs_of(values[:1], values[1:], True)[:, :, None] for values in (x, y)]
            theirs = [stats.kendalltau(a, b)[0] for a, b in zip(x, y)]
            np.testing.assert_allclose(tau_b(*signs)[:, 0, 0], theirs, atol=1e-12)

    def test_takes_the_units_that_both_metrics_have(self):
        rows = [row(item, "", f"M{m}", m + .01 * item, NAN if item == 0 else 2 * m, -m) for item in range(6) for m in (1, 2, 3)]
        found = agreement(study_of(rows, ("auc", "nss", "kl")))  # kl: lower is better
        self.assertEqual(list(zip(found["metric_a"], found["metric_b"], found["n"])), [("auc", "nss", 5), ("auc", "kl", 6), ("nss", "kl", 5)])
        self.assertEqual(list(found["tau"]), [1, 1, 1])
        np.testing.assert_array_equal(found["ci95_low"], [NAN, 1, NAN])  # five units show nothing

    def test_is_of_two_units_and_two_models_at_least(self):
        for units, models, found in ((2, 2, [2]), (1, 2, []), (2, 1, [])):
            rows = [row(item, "", f"M{m}", m + .01 * item, 2 * m + .01 * item) for item in range(units) for m in range(models)]
            self.assertEqual(list(agreement(study_of(rows, ("auc", "nss")))["n"]), found)

    def test_many_metrics_are_compared_as_two_are(self):  # more than are computed at once
        rng = np.random.default_rng(4)
        names = [f"m{i}" for i in range(19)]
        values = rng.normal(size=(7, 4, 19))
        rows = [row(item, "", f"M{m}", *values[item, m]) for item in range(7) for m in range(4)]
        found = agreement(study_of(rows, names))
        self.assertEqual(len(found), 19 * 18 // 2)
        for a, b in (("m0", "m1"), ("m3", "m18"), ("m17", "m18")):
            two = agreement(study_of([r[:6] + (r[6 + int(a[1:])], r[6 + int(b[1:])]) for r in rows], (a, b))).iloc[0]
            self.assertEqual(list(one(found, metric_a=a, metric_b=b)), list(two))


class PoorDataTest(unittest.TestCase):
    def test_nothing_can_be_said_and_no_interval_has_width_0(self):
        poor = [[row(1, "", "A", .5)], [row(1, 0, "A", .5), row(1, 0, "B", .6)],
                [row(1, "", "A", .5), row(2, "", "A", .5), row(1, "", "B", .5), row(2, "", "B", .5)],
                [row(1, "", "A", NAN), row(2, "", "A", NAN), row(1, "", "B", .5)],
                [row(1, 0, "A", .5), row(2, 0, "A", .4), row(2, 1, "A", .3)],
                [row(1, "", "RS", .5, category="cup"), row(2, "", "RS", .4, category="cup")], []]
        for rows in poor:
            for unit in ("mesh", "class", "shape"):
                study = study_of(rows, unit=unit)
                for table in (summary, significance, ranking, agreement, overview, compact):
                    frame = table(study)
                    low, high = ("low", "high") if table is compact else ("ci95_low", "ci95_high")
                    if low in frame:
                        self.assertFalse((frame[low] == frame[high]).any(), frame)
