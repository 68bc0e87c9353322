# SPDX-License-Identifier: GPL-3.0-or-later
"""Shapes of an extent that says nothing about them, or that is too small or too large to compute with.

Neighbourhoods as wide as a part of R are refused where they hold too many points. Coordinates of a size from 1e-50 to 1e50 give the result of
size 1; others are refused.
"""

import tempfile
import unittest
from pathlib import Path

import numpy as np
from scipy.spatial import ConvexHull

import salbench
from tests.support.shapes import off

N = 2400  # points of most shapes


def sphere(n=N):
    """Even points on the unit sphere."""
    i = np.arange(n) + 0.5
    z, angle = 1 - 2 * i / n, np.pi * (1 + 5**0.5) * i
    flat = np.sqrt(1 - z * z)
    return np.stack([flat * np.cos(angle), flat * np.sin(angle), z], 1)


def strays(distances):
    """A sphere, and points so far along an axis."""
    return np.vstack([sphere(), np.outer(distances, [1, 0, 0])])


# name: points, and whether they are refused
SHAPES = {
    "a sphere": (sphere(), False),
    "a line": (np.stack([np.linspace(0, 1, N), np.zeros(N), np.zeros(N)], 1), False),
    "a stray": (strays([1e4]), True),
}
FUNCTIONS = {
    "NV": salbench.models.nv,
    "CS": salbench.models.cs,
    "LS": salbench.models.ls,
    "descriptors": lambda points: salbench.fpfh(points, up(points), scan=True),
    "of one radius": lambda points: salbench.fpfh(points, up(points), neighbourhood="radius", radius=0.05, grow=False),
}


def up(points):
    return np.tile([0.0, 0, 1], (len(points), 1))


def surface(points):
    """Faces of points on a sphere, counter-clockwise from outside."""
    faces = ConvexHull(points).simplices.copy()
    corners = points[faces]
    inwards = (np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) * corners.mean(1)).sum(1) < 0
    faces[inwards] = faces[inwards][:, ::-1]
    return faces


class Strays(unittest.TestCase):
    def test_what_is_refused(self):
        """A twin of the rule: tests/stages/geometry/support_test.cpp."""
        for shape, (points, is_refused) in SHAPES.items():
            for name, call in FUNCTIONS.items():
                with self.subTest(f"{name} of {shape}"):
                    if is_refused:
                        self.assertRaisesRegex(ValueError, f"within .* R of a point are more than .*, of {len(points)} points", call, points)
                    else:
                        self.assertEqual(len(call(points)), len(points))

    def test_a_mesh_with_a_stray_corner(self):
        points = strays([1e6])
        faces = np.vstack([surface(sphere()), [[0, 1, N]]])
        sound = np.vstack([sphere(), [[0, 0, 1.1]]])
        calls = {
            "LVJ": salbench.models.lvj,
            "LCE": salbench.models.lce,
            "MS": lambda points, faces: salbench.models.ms(points, faces, scales="paper"),
            "normals": lambda points, faces: salbench.estimate_normals(points, faces, method="pca"),
            "interest points": lambda points, faces: salbench.score(points[:, 2], picks=[3], points=points, faces=faces, metrics="fne",
                                                                    peak_radius=0.1),
        }
        for name, call in calls.items():
            with self.subTest(name):
                call(sound, faces)
                self.assertRaisesRegex(ValueError, f"more than .*, of {N + 1} points: remove points far from the rest", call, points, faces)
        with self.subTest("MS, and a vertex of no face"):
            self.assertRaisesRegex(ValueError, "remove points far from the rest", calls["MS"], points, surface(sphere()))

    def test_a_sample_without_the_stray(self):
        for model in (salbench.models.cs, salbench.models.ls):
            with self.subTest(model.__name__):
                self.assertEqual(len(model(sphere(), sample=2000)), N)
                self.assertRaisesRegex(ValueError, "remove points far from the rest", model, strays([1e4]), sample=2000)


POINTS = sphere(300) * [1, 0.8, 0.6]
FACES = surface(sphere(300))
UP = up(POINTS)
VALUES = POINTS[:, 2]
OF_POINTS = {
    "normals of points": lambda points: salbench.estimate_normals(points),
    "descriptors": lambda points: salbench.fpfh(points, UP),
    "descriptors of scans": lambda points: salbench.fpfh(points, UP, scan=True),
    "partial mesh": lambda points: salbench.partial_mesh(points, UP),
    "centre bias": lambda points: list(salbench.score(VALUES, VALUES, [3], points=points, metrics=["ig_centre"]).values()),
    **{f"{row.name} of points": getattr(salbench.models, row.name.lower()) for row in salbench.models.table()},
}
OF_MESHES = {
    "normals": lambda points: salbench.estimate_normals(points, FACES),
    "normals of planes": lambda points: salbench.estimate_normals(points, FACES, method="pca"),
    "number of points in a scan": lambda points: len(salbench.simulate_scan(points, FACES, 3).points),
    "faces of a simplified mesh": lambda points: salbench.simplify(points, FACES, 100)[1],
    "shares of the area": lambda points: salbench.vertex_areas(points, FACES) / salbench.vertex_areas(points, FACES).sum(),
    "spectrum": lambda points: salbench.spectrum(points, FACES, 5).values,
    "smoothed picks": lambda points: salbench.smooth_picks(points, FACES, [3]),
    "values of faces": lambda points: salbench.vertex_values_of_faces(points, FACES, np.arange(1.0 * len(FACES))),
    "picture": lambda points: salbench.picture(points, FACES, size=24).shade,
    "interest points": lambda points: list(salbench.score(VALUES, picks=[3], points=points, faces=FACES, metrics=["fne", "fpe"]).values()),
    "a file": lambda points: read(points) / np.abs(points).max(),
    **{row.name: lambda points, of=getattr(salbench.models, row.name.lower()): of(points, FACES) for row in salbench.models.table()},
}
POWERS = (-1000, -200, -160, 160, 200, 1000)  # of two; 2^166 is 9.4e49
REFUSED = (-1000, -200, 200, 1000)
SAID = "extent of at least 1e-50: scale|coordinates of at most 1e50|expected at least 1e-50: scale the shape|larger than 1e50: scale the mesh"


def read(points):
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, "mesh.off").write_text(off(points, FACES))
        return salbench.Dataset("folder", folder)[0].points


class Sizes(unittest.TestCase):
    def check(self, calls):
        for name, call in calls.items():
            usual = np.asarray(call(POINTS))
            for power in POWERS:
                with self.subTest(f"{name} x 2^{power}"):
                    if power in REFUSED:
                        self.assertRaisesRegex(ValueError, SAID, call, POINTS * 2.0**power)
                    else:
                        np.testing.assert_allclose(np.asarray(call(POINTS * 2.0**power)), usual, rtol=1e-7, atol=1e-7)

    def test_of_points(self):
        self.check(OF_POINTS)

    def test_of_meshes(self):
        self.check(OF_MESHES)

    def test_faces_without_an_area_are_another_matter(self):
        for size in (1, 1e-45, 1e45):
            points = size * np.array([[0.0, 0, 0], [1, 0, 0], [2, 0, 0]])
            self.assertRaisesRegex(ValueError, "no face has an area", salbench.estimate_normals, points, [[0, 1, 2]])
