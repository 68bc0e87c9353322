# SPDX-License-Identifier: GPL-3.0-or-later
"""Gaze on arrays: fixations beside I-VT written again, rays beside all faces, and people who look at a density that is known."""

import unittest

import numpy as np

import salbench
from tests.support.shapes import sphere


def unit(vectors: np.ndarray) -> np.ndarray:
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


class FixationsTest(unittest.TestCase):
    def test_are_the_runs_of_slow_samples(self):
        random = np.random.default_rng(3)
        time = np.cumsum(random.uniform(5, 12, 4000))
        angle = np.cumsum(np.where(random.uniform(size=4000) < .05, random.uniform(2, 9, 4000), .05)) * random.choice([-1, 1])
        directions = np.stack([np.sin(np.radians(angle)), 0 * angle, np.cos(np.radians(angle))], axis=-1)
        valid = random.uniform(size=4000) > .01
        turned = np.degrees(np.arccos(np.clip((directions[1:] * directions[:-1]).sum(axis=1), -1, 1)))
        slow = (turned <= 30 * np.diff(time) / 1000) & valid[1:] & valid[:-1]
        edges = np.flatnonzero(np.diff(np.concatenate([[False], slow, [False]]).astype(int)))
        runs = [(time[first], time[last] - time[first]) for first, last in edges.reshape(-1, 2)]
        expected = np.array([run for run in runs if run[1] >= 100])
        lost = np.where(valid[:, None], directions, np.nan)
        found = salbench.fixations(time, lost, valid=valid, merge_ms=0)
        self.assertGreater(len(expected), 50)
        np.testing.assert_allclose(np.stack([found.start, found.duration], axis=-1), expected)

    def test_arrays_that_do_not_fit_are_named(self):
        ahead = [[0, 0, 1]] * 3
        for message, arguments in (
            ("directions must have shape", ([1, 2, 3], ahead[:2])),
            ("origins must have shape", ([1, 2, 3], ahead, [[0, 0, 0]])),
            ("sample 3: its time of 2 ms is not after 2 ms", ([1, 2, 2], ahead)),
            ("sample 1: its direction is 2 long", ([1, 2, 3], np.multiply(ahead, 2))),
            ("time must be given", (None, ahead)),
        ):
            with self.subTest(message), self.assertRaisesRegex(ValueError, message):
                salbench.fixations(*arguments)
        with self.assertRaisesRegex(ValueError, "velocity"):
            salbench.fixations([1, 2, 3], ahead, velocity=-1)


class RaysTest(unittest.TestCase):
    def test_meet_what_they_look_at(self):
        points, faces = sphere(40, 80)
        random = np.random.default_rng(2)
        eyes = 3 * unit(random.normal(size=(500, 3)))
        to = unit(random.normal(size=(500, 3))) * random.uniform(0, 1.6, (500, 1))
        hits = salbench.cast_rays(points, faces, eyes, to - eyes)
        met = hits.face >= 0
        self.assertTrue(100 < met.sum() < 500)
        places = (points[faces[hits.face[met]]] * hits.weights[met][..., None]).sum(axis=1)
        np.testing.assert_allclose(places, eyes[met] + hits.depth[met, None] * unit((to - eyes)[met]), atol=1e-9)
        self.assertTrue(np.isnan(hits.depth[~met]).all() and not hits.snapped.any())
        near = salbench.cast_rays(points, faces, eyes, to - eyes, snap=5)
        self.assertTrue((near.face[met] == hits.face[met]).all() and near.snapped.any())
        for first, second in zip(near, salbench.cast_rays(points, faces, eyes, to - eyes, snap=5, threads=2)):
            np.testing.assert_array_equal(first, second)

    def test_that_are_none_are_named(self):
        points, faces = sphere(4, 8)
        with self.assertRaisesRegex(ValueError, "ray 2: "):
            salbench.cast_rays(points, faces, [[0, 0, 9]] * 2, [[0, 0, -1], [0, 0, 0]])
        with self.assertRaisesRegex(ValueError, "face must have numbers of faces"):
            salbench.gaze_density(points, faces, [len(faces)], [[1, 0, 0]], radius=.1)
        with self.assertRaisesRegex(ValueError, "fixation 1: its distance from the eye is not known"):
            salbench.gaze_density(points, faces, [0], [[1, 0, 0]])


class PeopleTest(unittest.TestCase):
    def test_show_what_they_look_at(self):
        points, faces = sphere(60, 120)
        areas = salbench.vertex_areas(points, faces)
        peaks = unit(np.array([[1, .2, .5], [-.4, 1, 0], [.3, -.8, -.6], [0, .3, -1]]))
        truth = np.exp(8 * (points @ peaks.T - 1)).sum(axis=1)
        chances = truth * areas / (truth * areas).sum()
        random = np.random.default_rng(5)

        def of_one_person() -> np.ndarray:
            looked_at = points[random.choice(len(points), 60, p=chances)]
            eyes = 3 * unit(looked_at + .3 * random.normal(size=looked_at.shape))
            error = np.radians(.5) / np.sqrt(2) * random.normal(size=looked_at.shape)
            hits = salbench.cast_rays(points, faces, eyes, unit(looked_at - eyes) + error, snap=1)
            return salbench.gaze_density(points, faces, hits.face, hits.weights, hits.depth, degrees=3)

        people = np.array([of_one_person() for _ in range(30)])
        np.testing.assert_allclose(people @ areas, 1, atol=1e-9)
        correlation = [np.corrcoef(people[:n].mean(axis=0), truth)[0, 1] for n in (1, 5, 30)]
        self.assertGreater(correlation[2], .9)
        self.assertEqual(correlation, sorted(correlation))
