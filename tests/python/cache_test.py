# SPDX-License-Identifier: GPL-3.0-or-later
"""Caches, read-only: what an export of them holds, several artefacts of one stage, damage, and a run that goes on."""

import os
import pathlib
import pickle
import shutil
import tempfile
import unittest

import h5py
import numpy as np

import salbench
import toy
from tests.support.cache_files import damage, segments

CONFIG = "dataset: {layout: folder, participants: simulated}\nscan: {step_degrees: 2}\nmodels: {LS: {}, RS: {}}\n"


class Caches(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.shared = pathlib.Path(cls.enterClassContext(tempfile.TemporaryDirectory()))
        toy.meshes(cls.shared / "meshes", 2, 24, 14)
        cls.run_with(cls.shared / "cache", CONFIG, "--export")

    @classmethod
    def run_with(cls, cache, config, *export):
        path = cls.shared / "c.yaml"
        path.write_text(config)
        salbench.run(path, data=cls.shared / "meshes", cache=cache, out=cls.shared / "out", progress=False)
        if export:
            toy.export(path, "--data", cls.shared / "meshes", "--cache", cache, "--to", cls.shared / "all.h5")

    def setUp(self):
        self.folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory())) / "cache"
        shutil.copytree(self.shared / "cache", self.folder)
        self.cache = salbench.Cache(self.folder)

    def files(self):
        return sorted((str(path), path.stat().st_mtime_ns) for path in self.folder.rglob("*"))

    def test_items_and_stages(self):
        items = ["1", *(f"1_{view}" for view in range(12)), "2", *(f"2_{view}" for view in range(12))]
        self.assertEqual(sorted(self.cache.names()), sorted([*items, "meshes", "scans"]))
        self.assertEqual([name for name in self.cache if name not in ("meshes", "scans")], items)
        self.assertEqual(len(self.cache), 28)
        self.assertTrue("2_11" in self.cache and "3" not in self.cache and 3 not in self.cache)
        self.assertIn("score_table.LS", self.cache.stages)
        self.assertEqual(set(self.cache["1"].stages),
                         {"mesh", "ground_truth", "normals", "fpfh", "map.LS", "map.RS", "matched.LS", "matched.RS",
                          "scores.LS", "scores.RS"})
        self.assertEqual(tuple(self.cache["1"]), self.cache["1"].stages)

    def test_holds_what_the_export_holds(self):
        compared = 0
        with h5py.File(self.shared / "all.h5") as file:
            for name in file:
                if name not in self.cache:
                    continue
                for stage in self.cache[name].stages:
                    if stage not in file[name]:
                        continue
                    artefact = self.cache[name][stage]
                    self.assertEqual(set(artefact), set(file[name][stage]))
                    for array, values in artefact.items():
                        there = file[name][stage][array]
                        self.assertEqual(values.dtype, there.dtype)
                        np.testing.assert_array_equal(values, there[()])
                        compared += 1
        self.assertGreater(compared, 200)

    def test_what_everybody_asks_for(self):
        mesh, scan = self.cache["2"], self.cache["1_3"]
        shape = salbench.Dataset("folder", self.shared / "meshes")["2"]
        np.testing.assert_array_equal(mesh.points, shape.points)
        np.testing.assert_array_equal(mesh.faces, shape.faces)
        for item, kinds in ((mesh, ("mesh/vertices", "normals/normals")), (scan, ("scan/points", "scan_normals/normals"))):
            with h5py.File(self.shared / "all.h5") as file:
                np.testing.assert_array_equal(item.points, file[item.name][kinds[0]][:])
                np.testing.assert_array_equal(item.normals, file[item.name][kinds[1]][:])
                np.testing.assert_array_equal(item.fpfh, file[item.name]["fpfh/fpfh"][:])
                np.testing.assert_array_equal(item.maps["LS"], file[item.name]["map.LS/saliency"][:])
            self.assertEqual((item.fpfh.dtype, item.fpfh.shape), (np.float32, (len(item.points), 33)))
            self.assertEqual(item.ground_truth.shape, (len(item.points),))
            self.assertEqual(list(item.maps), ["LS", "RS"])
        self.assertEqual(scan.faces.shape[1], 3)
        self.assertEqual(list(mesh.matched), ["LS", "RS"])
        self.assertEqual(self.cache["meshes"]["reference"]["density"].shape, (100,))

    def test_arrays_are_views_and_attributes_are_there(self):
        artefact = self.cache["1"]["map.LS"]
        values = artefact["saliency"]
        self.assertFalse(values.flags.writeable or values.flags.owndata)
        self.assertEqual((artefact.item, artefact.stage, artefact.attributes["kind"]), ("1", "map.LS", "field"))
        self.assertIn("selected_share: 0.05", artefact.attributes["options"])
        self.assertIn("selected_share: 0.05", artefact.recipe.splitlines())
        self.assertTrue(os.path.exists(artefact.path))

    def test_names_that_there_are_not(self):
        for wrong, what in ((lambda: self.cache["1_13"], "no item '1_13'; did you mean '1_1"),
                            (lambda: self.cache["1"]["fpf"], "called 'fpf'; did you mean 'fpfh'"),
                            (lambda: self.cache["1"].maps["SL"], "called 'SL'; did you mean"),
                            (lambda: self.cache["1"]["fpfh"]["fpf"], "'fpf'; did you mean 'fpfh'"),
                            (lambda: self.cache["meshes"].points, "stage called 'points'")):
            with self.assertRaisesRegex(KeyError, what):
                wrong()

    def test_several_artefacts_of_a_stage_are_told_apart(self):
        self.run_with(self.folder, CONFIG + "fpfh: {neighbours: 12}\n")
        item = self.cache["1"]
        with self.assertRaises(LookupError) as raised:
            item.fpfh
        message = str(raised.exception)
        self.assertIn("fpfh of 1 was computed 2 times", message)
        self.assertIn("cache['1'].all('fpfh')[-1]", message)
        self.assertIn("neighbours: 12", message)
        self.assertNotIn("stage_version", message)  # is the same
        both = item.all("fpfh")
        self.assertEqual(len(both), 2)
        self.assertEqual(sum("neighbours: 12" in artefact.attributes["options"] for artefact in both), 1)
        self.assertEqual(item.normals.shape, item.points.shape)

    def test_versions_of_a_model_are_told_apart(self):
        def versions(axis, items="1-2"):
            salbench.run(self.shared / "c.yaml", data=self.shared / "meshes", models={"MINE": lambda shape: shape.points[:, axis]}, items=items,
                         cache=self.folder, out=self.shared / "out", progress=False)

        for axis in (0, 1):
            versions(axis)
        with self.assertRaises(LookupError) as raised:
            self.cache["1"]["map.MINE"]
        self.assertIn("was computed 2 times, with different results", str(raised.exception))
        newest = self.cache["1"].all("map.MINE")[-1]
        np.testing.assert_array_equal(newest["saliency"], self.cache["1"].points[:, 1])

    def test_equal_results_under_two_keys_are_one(self):
        self.run_with(self.folder, CONFIG + "fpfh: {radius: 0.3}\n")  # which is not used
        item = salbench.Cache(self.folder)["1"]
        self.assertEqual(len(item.all("fpfh")), 2)
        np.testing.assert_array_equal(item.fpfh, self.cache["1"].all("fpfh")[0]["fpfh"])

    def test_a_damaged_artefact_is_named_and_left_alone(self):
        path = damage(self.folder, "map.RS", "1")
        self.assertEqual(path, pathlib.Path(self.cache["1"]["map.LS"].path))
        before = self.files()
        for cache in (self.cache, salbench.Cache(self.folder)):
            with self.assertRaisesRegex(ValueError, f"{path}: map.RS of 1: checksum mismatch"):
                cache["1"].maps["RS"]
            self.assertEqual(cache["1"].maps["LS"].shape, (len(cache["1"].points),))
        self.assertEqual(self.files(), before)

    def test_nothing_is_written(self):
        before = self.files()
        for name in self.cache:
            for stage in self.cache[name].stages:
                self.cache[name].all(stage)
        self.assertEqual(self.files(), before)

    def test_a_run_may_go_on_meanwhile(self):
        self.assertNotIn("map.CS", self.cache["1"].stages)
        self.run_with(self.folder, CONFIG.replace("RS: {}", "CS: {}"))
        self.assertEqual(self.cache["1"].maps["CS"].shape, (len(self.cache["1"].points),))
        item = self.cache["2"]
        for path in segments(self.folder):
            path.unlink()
        with self.assertRaisesRegex(KeyError, "there is no artefact of 2 from a stage called 'fpfh'"):
            item.fpfh

    def test_folders_that_are_no_caches(self):
        with self.assertRaises(FileNotFoundError):
            salbench.Cache(self.folder / "nowhere")
        with self.assertRaises(NotADirectoryError):
            salbench.Cache(self.folder / "CACHEDIR.TAG")
        with self.assertRaisesRegex(ValueError, "not a salbench cache"):
            salbench.Cache(self.folder.parent)
        tag = self.folder / "CACHEDIR.TAG"
        tag.write_text(tag.read_text().replace("format 2", "format 9"))
        with self.assertRaisesRegex(OSError, "written by a newer salbench"):
            salbench.Cache(self.folder)

    def test_pickles(self):
        self.assertEqual(pickle.loads(pickle.dumps(self.cache))["1"].points.shape, self.cache["1"].points.shape)
