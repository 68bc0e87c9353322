# SPDX-License-Identifier: GPL-3.0-or-later
"""`salbench inspect A --against B`: shapes that are found again under another name, scale, pose and meshing, and shapes that are not."""

import json
import unittest
from types import SimpleNamespace

import numpy as np
from support import POINTS, WithArchive, off, sphere

import salbench
from tests.support import forked
from salbench.datasets import copies
from salbench.datasets.records import InputError


def turned(points, seed=1, scale=37.0):
    """Rotated, scaled and moved."""
    numbers = np.random.default_rng(seed)
    rotation = np.linalg.qr(numbers.normal(size=(3, 3)))[0]
    return scale * np.asarray(points) @ rotation.T + numbers.normal(size=3)


def shaped(points, faces):
    """A sphere with a bump: no symmetry hides what is compared."""
    x, y, z = np.asarray(points).T
    return np.column_stack([1.6 * x, y, 0.7 * z]) * (1 + 0.8 * np.exp(-4 * ((x - 0.7) ** 2 + (y - 0.5) ** 2 + z**2)))[:, None], faces


def apart(first, second):
    ours, theirs = (copies.signature(SimpleNamespace(points=np.asarray(points, float), faces=faces)) for points, faces in (first, second))
    return np.abs(ours - theirs).mean(axis=-1).max()


WHOLE = shaped(*sphere(60, 70))
FEW = shaped(*sphere(24, 20))
BEAN = shaped(*sphere(30, 36))


class Distance(unittest.TestCase):
    def test_what_plays_no_part(self):
        points, faces = WHOLE
        half = faces[points[faces].mean(axis=1)[:, 0] > 0]
        centres = len(points) + np.arange(len(half))
        uneven = (np.vstack([points, points[half].mean(axis=1)]), np.vstack([
            faces[points[faces].mean(axis=1)[:, 0] <= 0],
            *(np.column_stack([half[:, a], half[:, (a + 1) % 3], centres]) for a in range(3))]))
        area = np.linalg.norm(np.cross(points[faces[:, 1]] - points[faces[:, 0]], points[faces[:, 2]] - points[faces[:, 0]]), axis=1)
        chosen = np.random.default_rng(3).choice(len(faces), 6000, p=area / area.sum())
        for what, other in {
            "nothing": WHOLE,
            "pose and scale": (turned(points), faces),
            "a size whose squares overflow": (points * 1e200, faces),
            "orientation": (points, faces[:, ::-1]),
            "a mirror": (points * [-1, 1, 1], faces),
            "half of it finer": uneven,
            "fewer faces": FEW,
            "decimation": tuple(map(np.asarray, salbench.simplify(turned(points), faces, len(faces) // 8))),
            "points alone": (points[faces[chosen]].mean(axis=1), None),
        }.items():
            with self.subTest(what):
                self.assertLess(apart(WHOLE, other), copies.WITHIN)

    def test_other_shapes(self):
        points, faces = WHOLE
        for what, other in {
            "a sphere": sphere(60, 70),
            "another bump": (np.where(points[:, :1] > 1, points * 1.15, points), faces),
            "a tetrahedron": (POINTS, np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])),
        }.items():
            with self.subTest(what):
                self.assertGreater(apart(WHOLE, other), copies.WITHIN)

    def test_it_is_the_same_in_every_call(self):
        self.assertEqual(apart(WHOLE, WHOLE), 0)

    def test_what_has_no_extent(self):
        for points, faces in (([[1, 2, 3]] * 4, np.array([[0, 1, 2]])), ([[5, 5, 5]], None)):
            with self.assertRaisesRegex(InputError, "all points are at one place"):
                copies.signature(SimpleNamespace(points=np.array(points, float), faces=faces))
        with self.assertRaisesRegex(InputError, "its faces have no extent"):
            copies.signature(SimpleNamespace(points=np.random.default_rng(1).random((4, 3)), faces=np.array([[1, 1, 1]])))


class Against(WithArchive):
    def setUp(self):
        super().setUp()
        points, faces = BEAN
        small, fewer = salbench.simplify(turned(points), faces, len(faces) // 2)
        self.write({"a/bean.off": off(points, faces), "a/ball.off": off(*sphere()), "b/17.off": off(np.asarray(small), np.asarray(fewer)),
                    "b/18.off": off(sphere(30, 36)[0] * [3, 1, 1], faces), "b/19.off": "OFF\n1 2\n"})

    def inspect(self, *words, status=0):
        done = forked.salbench("inspect", "folder", "--data", self.root / "a", *words)
        self.assertEqual(done.returncode, status, done.stderr)
        return done

    def test_the_copy_is_named(self):
        other = ("--against", "folder", "--against-data", str(self.root / "b"))
        found = json.loads(self.inspect(*other, "--format", "json", status=1).stdout)
        (copy,), (after,), (problem,) = found["near_copies"], found["next"], found["not_compared"]
        self.assertEqual((found["against"], found["against_shapes"], found["within"]), ("folder", 2, "0.005"))
        self.assertEqual((copy["shape"], copy["other"], after["shape"], after["other"]), ("bean", "17", "bean", "18"))
        self.assertLess(float(copy["distance"]), copies.WITHIN)
        self.assertGreater(float(after["distance"]), copies.WITHIN)
        self.assertTrue(problem.startswith("19: ") and "19.off" in problem, problem)
        text = self.inspect(*other, status=1).stdout
        self.assertRegex(text, "\n1 near copy among the 2 shapes of folder, .*\n  bean is 17, 0.00(.|\n)*others: bean and 18, 0(.|\n)*\n1 not compared:\n  19: ")

    def test_a_set_against_itself(self):
        points, faces = BEAN
        self.write({"a/again.off": off(turned(points), faces)})
        found = json.loads(self.inspect("--against", "folder", "--format", "json").stdout)
        self.assertEqual([(copy["shape"], copy["other"]) for copy in found["near_copies"]], [("again", "bean")])

    def test_what_cannot_be_asked(self):
        for words, said in ((("--against", "schellin"), "there is no layout 'schellin'; did you mean"), (("--against-data", "x"), "give --against LAYOUT2"),
                            (("--against", "folder", "--against-data", str(self.root / "none")), "none"), (("--against-data", ""), "is empty")):
            done = self.inspect(*words, status=2)
            self.assertEqual((done.stdout, done.stderr.count("\n")), ("", 1), done.stderr)
            self.assertIn(said, done.stderr)
