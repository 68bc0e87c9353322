# SPDX-License-Identifier: GPL-3.0-or-later
"""Statistics on the pages and in figures equal those of the files."""

import pandas

import fixture
import support
from salbench.report import statistics
from salbench.report.results import Shown

LEADING = {"auc": "AUC", "nss": "NSS", "lcc": "LCC"}


def texts(*values):
    return [f"{value:.3f}".replace("-", "−") for value in values]


class Statistics(support.ReportTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.out = cls.folder / "out"
        items = [(str(item), "human" if item < 20 else "cup") for item in (1, 2, 3, 21, 22, 23)]
        models, metrics = ("LS", "PS", "HS", "RS"), (*fixture.METRICS, "kl", "nss_multiplicity")
        fixture.write_results(cls.out, items, models, results=fixture.with_metrics(fixture.results_table(items, models), metrics),
                              extra=fixture.metric_lines(metrics))
        cls.to = cls.report("out")
        cls.results = Shown(cls.out)
        cls.index = support.page(cls.to)

    def test_pages_show_the_numbers_of_the_files(self):
        rows = {tuple(row[:3]): row for row in support.rows(self.index, "means")}
        for row in self.results.table("summary").itertuples():
            label = LEADING.get(row.metric)
            if label:
                shown = rows[row.model, row.dataset.capitalize(), label]
                count = "6 meshes" if row.dataset == "meshes" else "6 meshes, 72 scans"
                self.assertEqual(shown[3:9], [count, *texts(row.mean, row.ci95_low, row.ci95_high, row.sd),
                                              " to ".join(texts(row.bca95_low, row.bca95_high))])
        pairs = {(row[0].partition("  ")[0], *row[1:3]): row for row in support.rows(self.index, "pairs")}
        for row in self.results.table("significance").itertuples():
            label = LEADING.get(row.metric)
            if label:
                shown = pairs[f"{row.model_a} − {row.model_b}", row.dataset.capitalize(), label]
                self.assertEqual(shown[4].removeprefix("+"), *texts(row.mean_difference))
                self.assertEqual(shown[5], " to ".join(texts(row.ci95_low, row.ci95_high)))
        classes = {row[0]: row for row in support.rows(self.index, "classes-scans-nss")}
        table = self.results.table("per_class")
        for name, at in (("LS", 3), ("Avg", 2)):
            row = table[(table["dataset"] == "scans") & (table["metric"] == "nss") & (table["model"] == name)
                        & (table["class"] == "cup")].iloc[0]
            self.assertEqual(classes["cup"][1], "3 meshes, 36 scans")
            self.assertEqual(" ".join(classes["cup"][at].split()), " ± ".join(texts(row["mean"], (row["ci95_high"] - row["ci95_low"]) / 2)))

    def test_the_mean_of_a_shape_is_over_the_models_that_compete(self):
        wide = statistics.scores(self.results, "meshes", "auc")
        pandas.testing.assert_series_equal(statistics.mean_per_shape(self.results, "meshes", "auc").sort_index(),
                                           wide[["LS", "PS"]].mean(axis=1).sort_index())

    def test_figures_plot_the_numbers_of_the_files(self):
        for metric in ("auc", "nss", "lcc"):
            plotted = pandas.read_csv(self.to / "data/ranking-scans.csv", float_precision="round_trip")
            plotted = plotted[plotted["metric"] == metric].set_index("model")
            expected = statistics.summary(self.results, "scans", metric).set_index("model")
            self.assertTrue(plotted.drop("RS")["mean"].is_monotonic_decreasing)
            for column in ("mean", "ci95_low", "ci95_high"):
                self.assertEqual(plotted[column].to_dict(), expected[column].to_dict())
            heat = pandas.read_csv(self.to / f"data/performance-meshes-{metric}.csv", dtype={"item": str},
                                   float_precision="round_trip").set_index("item")
            self.assertTrue(heat["mean"].is_monotonic_increasing)
            wide = statistics.scores(self.results, "meshes", metric).droplevel("view")
            for model in wide:
                self.assertEqual(heat[model].to_dict(), wide[model].to_dict())
