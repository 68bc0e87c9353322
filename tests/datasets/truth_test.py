# SPDX-License-Identifier: GPL-3.0-or-later
"""Reading of shapes, values per vertex, face and point, masks and picks, and conversions between them."""

import numpy as np

from salbench.datasets import reading
from salbench.datasets.records import InputError, Shape
from support import FACES, NAN, POINTS, WithArchive, lines, npy, obj, off, sphere


class Meshes(WithArchive):
    def test_points_faces_and_polygons(self):
        self.equal(reading.shape(self.write({"a.obj": "mtllib cat.mtl\n" + obj()})).points, POINTS)
        found = reading.mesh(self.write({"a.off": "OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n3 0 2 1\n"}))
        self.assertEqual((found.polygons, found.faces.tolist(), found.face_of.tolist()), ((1, 0), [[0, 1, 2], [0, 2, 3], [0, 2, 1]], [0, 0, 1]))
        path = self.write({"a.off": "OFF\n4 1 0\n0 0 0\n0 0 0\n0 0 0\n0 0 0\n3 0 1 9\n"})
        self.assertIn("ROOT/a.off:7: ", self.error_of(reading.mesh, path))
        self.assertEqual(self.error_of(reading.cloud, self.write({"a.txt": "1 2 3\n"})), "ROOT/a.txt: is not named as a point cloud: convert it to .ply, .pcd or .xyz")

    def test_a_value_per_polygon_is_that_of_its_triangles(self):
        """Files of the three formats, with faces of three to six corners; values may be of polygons or of triangles."""
        points = np.array([[0, 0, 0], [1, 0, 0], [2, 0, 0], [2, 1, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1.0], [0, 2, 1]])
        polygons = [[0, 1, 4, 5], [6, 0, 5], [1, 2, 3, 4], [7, 5, 6], [0, 6, 2, 1], [7, 6, 0, 2, 3, 5]]
        triangles = np.array([k for k, corners in enumerate(polygons) for _ in corners[2:]])
        plain = "".join(f"{x} {y} {z}\n" for x, y, z in points) + "".join(f"{len(corners)} {' '.join(map(str, corners))}\n" for corners in polygons)
        values = np.array([5, 1, 4, 2, 3, 0.5])
        for name, text in {
                "a.off": f"OFF\n8 6 0\n{plain}", "a.ply": "ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\n"
                f"element face 6\nproperty list uchar int vertex_indices\nend_header\n{plain}",
                "a.obj": "".join(f"v {x} {y} {z}\n" for x, y, z in points) + "".join(f"f {' '.join(str(k + 1) for k in corners)}\n" for corners in polygons)}.items():
            found = reading.mesh(self.write({name: text}))
            for content in (lines(values), lines(values[triangles]), npy(values)):
                per_face = reading.face_values(self.write({"a.csv": content}), found)
                self.equal(per_face, values[triangles])
                corners = points[found.faces]
                areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
                around = [(found.faces == k).any(axis=1) for k in range(len(points))]
                np.testing.assert_allclose(reading.from_faces(found, per_face), [np.average(per_face[near], weights=areas[near]) for near in around])
        path = self.write({"a.csv": "5\n1\n-1\n2\n3\n0.5\n"})
        self.equal(reading.face_values(path, found, -1), np.where(triangles == 2, NAN, values[triangles]))
        path = self.write({"a.csv": "5\n1\n"})
        self.assertEqual(self.error_of(reading.face_values, path, found), "ROOT/a.csv: the file has 2 values, but the mesh has 6 faces, split into 12 triangles")
        self.assertEqual(self.error_of(reading.face_values, path, Shape(points)), "ROOT/a.csv: has values per face, but the shape is a point cloud, which has none")

    def test_values_per_face_where_nobody_looked(self):
        found = reading.mesh(self.write({"a.off": off(faces=np.vstack([[0, 0, 1], FACES]))}))  # a face without area has its line all the same
        self.equal(reading.from_faces(found, np.array([NAN, NAN, 1, NAN, NAN])), [1, 1, NAN, 1])

    def test_values_per_point_are_those_of_the_nearest(self):
        found = Shape(POINTS, FACES)
        self.equal(reading.from_points(found, POINTS[:3] + 0.001, np.array([5.0, 6, 7])), [5, 6, 7, NAN])
        self.equal(reading.from_points(found, POINTS[:3], np.array([5.0, 6, 7]), max_distance=10), [5, 6, 7, 5])


class Truths(WithArchive):
    def test_positives_of_densities(self):
        density = np.arange(156) % 7.0
        density[:9] = NAN
        self.equal(reading.above_mean(density), np.flatnonzero(density > np.nanmean(density)))
        self.equal(reading.top(density, 20), np.flatnonzero(density >= np.sort(density[9:])[-int(np.ceil(0.2 * len(density[9:])))]))
        self.assertEqual((len(reading.top(np.full(9, 5.0), 20)), len(reading.above_mean(np.full(9, 5.0)))), (0, 0))

    def test_the_mean_is_over_those_who_saw_a_point(self):
        self.equal(reading.mean([np.array(one) for one in ([1, 2, 3, NAN], [2, 2, 9, NAN], [6, 5, NAN, NAN])]), [3, 3, 6, NAN])

    def test_masks_tell_hidden_from_seen(self):
        self.equal(reading.mask(self.write({"a.txt": "1\n0\n1\n"}), 3), [True, False, True])
        for text, wrong in [("1\n0.5\n1\n", ":2: a mask has 0 for hidden and 1 for seen"), ("0\n0\n0\n", ": hides everything"), ("1\n", ": the file has 1 values")]:
            self.assertIn(f"ROOT/a.txt{wrong}", self.error_of(reading.mask, self.write({"a.txt": text}), 3))

    def test_picks_keep_order_and_repetitions(self):
        for text, base, expected in [("7\r\n0\r\n7\r\n", 0, [7, 0, 7]), ("", 0, []), ("# from 0\n7 # here\n+0\n", 0, [7, 0]), ("7\r0\n7\r\n1", 0, [7, 0, 7, 1]),
                                     ("1\n8\n", 1, [0, 7])]:
            found = reading.picks(self.write({"9_0.pid": text}), 8, base)
            self.assertEqual((found.tolist(), found.dtype), (expected, np.int32))
        for text, base, wrong in [
                ("7\n8\n", 0, ":2: vertex 8 is out of range: the shape has 8, numbered from 0"), ("-1\n", 0, ":1: vertex -1 is out of range"),
                ("3\n0\n", 1, ":2: vertex 0 is out of range: the shape has 8, numbered from 1"), ("1.5\n", 0, ':1: "1.5" is not a whole number'),
                ("1 2\n", 0, ':1: "1 2" is not a whole'), ("9" * 20, 0, ":1: "), ("1_0\n", 0, "is not a whole"), ("7\n1#2\n", 0, ':2: "1#2" is not a whole')]:
            self.assertIn(f"{wrong}", self.error_of(reading.picks, self.write({"9_0.pid": text}), 8, base))

    def test_directions_become_unit_vectors(self):
        self.equal(reading.unit([[0, 0, 4], [3, 0, 4], [0, 0, 0]]), [[0, 0, 1], [0.6, 0, 0.8], [0, 0, 0]])


class Clouds(WithArchive):
    def test_rows_without_a_position_are_left_out(self):
        points, _ = sphere()
        rows = np.insert(points, [0, 5], NAN, axis=0)
        found = reading.cloud_of(rows, 7 * np.nan_to_num(rows))
        self.equal(found.points, points)
        np.testing.assert_allclose(found.normals, points, atol=1e-15)
        self.assertEqual(found.left_out.tolist(), [0, 6])
        self.assertEqual(reading.numbering(found)[:8].tolist(), [-1, 0, 1, 2, 3, 4, -1, 5])
        with self.assertRaisesRegex(InputError, "^a.txt: the point cloud has 2 points with a position"):
            reading.cloud_of(rows[:3], None, "a.txt")
        with self.assertRaisesRegex(InputError, "^a.txt: 1 points have a zero or not finite normal, the first is point 3"):
            reading.cloud_of(points, np.where(np.arange(len(points))[:, None] == 3, 0, points), "a.txt")
