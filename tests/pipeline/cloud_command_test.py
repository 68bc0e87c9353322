# SPDX-License-Identifier: GPL-3.0-or-later
"""A command of the user gets the point clouds of SAL3D and returns maps, which are scored like any other model's: docs/own_model.py, which is
started once for all of them, beside NumPy."""

import os
import subprocess
import tempfile
import unittest
from pathlib import Path

import numpy as np
import pandas as pd
from protocols_twin_test import PROGRAM, ROOT, bumpy_sphere, correlation, similarity

CONFIG = """\
dataset: {layout: sal3d}
metrics: {names: [cc, sim], matching: none}
models:
  MINE: {command: "/usr/bin/python3 own_model.py {list.h5}", depends: [own_model.py], reads: [points, normals], gpu: 1}
  RS:
"""


def from_mean(points):
    return np.linalg.norm(points - points.mean(axis=0), axis=1)


class CloudCommand(unittest.TestCase):
    def setUp(self):
        holder = tempfile.TemporaryDirectory()
        self.addCleanup(holder.cleanup)
        self.folder = Path(holder.name)
        (self.folder / "own_model.py").write_text((ROOT / "docs/own_model.py").read_text())
        (self.folder / "mine.yaml").write_text(CONFIG)

    def check(self, data, *selection):
        for subcommand, further in (("export", ["--to", "maps", "--format", "maps"]), ("run", ["--out", "out"])):
            subprocess.run([PROGRAM, subcommand, "mine.yaml", "--data", data, "--cache", "cache", "--quiet", *selection, *further],
                           cwd=self.folder, check=True)
        table = pd.read_csv(self.folder / "out/results.csv")
        rows = table[table["model"] == "MINE"].set_index("item")
        self.assertEqual(set(table["dataset"]), {"clouds"})
        for item, row in rows.iterrows():
            columns = np.loadtxt(data / f"Gaze/{item}.txt")
            map_ = np.loadtxt(self.folder / f"maps/MINE/{item}.val")
            np.testing.assert_allclose(map_, from_mean(columns[:, :3]), rtol=1e-12)
            self.assertAlmostEqual(row["cc"], correlation(map_, columns[:, 6]), delta=1e-9)
            self.assertAlmostEqual(row["sim"], similarity(map_, columns[:, 6]), delta=1e-9)
        return rows.index.tolist()

    def test_a_miniature(self):
        rng = np.random.default_rng(2)
        (self.folder / "data/Gaze").mkdir(parents=True)
        for k, name in enumerate(("cat", "cow", "dog")):
            points, _ = bumpy_sphere(k)
            density = np.maximum(0, rng.normal(size=len(points)))
            rows = np.column_stack([points, 6.28 * points, density, density > 1])
            (self.folder / f"data/Gaze/{name}.txt").write_text("".join(" ".join(map(repr, row)) + "\n" for row in rows.tolist()))
        (self.folder / "data/splits.csv").write_text("item,split\ncat,train\ncow,test\ndog,test\n")
        self.assertEqual(self.check(self.folder / "data", "--split", "test"), ["cow", "dog"])

    @unittest.skipUnless(os.environ.get("SALBENCH_DATA"), "SALBENCH_DATA is not set")
    def test_real_clouds(self):
        self.assertEqual(len(self.check(Path(os.environ["SALBENCH_DATA"]) / "sal3d", "--split", "val")), 6)


if __name__ == "__main__":
    unittest.main()
