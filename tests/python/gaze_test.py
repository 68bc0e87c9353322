# SPDX-License-Identifier: GPL-3.0-or-later
"""Gaze on arrays: fixations beside I-VT written again, rays beside all faces, and people who look at a density that is known."""

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


def bumpy() -> tuple[np.ndarray, np.ndarray]:
    points, faces = sphere(40, 80)
    return points * (1 + .1 * np.sin(4 * points).prod(axis=1, keepdims=True)), faces


def followed(points: np.ndarray, faces: np.ndarray, speeds: tuple[float, float], rate: int = 120, seed: int = 0) -> tuple[np.ndarray, ...]:
    """Time, eyes, directions and the vertex looked at, of 30 looks of 300 ms at a shape that turns by so many degrees a second, in either half."""
    random = np.random.default_rng(seed)
    time = np.arange(0, 30 * 330, 1000 / rate)
    look, since = np.divmod(time, 330)
    look = look.astype(int)

    def eyes_at(ms: np.ndarray) -> np.ndarray:
        half = 15 * 330
        angle = np.radians(speeds[0] * np.minimum(ms, half) + speeds[1] * np.maximum(ms - half, 0)) / 1000
        return 3 * np.linalg.norm(points - points.mean(axis=0), axis=1).max() * np.stack([np.sin(-angle), 0 * angle, np.cos(angle)], axis=-1)

    facing = unit(eyes_at(np.arange(31) * 330 + 150.0)) @ unit(points).T > .7
    targets = np.array([random.choice(np.flatnonzero(seen)) for seen in facing])
    share = np.clip((since - 300) / 30, 0, 1)[:, None]
    eyes = eyes_at(time)
    directions = unit((1 - share) * points[targets[look]] + share * points[targets[look + 1]] - eyes)
    return time, eyes, unit(directions + np.radians(.2) / 2**.5 * random.normal(size=directions.shape)), targets[look]


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

    def test_of_shapes_that_turn_are_the_looks_that_there_were(self):
        """120 Hz, 3 R, noise of 0.2 degrees, 30 looks of 300 ms; the last shape turns in the second half alone."""
        points, faces = bumpy()
        for speeds in ((0, 0), (10, 10), (21, 21), (36, 36), (60, 60), (90, 90), (0, 21)):
            with self.subTest(speeds):
                time, eyes, directions, targets = followed(points, faces, speeds)
                places = salbench.cast_rays(points, faces, eyes, directions).place
                found = salbench.fixations(time, directions, eyes, places=places)
                self.assertIn(len(found.start), (29, 30))
                self.assertGreater(found.duration.sum(), .95 * 30 * 300)
                middle = np.searchsorted(time, found.start + found.duration / 2)
                ways = points[targets[middle]] - found.origin
                turned = np.degrees(np.arctan2(np.linalg.norm(np.cross(ways, found.direction), axis=1), (ways * found.direction).sum(axis=1)))
                self.assertLess(np.median(turned), .1)
                if min(speeds) >= 21:
                    self.assertLess(len(salbench.fixations(time, directions, eyes).start), 10, "directions turn with the shape")

    def test_at_rest_are_those_of_directions(self):
        points, faces = bumpy()
        for rate in (60, 120, 500):
            time, eyes, directions, _ = followed(points, faces, (0, 0), rate)
            places = salbench.cast_rays(points, faces, eyes, directions).place
            for method in ("ivt", "idt", "none"):
                for with_places, without in zip(salbench.fixations(time, directions, eyes, places=places, method=method),
                                                salbench.fixations(time, directions, eyes, method=method)):
                    np.testing.assert_array_equal(with_places, without)

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


class PoorTrackingTest(unittest.TestCase):
    def test_of_two_of_ten_leaves_the_truth_to_the_other_eight(self) -> None:
        points, faces = bumpy()

        def truth_of(folder: Path, people: range, poor: tuple[int, ...] = ()) -> tuple[np.ndarray, list[str]]:
            """People in `poor` were tracked only for the first 0.4 of 10 s."""
            rows: dict[str, list[np.ndarray]] = {"person": [], "time": [], "origins": [], "directions": []}
            for place, person in enumerate(people):
                time, eyes, directions, _ = followed(points, faces, (0, 0), seed=person)
                n = 48 if person in poor else len(time)
                for name, values in zip(rows, (np.full(n, place, np.int32), time[:n], eyes[:n], directions[:n])):
                    rows[name].append(values)
            columns = {name: np.concatenate(parts) for name, parts in rows.items()}
            recording = salbench.datasets.Recording(tuple(f"P{person}" for person in people), valid=np.ones(len(columns["time"]), bool), **columns)
            salbench.datasets.write(folder / "set", [SimpleNamespace(id="ball", points=points, faces=faces, recording=recording)])
            salbench.run({"dataset": {"layout": "hdf5", "scans": False}}, data=folder / "set", models={"RS": {}}, cache=folder / "cache", out=folder / "out",
                         progress=False)
            left_out = pandas.read_csv(folder / "out/gaze.csv", comment="#", keep_default_na=False)["left_out"]
            return salbench.Cache(folder / "cache")["ball"]["ground_truth"]["saliency"], list(left_out)

        with tempfile.TemporaryDirectory() as of_eight, tempfile.TemporaryDirectory() as of_ten:
            eight, _ = truth_of(Path(of_eight), range(8))
            ten, left_out = truth_of(Path(of_ten), range(10), poor=(8, 9))
        np.testing.assert_array_equal(ten, eight)
        self.assertEqual(left_out, [""] * 8 + ["tracked for 0.4 s"] * 2)


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
