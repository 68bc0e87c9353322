# SPDX-License-Identifier: GPL-3.0-or-later
"""One contract for every archive, on a miniature of each that is generated: none of the data is ours to publish. And fingerprints of the
data that are at hand."""

import dataclasses
import importlib
import json
import re
import unittest

import numpy as np

from salbench import _core, datasets
from salbench.datasets import sets
from salbench.datasets.records import InputError, Item
from support import WithArchive, lines, obj, off, real, sphere

SPHERE = sphere()
N = len(SPHERE[0])
HEIGHTS = np.abs(SPHERE[0][:, 2])
STUDY = {"RawData/%s_0.pid": "0\n3\n", "RawData/%s_1.pid": "", "Distributions/%s.val": lines(HEIGHTS)}


def study(below, name):
    return {f"{below}{file % name}": content for file, content in STUDY.items()}


def gaze(points):
    """As SAL3D has it: positions, directions, density, flag."""
    return "".join(" ".join(map(str, [*point, *(6.0 * point), 0.5 * (k % 4), int(k % 4 > 2)])) + "\n" for k, point in enumerate(points))


def meshmamba(kind):
    values = np.arange(len(SPHERE[1])) % 5.0
    return {f"MeshFile/{kind}/Apple_Red/Apple_v01.obj": obj(*SPHERE), f"MeshFile/{kind}/Apple_Red/Apple_v01.obj.mtl": "newmtl a\n",
            f"MeshFile/{kind}/Apple_Red/a.jpg": "no picture", f"SaliencyMap/{kind}/Apple_v01.csv": lines(values),
            "paths_dataset_rgb.txt": "".join(f"MeshFile/rgb_texture/{name}/{name}.obj\n" for name in ("b", "c", "d", "Apple_v01", "e"))}


def fixations(points):
    """As Saliency3D has them, in columns without names: 4 and 5 pixel, 8 and 9 view, 10 duration, 11 to 13 hit."""
    return "".join(",".join(map(str, [k, 0, 0, 0, 960.5, 540.5, 0, 0, 3, 4, 200 + k, *point])) + "\n" for k, point in enumerate(points))


MINIATURES = {  # files, and the items that are in them
    "3dva": ({f"3DModels-Simplif/{name}.off": off() for name in ("bunny", "dragon")}
             | {f"FixationMaps/{name}_{view}norm.txt": "1\n2\n3\n4\n" for name in ("bunny", "dragon") for view in (300, 413)}
             | {f"CentricityAndVisibilityMaps/{name}_{view}_visibility.txt": "1\n1\n1\n0\n" for name in ("bunny", "dragon") for view in (300, 413)},
             ["bunny_300", "bunny_413", "dragon_300", "dragon_413"]),
    "gs": ({f"off/{k}.off": off(*SPHERE) for k in (10, 2)} | {f"GS/Saliency/{k}.val": lines(HEIGHTS) for k in (2, 10)} | study("GS/", 2), ["2", "10"]),
    "meshmamba": (meshmamba("non_texture"), ["Apple_v01"]),
    "meshmamba_textured": (meshmamba("rgb_texture"), ["Apple_v01"]),
    "princeton": ({"MeshsegBenchmark-1.0/data/off/400.off": off(*SPHERE)} | study("SchellingData/", 400), ["400"]),
    "sal3d": ({f"Gaze/{name}.txt": gaze(SPHERE[0]) for name in ("cow", "ant")} | {"splits.csv": "item,split\ncow,test\nant,train\n"}, ["ant", "cow"]),
    "sal3d_meshes": ({"Meshes/cow.obj": obj(*SPHERE), "Gaze/cow.txt": gaze(SPHERE[0]), "splits.csv": "item,split\ncow,test\n"}, ["cow"]),
    "sal3d_spread": ({f"Gaze/{name}.txt": gaze(SPHERE[0]) for name in ("cow", "ant")} | {"splits.csv": "item,split\ncow,test\nant,train\n"}, ["ant", "cow"]),
    "saliency3d": ({"obj/hand.obj": obj(*SPHERE)} | {f"3D_gaze_data/Code/Exp1/hand/{person}": fixations(SPHERE[0][k::9])
                                                     for k, person in enumerate(("zl", "zy"))}, ["hand"]),
    "zaragoza": ({"Meshes/hand.off": off(*SPHERE)} | study("", "hand"), ["hand"]),
}


class EveryArchive(WithArchive):
    def each(self):
        """Each archive with its miniature in a folder of its own."""
        for name, (files, names) in MINIATURES.items():
            self.setUp()
            self.write(files)
            with self.subTest(name):
                yield name, names

    def test_has_a_miniature_and_says_what_was_seen(self):
        self.assertEqual(list(MINIATURES), sorted(datasets.ARCHIVES))
        for name, module in datasets.ARCHIVES.items():
            archive, about = datasets.find(name), importlib.import_module(f"salbench.datasets.{module}").__doc__
            self.assertEqual((archive.LAYOUT.name, archive.VERSION > 0, bool(archive.LAYOUT.licence)), (name, True, True))
            self.assertIn("Seen: ", about)
            self.assertRegex(about, r"\[\w+\d{4}\]|2022")

    def test_lists_its_items_in_order(self):
        for name, names in self.each():
            listed = self.list(name)
            self.assertEqual([item.name for item in listed.items], names)
            self.assertEqual([item.problem for item in listed.items], [""] * len(names))
            self.assertTrue(all(item.truth or item.recorded for item in listed.items))
            self.assertEqual([Item.from_json(json.loads(json.dumps(item.to_json()))) for item in listed.items], listed.items)
            self.assertFalse(any(str(self.root) in file.name for item in listed.items for file in item.files), "no paths in names")
            self.assertEqual(listed, self.list(name))

    def test_reads_the_one_form_of_each(self):
        for name, names in self.each():
            for item in self.list(name).items:
                self.assertEqual(item.native, name in ("gs", "princeton", "zaragoza"))
                form = datasets.read(name, str(self.root), item)
                n = len(form.points)
                self.assertEqual((form.points.dtype, form.points.shape, bool(np.isfinite(form.points).all())), (np.float64, (n, 3), True))
                self.assertEqual(form.faces is None, item.kind == "cloud")
                self.assertEqual((len(form.truths), form.recording is None), (0, False) if item.recorded else (1, True))
                for truth in form.truths:
                    self.assertTrue(truth.saliency is None or truth.saliency.shape == (n,))
                    self.assertTrue(all(picks.dtype == np.int32 and ((0 <= picks) & (picks < n)).all() for picks in truth.picks))
                self.assertEqual(set(form.digests), {file.path for file in item.files})
                self.assertEqual(form.about["source"], name)
                again = _core.read_one_form(_core.one_form_image(form), b"form")
                for key in ("points", "faces", "normals"):
                    np.testing.assert_array_equal(again[key], getattr(form, key))
                for truth, read in zip(form.truths, again["truths"], strict=True):
                    np.testing.assert_array_equal(read["saliency"], truth.saliency)
                for key, column in (again["recording"] or {}).items():
                    np.testing.assert_array_equal(column, getattr(form.recording, key))
                self.assertEqual(_core.one_form_image(form), _core.one_form_image(datasets.read(name, str(self.root), item)))

    def test_a_damaged_file_fails_its_item_by_name(self):
        for name, names in self.each():
            item = self.list(name).items[0]
            for file in item.files:
                if item.native or file.name.startswith("texture"):  # the program reads the former
                    continue
                path = self.root / file.path
                content = path.read_bytes()
                for bad in (b"\0\xff damaged\n", b"", None):
                    path.unlink() if bad is None else path.write_bytes(bad)
                    if file.name.startswith("gaze"):  # fails its people
                        form = datasets.read(name, str(self.root), item)
                        self.assertTrue(form.problems[0].startswith(file.path), form.problems)
                        self.assertEqual(len(form.recording.people), item.recorded - 1)
                        continue
                    with self.assertRaises(InputError) as caught:
                        datasets.read(name, str(self.root), item)
                    self.assertTrue(str(caught.exception).startswith(file.path), caught.exception)
                path.write_bytes(content)

    def test_a_folder_without_it_is_refused_in_one_line(self):
        for name in datasets.ARCHIVES:
            self.assertIn("ROOT: no .off, .obj or .ply meshes found", self.error_of(lambda: self.list(name)))

    def test_each_is_known_again_in_a_message_of_another(self):
        for name, names in self.each():
            fit = sets.layouts_that_fit(str(self.root))
            self.assertIn(name, re.findall(r"\w+", fit.partition(": ")[2]))
            other = "saliency3d" if name != "saliency3d" else "sal3d"
            with self.assertRaisesRegex(InputError, re.escape(fit) + "$"):
                sets.listed(other, str(self.root))
        self.setUp()
        self.assertEqual(sets.layouts_that_fit(str(self.root)), "")


class Miniatures(WithArchive):
    """What is particular to one archive."""

    def make(self, name):
        self.write(MINIATURES[name][0])

    def test_3dva_scores_views_on_what_they_show(self):
        self.make("3dva")
        self.equal(self.truth("3dva", "dragon_413").saliency, [1, 2, 3, np.nan])
        self.setUp()
        self.write({"Meshes/bunny.off": off(), "FixationMaps/bunny_a.txt": "1\n-1\n3\n-1\n", "FixationMaps/bunny_b.txt": "3\n2\n-1\n-1\n"})
        self.equal(self.truth("3dva").saliency, [2, 2, 3, np.nan])

    def test_3dva_knows_people_by_view(self):
        """The ground truth stays the published one; what the mask hides is hidden to people, too."""
        self.make("3dva")
        people = {"T01": "4\n3\n2\n1\n", "T02": "0\n1\n0\n5\n"}
        self.write({f"PerSubjectFixations/bunny_300.csv.{name}.result": text for name, text in people.items()})
        self.write({"PerSubjectFixations/cow_300.csv.T01.result": "1\n"})
        listing = self.list("3dva")
        self.assertEqual([(item.name, item.viewers) for item in listing.items],
                         [("bunny_300", 2), ("bunny_413", 0), ("dragon_300", 0), ("dragon_413", 0)])
        self.assertEqual([note.replace(str(self.root), "ROOT") for note in listing.notes],
                         ["ROOT/PerSubjectFixations/cow_300.csv.T01.result: a viewer of no item"])
        form = self.read("3dva", "bunny_300")
        self.equal(form.truths[0].saliency, [1, 2, 3, np.nan])
        self.equal(form.truths[0].viewers, [[4, 3, 2, np.nan], [0, 1, 0, np.nan]])
        self.assertEqual(form.about["viewers"], "01\n02")
        self.setUp()
        self.write({"3DModels-Simplif/hand-35K.off": off(), "FixationMaps/hand-35K_300norm.txt": "1\n2\n3\n4\n",
                    "CentricityAndVisibilityMaps/hand-35K_300_visibility.txt": "1\n1\n1\n1\n"}
                   | {f"PerSubjectFixations/hand_300.csv.{name}.result": text for name, text in people.items()})
        self.equal(self.truth("3dva", "hand-35K_300").viewers, [[4, 3, 2, 1], [0, 1, 0, 5]])

    def test_the_study_is_native(self):
        self.make("princeton")
        (item,) = self.list("princeton").items
        self.assertEqual((item.category, item.participants, *map(len, item.native_files[:0:-1])), ("four-legged", 2, 2, 1))

    def test_sal3d_is_read_as_points_or_carried_to_meshes(self):
        self.make("sal3d")
        form = self.read("sal3d", "cow")
        self.equal(form.truths[0].saliency, 0.5 * (np.arange(N) % 4))
        self.equal(form.truths[0].picks[0], np.flatnonzero(np.arange(N) % 4 > 2))
        np.testing.assert_allclose(form.normals, SPHERE[0], atol=1e-12)
        self.assertEqual(form.about["split"], "test")
        for name, files in [("sal3d_meshes", MINIATURES["sal3d_meshes"][0]),
                            ("sal3d", {"Models_3D/cow.obj": obj(*SPHERE), "dataset_train/cow.txt": gaze(SPHERE[0][SPHERE[0][:, 0] > -0.5])})]:
            self.setUp()
            self.write(files)
            saliency, at = self.truth(name).saliency, SPHERE[0][:, 0] > -0.5
            self.equal(np.isnan(saliency), np.zeros(N, bool) if name != "sal3d" else ~at)
            if name != "sal3d":
                self.equal(saliency, 0.5 * (np.arange(N) % 4))

    def test_saliency3d_has_fixations_that_follow_one_another(self):
        self.make("saliency3d")
        form = self.read("saliency3d")
        found, n = form.recording, len(SPHERE[0][::9])
        self.assertEqual((found.people, form.remarks, found.origins), (("zl", "zy"), [], None))
        self.equal(found.points[:n], SPHERE[0][::9])
        self.equal(found.durations[:3], [200, 201, 202])
        self.equal(found.time[:3], [0, 200, 401])
        self.equal(np.flatnonzero(np.diff(found.person)), [n - 1])
        self.write({"3D_gaze_data/Code/Exp1/hand/zl": "1,2,3\n" + fixations(SPHERE[0][:2])})
        self.assertEqual([remark.replace(str(self.root), "ROOT") for remark in self.read("saliency3d").remarks],
                         ["ROOT/3D_gaze_data/Code/Exp1/hand/zl:1: 1 of 3 rows of zl is left out: fewer columns than are named (the first is here)"])

    def test_mesh_mamba_keeps_values_per_face(self):
        self.make("meshmamba")
        form = self.read("meshmamba")
        self.equal(form.truths[0].face_values, np.arange(len(SPHERE[1])) % 5.0)
        self.assertEqual(form.about["split"], "test+train_80")  # the fourth line of five
        self.assertEqual(len(self.list("meshmamba").items[0].files), 2)
        self.setUp()
        self.make("meshmamba_textured")
        self.assertEqual([file.name for file in self.list("meshmamba_textured").items[0].files],
                         ["mesh file .obj", "saliency file (per: face)", "texture 0, .mtl", "texture 1, .jpg"])
        self.assertIn("MeshFile/rgb_texture/Apple_Red/a.jpg\n", self.read("meshmamba_textured").about["source_files"])


@dataclasses.dataclass(frozen=True)
class Fingerprint:
    """Of all values of an archive, as NumPy reads its texts by itself; of vertices of Mesh Mamba as the program had them when it read the
    archive in C++. A new reading is a new version of an importer."""

    items: int
    count: int
    mean: float
    sd: float


class RealData(unittest.TestCase):
    def check(self, name, folder, of_points, of_faces=None):
        root = real(folder)
        if root is None:
            self.skipTest("no real data")
        listed = datasets.find(name).items(str(root))
        values, per_face = [], []
        for item in listed.items:
            self.assertEqual(item.problem, "")
            (truth,) = datasets.read(name, str(root), item).truths
            values.append(truth.saliency)
            per_face += [] if truth.face_values is None else [truth.face_values]
        for found, expected in ((values, of_points), (per_face, of_faces)):
            if expected is not None:
                found = np.concatenate(found)
                self.assertEqual((len(listed.items), len(found)), (expected.items, expected.count))
                np.testing.assert_allclose([found.mean(), found.std()], [expected.mean, expected.sd], rtol=1e-12)

    def test_sal3d(self):
        self.check("sal3d", "sal3d", Fingerprint(52, 1_040_000, 0.024071626019658864, 0.08400144942265421))

    def test_zaragoza(self):
        self.check("zaragoza", "eyetracking", Fingerprint(23, 460_000, 0.030516110805793653, 0.09007633749022932))

    def test_meshmamba(self):
        self.check("meshmamba", "meshmamba", Fingerprint(3, 49_304, 0.1432948148126139, 0.17593431582404928),
                   Fingerprint(3, 98_604, 0.14344942662569468, 0.17692641991820474))

    def test_meshmamba_textured(self):
        self.check("meshmamba_textured", "meshmamba", Fingerprint(3, 49_304, 0.15200427915012463, 0.17767700728436137),
                   Fingerprint(3, 98_604, 0.15215938336172974, 0.17867050907024543))
