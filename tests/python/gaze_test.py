# SPDX-License-Identifier: GPL-3.0-or-later
"""Gaze on arrays: a run makes of recordings what the functions make of them. The functions by themselves: tests/stages/gaze."""

import tempfile
import unittest
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pandas

import salbench
from tests.support.shapes import sphere


def unit(vectors: np.ndarray) -> np.ndarray:
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


class FixationsTest(unittest.TestCase):

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
        points, faces = sphere(4, 8)
        for message, call in (
            ("velocity", lambda: salbench.fixations([1, 2, 3], ahead, velocity=-1)),
            ("ray 2: ", lambda: salbench.cast_rays(points, faces, [[0, 0, 9]] * 2, [[0, 0, -1], [0, 0, 0]])),
            ("face must have numbers of faces", lambda: salbench.gaze_density(points, faces, [len(faces)], [[1, 0, 0]], radius=.1)),
            ("fixation 1: its distance from the eye is not known", lambda: salbench.gaze_density(points, faces, [0], [[1, 0, 0]])),
        ):
            with self.subTest(message), self.assertRaisesRegex(ValueError, message):
                call()


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


class PipelineTest(unittest.TestCase):
    """A run makes of recordings what the functions make of them, one after the other."""

    @classmethod
    def setUpClass(cls) -> None:
        cls.points, cls.faces = sphere(24, 40)
        random = np.random.default_rng(7)
        people, looks, samples = 4, 12, 30
        targets = cls.points[random.integers(len(cls.points), size=(people, looks))]
        eyes = 3 * unit(targets + .4 * random.normal(size=targets.shape)) * [1, 1, 1.2]
        targets[0, 0] = [0, 2, 0]  # beside the shape
        origins, targets = (np.repeat(each, samples, axis=1).reshape(-1, 3) for each in (eyes, targets))
        rows = people * looks * samples
        cls.recording = salbench.datasets.Recording(
            people=("a", "b", "c", "nobody"), person=np.repeat(np.arange(people, dtype=np.int32), rows // people),
            time=np.tile(np.arange(rows // people) * 1000 / 120, people), valid=random.uniform(size=rows) > .02, origins=origins,
            directions=unit(unit(targets - origins) + 2e-4 * random.normal(size=origins.shape)))
        cls.recording.valid[cls.recording.person == 3] = False

    def looks_of(self, person: int, fixations: dict, snap: float):
        own, recorded = self.recording.person == person, self.recording
        eyes, directions = recorded.origins[own], recorded.directions[own]
        places = salbench.cast_rays(self.points, self.faces, eyes, directions).place
        found = salbench.fixations(recorded.time[own], directions, eyes, recorded.valid[own], places, **fixations)
        return found, salbench.cast_rays(self.points, self.faces, found.origin, found.direction, snap=snap)

    def by_functions(self, fixations: dict, snap: float, **density) -> np.ndarray:
        all_looks = [self.looks_of(person, fixations, snap) for person in range(3)]
        return np.array([salbench.gaze_density(self.points, self.faces, hits.face, hits.weights, hits.depth, found.duration, found.origin, **density)
                         for found, hits in all_looks])

    def made(self, folder: Path, **gaze):
        if not (folder / "set").exists():
            salbench.datasets.write(folder / "set", [SimpleNamespace(id="ball", points=self.points, faces=self.faces, recording=self.recording)])
        config, cache = {"dataset": {"layout": "hdf5", "scans": False}, "gaze": gaze}, folder / "-".join(map(str, gaze.values())) / "cache"
        salbench.run(config, data=folder / "set", models={"RS": {}}, cache=cache, out=folder / "out", progress=False)
        return salbench.Cache(cache)["ball"]["ground_truth"]

    def test_is_beside_the_functions(self) -> None:
        cases = (({}, 0, {}), ({"method": "idt", "skip_ms": 300}, 0, {"degrees": 2.5}), ({"method": "none"}, 5, {"spread": "euclidean"}),
                 ({"skip_first": True}, 30, {"radius": .15}), ({"velocity": 25}, 0, {"spread": "view", "degrees": 3}))
        with tempfile.TemporaryDirectory() as folder:
            for fixations, snap, density in cases:
                with self.subTest(fixations | density, snap=snap):
                    made, maps = self.made(Path(folder), snap=snap, **fixations, **density), self.by_functions(fixations, snap, **density)
                    viewers = np.reshape(made["viewers"], (3, -1))  # who was lost did not look
                    np.testing.assert_allclose(viewers, maps, rtol=0, atol=1e-12 * maps.max())
                    np.testing.assert_allclose(made["saliency"], maps.mean(axis=0), rtol=0, atol=1e-12 * maps.max())
            left_out = pandas.read_csv(Path(folder) / "out/gaze.csv", keep_default_na=False)["left_out"]
            self.assertEqual([reason[:5] for reason in left_out], ["", "", "", "lost "])

    def test_models_are_trained_on_what_they_are_scored_against(self) -> None:
        own = {"ground_truth": self.points[:, 2] - self.points[:, 2].min()}
        with tempfile.TemporaryDirectory() as folder:
            def trained(name: str, config: dict, **truth) -> set:
                learned = []
                salbench.datasets.write(Path(folder) / name, [SimpleNamespace(id=id, points=self.points, faces=self.faces, recording=self.recording, **truth)
                                                              for id in ("1", "2")])
                dataset = {"layout": "hdf5", "scans": False, **config.get("dataset", {})}
                salbench.cross_validate(lambda shapes: learned.append(shapes[0].ground_truth) or (lambda shape: shape.points[:, 2]), Path(folder) / name,
                                        config | {"dataset": dataset}, models={}, folds=2, by="mesh", cache=Path(folder) / "cache",
                                        out=Path(folder) / "out", progress=False)
                return {each.tobytes() for each in learned}

            recorded = {"participants": "recorded"}
            scored = self.made(Path(folder))["saliency"]
            self.assertEqual(trained("gaze", {}), {scored.tobytes()})
            self.assertEqual(trained("gaze", {"dataset": recorded}), set(), "the same folds")
            self.assertEqual(trained("both", {"gaze": {"degrees": 2}}, **own), {own["ground_truth"].tobytes()})
            for name, config in (("gaze", {"gaze": {"degrees": 2}}), ("gaze", {"gaze": {"degrees": 2}, "dataset": recorded}), ("both", {"dataset": recorded})):
                with self.assertRaisesRegex(ValueError, "1: is scored against another ground truth of gaze than models would be trained on"):
                    trained(name, config, **(own if name == "both" else {}))

    def test_weighs_and_picks_what_they_find(self) -> None:
        found, hits = zip(*(self.looks_of(person, {}, 0) for person in range(3)))
        with tempfile.TemporaryDirectory() as folder:
            on_shape = [looks.duration[hit.face >= 0].sum() for looks, hit in zip(found, hits)]
            pooled = on_shape @ self.by_functions({}, 0) / 3
            np.testing.assert_allclose(self.made(Path(folder), weight="mass")["saliency"], pooled, rtol=0, atol=1e-12 * pooled.max())
            equal = np.mean([salbench.gaze_density(self.points, self.faces, hit.face, hit.weights, hit.depth) for hit in hits], axis=0)
            np.testing.assert_allclose(self.made(Path(folder), mass="one")["saliency"], equal, rtol=0, atol=1e-12 * equal.max())
            picks = [self.nearest_corners(hit.face[hit.face >= 0], hit.weights[hit.face >= 0]) for hit in hits]
            np.testing.assert_array_equal(self.made(Path(folder), picks="fixations")["picks"], np.concatenate(picks))

    def nearest_corners(self, face: np.ndarray, weights: np.ndarray) -> np.ndarray:
        corners = self.points[self.faces[face]]
        distances = np.linalg.norm(corners - (weights[..., None] * corners).sum(axis=1, keepdims=True), axis=2)
        return self.faces[face, distances.argmin(axis=1)]

    def test_people_with_maps_are_compared_by_these_whether_or_not_there_are_picks(self) -> None:
        maps = self.by_functions({}, 0)
        of_a_set = {"ground_truth": maps.mean(axis=0), "viewers": maps}
        picks = [[3], [5, 7], [9]]
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)

            def of_people(data: str, gaze: dict, **truth) -> pandas.DataFrame:
                salbench.datasets.write(folder / data, [SimpleNamespace(id="ball", points=self.points, faces=self.faces, **truth)])
                config = {"dataset": {"layout": "hdf5", "scans": False}, "gaze": gaze, "metrics": {"names": ["nss", "cc"]}}
                return salbench.run(config, data=folder / data, models={"HS": {}}, cache=folder / "cache", out=folder / "out", progress=False).scores

            for plain, picked in ((of_people("gaze", {}, recording=self.recording), of_people("gaze", {"picks": "fixations"}, recording=self.recording)),
                                  (of_people("maps", {}, **of_a_set), of_people("both", {}, participants=picks, **of_a_set))):
                self.assertEqual(plain["cc"].tolist(), picked["cc"].tolist())
                self.assertTrue(plain["nss"].isna().all() and picked["nss"].notna().all())
            others = of_people("others", {}, participants=picks[:2], **of_a_set)
            self.assertNotEqual(others["cc"].tolist(), plain["cc"].tolist(), "fewer have picks: these are other people")

    def test_is_not_written_if_no_run_could_read_it(self) -> None:
        first = np.arange(len(self.recording.time)) == 5
        with tempfile.TemporaryDirectory() as folder:
            for cause, spoilt in (("which is not after", {"time": np.where(first, 0, self.recording.time)}),
                                  ("5 \\(0-based\\) has a direction that is nan long",
                                   {"directions": np.where(first[:, None], np.nan, self.recording.directions), "valid": first}),
                                  ("of an earlier person", {"person": self.recording.person[::-1]}),
                                  ("without 'recording/origins'", {"origins": None})):
                shape = SimpleNamespace(id="ball", points=self.points, faces=self.faces, recording=replace(self.recording, **spoilt))
                with self.subTest(cause), self.assertRaisesRegex(ValueError, f"shape 'ball': .*{cause}"):
                    salbench.datasets.write(folder, [shape])
