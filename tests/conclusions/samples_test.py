# SPDX-License-Identifier: GPL-3.0-or-later
"""Statistics of samples and pairs: worked out by hand, and beside SciPy and statsmodels on random samples with and without ties. Units needed to
detect a difference, beside R and statsmodels; one model against every other."""

import itertools
import unittest

import numpy as np
from scipy import special, stats
from statsmodels.stats.multitest import multipletests
from statsmodels.stats.power import TTestPower
from statsmodels.stats.proportion import proportion_confint
from statsmodels.stats.weightstats import DescrStatsW

from salbench.conclusions.against import against
from salbench.conclusions.pairs import compare, holm_adjusted, rank_sum_test, signed_rank_test
from salbench.conclusions.power import POWER, detectable, power, power_of_paired_test, units_to_detect
from salbench.conclusions.samples import summarise
from support import NAN, apart, one, row, study_of


def column(*values):
    return np.array(values, dtype=float)[:, None]


def random_samples(columns=1):
    """Samples of several sizes, rounded or not."""
    rng = np.random.default_rng(3)
    for n, step in itertools.product((2, 3, 5, 12, 39, 50, 51, 120), (0, .25, .5)):
        values = rng.normal(size=(n, columns)) * np.exp(rng.normal()) + .3 * rng.normal()
        yield step * np.round(values / step) if step else values


class SummaryTest(unittest.TestCase):
    def test_few_or_equal_values_have_no_interval(self):
        for values, mean, sd in ((column(), NAN, NAN), (column(7), 7, NAN), (column(.1, .1, .1), .1, 0), (column(1e6, 1e6 + 2 ** -32), 1e6 + 2 ** -33, 0)):
            found = summarise(values.reshape(-1, 1))
            np.testing.assert_array_equal(np.ravel(found[1:]), [mean, sd, NAN, NAN])  # 0.1 + 0.1 + 0.1 rounds: not here

    def test_equals_statsmodels(self):
        for values in random_samples(4):
            values = values[:, np.ptp(values, axis=0) > 0]
            theirs, found = DescrStatsW(values), summarise(values)
            np.testing.assert_allclose(found.mean, theirs.mean, atol=1e-12)
            np.testing.assert_allclose((found.low, found.high), theirs.tconfint_mean(), rtol=1e-7, atol=1e-12)


class PairsTest(unittest.TestCase):
    def test_a_hand_made_example(self):
        found = compare(column(1, 2, -1, 4))
        half = 2.353363434801824 * (13 / 3) ** .5 / 2  # t(0.95, 3) of the tables
        expected = {"mean_difference": 1.5, "d_z": 1.5 / (13 / 3) ** .5, "rank_biserial": (8.5 - 1.5) / 10, "superiority": .75,
                    "ci90_low": 1.5 - half, "ci90_high": 1.5 + half, "signed_rank": 1.5}  # ranks 1.5, 3, -1.5, 4
        for name, value in expected.items():
            np.testing.assert_allclose(getattr(found, name), value, rtol=1e-7, err_msg=name)

    def test_one_unit_has_a_difference_and_models_that_agree_no_interval(self):
        one = compare(column(1))._asdict()
        self.assertEqual([name for name, value in one.items() if not np.isnan(value)], ["mean_difference", "signed_rank", "signed_rank_p"])
        equal = compare(column(0, 0, 0, 0, 0))
        self.assertEqual([float(value) for value in (equal.t_p, equal.superiority, equal.rank_biserial, equal.signed_rank_p)], [1, .5, 0, 1])
        self.assertTrue(np.isnan(equal.ci95_low) and np.isnan(equal.d_z))
        constant = compare(column(2, 2, 2))  # two shapes that agree by chance would be as sure as any number of them
        self.assertTrue(np.isnan(constant.t_p) and np.isnan(constant.ci95_low))

    def test_equals_scipy_and_statsmodels(self):
        for differences in random_samples(3):
            found = compare(differences)
            for at, d in enumerate(differences.T):
                n, mine = len(d), {name: float(values[at]) for name, values in found._asdict().items()}
                with self.subTest(n=n, at=at):
                    self.compare_one(d, mine)

    def compare_one(self, d, mine):
        if np.ptp(d) > 0:
            theirs = DescrStatsW(d)
            low, high = theirs.tconfint_mean(.1)
            self.near(mine, ci90_low=low, ci90_high=high, t_p=theirs.ttest_mean(0)[1], d_z=d.mean() / d.std(ddof=1))
        ranks, signs = stats.rankdata(np.abs(d[d != 0])), np.sign(d[d != 0])
        wins = np.mean(d > 0) + np.mean(d == 0) / 2
        low, high = proportion_confint(wins * len(d), len(d), method="wilson")
        self.near(mine, rank_biserial=(ranks * signs).sum() / ranks.sum() if len(ranks) else 0, superiority=wins,
                  superiority_low=low, superiority_high=high)
        if d.any() and (np.count_nonzero(d) > 50 or len(set(np.abs(d))) == len(d) and (d != 0).all()):
            # SciPy's exact distribution is that of ranks without ties.
            statistic, p = stats.wilcoxon(d, method="exact" if len(d) <= 50 else "approx")
            self.near(mine, signed_rank=statistic, signed_rank_p=p)

    def near(self, mine, **theirs):
        for name, value in theirs.items():
            np.testing.assert_allclose(mine[name], value, rtol=1e-7, atol=1e-12, err_msg=name)

    def test_the_interval_and_the_test_decide_alike(self):
        differences = np.random.default_rng(1).normal(.7, 2**.5, size=(10, 300))
        found = compare(differences)
        outside = (found.ci95_low > 0) | (found.ci95_high < 0)
        np.testing.assert_array_equal(found.t_p < .05, outside)
        self.assertTrue(30 < outside.sum() < 270)


class RankTestsTest(unittest.TestCase):
    def test_signed_ranks_equal_an_enumeration_of_all_signs(self):
        """200 samples, most of them with ties and zeros."""
        rng, tied = np.random.default_rng(4), 0
        for n in range(1, 13):
            values = rng.normal(.4, 1, size=(n, 17))
            d = np.where(np.arange(17) < 4, values, np.round(values * rng.integers(1, 4, size=17)))
            _, _, p = signed_rank_test(d)
            for at in range(17):
                left = d[d[:, at] != 0, at]
                ranks = stats.rankdata(np.abs(left))
                patterns = np.array(list(itertools.product((0, 1), repeat=len(left))))
                away = np.abs(patterns @ ranks - ranks.sum() / 2)
                self.assertAlmostEqual(p[at], np.mean(away >= abs(ranks[left > 0].sum() - ranks.sum() / 2) - 1e-9), delta=1e-12, msg=d[:, at])
                tied += len(left) < n or len(set(np.abs(left))) < n
        self.assertGreater(tied, 100)

    def test_fifty_are_exact_and_fifty_one_are_not(self):
        for n, p in ((50, 2.0**-49), (51, 2 * special.ndtr(-(51 * 52 / 4) / (51 * 52 * 103 / 24) ** .5))):
            self.assertAlmostEqual(float(signed_rank_test(np.arange(1.0, n + 1)[:, None])[2]) / p, 1, delta=1e-9)

    def test_differences_that_are_equal_but_for_rounding_are_equal(self):
        """.61 - .60 is another number than .63 - .62; nothing depends on the unit of the scores."""
        for a, b in (([61, 63, 65, 76, 61, 55, 80, 71, 64, 67, 65, 65, 44], [60, 62, 64, 74, 58, 57, 77, 72, 61, 69, 64, 63, 42]),
                     ([40, 70, 90, 50, 80, 60], [10, 40, 60, 20, 50, 30]), ([40, 70], [10, 40]), ([40, 70, 10], [40, 70, 10])):
            whole, decimals = compare(column(*a) - column(*b)), compare(column(*a) / 100 - column(*b) / 100)
            for name in ("t_p", "d_z", "rank_biserial", "superiority", "signed_rank", "signed_rank_p"):
                np.testing.assert_allclose(getattr(decimals, name), getattr(whole, name), rtol=1e-9, err_msg=name)
            for name in ("sd", "ci95_low", "ci90_high"):
                np.testing.assert_allclose(getattr(decimals, name) * 100, getattr(whole, name), rtol=1e-9, err_msg=name)

    def test_ties_of_many_take_the_corrected_normal_approximation(self):
        _, statistic, p = signed_rank_test(np.repeat([[1.0], [-1], [2]], (1, 1, 58), axis=0))
        variance = (60 * 61 * 121 - (6 + 58**3 - 58) / 2) / 24
        self.assertEqual(float(statistic), 1.5)
        self.assertAlmostEqual(float(p), 2 * special.ndtr(-(60 * 61 / 4 - 1.5) / variance**.5))

    def test_rank_sums_by_hand_and_beside_scipy(self):
        self.assertEqual(rank_sum_test(np.array([1.0, 2, 4]), np.array([3.0, 5, 6, 7]))[0], (1 - 6) / 8**.5)  # only 4 lies above 3
        for values in random_samples(2):
            x, y = np.sort(values[:, 0]), np.sort(values[: 1 + len(values) // 2, 1])
            np.testing.assert_allclose(rank_sum_test(x, y), stats.ranksums(x, y), rtol=1e-9, atol=1e-12)
        self.assertTrue(np.isnan(rank_sum_test(np.array([]), np.array([1.0]))[1]))

    def test_holms_adjustment(self):
        np.testing.assert_allclose(holm_adjusted(np.array([.01, .04, .03, .005])), [.03, .06, .06, .02])
        np.testing.assert_allclose(holm_adjusted(np.array([NAN, .01, .02])), [NAN, .02, .02])  # NaN is no test
        p = np.random.default_rng(5).random(20) ** 4
        np.testing.assert_allclose(holm_adjusted(p), multipletests(p, method="holm")[1])


def needed(*sizes, deviation=1.0):
    return units_to_detect(np.array(sizes) * deviation, np.full(len(sizes), deviation)).tolist()


class Power(unittest.TestCase):
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


MODELS = ("A", "B", "C", "D")


def scores(units=9, metric_sign=1):
    """Scores of four models; A is significantly ahead of D, not of C."""
    rng = np.random.default_rng(3)
    return .5 + metric_sign * (rng.normal(size=(units, 1)) + np.array([.1, .09, .04, -.1]) + .04 * rng.normal(size=(units, 4))) / 9


def study(values, metric="auc"):
    return study_of([row(f"m{unit}", "", model, values[unit, at]) for unit in range(len(values)) for at, model in enumerate(MODELS)], (metric,))


class Against(unittest.TestCase):
    def test_it_differs_from_those_that_the_slow_twin_finds(self):
        values, seen = scores(), set()
        for at, model in enumerate(MODELS):
            table = against(study(values), model)
            pairs = apart(values, [(at, other) for other in range(len(MODELS)) if other != at])
            told_apart = set(table.loc[table["verdict"] != "not told apart", "other"])
            self.assertEqual(told_apart, {MODELS[sum(pair) - at] for pair in pairs}, model)
            seen |= set(table["verdict"])
        self.assertEqual(seen, {"ahead", "behind", "not told apart"})

    def test_rows_are_differences_with_intervals_that_leave_out_0_only_where_they_differ(self):
        values = scores()
        table = against(study(values), "A")
        self.assertEqual(list(table["other"]), ["B", "C", "D"])
        for line in table.itertuples():
            self.assertAlmostEqual(line.mean_difference, (values[:, 0] - values[:, MODELS.index(line.other)]).mean(), places=12)
            self.assertLessEqual(line.low > 0 or line.high < 0, line.verdict != "not told apart")
        self.assertEqual((one(table, other="D")["verdict"], set(table["n"])), ("ahead", {9}))

    def test_lower_is_better_turns_the_verdict(self):
        table = against(study(scores(metric_sign=-1), "kl"), "A")
        self.assertEqual(one(table, other="D")["verdict"], "ahead")
        self.assertLess(one(table, other="D")["mean_difference"], 0)

    def test_its_intervals_are_no_wider_than_those_of_all_pairs(self):
        found = study(scores())
        table, pairs = against(found, "A"), found.pairs[found.pairs["model_a"] == "A"].set_index("model_b")
        for line in table.itertuples():
            pair = pairs.loc[line.other]
            self.assertLessEqual(line.high - line.mean_difference, pair["joint95_high"] - pair["mean_difference"] + 1e-12)

    def test_few_units_and_strangers(self):
        table = against(study(scores(5)), "A")
        self.assertEqual((set(table["verdict"]), table["low"].isna().all()), ({""}, True))
        self.assertEqual(len(against(study(scores()), "E")), 0)
