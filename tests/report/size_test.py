# SPDX-License-Identifier: GPL-3.0-or-later
"""The whole benchmark, 400 meshes and 4800 scans with made-up scores: time and size without pictures."""

import os
import subprocess
import unittest

import browser as chromium
import fixture
import support

CLASSES = ("human cup glasses airplane ant chair octopus table teddy hand plier fish bird spring armadillo buste mechanic bearing "
           "vase four-legged").split()


PROGRAM = os.environ.get("SALBENCH_PROGRAM", "")


class Size(support.ReportTest):
    def timed_report(self, name):
        """The report, whose processor time is a third of the limit on an idle core of 2024."""
        before = os.times()
        to = self.report(name)
        seconds = sum(os.times()[:4]) - sum(before[:4])
        index, whole = (to / "index.html").stat().st_size, sum(path.stat().st_size for path in to.rglob("*") if path.is_file())
        print(f"{name}: {seconds:.0f} s of processors; index {index / 1e6:.2f} MB; whole {whole / 1e6:.1f} MB")
        self.assertLess(seconds, 60)
        return to, index, whole

    def test_400_meshes_and_4800_scans(self):
        out = self.folder / "whole"
        fixture.write_results(out, [(str(index + 1), CLASSES[index // 20]) for index in range(400)])
        to, index, whole = self.timed_report("whole")
        self.assertLess(index, 1e5)
        self.assertLess(whole, 60e6)
        self.assertEqual(len(list((to / "shapes").glob("*.html"))), 400)
        if chromium.AVAILABLE:
            for path in ("index.html", "scores.html"):
                self.assert_usable_soon(to / path)

    @unittest.skipUnless(os.access(PROGRAM, os.X_OK), "SALBENCH_PROGRAM does not name the built program")
    def test_20_models_8_metrics_and_400_shapes(self):
        out = self.folder / "leaderboard"
        models = [f"model {number}" for number in range(18)] + ["HS", "RS"]
        metrics = (*fixture.METRICS, "spearman", "sim", "mse")
        items = [(str(index + 1), CLASSES[index // 20]) for index in range(400)]
        table = fixture.results_table(items, models, datasets=("meshes",))
        table["auc"] += table["model"].map({model: 0.002 * at for at, model in enumerate(models[:18])}).fillna(0)
        out.mkdir()
        fixture.with_metrics(table, metrics).to_csv(out / "results.csv", index=False)
        (out / "run.yaml").write_text(fixture.run_yaml(models, False, extra=fixture.metric_lines(metrics)), encoding="utf-8")
        subprocess.run([PROGRAM, "conclude", out / "results.csv", "--out", out, "--quiet"], check=True)
        to, index, _ = self.timed_report("leaderboard")
        self.assertLess(index, 1e5)
        self.assertIn("+ 12", support.page(to, "index.html"))  # six of 18 models are shown
        self.assertEqual(len(support.rows(support.page(to, "ranking.html"), "compact-meshes")), 20)

    def assert_usable_soon(self, path):
        browser = chromium.start()
        self.addCleanup(browser.quit)
        browser.get(path.as_uri())
        spent = browser.execute_script("return performance.timing.domContentLoadedEventEnd - performance.timing.navigationStart")
        print(f"{path.name}: usable after {spent} ms")
        self.assertLess(spent, 2000)
