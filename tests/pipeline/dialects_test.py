# SPDX-License-Identifier: GPL-3.0-or-later
"""A mesh is the same in whatever dialect of a format a program wrote it: tables have the same bytes, and nothing behind the reading of the
mesh is computed again."""

import os
import re
import shutil
import tempfile
import unittest
from pathlib import Path

import numpy as np

import salbench.conclusions  # noqa: F401  and with it libraries that each call would import
from tests.support import dialects, forked

DATA = Path(os.environ.get("SALBENCH_DATA", ""), "SchellingData")
REAL = ("58", "114", "125")  # with 297, 2502 and no flat quads
CONFIG = "dataset: {{layout: folder, participants: {}, scans: false}}\nmodels: {{LS: , MC: , HS: , RS: }}\n"


def steps():
    """A solid of unit cubes side by side, of many heights: quads that are flat, in coordinates that no float holds."""
    heights = np.random.default_rng(3).integers(1, 5, (6, 7))
    full = np.zeros((8, 9, 7), bool)
    for x, y in np.ndindex(heights.shape):
        full[x + 1, y + 1, 1:1 + heights[x, y]] = True
    corners = {}
    faces = []
    for place in np.argwhere(full):
        for axis in range(3):
            for side in (0, 1):
                step = np.eye(3, dtype=int)[axis] * (2 * side - 1)
                if full[tuple(place + step)]:
                    continue
                u, v = np.eye(3, dtype=int)[(axis + 1) % 3], np.eye(3, dtype=int)[(axis + 2) % 3]
                start = place + np.eye(3, dtype=int)[axis] * side
                quad = [tuple(start + i * u + j * v) for i, j in ((0, 0), (1, 0), (1, 1), (0, 1))][::1 if side else -1]
                a, b, c, d = (corners.setdefault(corner, len(corners)) for corner in quad)
                faces += [(a, b, c), (c, d, a)]
    return np.array(list(corners)) * 0.1 + np.sqrt(2), np.array(faces)


class Dialects(unittest.TestCase):
    def setUp(self):
        self.folder = Path(self.enterContext(tempfile.TemporaryDirectory()))

    def run_of(self, dialect, participants):
        """The bytes of the table of scores, and how many artefacts were computed."""
        (self.folder / "c.yaml").write_text(CONFIG.format(participants))
        out = self.folder / f"out-{dialect}"
        done = forked.salbench("run", self.folder / "c.yaml", "--data", self.folder / dialect, "--cache", self.folder / "cache", "--out", out, "--quiet")
        self.assertEqual(done.returncode, 0, done.stderr)
        return (out / "results.csv").read_bytes(), int(re.search(r"artefacts_computed: (\d+)", (out / "run.yaml").read_text())[1])

    def check(self, meshes, participants):
        quads = sum(dialects.write_all(points, faces, name, self.folder) for name, (points, faces) in meshes.items())
        self.assertGreater(quads, 100)
        first, *others = dialects.DIALECTS
        expected, _ = self.run_of(first, participants)
        self.assertEqual(len(re.findall(rb"(?m)^meshes,.*,LS,0\.", expected)), len(meshes))
        for dialect in others:
            with self.subTest(dialect):
                results, computed = self.run_of(dialect, participants)
                self.assertEqual(results, expected)
                self.assertLessEqual(computed, len(meshes), "the meshes alone")

    def test_nine_dialects_of_toys_give_the_same_bytes(self):
        self.assertEqual(len(dialects.DIALECTS), 9)
        self.check({"steps": steps()}, "simulated")

    def test_nine_dialects_of_real_meshes_give_the_same_bytes(self):
        if not (DATA / "Meshes").is_dir():
            self.skipTest("needs real data: SALBENCH_DATA")
        for part, pattern in (("Distributions", "{}.val"), ("RawData", "{}_*.pid")):
            (self.folder / part).mkdir()
            for name in REAL:
                for file in (DATA / part).glob(pattern.format(name)):
                    shutil.copy(file, self.folder / part)
        self.check({name: dialects.read_off(DATA / f"Meshes/{name}.off") for name in REAL}, "measured")
