# SPDX-License-Identifier: GPL-3.0-or-later
"""An old cache is found: a run over it computes nothing."""

import csv
import json
import shutil
import tempfile
import unittest
from pathlib import Path

import support

REMEDY = """the old cache is not found: {causes}.
Keys have changed. If no output did, give what is new in a key a value that older keys imply (CONTRIBUTING.md, Options). If the version of
a stage was raised, say under "Changes results" in CHANGELOG.md what changes, and add the stage, or the model, to RAISED."""


# Stages, and models by their names, whose version was raised since 1.0, and what gathers them: scores, whose draws no longer follow from the name of a model;
# and pictures, since those of scans and clouds show the partial mesh.
RAISED = {"scores", "score_table", "smoothed_scores", "smoothed_table", "curve", "picture"}


class Cache(support.OldExamples):
    def assert_found(self, folder, run):
        """All but what was raised."""
        plan = json.loads(support.salbench(folder, run.replace("run", "plan") + " --format json").stdout)
        causes = [
            f"{stage['stage']}: {reason['why']}"
            for stage in plan["stages"]
            if stage["to_compute"] + stage["waiting"] and RAISED.isdisjoint(stage["stage"].split("."))
            for reason in stage["reasons"] or [{"why": "waits"}]
        ]
        self.assertEqual(causes, [], REMEDY.format(causes="; ".join(causes)))

    def test_runs_over_it_compute_nothing_that_was_not_raised(self):
        for run in support.RUNS:
            with self.subTest(run):
                self.assert_found(self.folder, run)
                self.said(run)
                self.assertEqual(json.loads(self.said(run + " --format json"))["computed"], 0)

    def test_what_its_maps_cost_is_not_known(self):
        self.said(support.RUNS[0] + " --quiet")
        with open(next(self.folder.rglob("costs.csv")), newline="") as file:
            costs = list(csv.DictReader(file))
        self.assertTrue(costs)
        for row in costs:
            known = {row[name] for name in ("seconds", "processor_seconds", "input_seconds")} - {""}
            self.assertEqual(bool(known), row["model"] in RAISED, row)

    def test_its_artefacts_are_sound_and_of_the_form_of_today(self):
        (cache,) = json.loads(self.said("verify --cache cache --format json"))["caches"]
        self.assertEqual((cache["artefacts"], cache["other_files"], cache["faults"]), (len(list(self.folder.glob("cache/*/*/*.h5"))), 0, []))

    def test_gc_turns_it_into_segments_that_are_found_as_well(self):
        with tempfile.TemporaryDirectory() as scratch:
            folder = Path(scratch) / "old"
            shutil.copytree(self.folder, folder)
            for line in ("gc meshes.yaml --quiet", "verify --cache cache"):
                done = support.salbench(folder, line)
                self.assertEqual(done.returncode, 0, f"{line}: {done.stderr}")
            self.assert_found(folder, "run meshes.yaml")
            self.assertEqual([path.name for path in (folder / "cache").iterdir() if path.name == "mesh"], [])
            self.assertIn("format 2", (folder / "cache/CACHEDIR.TAG").read_text())
            names = {path.name.partition(".")[0] for path in (folder / "cache").glob("??/*.h5")}
            self.assertNotIn("1_0", names, "scans lie with their mesh")


if __name__ == "__main__":
    unittest.main()
