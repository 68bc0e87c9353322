# SPDX-License-Identifier: GPL-3.0-or-later
"""Statistics on the pages equal those of the program's files, which equal those of twin.py, on a run of the real program over meshes
made here with simulated participants. SALBENCH_PROGRAM names the program."""

import os
import subprocess
import unittest

import numpy
import pandas

import fixture
import support
import twin
from report.results import read_results
from report import statistics

PROGRAM = os.environ.get("SALBENCH_PROGRAM", "")
CONFIGURATION = """dataset: {layout: schelling, participants: simulated}
scan: {step_degrees: 1}
models: {LS: , PS: , HS: , RS: }
metrics: [auc, auc_exact, nss, cc, lcc, kl, nss_multiplicity]
"""


LEADING = {"auc": "AUC", "nss": "NSS", "lcc": "LCC"}


def texts(*values):
    return [f"{value:.3f}".replace("-", "−") for value in values]


def write_off(path, points, faces):
    lines = ["OFF", f"{len(points)} {len(faces)} 0"]
    lines += [" ".join(f"{value:.9g}" for value in point) for point in points]
    lines += [f"3 {a} {b} {c}" for a, b, c in faces]
    path.write_text("\n".join(lines) + "\n")


@unittest.skipUnless(os.access(PROGRAM, os.X_OK), "SALBENCH_PROGRAM does not name the built program")
class Statistics(support.ReportTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        data, cls.out = cls.folder / "data", cls.folder / "out"
        (data / "Meshes").mkdir(parents=True)
        for index in range(6):  # three of the class human, three of the class cup
            write_off(data / "Meshes" / f"{[1, 2, 3, 21, 22, 23][index]}.off", *fixture.sphere(rings=10 + index, bumps=0.1 + 0.05 * index))
        (cls.folder / "run.yaml").write_text(CONFIGURATION)
        ran = subprocess.run([PROGRAM, "run", cls.folder / "run.yaml", "--data", data, "--cache", cls.folder / "cache", "--out",
                              cls.out, "--quiet"], capture_output=True, text=True)
        assert ran.returncode == 0, ran.stderr
        cls.to = cls.folder / "report"
        with support.without_figures():
            status, errors = support.make(cls.out, cls.to)
        assert status == 0, errors
        cls.results = read_results(cls.out)
        cls.scores = cls.results.table("results.csv")
        cls.index = support.page(cls.to)

    def matched(self, name, expected, keys):
        """The program's table and the twin's, row by row; the twin's columns end in _twin."""
        table = self.results.table(name)
        self.assertEqual(list(table), list(expected))
        both = table.merge(expected, on=keys, suffixes=("", "_twin"))
        self.assertEqual([len(both)] * 2, [len(table), len(expected)], name)
        return both

    def assert_equal_columns(self, both, columns, **tolerance):
        for column in columns:
            numpy.testing.assert_allclose(both[column], both[f"{column}_twin"].astype(float), err_msg=column, **tolerance)

    def test_means_intervals_and_tests_equal_scipys_by_mesh(self):
        exact = {"rtol": 1e-9, "atol": 1e-9}
        summary = self.matched("summary.csv", twin.summary(self.scores), ["dataset", "model", "metric"])
        self.assert_equal_columns(summary, ["n", "mean", "sd", "ci95_low", "ci95_high", "n_shapes", "n_own_shapes", "own_mean"],
                                  **exact)
        self.assertEqual(set(zip(summary["dataset"], summary["n"], summary["n_shapes"])), {("meshes", 6, 6), ("scans", 6, 72)})
        classes = self.matched("per_class.csv", twin.per_class(self.scores), ["dataset", "class", "model", "metric"])
        self.assert_equal_columns(classes, ["n", "n_shapes", "mean", "ci95_low", "ci95_high"], **exact)
        self.assertEqual(set(classes["class"]), {"human", "cup"})
        pairs = self.matched("significance.csv", twin.significance(self.scores), ["dataset", "metric", "model_a", "model_b"])
        self.assert_equal_columns(pairs, [column for column in self.results.table("significance.csv").columns[4:]], **exact)

    def test_the_compact_table_and_the_leaders_equal_numpys(self):
        lower, exact = fixture.is_distance, {"rtol": 1e-9, "atol": 1e-9}
        compact = self.matched("compact.csv", twin.compact(self.scores, lower, resamples=10_000), ["dataset", "metric", "model"])
        self.assert_equal_columns(compact, ["n", "n_shapes", "n_missing", "mean", "low", "high", "half", "rank", "best"], **exact)
        for column in ("better", "kind"):
            self.assertEqual(list(compact[column]), list(compact[f"{column}_twin"]))
        leaders = self.matched("leaders.csv", twin.leaders(self.scores, lower, resamples=10_000), ["dataset", "metric"])
        self.assert_equal_columns(leaders, ["n", "n_shapes", "mean", "ci95_low", "ci95_high", "lead"], **exact)
        width = leaders["lead_high"] - leaders["lead_low"]
        numpy.testing.assert_allclose(width, leaders["lead_high_twin"] - leaders["lead_low_twin"], rtol=0.1)  # by other draws
        for row in leaders[leaders["metric"] != ""].to_dict("records"):
            if abs(row["lead_low"]) > 0.05 * (row["lead_high"] - row["lead_low"]):  # no tie that the draws decide
                self.assertEqual((row["verdict"], row["leaders"]), (row["verdict_twin"], row["leaders_twin"]), row)
        for sentence in leaders.loc[leaders["metric"] == "", "sentence"]:
            self.assertIn(sentence, support.page(self.to, "index.html"))

    def test_resampled_figures_equal_numpys(self):
        lower, resamples = fixture.is_distance, 10_000
        ranking = self.matched("ranking.csv", twin.ranking(self.scores, lower, resamples=resamples), ["dataset", "metric", "model"])
        self.assert_equal_columns(ranking, ["n", "n_shapes", "mean", "rank"], rtol=1e-9)
        self.assert_equal_columns(ranking, ["first"], atol=0.03)
        self.assertEqual(set(ranking["model"]), {"LS", "PS"}, "chance is no competitor")
        agreement = self.matched("ranking_agreement.csv", twin.agreement(self.scores, lower, resamples=resamples),
                                 ["dataset", "metric_a", "metric_b"])
        self.assert_equal_columns(agreement, ["n", "n_models", "tau"], rtol=1e-9)

    def curves(self):
        """human_curve_by_mesh.csv with all digits of its values, which are those of people.csv."""
        names = ["item", "class", "n", "metric"]
        people = self.results.table("people.csv").melt(names[:3], var_name="metric")
        return self.results.table("human_curve_by_mesh.csv").drop(columns="value").merge(people, on=names, how="left")

    def test_curves_by_mesh_differences_and_reliability_equal_scipys(self):
        curves = self.curves()
        exact = {"rtol": 1e-9, "atol": 1e-9}
        means = self.results.table("human_curve.csv")
        grouped = curves.groupby(["n", "metric"])["value"]
        expected = means.assign(mean=[grouped.get_group((row.n, row.metric)).mean() for row in means.itertuples()])
        numpy.testing.assert_allclose(means["mean"], expected["mean"], **exact)
        differences = self.matched("human_curve_differences.csv", twin.human_differences(curves),
                                   ["metric", "from_participants", "to_participants"])
        self.assert_equal_columns(differences, list(self.results.table("human_curve_differences.csv"))[3:], **exact)
        reliability = self.matched("human_reliability.csv", twin.human_reliability(curves), ["metric"])
        self.assert_equal_columns(reliability, list(self.results.table("human_reliability.csv"))[1:], **exact)
        halves = curves[curves["metric"] == "cc"]
        numpy.testing.assert_allclose(halves["reliability"], 2 * halves["value"] / (1 + halves["value"]))

    def assert_end(self, resampled, end, level):
        """`level` of the resampled values lie below that end of an interval, but for noise and for values that tie."""
        self.assertLess((resampled < end).mean(), level + 0.01)
        self.assertGreater((resampled <= end).mean(), level - 0.01)

    def test_participants_and_shares_equal_numpys(self):
        curves, lower = self.curves(), fixture.is_distance
        expected = twin.human_equivalents(curves, self.scores, lower, resamples=10_000)
        both = self.matched("human_equivalents.csv", expected, ["dataset", "metric", "model"])
        self.assert_equal_columns(both, ["n", "n_shapes", "largest_group", "mean", "k", "crossings"], rtol=1e-9)
        self.assertEqual(both["k_bound"].tolist(), both["k_bound_twin"].tolist())
        table = self.results.table("human_equivalents.csv").set_index(["metric", "model"])
        tail = float(twin.stats.norm.cdf(-(6 / 5) ** 0.5 * twin.stats.t.ppf(0.975, 5)))
        ends = 0
        for metric, model, n, _, _, _, resampled, _ in twin.human_places(curves, self.scores, lower, resamples=10_000):
            row = table.loc[metric, model]
            for end, level in (("low", tail), ("high", 1 - tail)):
                value = {"<": -numpy.inf, ">": numpy.inf}.get(row[f"{end}_bound"][:1], row[f"ci95_{end}"])
                if value == value:
                    self.assert_end(resampled, value, level)
                    ends += 1
        self.assertGreater(ends, 40)
        shares = self.matched("human_share.csv", twin.human_shares(self.scores, lower, resamples=10_000), ["dataset", "metric", "model"])
        self.assert_equal_columns(shares, ["n", "n_shapes", "mean", "mean_rs", "mean_hs", "share"], rtol=1e-9)
        self.assertEqual(shares["remark"].tolist(), shares["remark_twin"].tolist())
        width = (shares["ci95_high"] - shares["ci95_low"]).to_numpy()
        self.assertGreater(numpy.isfinite(width).sum(), 5)
        for end in ("ci95_low", "ci95_high"):
            away = ((shares[end] - shares[f"{end}_twin"]).abs() / width).dropna()
            self.assertLess(away.max(), 0.15)

    def test_pages_show_the_numbers_of_the_files(self):
        rows = {tuple(row[:3]): row for row in support.rows(self.index, "means")}
        for row in self.results.table("summary.csv").itertuples():
            label = LEADING.get(row.metric)
            if label:
                shown = rows[row.dataset.capitalize(), row.model, label]
                count = "6 meshes" if row.dataset == "meshes" else "6 meshes, 72 scans"
                self.assertEqual(shown[3:9], [count, *texts(row.mean, row.ci95_low, row.ci95_high, row.sd),
                                              " to ".join(texts(row.bca95_low, row.bca95_high))])
        pairs = {tuple(row[:3]): row for row in support.rows(self.index, "pairs")}
        for row in self.results.table("significance.csv").itertuples():
            label = LEADING.get(row.metric)
            if label:
                shown = pairs[row.dataset.capitalize(), label, f"{row.model_a} − {row.model_b}"]
                self.assertEqual(shown[4].removeprefix("+"), *texts(row.mean_difference))
                self.assertEqual(shown[5], " to ".join(texts(row.ci95_low, row.ci95_high)))
        classes = {row[0]: row for row in support.rows(self.index, "classes-scans-nss")}
        table = self.results.table("per_class.csv")
        for name, at in (("LS", 2), ("Avg", -1)):
            row = table[(table["dataset"] == "scans") & (table["metric"] == "nss") & (table["model"] == name)
                        & (table["class"] == "cup")].iloc[0]
            self.assertEqual(classes["cup"][1], "3 meshes, 36 scans")
            self.assertEqual(classes["cup"][at], " ± ".join(texts(row["mean"], (row["ci95_high"] - row["ci95_low"]) / 2)))

    def test_figures_plot_the_numbers_of_the_files(self):
        for metric in ("auc", "nss", "lcc"):
            plotted = pandas.read_csv(self.to / "data/ranking-scans.csv", float_precision="round_trip")
            plotted = plotted[plotted["metric"] == metric].set_index("model")
            expected = statistics.summary(self.results, "scans", metric).set_index("model")
            for column in ("mean", "ci95_low", "ci95_high"):
                self.assertEqual(plotted[column].to_dict(), expected[column].to_dict())
            heat = pandas.read_csv(self.to / f"data/performance-meshes-{metric}.csv", dtype={"item": str},
                                   float_precision="round_trip").set_index("item")
            wide = statistics.scores(self.results, "meshes", metric).droplevel("view")
            for model in wide:
                self.assertEqual(heat[model].to_dict(), wide[model].to_dict())


if __name__ == "__main__":
    unittest.main()
