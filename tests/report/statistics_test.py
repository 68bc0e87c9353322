# SPDX-License-Identifier: GPL-3.0-or-later
"""Statistics on the pages and in figures equal those of the files, on a run of the real program over meshes made here with simulated
participants. SALBENCH_PROGRAM names the program."""

import os
import shutil
import subprocess
import unittest

import pandas

import fixture
import support
from salbench.report import statistics
from salbench.report.results import Shown
from tests.support import shapes

PROGRAM = os.environ.get("SALBENCH_PROGRAM", "")
CONFIGURATION = """dataset: {layout: schelling, participants: simulated}
scan: {step_degrees: 1}
models: {LS: , PS: , HS: , RS: }
metrics: [auc, auc_exact, nss, cc, lcc, kl, nss_multiplicity]
"""


LEADING = {"auc": "AUC", "nss": "NSS", "lcc": "LCC"}


def texts(*values):
    return [f"{value:.3f}".replace("-", "−") for value in values]


@unittest.skipUnless(os.access(PROGRAM, os.X_OK), "SALBENCH_PROGRAM does not name the built program")
class Statistics(support.ReportTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        data, cls.out = cls.folder / "data", cls.folder / "out"
        (data / "Meshes").mkdir(parents=True)
        for index in range(6):  # three of the class human, three of the class cup
            (data / f"Meshes/{[1, 2, 3, 21, 22, 23][index]}.off").write_text(shapes.off(*fixture.sphere(rings=10 + index, bumps=0.1 + 0.05 * index)))
        (cls.folder / "run.yaml").write_text(CONFIGURATION)
        ran = subprocess.run([PROGRAM, "run", cls.folder / "run.yaml", "--data", data, "--cache", cls.folder / "cache", "--out",
                              cls.out, "--quiet"], capture_output=True, text=True)
        assert ran.returncode == 0, ran.stderr
        shutil.rmtree(cls.folder / "cache")  # or the report has pictures of all shapes
        cls.to = cls.report("out")
        cls.results = Shown(cls.out)
        cls.scores = cls.results.table("results")
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
