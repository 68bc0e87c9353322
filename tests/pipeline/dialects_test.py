# SPDX-License-Identifier: GPL-3.0-or-later
"""A mesh reads the same from every dialect of a format that programs write."""

import os
import tempfile
import unittest
from pathlib import Path

import numpy as np

import salbench
from tests.support import dialects

DATA = Path(os.environ.get("SALBENCH_DATA", ""), "SchellingData/Meshes")
REAL = ("58", "114", "125")  # with 297, 2502 and no flat quads


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
    def check(self, meshes):
        folder = Path(self.enterContext(tempfile.TemporaryDirectory()))
        quads = sum(dialects.write_all(points, faces, name, folder) for name, (points, faces) in meshes.items())
        self.assertGreater(quads, 100)
        sets = {dialect: salbench.Dataset("folder", folder / dialect) for dialect in dialects.DIALECTS}
        for dialect, name in ((dialect, name) for dialect in sets for name in meshes):
            with self.subTest(dialect, name=name):
                shape, expected = sets[dialect][name], sets["off"][name]
                self.assertEqual(sorted(map(tuple, shape.points.tolist())), sorted(map(tuple, meshes[name][0].tolist())))
                np.testing.assert_array_equal(shape.points, expected.points)
                np.testing.assert_array_equal(shape.faces, expected.faces)

    def test_nine_dialects_of_toys_give_the_same_bytes(self):
        self.assertEqual(len(dialects.DIALECTS), 9)
        self.check({"steps": steps()})

    @unittest.skipUnless(DATA.is_dir(), "needs real data: SALBENCH_DATA")
    def test_nine_dialects_of_real_meshes_give_the_same_bytes(self):
        self.check({name: dialects.read_off(DATA / f"{name}.off") for name in REAL})
