# SPDX-License-Identifier: GPL-3.0-or-later
"""A small data set in the Schelling study's form, maps that predict it well or badly, and the program over them."""

import csv
import random
import shutil
import subprocess
import tempfile
import unittest
from pathlib import Path

from salbench import _core
from salbench.leaderboard import commands  # noqa: F401: what the subcommands import is there before they start
from salbench.leaderboard.archive import read_zip, zip_of
from tests.support import forked
from tests.support.toy_data import PROGRAM, study


def card(name, date="2026-01-01", overlap="none", **others):
    fields = {"name": name, "citation": "Somebody, <i>A model</i>, 2026", "licence": "GPL", "training_data": "none", "test_overlap": overlap,
              "date": date, **others}
    return "".join(f"{key}: {value}\n" for key, value in fields.items())


def rewrite(entries, name, change):
    """Changes a text of an archive and the digest of it in the manifest, as somebody would who means to."""
    before, entries[name] = entries[name], change(entries[name])
    entries["submission.yaml"] = entries["submission.yaml"].replace(*(_core.digest(text).encode() for text in (before, entries[name])))


class Toy:
    def __init__(self, folder, meshes=6):
        self.folder, self.meshes = folder, range(1, meshes + 1)
        self.submissions, self.site, self.data = folder / "submissions", folder / "site", folder / "data set"
        self.submissions.mkdir()
        self.truth = study(self.data, self.meshes)
        self.config = folder / "toy.yaml"
        self.config.write_text("dataset: {scans: false}\nmetrics: [auc, cc]\nmodels: {RS: }\n")

    def salbench(self, command, *words, **others):
        line = [command, *words, "--data", self.data, "--cache", self.folder / "cache", "--threads", "2"]
        if not others:
            return forked.salbench(*line)
        return subprocess.run([PROGRAM, *line], capture_output=True, text=True, **others)

    def maps(self, name, noise):
        """Ground truth with more or less noise: the more, the worse the model."""
        numbers = random.Random(2)
        folder = self.folder / name
        folder.mkdir(exist_ok=True)
        for mesh in self.meshes:
            (folder / f"{mesh}.val").write_text("".join(f"{value + noise * numbers.random()}\n" for value in self.truth[mesh]))
        (folder / "card.yaml").write_text(card(name))
        return folder

    def submit(self, name, noise):
        return self.salbench("submit", self.maps(name, noise), "--to", self.submissions / f"{name}.zip", "-c", self.config)

    def spoil(self, file, change, of="G0"):
        """A copy of a good submission with other entries."""
        entries = read_zip((self.submissions / f"{of}.zip").read_bytes(), 100, 1 << 24)
        change(entries)
        (self.submissions / file).write_bytes(zip_of(entries.items()))

    def with_card(self, file, text, of="G0"):
        self.spoil(file, lambda entries: entries.update({"card.yaml": text.encode()}), of)

    def rank(self, *words, site=None):
        return self.salbench("leaderboard", self.submissions, "--to", site or self.site, "-c", self.config, *words)

    def table(self, name):
        with open(self.site / f"data/{name}.csv", encoding="utf-8", newline="") as file:
            return list(csv.DictReader(line for line in file if not line.startswith("#")))

    def verdicts(self):
        """Status and reason of each file."""
        return {row["file"]: row["status"] + (f": {row['reason']}" if row["reason"] else "") for row in self.table("submissions")}

    def page(self, name="index.html"):
        return (self.site / name).read_text(encoding="utf-8")


class OverSubmissions(unittest.TestCase):
    """Each test begins with these submissions, and no site. NOISES: of the maps of G0 and so on."""

    NOISES = ()
    AT_FIRST = ("G0", "G1")

    @classmethod
    def setUpClass(cls):
        cls.toy = Toy(Path(cls.enterClassContext(tempfile.TemporaryDirectory())))
        for number, noise in enumerate(cls.NOISES):
            made = cls.toy.submit(f"G{number}", noise)
            assert made.returncode == 0, made.stderr
        cls.good = everything(cls.toy.submissions)

    def setUp(self):
        for folder in (self.toy.submissions, self.toy.site):
            shutil.rmtree(folder, ignore_errors=True)
        self.submissions(*self.AT_FIRST)

    def submissions(self, *names):
        self.toy.submissions.mkdir(exist_ok=True)
        for name in names:
            (self.toy.submissions / f"{name}.zip").write_bytes(self.good[f"{name}.zip"])

    def rank(self, status=0, *words):
        done = self.toy.rank(*words)
        self.assertEqual(done.returncode, status, done.stderr)
        return done


def everything(site):
    return {str(path.relative_to(site)): path.read_bytes() for path in sorted(site.rglob("*")) if path.is_file()}
