# SPDX-License-Identifier: GPL-3.0-or-later
"""One contract for every public set, on a miniature of each that is generated: none of the data is ours to publish. And fingerprints of the
data that are at hand."""

import subprocess
import sys
import unittest
from collections import namedtuple
from importlib import import_module
from pathlib import Path

import numpy as np

from salbench.datasets import sets
from salbench.datasets.files import extension
from salbench.datasets.records import InputError
from support import WithArchive, find, lines, obj, off, real, sphere

SPHERE = sphere()
N = len(SPHERE[0])
HEIGHTS = np.abs(SPHERE[0][:, 2])
STUDY = {"RawData/%s_0.pid": "0\n3\n", "RawData/%s_1.pid": "", "Distributions/%s.val": lines(HEIGHTS)}
NATIVE = ("gs", "princeton", "zaragoza")  # C++ reads them


def study(below, name):
    return {f"{below}{file % name}": content for file, content in STUDY.items()}


def gaze(points):
    """As SAL3D has it: positions, directions, density, flag."""
    return "".join(" ".join(map(str, [*point, *(6.0 * point), 0.5 * (k % 4), int(k % 4 > 2)])) + "\n" for k, point in enumerate(points))


def meshmamba(kind, paths="paths_dataset_rgb.txt", above=""):
    values = np.arange(len(SPHERE[1])) % 5.0
    return {f"MeshFile/{kind}/Apple_Red/Apple_v01.obj": obj(*SPHERE), f"MeshFile/{kind}/Apple_Red/Apple_v01.obj.mtl": "newmtl a\n",
            f"MeshFile/{kind}/Apple_Red/a.jpg": "no picture", f"SaliencyMap/{kind}/Apple_v01.csv": lines(values),
            paths: "".join(f"{above}MeshFile/rgb_texture/{name}/{name}.obj\n" for name in ("b", "c", "d", "Apple_v01", "e"))}


CLOUDS = {f"Gaze/{name}.txt": gaze(SPHERE[0]) for name in ("cow", "ant")} | {"splits.csv": "item,split\ncow,test\nant,train\n"}
MINIATURES = {  # files, and the items that are in them
    "3dva": ({f"3DModels-Simplif/{name}.off": off() for name in ("bunny", "dragon")}
             | {f"FixationMaps/{name}_{view}norm.txt": "1\n2\n3\n4\n" for name in ("bunny", "dragon") for view in (300, 413)}
             | {f"CentricityAndVisibilityMaps/{name}_{view}_visibility.txt": "1\n1\n1\n0\n" for name in ("bunny", "dragon") for view in (300, 413)},
             ["bunny_300", "bunny_413", "dragon_300", "dragon_413"]),
    "3dvisa": ({f"mesh3d/{name}.off": off() for name in ("cup_0002", "cup_0010")}
               | {f"saliency3d_gt/cup_00{k}.txt": "0.5\n1\n0\n0.4\n" for k in ("101", "022", "021", "023", "10_new")}, ["cup_0002_1", "cup_0002_2", "cup_0002_3", "cup_0010_1"]),
    "alexiou": ({"Clouds/amphoriskos.xyz": "nan nan nan\n" + "".join(f"{x} {y} {z}\n" for x, y, z in SPHERE[0]),
                 "Densities/amphoriskos.txt": "9\n" + lines(HEIGHTS)}, ["amphoriskos"]),
    "gs": ({f"off/{k}.off": off(*SPHERE) for k in (10, 2)} | {"off/README": "as downloaded\n"} | {f"GS/Saliency/{k}.val": lines(HEIGHTS) for k in (2, 10)} | study("GS/", 2), ["2", "10"]),
    "meshmamba": (meshmamba("non_texture"), ["Apple_v01"]),
    "meshmamba_textured": (meshmamba("rgb_texture"), ["Apple_v01"]),
    "princeton": ({"MeshsegBenchmark-1.0/data/off/400.off": off(*SPHERE)} | study("SchellingData/", 400), ["400"]),
    "sal3d": (CLOUDS, ["ant", "cow"]),
    "sal3d_meshes": ({"Meshes/cow.obj": obj(*SPHERE), "Gaze/cow.txt": gaze(SPHERE[0]), "splits.csv": "item,split\ncow,test\n"}, ["cow"]),
    "sal3d_spread": (CLOUDS, ["ant", "cow"]),
    "texmeshsaliency": (meshmamba("rgb_texture", "paths_dataset_tex.txt", "/home/somebody/ColorMesh/"), ["Apple_v01"]),
    "zaragoza": ({"Meshes/hand.off": off(*SPHERE)} | study("", "hand"), ["hand"]),
}
RECORDINGS = ("saliency3d", "eyenavgs")  # recordings_test.py has theirs


class EverySet(WithArchive):
    def each(self):
        """Each set with its miniature in a folder of its own."""
        for name, (files, names) in MINIATURES.items():
            self.setUp()
            self.write(files)
            with self.subTest(name):
                yield name, names, find(name)

    def test_has_a_miniature_and_says_what_was_seen(self):
        self.assertEqual(sorted((*MINIATURES, *RECORDINGS)), sorted(sets.SETS))
        for name, module in sets.SETS.items():
            about = import_module(f"salbench.datasets.{module}").__doc__
            self.assertTrue(find(name).version > 0 or name in NATIVE, name)
            self.assertTrue(find(name).licence, name)
            self.assertIn("Seen: ", about)
            self.assertRegex(about, r"\[\w+\d{4}\w*\]|2022")

    def test_lists_its_items_in_order(self):
        for name, names, found in self.each():
            listing = found.items(self.root)
            self.assertEqual([item.name for item in listing.items], names)
            self.assertTrue(all(item.truth and not item.problem for item in listing.items))
            self.assertEqual(listing, found.items(self.root))

    def test_a_listing_loads_no_numpy(self):
        self.write({name: text for files, _ in MINIATURES.values() for name, text in files.items()})
        code = "import importlib, sys\nfor name in sys.argv[2:]:\n    importlib.import_module('salbench.datasets.' + name).items(sys.argv[1])\n"
        done = subprocess.run([sys.executable, "-c", code + "assert 'numpy' not in sys.modules", self.root, *(sets.SETS[name] for name in MINIATURES)],
                              capture_output=True, text=True)
        self.assertEqual((done.returncode, done.stderr), (0, ""))

    def test_reads_the_shape_of_each(self):
        for name, names, found in self.each():
            self.assertEqual(found.has_read, name not in NATIVE)
            for item in found.items(self.root).items:
                shape = found.read(item)
                n = len(shape.points)
                self.assertEqual((shape.points.dtype, shape.points.shape, bool(np.isfinite(shape.points).all())), (np.float64, (n, 3), True))
                self.assertEqual(shape.faces is None, item.kind == "cloud")
                if shape.ground_truth is not None or not shape.participants:
                    self.assertEqual((shape.ground_truth.shape, shape.ground_truth.dtype), ((n,), np.float64))
                self.assertTrue(all(picks.dtype == np.int32 and ((0 <= picks) & (picks < n)).all() for picks in shape.participants))
                self.assertTrue(shape.face_truth is None or shape.face_truth.shape == (len(shape.faces),))
                again = found.read(item)
                for one in ("points", "faces", "normals", "ground_truth", "face_truth"):
                    self.equal(getattr(again, one), getattr(shape, one))

    def test_a_damaged_file_fails_its_item_by_name(self):
        for name, names, found in self.each():
            for item in found.items(self.root).items[:1] if found.has_read else []:
                for file in item.files:
                    if extension(file) in (".mtl", ".jpg"):
                        continue  # beside the shape: its content is a part of the key alone
                    path = Path(file)
                    content = path.read_bytes()
                    for bad in (b"\0\xff damaged\n", b"", content[:len(content) // 2], None):
                        path.unlink() if bad is None else path.write_bytes(bad)
                        with self.assertRaises(InputError) as caught:
                            found.read(item)
                        self.assertTrue(str(caught.exception).startswith(file), caught.exception)
                    path.write_bytes(content)

    def test_a_folder_without_it_is_refused_in_one_line(self):
        for name in MINIATURES:
            self.assertIn("ROOT: no .off, .obj or .ply meshes found", self.error_of(self.list, name))
        for name, _, found in self.each():
            for path in sorted(self.root.rglob("*.*")):
                if extension(str(path)) in (".csv", ".val", ".pid") or (extension(str(path)) == ".txt" and "sal3d" not in name):
                    path.unlink()
            if name not in ("gs", "princeton", "sal3d", "sal3d_spread", "sal3d_meshes"):  # truth is optional, or in one file with the points
                self.assertRegex(self.error_of(found.items, self.root), "^ROOT/.*: has no .* of a (view of a )?(mesh|cloud): expected are files ")


class Miniatures(WithArchive):
    """Miniature archives: cases of single data sets."""

    def make(self, name, **more):
        self.write(MINIATURES[name][0] | more)

    def test_3dva_scores_views_on_what_they_show(self):
        self.make("3dva")
        self.equal(self.read("3dva", "dragon_413").ground_truth, [1, 2, 3, np.nan])
        self.setUp()
        self.write({"Meshes/bunny.off": off(), "FixationMaps/bunny_a.txt": "1\n-1\n3\n-1\n", "FixationMaps/bunny_b.txt": "3\n2\n-1\n-1\n"})
        self.equal(self.read("3dva").ground_truth, [2, 2, 3, np.nan])

    def test_3dva_knows_people_by_view(self):
        """The ground truth stays the published one; what the mask hides is hidden to people, too."""
        self.make("3dva")
        people = {"T01": "4\n3\n2\n1\n", "T02": "0\n1\n0\n5\n"}
        self.write({f"PerSubjectFixations/bunny_300.csv.{name}.result": text for name, text in people.items()})
        self.write({"PerSubjectFixations/cow_300.csv.T01.result": "1\n"})
        listing = self.list("3dva")
        self.assertEqual([item.viewers for item in listing.items], [2, 0, 0, 0])
        self.assertEqual(listing.notes, [f"{self.root}/PerSubjectFixations/cow_300.csv.T01.result: belongs to no item and was left out"])
        shape = self.read("3dva", "bunny_300")
        self.equal(shape.ground_truth, [1, 2, 3, np.nan])
        self.equal(shape.viewers, [[4, 3, 2, np.nan], [0, 1, 0, np.nan]])
        self.setUp()
        self.write({"3DModels-Simplif/hand-35K.off": off(), "FixationMaps/hand-35K_300norm.txt": "1\n2\n3\n4\n",
                    "CentricityAndVisibilityMaps/hand-35K_300_visibility.txt": "1\n1\n1\n1\n"}
                   | {f"PerSubjectFixations/hand_300.csv.{name}.result": text for name, text in people.items()})
        self.equal(self.read("3dva", "hand-35K_300").viewers, [[4, 3, 2, 1], [0, 1, 0, 5]])

    def test_3dvisa_hides_zeros(self):
        self.make("3dvisa")
        self.equal(self.read("3dvisa").ground_truth, [0.5, 1, np.nan, 0.4])
        self.assertEqual([(item.shape_name, item.view) for item in self.list("3dvisa").items][2:], [("cup_0002", "3"), ("cup_0010", "1")])

    def test_a_cloud_leaves_out_densities_with_their_points(self):
        self.make("alexiou")
        self.equal(self.read("alexiou").ground_truth, HEIGHTS)

    def test_the_study_is_read_by_the_program(self):
        self.make("princeton")
        (item,) = self.list("princeton").items
        self.assertEqual((item.category, item.participants, len(item.picks), Path(item.saliency).name), ("four-legged", 2, 2, "400.val"))
        self.setUp()
        self.make("gs", **{"GS/Saliency/77.val": "1\n", "GS/RawData/2_x.pid": "1\n"})
        *stray, missing = self.list("gs").notes
        self.assertEqual(stray, [f"{self.root}/GS/{name}: belongs to no item and was left out" for name in ("Saliency/77.val", "RawData/2_x.pid")])
        self.assertEqual(missing, "2 of the 400 meshes of SHREC'07 are here, without 1, 3-9, 11-400")

    def test_sal3d_is_read_as_points_or_carried_to_meshes(self):
        self.make("sal3d")
        shape = self.read("sal3d", "cow")
        self.equal(shape.ground_truth, 0.5 * (np.arange(N) % 4))
        self.equal(shape.participants[0], np.flatnonzero(np.arange(N) % 4 > 2))
        np.testing.assert_allclose(shape.normals, SPHERE[0], atol=1e-12)
        self.assertEqual([item.split for item in self.list("sal3d").items], ["train", "test"])
        self.setUp()
        self.make("sal3d_meshes")
        self.equal(self.read("sal3d_meshes").ground_truth, 0.5 * (np.arange(N) % 4))
        self.setUp()
        self.write({"Models_3D/cow.obj": obj(*SPHERE), "dataset_train/cow.txt": gaze(SPHERE[0][SPHERE[0][:, 0] > -0.5])})
        self.equal(np.isnan(self.read("sal3d").ground_truth), SPHERE[0][:, 0] <= -0.5)

    def test_sal3d_leaves_out_the_rows_that_fill_a_file_up(self):
        rows, zeros = gaze(SPHERE[0]).splitlines(True), "0 0 0 0 0 0 0 0\n"
        for more in ([zeros] * 5, rows[3:4] * 7, [rows[5], zeros, rows[-1], zeros]):
            self.write({"Gaze/cow.txt": "".join(rows + more)})
            shape = self.read("sal3d")
            self.equal(shape.left_out, N + np.arange(len(more)))
            self.equal(shape.ground_truth, 0.5 * (np.arange(N) % 4))
        self.write({"Gaze/cow.txt": "".join(rows[:5] + rows[2:3] + rows[5:])})
        self.assertEqual(len(self.read("sal3d").points), N + 1)  # a clone of a vertex

    def test_mesh_mamba_keeps_values_per_face(self):
        self.make("meshmamba")
        shape = self.read("meshmamba")
        self.equal(shape.face_truth, np.arange(len(SPHERE[1])) % 5.0)
        (item,) = self.list("meshmamba").items
        self.assertEqual((item.split, len(item.files), shape.participants), ("test+train_80", 2, ()))  # the fourth line of five
        looked_at = np.zeros(len(SPHERE[1]))
        looked_at[[3, 7]] = 1, 2
        self.write({"FixationMap/Apple_v01.csv": lines(looked_at)})
        (picks,) = self.read("meshmamba").participants
        self.equal(picks, sorted({*SPHERE[1][3], *SPHERE[1][7]}))

    def test_textures_are_a_part_of_the_key(self):
        self.make("meshmamba_textured")
        files = [str(Path(file).relative_to(self.root)) for file in self.list("meshmamba_textured").items[0].files]
        self.assertEqual(files[2:], ["MeshFile/rgb_texture/Apple_Red/Apple_v01.obj.mtl", "MeshFile/rgb_texture/Apple_Red/a.jpg"])

    def test_textured_mesh_saliency_has_splits_of_its_own(self):
        self.make("texmeshsaliency")
        listing = self.list("texmeshsaliency")
        self.assertEqual((listing.items[0].split, len(listing.unknown)), ("train", 4))
        self.assertIn("SaliencyMap/non_texture", listing.remark)


Fingerprint = namedtuple("Fingerprint", "items count mean sd")  # of all values, as NumPy reads them by itself; another reading is another VERSION


class RealData(unittest.TestCase):
    def check(self, name, folder, of_points, of_faces=None):
        root = real(folder)
        if root is None:
            self.skipTest("no real data")
        items, shapes = find(name).items(root).items, []
        for item in items:
            shapes.append(find(name).read(item))
        for found, expected in (([shape.ground_truth for shape in shapes], of_points), ([shape.face_truth for shape in shapes], of_faces)):
            if expected is not None:
                found = np.concatenate(found)
                self.assertEqual((len(items), len(found)), (expected.items, expected.count))
                np.testing.assert_allclose([found.mean(), found.std()], [expected.mean, expected.sd], rtol=1e-12)

    def test_sal3d(self):
        self.check("sal3d", "sal3d", Fingerprint(52, 1_040_000, 0.024071626019658864, 0.08400144942265421))

    def test_meshmamba(self):
        self.check("meshmamba", "meshmamba", Fingerprint(3, 49_304, 0.1432948148126139, 0.17593431582404928),
                   Fingerprint(3, 98_604, 0.14344942662569468, 0.17692641991820474))

    def test_meshmamba_textured(self):
        self.check("meshmamba_textured", "meshmamba", Fingerprint(3, 49_304, 0.15200427915012463, 0.17767700728436137),
                   Fingerprint(3, 98_604, 0.15215938336172974, 0.17867050907024543))

    def test_zaragoza(self):
        self.check("zaragoza", "eyetracking", Fingerprint(23, 460_000, 0.030516110805793653, 0.09007633749022932))
