# SPDX-License-Identifier: GPL-3.0-or-later
"""Models, and the stages before them, as functions: the bytes of the program's artefacts. Conclusions: its tables."""

import inspect
import pathlib
import tempfile
import unittest

import h5py
import numpy as np
import pandas

import salbench
from salbench.conclusions import tables
import toy
from tests.support.shapes import sphere

SEED = 2016
STEP = 1  # degrees between the rays of scans
PICTURE = 48  # pixels
MODELS = [row.name for row in salbench.models.table()]
CONFIG = f"""\
dataset: {{layout: folder, participants: simulated}}
scan: {{step_degrees: {STEP}}}
picture: {{size: {PICTURE}}}
models: {{{', '.join(f'{name}: {{}}' for name in MODELS)}, HS: {{}}}}
"""


def function_of(model):
    return getattr(salbench.models, model.lower())


class Artefacts(unittest.TestCase):
    """A run of every model on meshes and their scans, and its export."""

    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(cls.enterClassContext(tempfile.TemporaryDirectory()))
        config = cls.folder / "all.yaml"
        config.write_text(CONFIG)
        options = ["--data", toy.meshes(cls.folder / "meshes", 2), "--cache", cls.folder / "cache"]
        toy.run(config, *options, "--out", cls.folder / "out")
        toy.export(config, *options, "--to", cls.folder / "all.h5")
        cls.file = h5py.File(cls.folder / "all.h5")
        cls.addClassCleanup(cls.file.close)
        cls.meshes = [name for name in cls.file if f"{name}/mesh" in cls.file]
        cls.scans = [name for name in cls.file if f"{name}/scan" in cls.file]

    def same(self, found, shape, path):
        """Equal to the bit, in the type of the artefact."""
        stored = self.file[shape][path][...]
        self.assertEqual(found.dtype, stored.dtype, f"{shape}/{path}")
        self.assertEqual(found.shape, stored.shape, f"{shape}/{path}")
        self.assertEqual(found.tobytes(), stored.tobytes(), f"{shape}/{path}")

    def mesh(self, item):
        return self.file[item]["mesh/vertices"][:], self.file[item]["mesh/faces"][:]

    def scan(self, name):
        return salbench.Scan(self.file[name]["scan/points"][:], self.file[name]["scan/camera"][:])

    def test_meshes(self):
        self.assertEqual(len(self.scans), 12 * len(self.meshes))
        for item in self.meshes:
            points, faces = self.mesh(item)
            normals = salbench.estimate_normals(points, faces)
            self.same(normals, item, "normals/normals")
            self.same(salbench.fpfh(points, normals), item, "fpfh/fpfh")

    def test_scans(self):
        for item in self.meshes:
            scans = salbench.simulate_scans(*self.mesh(item), step_degrees=STEP)
            for view, scan in enumerate(scans):
                name = f"{item}_{view}"
                self.same(scan.points, name, "scan/points")
                self.same(scan.camera, name, "scan/camera")
                alone = salbench.simulate_scan(*self.mesh(item), view, step_degrees=STEP)
                self.same(alone.points, name, "scan/points")
                normals = salbench.estimate_normals(scan.points, viewpoint=scan.camera)
                self.same(normals, name, "scan_normals/normals")
                self.same(salbench.partial_mesh(scan.points, normals), name, "surface/faces")
                self.same(salbench.fpfh(scan.points, normals, scan=True), name, "fpfh/fpfh")

    def picks(self, shape, stage):
        truth = self.file[shape][stage]
        if "picks" not in truth:
            return []
        return np.split(truth["picks"][:], truth["pick_offsets"][1:-1])

    def test_ground_truth_of_scans(self):
        for name in self.scans:
            item = name.rsplit("_", 1)[0]
            carried = salbench.carry_ground_truth(self.mesh(item)[0], self.scan(name).points,
                                                  self.file[item]["ground_truth/saliency"][:],
                                                  self.picks(item, "ground_truth"))
            self.same(carried.ground_truth, name, "scan_ground_truth/saliency")
            expected = self.picks(name, "scan_ground_truth")
            self.assertEqual([own.tolist() for own in carried.picks], [own.tolist() for own in expected])

    def test_maps_of_meshes_from_points_and_faces_alone(self):
        for item in self.meshes:
            for model in MODELS:
                self.same(function_of(model)(*self.mesh(item), seed=SEED, item=item), item, f"map.{model}/saliency")

    def test_maps_of_scans_from_the_scan_alone(self):
        for name in self.scans:
            for model in MODELS:
                self.same(function_of(model)(self.scan(name), seed=SEED, item=name), name, f"map.{model}/saliency")

    def test_maps_of_what_is_given(self):
        name = self.scans[3]
        part = {"normals": "scan_normals/normals", "faces": "surface/faces", "fpfh": "fpfh/fpfh"}
        given = {key: self.file[name][path][:] for key, path in part.items()}
        shape = salbench.Shape(name, self.scan(name).points, **given)
        for model in MODELS:
            self.same(function_of(model)(shape, scan=True, seed=SEED), name, f"map.{model}/saliency")
            self.same(function_of(model)(shape.points, **given, scan=True, seed=SEED, item=name, threads=2), name,
                      f"map.{model}/saliency")

    def test_pictures_of_meshes(self):
        for item in self.meshes:
            picture = salbench.picture(*self.mesh(item), seed=SEED, item=item, size=PICTURE)
            for part in ("primitive", "weights", "depth", "shade", "coverage", "view_projection"):
                self.same(getattr(picture, part), item, f"picture/{part}")

    def test_conclusions(self):
        out = self.folder / "out"
        scores = pandas.read_csv(out / "results.csv", float_precision="round_trip")
        found = salbench.stats.conclude(scores, seed=SEED)
        for name, file in (("summary", "summary"), ("ranking", "ranking"), ("significance", "significance"),
                           ("agreement", "ranking_agreement"), ("per_class", "per_class"), ("human_share", "human_share")):
            expected = (out / f"{file}.csv").read_text()
            frame = getattr(found, name)
            self.assertEqual(tables.csv(frame, set(scores.get("remarks", ()))), expected, name)


class Points(unittest.TestCase):
    """Point clouds, through files and in memory."""

    def test_maps_equal_those_of_a_run(self):
        rng = np.random.default_rng(3)
        points = rng.normal(size=(300, 3))
        points /= np.linalg.norm(points, axis=1)[:, None] * (1 + 0.3 * rng.random((300, 1)))
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            (folder / "data").mkdir()
            (folder / "data/1.xyz").write_text("".join(f"{x!r} {y!r} {z!r}\n" for x, y, z in points.tolist()))
            (folder / "c.yaml").write_text("dataset: {layout: folder, participants: simulated}\n"
                                           f"models: {{{', '.join(f'{name}: {{}}' for name in MODELS)}}}\n")
            options = ["--data", folder / "data", "--cache", folder / "cache"]
            toy.run(folder / "c.yaml", *options, "--out", folder / "out")
            toy.export(folder / "c.yaml", *options, "--to", folder / "all.h5")
            with h5py.File(folder / "all.h5") as file:
                self.assertEqual(file["1/cloud/points"][:].tobytes(), points.tobytes())
                self.assertEqual(salbench.estimate_normals(points).tobytes(), file["1/cloud_normals/normals"][:].tobytes())
                for model in MODELS:
                    found = function_of(model)(points, seed=SEED, item="1")
                    self.assertEqual(found.tobytes(), file[f"1/map.{model}/saliency"][:].tobytes(), model)


SPHERE = sphere(12, 16)[0]


class Functions(unittest.TestCase):
    """Known answers."""

    def setUp(self):
        self.points = np.array([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]], float)
        self.faces = np.array([[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]])

    def test_options_are_those_of_a_configuration(self):
        points = SPHERE
        self.assertFalse(np.array_equal(salbench.models.ls(points), salbench.models.ls(points, foci_share=0.5)))
        np.testing.assert_array_equal(salbench.models.ps(points, absolute=True) >= 0, True)
        self.assertEqual(inspect.signature(salbench.models.ms).parameters["weight"].default, "area")
        self.assertEqual(inspect.signature(salbench.fpfh).parameters["neighbours"].default, 9)

    def test_a_model_of_random_numbers_draws_those_of_seed_and_item(self):
        first = salbench.models.rs(self.points, seed=1, item="a")
        np.testing.assert_array_equal(first, salbench.models.rs(self.points, seed=1, item="a"))
        for seed, item in ((2, "a"), (1, "b")):
            self.assertFalse(np.array_equal(first, salbench.models.rs(self.points, seed=seed, item=item)))

    def test_types_orders_and_lists_have_the_same_results(self):
        points = SPHERE.round(2)
        expected = salbench.models.cs(points)
        for same in (points.tolist(), np.asfortranarray(points), points[::-1][::-1], points.astype(">f8"),
                     np.repeat(points, 2, axis=0)[::2], points.astype("longdouble")):
            np.testing.assert_array_equal(salbench.models.cs(same), expected)
        faces = self.faces
        expected = salbench.models.mc(self.points, faces)
        for same in (faces.tolist(), faces.astype("u1"), faces.astype(">i8"), np.asfortranarray(faces)):
            np.testing.assert_array_equal(salbench.models.mc(self.points.astype("i1"), same), expected)

    def test_results_are_the_callers(self):
        areas = salbench.vertex_areas(self.points, self.faces)
        areas += 1
        self.assertTrue(areas.flags.writeable)
        self.assertTrue(areas.flags.c_contiguous)

    def test_what_cannot_be_used_is_named(self):
        points, faces, models, up = self.points, self.faces, salbench.models, np.tile([0, 0, 1], (6, 1))
        for named, *calls in [
            ("^points", lambda: models.ls(points[:, :2]), lambda: models.rs(np.empty((0, 3))), lambda: models.cb(points + np.inf),
             lambda: models.ls(None)),
            ("^points.*1e50", lambda: models.cb(points * 1e200)), ("^faces.* 5.* 6", lambda: salbench.vertex_areas(points, faces + 1)),
            ("^faces.*float64", lambda: salbench.vertex_areas(points, faces * 1.0)), ("^normals.* row 0", lambda: salbench.fpfh(points, 2 * up)),
            ("^normals", lambda: salbench.fpfh(points, up[:5]), lambda: salbench.fpfh(points, None), lambda: salbench.picture(points)),
            ("^fpfh", lambda: models.ps(points, fpfh=np.zeros((6, 32))), lambda: models.ps(points, fpfh=-np.ones((6, 33)))),
            ("^view.* 11.* 12", lambda: salbench.simulate_scan(points, faces, 12)),
            ("^view.*float", lambda: salbench.simulate_scan(points, faces, 1.0)),
            ("^threads", lambda: models.ls(points, threads=0)), ("^seed", lambda: models.rs(points, seed=-1)),
            ("area is 0", lambda: salbench.simulate_scan(points * 0, faces, 1)), ("foci_share", lambda: models.ls(points, foci_share=2)),
            ("weight.*'areas'.*area, inverse_square", lambda: models.ms(points, weight="areas")),
            ("^k .* 5", lambda: salbench.spectrum(points, faces, 5)),
            ("3 parts", lambda: salbench.spectrum(np.r_[points, points[:2] + 9], faces, 2)),
            ("^viewpoint", lambda: salbench.estimate_normals(points, viewpoint=[1, 2]),
             lambda: salbench.estimate_normals(points, faces, viewpoint=[1, 2, 3])),
            ("max_distance", lambda: salbench.vertex_values_of_samples(points, points, up[:, 0], -1)),
        ]:
            for call in calls:
                with self.subTest(named), self.assertRaisesRegex(ValueError, named):
                    call()
        with self.assertRaisesRegex(TypeError, "'foci_share'"):
            models.ls(points, foci_shar=1)


class Statistics(unittest.TestCase):
    def scores(self, **more):
        rng = np.random.default_rng(5)
        items = [str(i) for i in range(12)]
        table = pandas.DataFrame([{"item": item, "model": model, "auc": rng.random() / 2 + gain, "mine": rng.random() - gain}
                                  for model, gain in (("A", 0.5), ("B", 0.1), ("C", 0.1)) for item in items])
        return table.assign(**more)

    def test_metrics_are_chosen_and_others_are_named(self):
        found = salbench.stats.conclude(self.scores(), metrics=["mine", "auc"], lower_is_better=["mine"])
        self.assertEqual(list(dict.fromkeys(found.summary.metric)), ["mine", "auc"])
        best = found.ranking.groupby("metric").first().model
        self.assertEqual(best.to_dict(), {"mine": "A", "auc": "A"})
        self.assertEqual(set(salbench.stats.conclude(self.scores()).summary.metric), {"auc"})

    def test_means_intervals_and_units(self):
        scores = self.scores()
        by_view = pandas.concat([scores.assign(view=float(view)) for view in range(3)] +
                                [scores.assign(view=np.nan)], ignore_index=True)
        found = salbench.stats.conclude(by_view)
        summary = found.summary.set_index(["dataset", "model"])
        self.assertEqual(summary.loc[("scans", "A"), ["n", "n_shapes"]].tolist(), [12, 36])
        own = scores[scores.model == "A"].auc
        self.assertAlmostEqual(summary.loc[("meshes", "A"), "mean"], own.mean(), places=14)
        self.assertAlmostEqual(summary.loc[("meshes", "A"), "sd"], own.std(), places=14)
        self.assertEqual(salbench.stats.conclude(by_view, unit="shape").summary.n.max(), 36)
        self.assertFalse(salbench.stats.conclude(scores, seed=1).summary.equals(salbench.stats.conclude(scores).summary))

    def test_names_that_look_like_numbers_and_gaps_stay(self):
        scores = self.scores()
        scores["model"] = scores.model.map({"A": "NA", "B": "1.50", "C": "None"})
        self.assertEqual(set(salbench.stats.conclude(scores).summary.model), {"NA", "1.50", "None"})

    def test_what_cannot_be_used_is_named(self):
        scores, conclude = self.scores(), salbench.stats.conclude
        for error, named, call in [
            (ValueError, "^table.*dict", lambda: conclude({})), (ValueError, "^table.*'model'", lambda: conclude(scores.drop(columns="model"))),
            (KeyError, "'acu'.*'auc'", lambda: conclude(scores, metrics=["acu"])), (ValueError, "^unit.*'item'", lambda: conclude(scores, unit="item")),
            (ValueError, "^table:5: auc", lambda: conclude(scores.assign(auc=scores.auc.where(scores.index != 5, np.inf)))),
            (ValueError, "^seed", lambda: conclude(scores, seed=-1)),
        ]:
            with self.subTest(named), self.assertRaisesRegex(error, named):
                call()
