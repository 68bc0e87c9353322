# SPDX-License-Identifier: GPL-3.0-or-later
"""run.yaml, edited by hand: a field of another kind is named by every command that reads it; what people were asked, in words."""

import contextlib
import io
import shutil
import unittest

import yaml

import fixture
import support
from salbench import __main__
from salbench.conclusions.folders import read_record
from salbench.report.front import told_apart

ITEMS = fixture.eight_meshes()[:2]
WHOLE = fixture.run_yaml(("LS", "RS"), False, failed=[("3", "map.LS", "no faces")], extra=(
    "peak_memory_mb: 512\nshard: 1/2\nreference: mean\nlibraries: TBB\nscores_digest: abc\ncache_bytes: {mesh: 1000}\n"
    'evaluated: {model: MINE, maps: "maps", matched: false}\n'))

# A field as a path of names and numbers, what somebody wrote there, and what the message says.
SLIPS = [
    (["configuration"], "abc", 'configuration is "abc", not a mapping of names to values'),
    (["configuration"], [1], "configuration is a list, not a mapping"),
    (["configuration", "seed"], "x", 'configuration.seed is "x", not a whole number'),
    (["configuration", "seed"], 1.5, 'configuration.seed is "1.5", not a whole number'),
    (["configuration", "seed"], -1, 'configuration.seed is "-1", not a whole number'),
    (["configuration", "seed"], "9" * 5000, 'configuration.seed is "99'),
    (["configuration", "seed"], {"a": 1}, "configuration.seed is a mapping, not a whole number"),
    (["configuration", "protocol"], ["published"], "configuration.protocol is a list, not a text"),
    (["configuration", "statistics"], "mesh", 'configuration.statistics is "mesh", not a mapping'),
    (["configuration", "statistics", "unit"], "meshes", 'configuration.statistics.unit is "meshes", not one of mesh, class, shape'),
    (["configuration", "dataset"], "measured", 'configuration.dataset is "measured", not a mapping'),
    (["configuration", "models"], ["LS"], "configuration.models is a list, not a mapping"),
    (["configuration", "models", "LS"], "x", 'configuration.models.LS is "x", not a mapping'),
    (["configuration", "models", "LS"], {"trained": [1]}, "configuration.models.LS.trained is a list, not a text"),
    (["data_set"], "SchellingData", 'data_set is "SchellingData", not a mapping'),
    (["data_set", "participants"], 5, 'data_set.participants is "5", not a list of 2'),
    (["data_set", "participants"], [5], "data_set.participants is a list, not a list of 2"),
    (["data_set", "participants"], [5, "many"], 'data_set.participants[1] is "many", not a whole number'),
    (["data_set", "participants"], {"fewest": 5}, "data_set.participants is a mapping, not a list of 2"),
    (["data_set", "layout"], ["schelling"], "data_set.layout is a list, not a text"),
    (["data_set", "digest"], {}, "data_set.digest is a mapping, not a text"),
    (["metrics"], ["auc"], "metrics is a list, not a mapping"),
    (["metrics", "auc"], "higher", 'metrics.auc is "higher", not a mapping'),
    (["metrics", "auc", "better"], "up", 'metrics.auc.better is "up", not one of higher, lower'),
    (["metrics", "auc", "unit"], [1], "metrics.auc.unit is a list, not a text"),
    (["stages"], 5, 'stages is "5", not a mapping'),
    (["stages", "mesh"], 1, 'stages.mesh is "1", not a mapping'),
    (["stages", "mesh", "version"], "one", 'stages.mesh.version is "one", not a whole number'),
    (["stages", "mesh", "why"], ["new"], "stages.mesh.why is a list, not a mapping"),
    (["nodes"], {"stage": "mesh"}, "nodes is a mapping, not a list"),
    (["nodes", 0], "mesh", 'nodes[0] is "mesh", not a mapping'),
    (["nodes", 1, "seconds"], "long", 'nodes[1].seconds is "long", not a number'),
    (["nodes", 0, "stage"], ["mesh"], "nodes[0].stage is a list, not a text"),
    (["cache_bytes"], 5, 'cache_bytes is "5", not a mapping'),
    (["cache_bytes", "mesh"], "1 MB", 'cache_bytes.mesh is "1 MB", not a number'),
    (["failed"], "3", 'failed is "3", not a list'),
    (["failed", 0, "cause"], {"a": 1}, "failed[0].cause is a mapping, not a text"),
    (["evaluated"], "MINE", 'evaluated is "MINE", not a mapping'),
    (["evaluated", "model"], ["MINE"], "evaluated.model is a list, not a text"),
    *(([name], [1], f"{name} is a list, not a") for name in ("program", "results", "host", "libraries", "shard", "scores_digest", "reference",
                                                            "threads", "seconds", "peak_memory_mb", "artefacts_computed")),
    (["threads"], "all", 'threads is "all", not a number'),
]


def edited(path, value):
    record = yaml.load(WHOLE, yaml.BaseLoader)
    *above, last = path
    at = record
    for name in above:
        at = at[name]
    at[last] = value
    return yaml.safe_dump(record)


class Edited(support.ReportTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.out = cls.folder / "out"
        fixture.write_results(cls.out, ITEMS, ("LS", "RS"), results=fixture.results_table(ITEMS, ("LS", "RS"), views=1))

    def said(self, *arguments):
        """The status, and the lines that a command says."""
        errors = io.StringIO()
        with contextlib.redirect_stderr(errors), contextlib.redirect_stdout(io.StringIO()):
            return __main__.main([*map(str, arguments)]), errors.getvalue().splitlines()

    def test_each_field_of_another_kind_is_named(self):
        to = self.folder / "to"
        for path, value, message in SLIPS:
            (self.out / "run.yaml").write_text(edited(path, value))
            for command in (["conclude", self.out, "--out", to], ["report", self.out, "--to", to],
                            ["report", self.out, "--to", to]):
                with self.subTest(message, command=command[0]):
                    status, lines = self.said(*command)
                    self.assertEqual((status, len(lines)), (2, 1), lines)
                    self.assertIn(f"error: {self.out / 'run.yaml'}: {message}", lines[0])
                    self.assertFalse(to.exists())

    def test_what_is_absent_or_empty_is_no_slip(self):
        for value in ("", None):
            for within in (["configuration", "data_set"], []):
                record = yaml.load(WHOLE, yaml.BaseLoader)
                for fields in [record[name] for name in within] or [record]:
                    for name in set(fields) - {"metrics"}:
                        fields[name] = value
                        if value is None:
                            del fields[name]
                (self.out / "run.yaml").write_text(yaml.safe_dump(record))
                with self.subTest(within=within, value=value), support.without_figures():
                    self.assertEqual(support.make(self.out, self.folder / "made"), (0, ""))
                    shutil.rmtree(self.folder / "made")
                    self.assertEqual(self.said("conclude", self.out, "--out", self.folder / "made", "--quiet"), (0, []))
                    shutil.rmtree(self.folder / "made")

    def test_a_metric_of_somebody_says_which_scores_are_better(self):
        (self.out / "run.yaml").write_text(edited(["metrics", "own"], {"unit": "1"}))
        status, lines = self.said("conclude", self.out, "--out", self.folder / "to")
        self.assertEqual(status, 2)
        self.assertIn("metrics.own does not say which scores are better", lines[0])

    def test_every_scalar_is_a_text(self):
        (self.out / "run.yaml").write_text("results: finished\nmetrics: {NO: {better: lower}}\nconfiguration: {models: {ON: , 7: {trained: 1e3}}}\n")
        record = read_record(self.out / "run.yaml")
        self.assertEqual(record["configuration"]["models"], {"ON": {}, "7": {"trained": "1e3"}})
        self.assertEqual(record["metrics"], {"NO": {"better": "lower"}})


class People(unittest.TestCase):
    def test_how_many_there_were_per_shape(self):
        for participants, words in (
                (["0", "0"], "participants, pooled"), (["5", "5"], "5 participants per shape"), (["22", "25"], "22 to 25 participants per shape"),
                (["0", "5"], "up to 5 participants per shape, pooled on some"), ([], "participants"), (None, "participants")):
            self.assertEqual(told_apart({"participants": participants} if participants is not None else {}), words)
