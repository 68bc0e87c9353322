# SPDX-License-Identifier: GPL-3.0-or-later
"""Statistics on the pages equal those of the program's files, which equal SciPy's, on a run of the real program over meshes
made here with simulated participants. SALBENCH_PROGRAM names the program."""

import os
import subprocess
import unittest

import numpy
import pandas
from scipy import stats

import fixture
import support
from report.results import read_results
from report import statistics

PROGRAM = os.environ.get("SALBENCH_PROGRAM", "")
CONFIGURATION = """dataset: {layout: schelling, participants: simulated}
scan: {step_degrees: 1}
models: {LS: , PS: , RS: }
"""


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
        cls.index = support.page(cls.to)

    def each(self):
        for dataset in ("meshes", "scans"):
            for metric in fixture.METRICS:
                yield dataset, metric, statistics.scores(self.results, dataset, metric)

    def test_means_and_intervals_equal_scipy(self):
        for dataset, metric, wide in self.each():
            for row in statistics.summary(self.results, dataset, metric).itertuples():
                values = wide[row.model].dropna()
                low, high = stats.t.interval(0.95, len(values) - 1, values.mean(), stats.sem(values))
                numpy.testing.assert_allclose([row.n, row.mean, row.sd, row.ci95_low, row.ci95_high],
                                              [len(values), values.mean(), values.std(), low, high], rtol=1e-8, atol=1e-12)

    def test_tests_equal_scipy_and_holm(self):
        table = self.results.table("significance.csv")
        for dataset, metric, wide in self.each():
            rows = table[(table["dataset"] == dataset) & (table["metric"] == metric)].reset_index(drop=True)
            signed = []
            for row in rows.itertuples():
                both = wide[[row.model_a, row.model_b]].dropna()
                z, p = stats.ranksums(both[row.model_a], both[row.model_b])
                numpy.testing.assert_allclose([row.rank_sum_z, row.rank_sum_p], [z, p], rtol=1e-6, atol=1e-12)
                difference = (both[row.model_a] - both[row.model_b])
                signed.append(stats.wilcoxon(difference).pvalue)
                if len(both) < 25:  # exact there; beyond, versions of SciPy differ in their normal approximation
                    self.assertAlmostEqual(row.signed_rank_p, signed[-1], places=9)
            order = rows["signed_rank_p"].to_numpy().argsort(kind="stable")
            holm = numpy.minimum(1, numpy.maximum.accumulate(
                rows["signed_rank_p"].to_numpy()[order] * numpy.arange(len(rows), 0, -1)))
            numpy.testing.assert_allclose(rows["signed_rank_p_holm"].to_numpy()[order], holm, rtol=1e-9)

    def test_pages_show_the_numbers_of_the_files(self):
        rows = {tuple(row[:3]): row for row in support.rows(self.index, "means")}
        for row in self.results.table("summary.csv").itertuples():
            label = {"auc": "AUC", "nss": "NSS", "lcc": "LCC"}.get(row.metric)
            if label:
                shown = rows[row.dataset.capitalize(), row.model, label]
                expected = [f"{value:.3f}".replace("-", "−") for value in (row.mean, row.ci95_low, row.ci95_high, row.sd)]
                self.assertEqual(shown[3:8], [str(int(row.n)), *expected])

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

    def test_classes_of_other_metrics_are_made_as_the_programs(self):
        """Of AUC the program writes the table; the report's way of making it gives the same."""
        written = statistics.per_class(self.results, "meshes", "auc")
        wide = statistics.scores(self.results, "meshes", "auc")
        class_of = statistics.classes(self.results)
        self.assertEqual(set(written["class"]), {"human", "cup"})
        for name in ("human", "cup"):
            part = wide[[class_of[item] == name for item, _ in wide.index]]
            rows = written[written["class"] == name].set_index("model")
            for model in wide:
                numpy.testing.assert_allclose(rows.loc[model, ["n", "mean", "ci95"]].astype(float),
                                              [3, part[model].mean(), statistics.student_half_width(part[model].to_numpy())])
            numpy.testing.assert_allclose(rows.loc["Avg", ["mean", "ci95"]].astype(float),
                                          [part.mean().mean(), statistics.student_half_width(part.mean().to_numpy())])


if __name__ == "__main__":
    unittest.main()
