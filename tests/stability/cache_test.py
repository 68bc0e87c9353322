# SPDX-License-Identifier: GPL-3.0-or-later
"""An old cache is found: a run over it computes nothing."""

import json

import support

REMEDY = """the old cache is not found: {causes}.
Keys have changed. If no output did, give what is new in a key a value that older keys imply (CONTRIBUTING.md, Options). If the version of
a stage was raised, say under "Changes results" in CHANGELOG.md what changes, and add the stage, or the model, to RAISED."""


RAISED: set[str] = set()  # stages, and models by their names, whose version was raised since 1.1, and what gathers them


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

    def test_its_artefacts_are_sound(self):
        (cache,) = json.loads(self.said("verify --cache cache --format json"))["caches"]
        self.assertEqual((cache["artefacts"], cache["other_files"], cache["faults"]), (307, 0, []))
