# SPDX-License-Identifier: GPL-3.0-or-later
"""Exports contain exactly the stages of docs/tables/stages.csv, at the listed paths."""

import csv
import os
import re
import subprocess
import tempfile
import types
import unittest
from pathlib import Path

import h5py

import pages
from salbench.datasets import Recording, write

PROGRAM = os.environ.get("SALBENCH_PROGRAM", str(pages.ROOT / "build/release/salbench"))
EVERYTHING = """
dataset: {layout: hdf5}
scan: {step_degrees: 2}
picture: {size: 16}
models: {LS: , MS: , HS: {draws: 5}, RS: }
metrics: {names: [auc, sauc], smoothing: [2]}
"""
OF_FACES = "dataset: {layout: faces.py, scans: false, score_on: faces}\nmodels: {RS: }\nmetrics: {names: [cc]}\n"
FACES = """
from salbench.datasets import Item, face_values, from_faces, match, mesh


def items(root):
    return [Item(one.item, [one.path, f"{root}/values/{one.item}.txt"]) for one in match(root, "off/{item}.off")]


def read(item):
    shape = mesh(item.files[0])
    shape.face_truth = face_values(item.files[1], shape)
    shape.ground_truth = from_faces(shape, shape.face_truth)
    return shape
"""


def documented():
    """(place, stage) of each row of docs/tables/stages.csv that has a place."""
    with open(pages.ROOT / "docs/tables/stages.csv", encoding="utf-8", newline="") as file:
        return {(row["place"], row["stage"]) for row in csv.DictReader(file) if row["place"]}


def exported(path, named):
    """Likewise of a file; a model's own name is MODEL, unless the stage is known by it."""
    def as_documented(stage):
        return stage if stage in named else re.sub(r"\..*", ".MODEL", stage)

    with h5py.File(path) as file:
        items = [item for item in file.values() if "dataset" in item.attrs]
        found = {("/ITEM", as_documented(stage)) for item in items for stage in item}
        found |= {("/means", as_documented(stage)) for stage in file["means"]}
        return found | ({("/scores", "scores.MODEL")} if len(file["scores"]) else set())


class ExportStages(unittest.TestCase):
    def setUp(self):
        self.folder = Path(self.enterContext(tempfile.TemporaryDirectory()))

    def export(self, config, data, *further):
        (self.folder / "config.yaml").write_text(config)
        subprocess.run([PROGRAM, "export", "config.yaml", "--data", data, "--cache", "cache", "--to", "made.h5", "--quiet", *further], cwd=self.folder,
                       check=True)
        return exported(self.folder / "made.h5", {stage for _, stage in documented()})

    def of_faces(self):
        """A set whose ground truth is of faces."""
        (self.folder / "values").mkdir()
        subprocess.run([pages.ROOT / "scripts/toy_meshes.py", self.folder / "off", "2", "6", "8"], check=True)
        for path in (self.folder / "off").glob("*.off"):
            faces = int(path.read_text().split()[2])
            (self.folder / f"values/{path.stem}.txt").write_text("".join(f"{face % 7}\n" for face in range(faces)))
        (self.folder / "faces.py").write_text(FACES)
        return self.export(OF_FACES, ".")

    def of_gaze(self):
        """A set whose ground truth is made of recordings, by all stages."""
        shape = types.SimpleNamespace(
            id="wedge", points=[[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], faces=[[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]],
            recording=Recording(("A",), [0, 0], [0, 100], [True, True], [[5, 5, 5]] * 2, [[-1 / 3 ** 0.5] * 3] * 2, durations=[90, 90]))
        write(self.folder / "gaze", [shape])
        return self.export("dataset: {layout: hdf5, scans: false}\nmodels: {RS: }\ngaze: {visible: divided}\n", "gaze")

    def test_exports_have_the_stages_of_the_table_and_it_has_theirs(self):
        found = self.export(EVERYTHING, pages.ROOT / "tests/stability/examples/set") | self.of_faces() | self.of_gaze()
        self.assertEqual(sorted(found - documented()), [], "not in the table")
        self.assertEqual(sorted(documented() - found), [], "in no export")
