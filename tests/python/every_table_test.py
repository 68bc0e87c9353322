# SPDX-License-Identifier: GPL-3.0-or-later
"""Whatever CSV file the program or the package writes is a table to pandas.read_csv as it stands: its first line is the header, and what
is said of all of it stands in the last column."""

import csv
import os
import pathlib
import shutil
import sys
import tempfile
import unittest

import numpy as np
import pandas

import salbench
import toy
from salbench import conclusions
from salbench.leaderboard import site  # noqa: F401: what the subcommands import is there before they start
from salbench.report import write  # noqa: F401
from tests.support import forked
from tests.support.without_figures import without_figures

METRICS = "metrics: {names: [cc], smoothing: [5]}\n"
SIMULATED = "dataset: {participants: simulated, scans: true}\nmodels: {PS: , RS: , HS: }\n" + METRICS
MEASURED = "dataset: {scans: false}\nmodels: {RS: }\n" + METRICS


@unittest.skipIf("libasan" in os.environ.get("LD_PRELOAD", ""), "AddressSanitizer needs all of the address space, of which a submission has 1 GB")
class EveryTable(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(cls.enterClassContext(tempfile.TemporaryDirectory()))
        cls.remarked = {}  # folders of tables that all have remarks, and how each of these begins
        cls.inputs = set()
        cls.simulated()
        cls.cross_validated()
        cls.imported()

    @classmethod
    def salbench(cls, *words, work=lambda: None):
        """A subcommand of the package, or other work, in a process of its own."""
        def before():
            os.chdir(cls.folder)
            without_figures().__enter__()
            work()

        done = forked.salbench(*words, before=before)
        if done.returncode:
            raise AssertionError(f"{words}: {done.stderr}")

    @classmethod
    def has(cls, name, *remarks):
        cls.remarked[cls.folder / name] = remarks

    @classmethod
    def simulated(cls):
        toy.meshes(cls.folder / "meshes", 2)
        (cls.folder / "simulated.yaml").write_text(SIMULATED)
        common = ["simulated.yaml", "--data", "meshes", "--cache", "cache"]
        cls.salbench("run", *common, "--out", "simulated")
        cls.salbench("conclude", "simulated", "--unit", "shape", "--out", "simulated_by_shape")
        cls.salbench("conclude", "simulated/results.csv", "--out", "simulated_table")
        shutil.rmtree(cls.folder / "cache")  # or the report has pictures of shapes
        cls.salbench("report", "simulated", "--to", "pages", "--no-viewer")
        for name in ("simulated", "simulated_by_shape"):
            cls.has(name, "SIMULATED")

    @classmethod
    def cross_validated(cls):
        toy.learnable(cls.folder / "data")
        (cls.folder / "measured.yaml").write_text(MEASURED)
        cls.salbench(work=cls.trained)
        common = ["-c", "measured.yaml", "--data", "data", "--cache", "cache"]
        cls.salbench("submit", "mine", "--to", "submissions/mine.zip", *common)
        cls.salbench("leaderboard", "submissions", "--to", "site", "--models", "RS", *common)
        cls.salbench("conclude", "validated", "--out", "validated_again")
        cls.has("validated_again", "MINE: cross-validated")

    @classmethod
    def trained(cls):
        results = salbench.cross_validate(lambda shapes: lambda shape: shape.points[:, 2], "data", "measured.yaml", by="class", folds=2, models={"RS": {}},
                                          cache="cache", out="validated", progress=False)
        results.write_submission("mine", "MINE", citation="nobody", licence="GPL")
        sys.exit(0)

    @classmethod
    def imported(cls):
        """Imports a set whose ground truth differs from the published one."""
        points = np.stack([np.cos(np.arange(200)), np.sin(np.arange(200)), np.arange(200) / 99], axis=1)
        (cls.folder / "archive/Gaze").mkdir(parents=True)
        cls.inputs.add(cls.folder / "archive/splits.csv")
        (cls.folder / "archive/splits.csv").write_text("item,split\ncat,train\ncow,test\n")
        for k, name in enumerate(("cat", "cow")):
            values = np.random.default_rng(k).random(len(points))
            np.savetxt(cls.folder / f"archive/Gaze/{name}.txt", np.column_stack([points, points, values, values > .9]), "%.17g")
        (cls.folder / "clouds.yaml").write_text("dataset: {layout: hdf5}\n" + SIMULATED.splitlines()[1] + "\n")
        cls.salbench("import", "sal3d", "--data", "archive", "--to", "imported")
        cls.salbench("run", "clouds.yaml", "--data", "imported", "--cache", "cache", "--out", "clouds")
        for name in ("imported", "clouds"):
            cls.has(name, "TRUTH")

    def tables(self):
        return sorted(set(self.folder.rglob("*.csv")) - self.inputs)

    def test_pandas_reads_it_as_it_stands(self):
        for path in self.tables():
            with self.subTest(str(path.relative_to(self.folder))), open(path, encoding="utf-8", newline="") as file:
                header, *rows = csv.reader(file, strict=True)
                frame = pandas.read_csv(path)
                self.assertEqual((list(frame), frame.shape), (header, (len(rows), len(header))))
                self.assertFalse([name for name in header if name.lstrip().startswith("#")])
                self.assertNotIn("remarks", header[:-1])
                if "remarks" in header:
                    self.assertLessEqual(frame["remarks"].nunique(dropna=False), 1)

    def test_what_is_said_of_all_of_it_is_in_each(self):
        for folder, beginnings in self.remarked.items():
            found = sorted(folder.glob("*.csv"))
            self.assertTrue(found, folder)
            for path in found:
                with self.subTest(str(path.relative_to(self.folder))):
                    if path.name in ("costs.csv", "folds.csv", "training.csv"):  # of no scores
                        continue
                    frame = pandas.read_csv(path)
                    self.assertEqual(frame.columns[-1], "remarks")
                    self.assertTrue(frame["remarks"].str.startswith(beginnings).all())

    def test_there_is_every_table(self):
        there = {path.stem for path in self.tables()}
        self.assertEqual({table.name for table in conclusions.TABLES} - there, set())
        self.assertLessEqual({"results", "means", "constant", "people", "smoothed", "costs", "folds", "training", "index", "submissions",
                              "mean_histograms_clouds"}, there)
