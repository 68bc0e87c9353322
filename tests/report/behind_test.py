# SPDX-License-Identifier: GPL-3.0-or-later
"""Distances of models from the best equal those in the tables, for either direction of the metric."""

import pandas

import fixture
import support
from salbench.pages import dots
from salbench.report.front import behind
from salbench.report.results import Shown

METRICS = ("auc", "kl")


class Behind(support.ReportTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        items = fixture.eight_meshes()
        results = fixture.with_metrics(fixture.results_table(items, views=2), METRICS)
        fixture.write_results(cls.folder / "run", items, results=results, extra=fixture.metric_lines(METRICS))
        cls.results = Shown(cls.folder / "run")

    def table(self, name, metric):
        table = pandas.read_csv(self.folder / "run" / name, keep_default_na=name != "leaders.csv")
        return table[(table["dataset"] == "meshes") & (table["metric"] == metric)]

    def test_the_second_is_as_far_behind_as_the_first_leads(self):
        for metric in METRICS:
            leader = self.table("leaders.csv", metric).iloc[0]
            first, second = behind(self.results, "meshes", metric)[:2]
            self.assertEqual((first.distance, second.model), (0, leader["second"]))
            for ours, theirs in ((second.distance, leader["lead"]), (second.low, leader["lead_high"]), (second.high, leader["lead_low"])):
                self.assertAlmostEqual(ours, -float(theirs), places=9)

    def test_a_distance_of_rounding_is_none(self):
        for distance, text in ((0, "best mean"), (-1e-17, "best mean"), (-3e-4, "less than 0.001 behind"), (-.02, "0.020 behind")):
            self.assertEqual(dots.in_words(dots.Behind("A", .5, distance)), text)

    def test_a_pair_whose_interval_leaves_out_0_differs(self):
        seen = set()
        for metric in METRICS:
            pairs = self.table("significance.csv", metric)
            differ = {frozenset((row.model_a, row.model_b)): abs(row.t) > row.t_bound for row in pairs.itertuples()}
            best, *others = [one for one in behind(self.results, "meshes", metric) if one.model not in ("HS", "RS")]
            for one in others:
                self.assertLessEqual(one.high < 0, differ[frozenset((best.model, one.model))], (metric, one.model))
                seen.add(one.high < 0)
        self.assertEqual(seen, {True, False})
