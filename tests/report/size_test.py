# SPDX-License-Identifier: GPL-3.0-or-later
"""The whole benchmark, 400 meshes and 4800 scans with made-up scores: sizes of its report without pictures. Limits are of
bytes and elements, which are the same on every machine."""

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
    def sized_report(self, name, index, whole):
        """The report, whose first page and whole may have so many bytes: half as much again as they have."""
        to = self.report(name)
        sizes = (to / "index.html").stat().st_size, sum(path.stat().st_size for path in to.rglob("*") if path.is_file())
        print(f"{name}: index {sizes[0]} bytes; whole {sizes[1]} bytes")
        for size, limit in zip(sizes, (index, whole)):
            self.assertLess(size, limit)
        return to

    def test_400_meshes_and_4800_scans(self):
        out = self.folder / "whole"
        fixture.write_results(out, [(str(index + 1), CLASSES[index // 20]) for index in range(400)])
        to = self.sized_report("whole", 40_000, 29_000_000)
        self.assertEqual(len(list((to / "shapes").glob("*.html"))), 400)
        if chromium.AVAILABLE:
            self.assert_few_elements(to / "index.html", 900)
            self.assert_few_elements(to / "scores.html", 2800)

    @unittest.skipUnless(os.access(PROGRAM, os.X_OK), "SALBENCH_PROGRAM does not name the built program")
    def test_20_models_8_metrics_and_400_shapes(self):
        out = self.folder / "leaderboard"
        models = [f"model {number}" for number in range(18)] + ["HS", "RS"]
        metrics = (*fixture.METRICS, "spearman", "sim", "kl")
        items = [(str(index + 1), CLASSES[index // 20]) for index in range(400)]
        table = fixture.results_table(items, models, datasets=("meshes",))
        table["auc"] += table["model"].map({model: 0.002 * at for at, model in enumerate(models[:18])}).fillna(0)
        out.mkdir()
        fixture.with_metrics(table, metrics).to_csv(out / "results.csv", index=False)
        (out / "run.yaml").write_text(fixture.run_yaml(models, False, extra=fixture.metric_lines(metrics)), encoding="utf-8")
        subprocess.run([PROGRAM, "conclude", out, "--quiet"], check=True)
        to = self.sized_report("leaderboard", 27_000, 13_000_000)
        self.assertIn("+ 12", support.page(to, "index.html"))  # six of 18 models are shown
        self.assertEqual(len(support.rows(support.page(to, "ranking.html"), "compact-meshes")), 20)

    def assert_few_elements(self, path, limit):
        """Limits elements whose number determines the browser's time."""
        browser = chromium.start()
        self.addCleanup(browser.quit)
        browser.get(path.as_uri())
        elements = browser.execute_script("return document.getElementsByTagName('*').length")
        print(f"{path.name}: {elements} elements")
        self.assertLess(elements, limit)
