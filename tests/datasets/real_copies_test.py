# SPDX-License-Identifier: GPL-3.0-or-later
"""The 380 real meshes, each compared with a shape that is one of them and with one that is not."""

import os
import tempfile
import unittest
from pathlib import Path

import numpy as np
from copies_test import WHOLE, turned
from support import off

import salbench
from salbench.datasets import copies

DATA = Path(os.environ.get("SALBENCH_DATA", ""), "SchellingData")


@unittest.skipUnless((DATA / "Meshes").is_dir(), "SALBENCH_DATA has no SchellingData")
class RealMeshes(unittest.TestCase):
    def test_one_of_380_is_found_and_another_shape_is_not(self):
        with tempfile.TemporaryDirectory() as folder:
            mesh = salbench.Dataset("schelling", DATA)["125"]
            few, fewer = salbench.simplify(turned(mesh.points), mesh.faces, len(mesh.faces) // 4)
            Path(folder, "unknown.off").write_text(off(np.asarray(few), np.asarray(fewer)))
            Path(folder, "bean.off").write_text(off(*WHOLE))
            found = copies.compared(("folder", folder), ("schelling", str(DATA)))
        self.assertEqual([pair[:2] for pair in found.near], [("unknown", "125")])
        self.assertEqual(found.problems, [])
