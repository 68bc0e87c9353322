# SPDX-License-Identifier: GPL-3.0-or-later
"""Densities that are spread over neighbours: by hand, by other programs' means, and on SAL3D's clouds with lists that are made for them."""

import os
import unittest

import numpy as np

from salbench.datasets import spread
from salbench.datasets.records import InputError
from archives_test import MINIATURES, SPHERE, gaze
from support import WithArchive, real

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
        np.testing.assert_allclose(self.read("sal3d", "cow").truth, expected, rtol=1e-12)
        self.assertEqual(self.read("sal3d", "ant").truth, None)
        self.write({"Smooth_Gaze/cow_neighbors.txt": lists_text(lists, np.flatnonzero(values))})  # of the points that somebody looked at
        np.testing.assert_allclose(self.read("sal3d", "cow").truth, expected, rtol=1e-12)
        self.write({"Smooth_Gaze/cow_neighbors.txt": lists_text(lists[:N])})
        self.assertIn("ROOT/Smooth_Gaze/cow_neighbors.txt", self.error_of(self.read, "sal3d", "cow"))

    def test_on_meshes_samples_are_spread_before_they_are_carried_over(self):
        self.write(MINIATURES["sal3d_meshes"][0] | {"Gaze/cow.txt": gaze(np.concatenate([SPHERE[0]] * 4))})
        self.write({"Smooth_Gaze/cow_neighbors.txt": lists_text(np.tile(np.arange(4 * N)[::-1], (4 * N, 1)))})
        steps, values = np.linspace(0.9, 0, 500), 0.5 * (np.arange(4 * N) % 4)
        expected = values.copy()
        expected[np.arange(4 * N)[::-1][:500]] += steps * values.sum()
        np.testing.assert_allclose(self.read("sal3d_meshes").truth, expected[:N], rtol=1e-9)  # the nearest sample is the first of its clones

    def test_a_stand_in_says_so(self):
        self.write(MINIATURES["sal3d_spread"][0])
        self.assertIn("a stand-in", self.list("sal3d_spread").remark)
        values = 0.5 * (np.arange(N) % 4)
        expected = values.copy()
        for point in np.flatnonzero(values):
            near = brute_force(np.loadtxt(self.root / "Gaze/cow.txt")[:, :3], point, 500)
            expected[near] += np.linspace(0.9 * values[point], 0, 500)[:len(near)]
        np.testing.assert_allclose(self.read("sal3d_spread", "cow").truth, expected, rtol=1e-12)


class RealData(WithArchive):
    def test_lists_that_are_made_for_clouds_give_what_numpy_gives(self):
        """For two clouds; SALBENCH_CLOUDS=all: for all 52, which takes minutes."""
        root = real("sal3d")
        if root is None:
            self.skipTest("needs real data: SALBENCH_DATA")
        (self.root / "Gaze").symlink_to(root / "Gaze")
        (self.root / "Smooth_Gaze").mkdir()
        clouds = sorted((root / "Gaze").iterdir())
        self.assertEqual(len(clouds), 52)
        for path in clouds[::1 if os.environ.get("SALBENCH_CLOUDS") == "all" else 26]:
            table = np.loadtxt(path, usecols=(0, 1, 2, 6))
            points, values = table[:, :3], table[:, 3]
            sources = np.flatnonzero(values > 0)
            near = spread.nearest_in_space(points, sources, 500)
            file = self.root / f"Smooth_Gaze/{path.stem}_neighbors.txt"
            file.write_text(lists_text(dict(zip(sources.tolist(), near.tolist())), sources.tolist()))
            expected = values.copy()
            np.add.at(expected, near, np.linspace(0.9 * values[sources], 0, 500, axis=1))
            np.testing.assert_allclose(self.read("sal3d", path.stem).truth, expected, rtol=1e-12)
            file.unlink()
