# SPDX-License-Identifier: GPL-3.0-or-later
"""Conclusions from the scores of a run: when they are drawn, and what becomes of a run without them."""

import json
import os
import signal
import time
from unittest import mock

from salbench import conclusions
from salbench.conclusions import TABLES, folders
from support import Workspace, without

FILES = [folders.CONCLUDED, *(f"{table.name}.csv" for table in TABLES)]


def without_scipy():
    without("scipy")


def doing(work):
    """In place of conclusions."""
    return lambda: mock.patch.object(conclusions, "conclude", lambda *_, **__: work()).start()


def fail():
    raise RuntimeError("no room")


def interrupted():
    os.kill(os.getpid(), signal.SIGINT)
    time.sleep(1000)


class Conclusions(Workspace):
    def there(self):
        return [name for name in FILES if (self.out / name).exists()]

    def test_they_are_drawn_once_and_are_those_of_the_table(self):
        first = self.salbench("run").stdout
        self.assertLessEqual({"conclusions.json", "summary.csv", "ranking.csv", "leaders.csv"}, {*self.there()})
        self.assertIn("\nOn 2 meshes, PS is the only model", first)
        sentences = first.partition("maps of ")[0]
        again = self.salbench("run", before=doing(fail))
        self.assertEqual((again.stdout.partition("maps of ")[0], "conclusions" in again.stderr), (sentences, False))
        again = self.salbench("run", before=without_scipy)
        self.assertEqual((again.stdout.partition("maps of ")[0], "conclusions" in again.stderr), (sentences, False))
        self.said("conclude", self.out / "results.csv", "--out", self.folder / "concluded")
        for name in ("summary.csv", "ranking.csv", "significance.csv", "per_class.csv", "compact.csv", "leaders.csv"):
            self.assertEqual((self.folder / "concluded" / name).read_bytes(), (self.out / name).read_bytes(), name)

    def test_stale_ones_go_before_new_scores_are_written(self):
        self.salbench("run")
        for name in FILES:
            self.write(f"out/{name}", "of an earlier run")
        self.configure("dataset: {scans: false}\nmodels: {PS: , LS: , RS: }\n")
        done = self.salbench("run", before=without_scipy)
        self.assertEqual(self.there(), [])
        self.assertTrue(self.rows(model="LS"))
        self.assertRegex(done.stdout, "^dataset  metric     model  n     mean\n")
        self.assertRegex(done.stderr, "(?m)^warning: no conclusions: .*scipy")
        scores = json.loads(self.salbench("run", "--format", "json", before=without_scipy).stdout)["scores"]
        self.assertEqual({(row["model"], row["n"]) for row in scores}, {(model, "2") for model in ("PS", "LS", "RS")})
        self.assertRegex(self.said("conclude", self.out, status=2, before=without_scipy).stderr, "^error: .*scipy")
        self.salbench("run")
        summary = (self.out / "summary.csv").read_bytes()
        self.configure("dataset: {scans: false}\nmodels: {PS: , LS: , RS: }\nstatistics: {unit: class}\n")
        self.salbench("run")
        self.assertNotEqual((self.out / "summary.csv").read_bytes(), summary, "the unit is a part of what they are of")

    def test_a_failure_keeps_the_scores_and_is_said(self):
        done = self.salbench("run", status=70, before=doing(fail))
        self.assertRegex(done.stderr, f"(?m)^error: {self.out}: the scores are there, but no conclusions .*: no room; salbench conclude ")
        self.assertTrue(self.rows(model="PS"))
        self.assertNotIn("conclusions.json", self.there())
        self.salbench("run", status=130, before=doing(interrupted))
        self.assertNotIn("conclusions.json", self.there())
        self.salbench("run")
        self.assertEqual((self.computed(), "conclusions.json" in self.there()), (0, True))

    def test_models_without_a_map_are_those_of_this_run(self):
        for names, why in (("AB", "first"), ("AB", "second"), ("B", "second"), ("BC", "second"), ("B", f"{300 * 'x'} with a remedy")):
            models = "".join(f', {name}: {{command: "echo {why}; false {{mesh}} {{out}}"}}' for name in names)
            self.configure(f"dataset: {{scans: false}}\nmodels: {{PS: {models}}}\n")
            said = self.salbench("run", status=1).stdout
            self.assertRegex(said, rf"(?m)^{len(names)} of {1 + len(names)} models .* no map: {' and '.join(names)}, because .*{why[-13:]}")

    def test_a_share_draws_none(self):
        self.salbench("run", "--shard", "1/1", before=doing(fail))
        self.assertEqual(self.there(), [])
