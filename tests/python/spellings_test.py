# SPDX-License-Identifier: GPL-3.0-or-later
"""Alternative spellings and values out of range, through every interface: numbers of threads and processes, an item whose name is a keyword, and a
configuration named like a folder.
"""

import inspect
import os
import re
import shutil
import tempfile
import unittest
from pathlib import Path

import numpy as np
import pandas
import toy

import salbench
from salbench import models, stats
from salbench.datasets import sets
from tests.support import forked
from tests.support.shapes import FACES, POINTS

UNIT = np.array([[0, 0, 1.0]] * 4)
NO_COUNTS = {0: "0", -1: "-1", 1025: "1025", 10**7: "10000000", 2**31: "2147483648", 2**64: "18446744073709551616", -(2**70): "-1180591620717411303424"}
NO_NUMBERS = (2.0, "2", [2], float("nan"), b"2", 1j)
TABLE = pandas.DataFrame({"item": ["1", "2"], "model": ["LS", "LS"], "auc": [.5, .6]})


def with_threads(module):
    return {name for name in dir(module) if inspect.isfunction(getattr(module, name)) and "threads" in inspect.signature(getattr(module, name)).parameters}


class Counts(toy.InAFolder):
    CALLS = {
        "run": lambda data, n: salbench.run({"models": {"CB": None}}, data=data, cache=data / "c", out=data / "o", threads=n),
        "plan": lambda data, n: salbench.plan({"models": {"CB": None}}, data=data, cache=data / "c", out=data / "o", threads=n),
        "cross_validate": lambda data, n: salbench.cross_validate(lambda shapes: np.copy, data, {"models": {"CB": None}}, cache=data / "c",
                                                                 out=data / "o", threads=n),
        "estimate_normals": lambda _, n: salbench.estimate_normals(POINTS, FACES, threads=n),
        "fpfh": lambda _, n: salbench.fpfh(POINTS, UNIT, threads=n),
        "simulate_scans": lambda _, n: salbench.simulate_scans(POINTS, FACES, threads=n),
        "cast_rays": lambda _, n: salbench.cast_rays(POINTS, FACES, [[0, 0, 9]], [[0, 0, -1]], threads=n),
        "picture": lambda _, n: salbench.picture(POINTS, FACES, threads=n),
        "conclude": lambda _, n: stats.conclude(TABLE, threads=n),
        "ls": lambda _, n: models.ls(POINTS, FACES, UNIT, np.zeros((4, 33)), threads=n),
        "cb": lambda _, n: models.cb(POINTS, FACES, threads=n),
    }

    def test_every_function_that_takes_threads_has_a_row(self):
        known = {*self.CALLS, *(row.name.lower() for row in models.table())}
        for module in (salbench, stats, models):
            self.assertEqual(with_threads(module) - known, set(), module.__name__)

    def test_threads_of_functions(self):
        data = toy.meshes(self.folder / "data", 1)
        for name, call in self.CALLS.items():
            for count, shown in NO_COUNTS.items():
                with self.subTest(name, count=count), self.assertRaises(ValueError) as caught:
                    call(data, count)
                self.assertIn(f"threads must be a whole number from 1 to 1024, not {shown}", str(caught.exception))
            for count in NO_NUMBERS:
                with self.subTest(name, count=count), self.assertRaisesRegex((ValueError, TypeError), "threads must be a whole number"):
                    call(data, count)
        self.assertEqual(sorted(path.name for path in data.iterdir() if path.suffix != ".off"), [], "neither cache nor results")

    def test_counts_of_commands(self):
        out = self.folder / "out"
        for command, option, *words in (("report", "--processes", out), ("submit", "--threads", out, "--to", out / "a.zip"),
                                        ("leaderboard", "--threads", out, "--to", out / "site"), ("run", "--threads", "shrec07"),
                                        ("export", "--threads", "shrec07", "--to", out / "a.h5")):
            for count in ("0", "-1", "1025", "10000000", "18446744073709551616", "2.5", "two", "", " 2 x", "1e1", "nan"):
                line = [command, *map(str, words), f"{option}={count}"]
                done = forked.salbench(*line, before=lambda: os.chdir(self.folder))
                with self.subTest(command, count=count):
                    self.assertEqual((done.returncode, done.stdout), (2, ""), done.stderr)
                    self.assertIn(option, done.stderr.splitlines()[0])
                    if re.fullmatch("-?[0-9]+", count):
                        self.assertRegex(done.stderr, r"\b1024\b")
        self.assertEqual([*self.folder.iterdir()], [])


class Keyword(unittest.TestCase):
    """An item is called `scored`, as is the word for all items with ground truth."""

    def setUp(self):
        folder = Path(self.enterContext(tempfile.TemporaryDirectory()))
        self.data = folder / "data"
        made = sorted(toy.meshes(folder / "made", 4).glob("*.off"))
        (self.data / "Meshes").mkdir(parents=True)
        (self.data / "Distributions").mkdir()
        for path, name in zip(made, ("cow", "scored", "scored-1", "scored,cow")):
            n = int(path.read_text().split()[1])
            shutil.copy(path, self.data / f"Meshes/{name}.off")
            if name in ("cow", "scored-1"):
                (self.data / f"Distributions/{name}.val").write_text("1\n2\n" * (n // 2) + "1\n" * (n % 2))
        (self.data / "c.yaml").write_text("dataset: {layout: schelling, scans: false}\nmodels: {CB: }\n")

    ROWS = (("scored", {"cow", "scored-1"}), ("./scored", {"scored"}), ("./scored,cow", {"scored", "cow"}), ("cow,./scored", {"scored", "cow"}),
            ("scored,./scored", {"scored", "cow", "scored-1"}), ("scored-1", {"scored-1"}), ("./cow", {"cow"}), ("./scored-1", {"scored-1"}))

    def test_in_python(self):
        listing = sets.listed("schelling", str(self.data))[1]
        for text, names in (*self.ROWS, (["scored"], {"scored"}), (["scored,cow"], {"scored,cow"}), (["scored", "cow"], {"scored", "cow"})):
            with self.subTest(text):
                self.assertEqual({item.name for item in sets.chosen(listing, text)}, names)
                self.assertEqual(set(salbench.Dataset("schelling", self.data, items=text).ids), names)
        for text in (".scored", "/scored", "././scored", "Scored", "./"):
            with self.subTest(text), self.assertRaises((KeyError, ValueError)):
                sets.chosen(listing, text)


class NamesOfConfigurations(toy.InAFolder):
    """`salbench run NAME --out NAME`: the folder of that name is not the configuration, however the two are spelled, the first time and again."""

    def setUp(self):
        super().setUp()
        toy.meshes(self.folder / "data", 1)
        os.mkdir(self.folder / "sub")

    def run_twice(self, config, out):
        words = ["run", config, "--data", "data", "--cache", "cache", "--models", "RS", "--out", out, "--quiet"]
        for call in ("first", "again"):
            done = forked.salbench(*words, before=lambda: os.chdir(self.folder))
            with self.subTest(config, out=out, call=call):
                self.assertEqual((done.returncode, done.stdout), (0, ""), done.stderr)
                self.assertTrue((self.folder / out / "results.csv").is_file())

    def test_of_an_installed_one(self):
        for config, out in (("shrec07_meshes", "shrec07_meshes"), ("shrec07_meshes.yaml", "shrec07_meshes"), ("shrec07_meshes", "./shrec07_meshes"),
                            ("shrec07_meshes", "shrec07_meshes/"), ("shrec07_meshes.yaml", "shrec07_meshes.yaml")):
            self.run_twice(config, out)
            shutil.rmtree(self.folder / out)

    def test_of_a_file(self):
        text = "dataset: {layout: folder, scans: false}\nmodels: {RS: }\n"
        for config, out in (("mine", "mine.yaml.d"), ("mine.yaml", "mine"), ("./mine.yaml", "mine"), ("sub/mine.yaml", "sub/mine"), ("sub/mine.yaml", "sub")):
            (self.folder / config).write_text(text)
            self.run_twice(config, out)
            self.assertEqual((self.folder / config).read_text(), text)
            (self.folder / config).unlink()

    def test_that_is_shadowed(self):
        """A file beside the folder of results; a folder in place of the configuration, or of the results a file."""
        text = "dataset: {layout: folder, scans: false}\nmodels: {RS: }\n"
        (self.folder / "mine.yaml").write_text(text)
        (self.folder / "mine").mkdir()
        (self.folder / "empty.yaml").mkdir()
        for words, status, said in ((("mine",), 2, "mine"), (("empty.yaml",), 2, "empty.yaml"), (("empty",), 2, "empty"), (("none",), 2, "none"),
                                    (("mine.yaml", "--out", "mine.yaml"), 3, "mine.yaml"), (("mine.yaml", "--cache", "mine.yaml"), 3, "mine.yaml")):
            done = forked.salbench("run", *words, "--data", "data", "--quiet", before=lambda: os.chdir(self.folder))
            with self.subTest(words):
                self.assertEqual((done.returncode, done.stderr.count("\n")), (status, 1), done.stderr)
                self.assertIn(said, done.stderr)
                self.assertEqual((self.folder / "mine.yaml").read_text(), text)
