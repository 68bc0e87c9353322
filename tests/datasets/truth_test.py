# SPDX-License-Identifier: GPL-3.0-or-later
"""Reading of shapes, values per vertex, face and point, masks and picks, and conversions between them. Densities that are
spread over neighbours: by hand, and as brute force finds these."""

import unittest

import numpy as np

from archives_test import MINIATURES, SPHERE, gaze
from salbench.datasets import reading, spread
from salbench.datasets.records import InputError, Shape
from support import FACES, NAN, POINTS, WithArchive, lines, npy, obj, off, sphere


class Meshes(WithArchive):
    def test_points_faces_and_polygons(self):
        self.equal(reading.shape(self.write({"a.obj": "mtllib cat.mtl\n" + obj()})).points, POINTS)
        found = reading.mesh(self.write({"a.off": "OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n3 0 2 1\n"}))
        self.assertEqual((found.polygons, found.faces.tolist(), found.face_of.tolist()), ((1, 0), [[0, 1, 2], [0, 2, 3], [0, 2, 1]], [0, 0, 1]))
        path = self.write({"a.off": "OFF\n4 1 0\n0 0 0\n0 0 0\n0 0 0\n0 0 0\n3 0 1 9\n"})
        self.assertIn("ROOT/a.off:7: ", self.error_of(reading.mesh, path))
        self.assertEqual(self.error_of(reading.cloud, self.write({"a.txt": "1 2 3\n"})), "ROOT/a.txt: is not named as a point cloud: convert it to .ply, .pcd or .xyz, a mesh to .off, .obj or .ply")

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
                                     ("1\n8\n", 1, [0, 7]), ("vertex\n7.000e+00\n0.0\n", 0, [7, 0]), (npy([7, 0]), 0, [7, 0]), (npy([7.0]), 1, [6])]:
            found = reading.picks(self.write({"9_0.pid": text}), 8, base)
            self.assertEqual((found.tolist(), found.dtype), (expected, np.int32))
        for text, base, wrong in [
                ("7\n8\n", 0, ":2: vertex 8 is out of range: the shape has 8, numbered from 0"), ("-1\n", 0, ":1: vertex -1 is out of range"),
                ("3\n0\n", 1, ":2: vertex 0 is out of range: the shape has 8, numbered from 1"), ("1.5\n", 0, ':1: "1.5" is not a whole number'),
                ("1 2\n", 0, ':1: "1 2" is not a whole'), ("9" * 20, 0, ":1: "), ("1_0\n", 0, "is not a whole"), ("7\n1#2\n", 0, ':2: "1#2" is not a whole'),
                ("nan\n", 0, "is not a whole"), (npy([7, 0.5]), 0, ':2: "0.5" is not a whole'), ("vertex saliency\n", 0, "2 columns")]:
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


N = len(SPHERE[0])


def lists_text(lists, points=None):
    """As the authors write them: the head of a point stands at the end of the line before."""
    points = range(len(lists)) if points is None else points
    heads = [f"{point} neighbors" for point in points]
    rows = [";".join(map(str, lists[point])) + ";" for point in points]
    return heads[0] + "\n" + "\n".join(row + head for row, head in zip(rows, [*heads[1:], ""])) + "\n"


def brute_force(points, source, count):
    """The nearest ones, itself left out; of equal distances the first."""
    far = ((points - points[source]) ** 2).sum(axis=1)
    return [point for point in np.lexsort((np.arange(len(points)), far)) if point != source][:count]


class ByHand(unittest.TestCase):
    def test_five_points(self):
        """Point 1 adds .9 and 0 of its 2, point 4 .9 and 0 of its 1, on top of what is there."""
        values = np.array([0, 2.0, 0, np.nan, 1])
        sources = np.array([1, 4])
        neighbours = np.array([[0, 2], [1, 3]], np.int32)
        np.testing.assert_allclose(spread.spread(values, sources, neighbours, 2, 0.9), [1.8, 2.9, 0, np.nan, 1], rtol=1e-15)
        np.testing.assert_allclose(spread.spread(values, sources, neighbours, 3, 0.9), [1.8, 2.9, 0.9, np.nan, 1], rtol=1e-15)  # half way

    def test_nearest_as_brute_force_finds_them(self):
        rng = np.random.default_rng(5)
        clouds = [rng.random((300, 3)), np.repeat(rng.random((40, 3)), 5, axis=0), np.stack(np.meshgrid(*3 * [np.arange(5.0)]), -1).reshape(-1, 3),
                  np.zeros((90, 3))]  # with clones, ties everywhere, and nothing but ties
        for points in clouds:
            sources = np.arange(0, len(points), 7, dtype=np.int32)
            for count in (1, 6, 80, len(points) + 5):
                expected = [brute_force(points, source, count) for source in sources]
                np.testing.assert_array_equal(spread.nearest_in_space(points, sources, count), expected)


class Lists(WithArchive):
    def read(self, text, count, points=(0, 1, 2, 3)):
        return spread.read_lists(self.write({"a.txt": text}), 4, count, np.array(points, np.int32))

    def test_are_those_of_the_points_that_are_needed(self):
        good = lists_text([[1, 2, 3], [0, 2, 3], [3, 1, 0], [2, 1, 0]])
        self.assertEqual(self.read(good, 2).tolist(), [[1, 2], [0, 2], [3, 1], [2, 1]])
        turned = lists_text([[1, 2, 3], [0, 2, 3], [3, 1, 0], [2, 1, 0]], (2, 0, 3, 1)).replace("\n", "\r\n")
        self.assertEqual(self.read(turned, 3, (1, 2)).tolist(), [[0, 2, 3], [3, 1, 0]])
        some = lists_text([[1, 2, 3], [0, 2, 3], [3, 1, 0], [2, 1, 0]], (1, 3))
        self.assertEqual(self.read(some, 3, (1, 3)).tolist(), [[0, 2, 3], [2, 1, 0]])
        self.assertEqual(self.error_of(self.read, some, 3, (1, 2)), "ROOT/a.txt:3: the file ends after the neighbours of 2 points, and without those of point 2, "
                                                                    "which was looked at: it is cut short, copy it again")

    def test_bad_ones_name_their_line(self):
        good = lists_text([[1, 2, 3], [0, 2, 3], [3, 1, 0], [2, 1, 0]])
        for text, expected in [
                ("", "0: does not begin with a point's number"),
                ("neighbors\n1;2\n", "1: does not begin with a point's number and the word neighbors"),
                ("0 neighbors\n", "1: the file ends after the neighbours of 0 points, and without those of point 0"),
                (good[:good.index("2 neighbors")], "3: the file ends after the neighbours of 2 points"),
                (good[:good.index("2;1;0")], "4: the file ends after the neighbours of 3 points"),
                (good[:good.index("2;1;0") + 3], "5: point 3 has 2 neighbours, expected 3: is the file cut short?"),
                (good.replace("3;1;0", "3;4;0"), "4: neighbour 4 of point 2 is out of range: there are 4 points, numbered from 0"),
                (good.replace("3;1;0", "-1;1;0"), "4: neighbour -1 of point 2 is out of range"),
                (good.replace("3;1;0", "3;x;0"), "4: is not a list of whole numbers between semicolons"),
                (good.replace("3;1;0", "3;99999999999999999999;0"), "4: is not a list of whole numbers between semicolons"),
                (good.replace("2 neighbors", "0 neighbors"), "4: expected neighbours of a point from 0 to 3, each once: the line before names 0"),
                (good.replace("2 neighbors", "7 neighbors"), "4: expected neighbours of a point from 0 to 3, each once: the line before names 7"),
                (good + "1;2;3\n", "6: expected neighbours of a point from 0 to 3, each once: the line before names none")]:
            self.assertIn(f"ROOT/a.txt:{expected}", self.error_of(self.read, text, 2))
        self.assertIn("a.txt:2: point 0 has 3 neighbours, expected 4: is the file cut short", self.error_of(self.read, good, 4))


class Archives(WithArchive):
    def test_sal3d_is_spread_where_its_lists_lie(self):
        self.write(MINIATURES["sal3d"][0])
        raw = self.list("sal3d")
        self.assertIn("TRUTH: raw gaze densities; the published scores are measured on smoothed ones", raw.remark)
        rng = np.random.default_rng(3)
        clouds = {name: np.concatenate([scale * SPHERE[0] for scale in (1, 2, 3, 4)]) for name in ("cow", "ant")}  # 624 points
        lists = np.argsort(rng.random((4 * N, 4 * N)), axis=1)[:, :520]
        self.write({f"Gaze/{name}.txt": gaze(points) for name, points in clouds.items()} | {"Smooth_Gaze/cow_neighbors.txt": lists_text(lists)})
        listing = self.list("sal3d")
        self.assertEqual((listing.remark, raw.notes), ("", [raw.remark]))
        self.assertEqual([(item.name, item.truth) for item in listing.items], [("ant", False), ("cow", True)])
        self.assertEqual([note.replace(str(self.root), "ROOT") for note in listing.notes],
                         ["1 of 2 items have no list of neighbours (ROOT/Smooth_Gaze/{item}_neighbors.txt), and so no ground truth: ant"])
        values = 0.5 * (np.arange(4 * N) % 4)
        expected = values.copy()
        for point in np.flatnonzero(values):
            expected[lists[point][:500]] += np.linspace(0.9 * values[point], 0, 500)
        np.testing.assert_allclose(self.read("sal3d", "cow").ground_truth, expected, rtol=1e-12)
        self.assertEqual(self.read("sal3d", "ant").ground_truth, None)
        self.write({"Smooth_Gaze/cow_neighbors.txt": lists_text(lists, np.flatnonzero(values))})  # of the points that somebody looked at
        np.testing.assert_allclose(self.read("sal3d", "cow").ground_truth, expected, rtol=1e-12)
        self.write({"Smooth_Gaze/cow_neighbors.txt": lists_text(lists[:N])})
        self.assertIn("ROOT/Smooth_Gaze/cow_neighbors.txt", self.error_of(self.read, "sal3d", "cow"))

    def test_on_meshes_samples_are_spread_before_they_are_carried_over(self):
        self.write(MINIATURES["sal3d_meshes"][0] | {"Gaze/cow.txt": gaze(np.concatenate([SPHERE[0]] * 4))})
        self.write({"Smooth_Gaze/cow_neighbors.txt": lists_text(np.tile(np.arange(4 * N)[::-1], (4 * N, 1)))})
        steps, values = np.linspace(0.9, 0, 500), 0.5 * (np.arange(4 * N) % 4)
        expected = values.copy()
        expected[np.arange(4 * N)[::-1][:500]] += steps * values.sum()
        np.testing.assert_allclose(self.read("sal3d_meshes").ground_truth, expected[:N], rtol=1e-9)  # the nearest sample is the first of its clones

    def test_a_stand_in_says_so(self):
        self.write(MINIATURES["sal3d_spread"][0])
        self.assertIn("a stand-in", self.list("sal3d_spread").remark)
        values = 0.5 * (np.arange(N) % 4)
        expected = values.copy()
        for point in np.flatnonzero(values):
            near = brute_force(np.loadtxt(self.root / "Gaze/cow.txt")[:, :3], point, 500)
            expected[near] += np.linspace(0.9 * values[point], 0, 500)[:len(near)]
        np.testing.assert_allclose(self.read("sal3d_spread", "cow").ground_truth, expected, rtol=1e-12)
