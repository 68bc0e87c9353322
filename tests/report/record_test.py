# SPDX-License-Identifier: GPL-3.0-or-later
"""run.yaml, edited by hand: a field of another kind is named by every command that reads it; what people were asked, in words."""

import contextlib
import io
import re
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
    'evaluated: {model: MINE, maps: "maps", matched: false}\n' + fixture.metric_lines(["auc"])))

LONG = "9" * 5000
SLIPS = {  # what somebody wrote in a field, which is of another kind
    "configuration": ("abc", [1]), "configuration.seed": ("x", 1.5, -1, LONG, {"a": 1}), "configuration.protocol": (["published"],),
    "configuration.statistics": ("mesh",), "configuration.statistics.unit": ("meshes",), "configuration.dataset": ("measured",),
    "configuration.models": (["LS"],), "configuration.models.LS": ("x",), "configuration.models.LS.trained": ([1],),
    "data_set": ("SchellingData",), "data_set.participants": (5, [5], {"fewest": 5}), "data_set.participants[1]": ("many",),
    "data_set.layout": (["schelling"],), "data_set.digest": ({},),
    "metrics": (["auc"],), "metrics.auc": ("higher",), "metrics.auc.better": ("up",), "metrics.auc.unit": ([1],),
    "stages": (5,), "stages.mesh": (1,), "stages.mesh.version": ("one",), "stages.mesh.why": (["new"],),
    "nodes": ({"stage": "mesh"},), "nodes[0]": ("mesh",), "nodes[1].seconds": ("long",), "nodes[0].stage": (["mesh"],),
    "cache_bytes": (5,), "cache_bytes.mesh": ("1 MB",), "remarks": ("3",), "failed": ("3",), "failed[0].cause": ({"a": 1},),
    "evaluated": ("MINE",), "evaluated.model": (["MINE"],),
    "threads": ("all", [1]),
    **{name: ([1],) for name in ("program", "results", "host", "libraries", "shard", "scores_digest", "reference", "seconds",
                                 "peak_memory_mb", "artefacts_computed")},
}


def edited(field, value):
    record = yaml.load(WHOLE, yaml.BaseLoader)
    *above, last = [int(name) if name.isdigit() else name for name in re.findall(r"\w+", field)]
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
        table = fixture.with_metrics(fixture.results_table(ITEMS, ("LS", "RS"), views=1), ["auc"])
        fixture.write_results(cls.out, ITEMS, ("LS", "RS"), results=table, extra=fixture.metric_lines(["auc"]))

    def said(self, *arguments):
        """The status, and the lines that a command says."""
        errors = io.StringIO()
        with contextlib.redirect_stderr(errors), contextlib.redirect_stdout(io.StringIO()):
            return __main__.main([*map(str, arguments)]), errors.getvalue().splitlines()

    def test_each_field_of_another_kind_is_named(self):
        to = self.folder / "to"
        for field, value in ((field, value) for field, values in SLIPS.items() for value in values):
            (self.out / "run.yaml").write_text(edited(field, value))
            for command in (["conclude", self.out, "--out", to], ["report", self.out, "--to", to]):
                with self.subTest(field, value=str(value)[:20], command=command[0]):
                    status, lines = self.said(*command)
                    self.assertEqual((status, len(lines)), (2, 1), lines)
                    self.assertTrue(lines[0].startswith(f"error: {self.out / 'run.yaml'}: {field} is "), lines)
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
        (self.out / "run.yaml").write_text(edited("metrics.own", {"unit": "1"}))
        status, lines = self.said("conclude", self.out, "--out", self.folder / "to")
        self.assertEqual(status, 2)
        self.assertIn("metrics.own ", lines[0])

    def test_every_scalar_is_a_text(self):
        (self.out / "run.yaml").write_text("results: finished\nmetrics: {NO: {better: lower}}\nconfiguration: {models: {ON: , 7: {trained: 1e3}}}\n")
        record = read_record(self.out / "run.yaml")
        self.assertEqual(record["configuration"]["models"], {"ON": {}, "7": {"trained": "1e3"}})
        self.assertEqual(record["metrics"], {"NO": {"better": "lower"}})


class People(unittest.TestCase):
    def test_how_many_there_were_per_shape(self):
        for participants, words in (
                (["0", "0"], "number unknown, pooled"), (["5", "5"], "5 participants per shape"), (["22", "25"], "22 to 25 participants per shape"),
                (["0", "5"], "up to 5 participants per shape, pooled on some"), ([], "number unknown"), (None, "number unknown")):
            self.assertEqual(told_apart({"participants": participants} if participants is not None else {}), words)
