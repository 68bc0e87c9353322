# SPDX-License-Identifier: GPL-3.0-or-later
"""A night before a deadline: five networks written as closures, one fails in training, one in predicting, and the machine goes down in between.
Asked is what run, report, submission and reproduction say."""

import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import unittest

import toy

import salbench
from salbench.leaderboard import site  # noqa: F401: what the subcommands import is there before they start
from salbench.report import write  # noqa: F401
from tests.support import forked
from tests.support.without_figures import without_figures

DEADLINE = '''
import os, pathlib, signal, sys, warnings
import numpy as np
import salbench

data, layout, work = sys.argv[1:]
log, power = pathlib.Path(work, "log"), pathlib.Path(work, "power")

def network(name, width):
    def fit(shapes, fold):
        with open(log, "a") as file:
            print(name, fold, file=file)
        if name == "DEEP":
            raise RuntimeError(f"loss is NaN in step {fold}")
        if name == "WIDE" and fold == 2 and not power.exists():
            power.touch()
            os.kill(os.getpid(), signal.SIGKILL)
        layer = lambda points: np.tanh(points - points.mean(axis=0))[:, :width]
        x = np.vstack([layer(shape.points[shape.mask]) for shape in shapes])
        y = np.concatenate([shape.ground_truth[shape.mask] for shape in shapes])
        weights = np.linalg.lstsq(x, y, rcond=None)[0]
        def predict(shape):
            return (layer(shape.points) @ weights)[:-1] if name == "CUT" else layer(shape.points) @ weights
        return predict
    return fit

networks = {name: network(name, 1 + number % 3) for number, name in enumerate(("FULL", "WIDE", "DEEP", "CUT", "NO-A"))}
config = {"dataset": {"layout": layout, "scans": False}, "metrics": {"names": ["cc", "nss"]}}
results = salbench.cross_validate(networks, data, config, folds=4, by="mesh", models={"RS": {}}, keep=f"{work}/kept",
                                  cache=f"{work}/cache", out=f"{work}/out", progress=False)
if power.stat().st_size == 0:
    power.write_text("on")
    results.write_submission(f"{work}/full", "FULL", citation="Somebody, Full, 2026", licence="GPL")
'''
MISSING = "2 of 6 models have no map: DEEP, because RuntimeError: loss is NaN in step"


class Ablations(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.work = pathlib.Path(cls.enterClassContext(tempfile.TemporaryDirectory()))
        cls.data, layout = cls.data_set(cls.work)
        (cls.work / "deadline.py").write_text(DEADLINE)
        line = [sys.executable, "-B", cls.work / "deadline.py", cls.data, layout, cls.work]
        cls.runs = [subprocess.run(line, capture_output=True, text=True, cwd=cls.work) for _ in range(3)]
        cls.results = salbench.Results(cls.work / "out")

    @staticmethod
    def data_set(work):
        return toy.learnable(work / "data"), "schelling"

    def salbench(self, *line, status=0):
        def before():
            os.chdir(self.work)
            without_figures().__enter__()

        done = forked.salbench(*line, before=before)
        self.assertEqual(done.returncode, status, done.stderr)
        return done

    def test_nothing_is_trained_twice(self):
        self.assertEqual([done.returncode for done in self.runs], [-signal.SIGKILL, 0, 0], self.runs[1].stderr)
        trained = (self.work / "log").read_text().splitlines()
        for name in ("FULL", "NO-A"):
            self.assertEqual(sorted(line for line in trained if line.startswith(name)), [f"{name} {fold}" for fold in range(4)])
        self.assertEqual(sorted(line for line in trained if line.startswith("WIDE")), ["WIDE 0", "WIDE 1", "WIDE 2", "WIDE 2", "WIDE 3"])
        self.assertLessEqual(sum(line.startswith("DEEP") for line in trained), 2 * len(self.runs))
        self.assertLessEqual(len({line for line in trained if line.startswith("CUT")}), 2)

    def test_who_is_missing_is_said_first_and_last(self):
        said = self.runs[1].stderr
        self.assertIn(f"RuntimeWarning: {MISSING}", said)
        self.assertNotIn("is not kept", said)
        self.assertEqual(set(self.results.failed), {"DEEP", "CUT"})
        self.assertRegex(self.results.failed["CUT"], r"InputError: the map: \d+ values, but the shape has \d+ points")
        self.assertEqual(set(self.results.trained), {"FULL", "WIDE", "NO-A"})
        told = self.salbench("conclude", self.work / "out").stdout
        self.assertLess(told.index(MISSING), told.index("On "))

    def test_the_report_says_so_and_has_folds_and_costs(self):
        cache = (self.work / "cache").rename(self.work / "away")  # or the report has pictures of all shapes
        self.addCleanup(cache.rename, self.work / "cache")
        self.salbench("report", self.work / "out", "--to", self.work / "report", "--quiet", "--no-viewer")
        first, folds, run = ((self.work / f"report/{page}.html").read_text() for page in ("index", "folds", "run"))
        self.assertIn(f"<p><strong>Missing:</strong> {MISSING}", first)
        self.assertNotIn("DEEP: cross-validated", first)
        self.assertEqual([run.count(f"{name}() raised") for name in ("DEEP", "CUT")], [1, 1])
        for said in ("Scores per fold", "Seconds of training", "cross-validated, 4 folds by mesh"):
            self.assertIn(said, folds)
        self.assertFalse(self.results.training.loc[self.results.training.model == "FULL", "seconds"].isna().any())
        done = self.salbench("report", self.work / "out", "--mine", "DEEP", "--to", self.work / "mine", status=2)
        self.assertIn("--mine DEEP: has no scores", done.stderr)

    def test_a_split_takes_no_part(self):
        self.assertNotIn("split", self.results.ranking.columns)
        self.assertEqual(len(self.results.ranking.query("metric == 'cc' and model == 'FULL'")), 1)

    def test_others_make_the_same_maps(self):
        mine = self.work / "full"
        self.assertIn(f"salbench=={salbench.__version__}\n", (mine / "requirements.txt").read_text())
        self.salbench("submit", mine, "-c", mine / "model.yaml", "--data", self.data, "--to", self.work / "full.zip", "--quiet")
        done = self.salbench("reproduce", self.work / "full.zip", "--model", mine, "--data", self.data)
        self.assertRegex(done.stdout, r"FULL: to the bit: (\d+) of \1 maps are the same to the bit")
        self.salbench("run", mine / "model.yaml", "--data", self.data, "--items", "scored", "--cache", self.work / "other",
                      "--out", self.work / "again")
        results = salbench.Results(self.work / "again")
        self.assertEqual(results.trained, {"FULL": "cross-validated, 4 folds by mesh"})
        ours = self.results.scores.query("model == 'FULL'").set_index("item").cc
        self.assertTrue(results.scores.query("model == 'FULL'").set_index("item").cc.equals(ours))
