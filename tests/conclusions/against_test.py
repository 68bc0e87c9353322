# SPDX-License-Identifier: GPL-3.0-or-later
"""One model against every other, when these pairs alone are compared at once."""

import unittest

import numpy as np
from support import apart, one, row, study_of

from salbench.conclusions.against import against

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
