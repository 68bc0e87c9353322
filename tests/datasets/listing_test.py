# SPDX-License-Identifier: GPL-3.0-or-later
"""Listings of folders by the layouts of the Schelling study's files, by those that C++ lists, and by none: then one error. Names of files: patterns,
shapes of a folder, and natural order."""

import itertools
import os
import unittest

import salbench
from salbench.datasets import files, sets
from salbench.system.errors import InputError
from support import WithArchive, lines, off


class Folders(WithArchive):
    def rows(self, layout, below="."):
        """ "2 cup Meshes/22.off RawData/22_0.pid" of each item, of a folder in it."""
        rows = []
        for item in sets.listed(layout, str(self.root / below))[1].items:
            files = [os.path.relpath(os.path.realpath(path), os.path.realpath(self.root)) for path in (*item.files, item.saliency, *item.picks) if path]
            rows.append(" ".join([item.name, item.category or "-", *files]))
        return rows

    def empty(self, *files):
        self.write({file: "" for file in files})

    def test_princeton_has_its_ground_truth_beside_it(self):
        for meshes in ("off", "data/off", "MeshsegBenchmark-1.0/data/off"):
            for truth in ("Distributions", "SchellingData/Distributions", "SchellingData/SchellingData/Distributions"):
                self.setUp()
                self.empty(f"{meshes}/400.off", f"{truth}/400.val")
                self.assertEqual(self.rows("princeton"), [f"400 four-legged {meshes}/400.off {truth}/400.val"])
        self.setUp()
        self.empty("off/1.off", "RawData/1_0.pid")
        self.assertEqual(self.rows("princeton", below="off"), ["1 human off/1.off RawData/1_0.pid"])

    def test_gs_is_found_from_any_of_its_folders(self):
        for meshes in ("off", "Meshes"):
            self.setUp()
            self.empty(f"{meshes}/41.off", "GS/Saliency/41.val", "GS/RawData/41_0.pid", "GS/RawData/41_10.pid", "GS/RawData/41_9.pid")
            expected = f"41 glasses {meshes}/41.off GS/Saliency/41.val GS/RawData/41_0.pid GS/RawData/41_9.pid GS/RawData/41_10.pid"
            self.assertEqual(self.rows("gs"), [expected])
            self.assertEqual(self.rows("gs", below="GS"), [expected])

    def test_only_numbers_of_the_benchmark_have_a_class(self):
        self.empty(*(f"off/{name}.off" for name in ("1", "20", "261", "400", "0", "401", "007", "1b")), "Distributions/1.val")
        self.assertEqual([" ".join(row.split()[:2]) for row in self.rows("princeton")],
                         ["0 -", "1 human", "1b -", "007 -", "20 human", "261 spring", "400 four-legged", "401 -"])
        self.assertEqual(sets.listed("princeton", str(self.root))[1].notes, [])

    def test_meshes_of_the_benchmark_that_are_missing_are_noted(self):
        self.empty(*(f"off/{k}.off" for k in range(1, 401) if not 261 <= k <= 280 and k != 399), "Distributions/1.val")
        (note,) = sets.listed("princeton", str(self.root))[1].notes
        self.assertRegex(note, "^379 of the 400 meshes .* 261-280, 399$")

    def test_names_may_have_digits_and_underscores(self):
        self.empty("Meshes/michael3.off", "Meshes/michael.off", "Meshes/a_1.off", "Meshes/a.off", "Distributions/a.val", "RawData/michael3_0.pid",
                   "RawData/michael_30.pid", "RawData/a_1.pid", "RawData/a_1_2.pid")
        expected = ["a - Meshes/a.off Distributions/a.val RawData/a_1.pid", "a_1 - Meshes/a_1.off RawData/a_1_2.pid",
                    "michael - Meshes/michael.off RawData/michael_30.pid", "michael3 - Meshes/michael3.off RawData/michael3_0.pid"]
        for layout in ("zaragoza", "schelling"):
            self.assertEqual(self.rows(layout), expected)

    def test_ground_truth_without_a_mesh_is_noted(self):
        self.empty("Meshes/horse.off", "Distributions/261.val", "Distributions/horse.val", "RawData/261_0.pid", "RawData/horse_1.pid",
                   "RawData/cow_0.pid", "RawData/readme.pid", "RawData/notes.txt")
        notes = [note.replace(f"{self.root}/", "").split(":")[0] for note in sets.listed("zaragoza", str(self.root))[1].notes]
        self.assertEqual(notes, ["Distributions/261.val", "RawData/261_0.pid", "RawData/cow_0.pid", "RawData/readme.pid"])

    def test_extensions_may_be_in_upper_or_lower_case(self):
        self.empty("Meshes/1.OFF", "Distributions/1.VAL", "RawData/1_0.PID", "RawData/1_1.Pid")
        for layout, category in (("zaragoza", "-"), ("schelling", "human")):
            self.assertEqual(self.rows(layout), [f"1 {category} Meshes/1.OFF Distributions/1.VAL RawData/1_0.PID RawData/1_1.Pid"])

    def test_two_files_of_one_name_are_an_error(self):
        for layout, files in (("folder", ("a.off", "a.ply", "b.off")), ("folder", ("a.PLY", "a.ply")), ("zaragoza", ("Meshes/a.off", "Meshes/a.obj")),
                              ("zaragoza", ("Distributions/a.VAL", "Distributions/a.val", "Meshes/a.off"))):
            self.setUp()
            self.empty(*files)
            message = self.error_of(sets.listed, layout, str(self.root))
            for file in files[:2]:
                self.assertIn(f"ROOT/{file}", message)

    def test_a_folder_where_nothing_fits_says_which_layouts_do(self):
        self.write({"Meshes/cow.off": off(), "Distributions/cow.val": lines([1, 2, 3, 4]), "RawData/cow_0.pid": "1\n"})
        for layout in ("sal3d", "gs", "princeton", "automatic"):
            if layout == "automatic":
                self.assertEqual(salbench.Dataset(layout, self.root).layout, "schelling")
            else:
                self.assertRegex(self.error_of(sets.listed, layout, str(self.root)), "^ROOT: .*; looked in .*ROOT.*; layouts that fit: schelling, zaragoza$")
        self.assertRaisesRegex(InputError, "^there is no layout '3dav'; did you mean '3dva'", sets.find, "3dav")
        self.assertRaisesRegex(InputError, "^/no/such/own.py: ", sets.find, "/no/such/own.py")
        for missing in ("absent", "Meshes/cow.off"):
            for layout in ("hdf5", "schelling", "sal3d", "folder"):
                self.assertRaisesRegex(InputError, missing, sets.listed, layout, str(self.root / missing))

    def test_shapes_in_sub_folders_are_named(self):
        self.empty("ants/1.off", "cups/2.ply", "readme.txt")
        self.assertRegex(self.error_of(sets.listed, "folder", str(self.root)), r'sub-folders ants, cups: .*"\*/{item}.off"')

    def test_every_layout_is_found_by_its_name(self):
        for name in sets.SETS:
            found = sets.find(name)
            self.assertEqual((found.name, found.layout, found.key.partition(",")[0]), (name, name, name))
            self.assertTrue(found.licence)


class Patterns(WithArchive):
    def found(self, pattern, *names):
        """ "michael_1/front.txt: michael_1, front" of each file that fits."""
        return [f"{one.path.removeprefix(str(self.root))[1:]}: {one.item}, {one.view or one.viewer}" for one in files.match(self.root, pattern, names)]

    def test_files_that_fit(self):
        cases = [
            ("natural order, without hidden files", ["off/10.off", "off/2.OFF", "off/.hidden.off", "off/2.obj", "off/below/3.off", ".git/4.off", "1.off"], (),
             {"off/*.off": ["off/2.OFF: , ", "off/10.off: , "], "off/*": ["off/2.OFF: , ", "off/2.obj: , ", "off/10.off: , "],
              "*/*/*.off": ["off/below/3.off: , "], "*/{item}.off": ["off/2.OFF: 2, ", "off/10.off: 10, "], "absent/*": [], "off/../1.off": ["1.off: , "]}),
            ("the longest name", ["a_1.pid", "a_1_2.pid", "a_1_2_3.pid", "b_7.pid", "a_x.pid", "a_7.txt"], ("a", "a_1"),
             {"{item}_{participant}.pid": ["a_1.pid: a, ", "a_1_2.pid: a_1, "]}),
            ("a view is any text", ["cat_front_left.txt", "cat_2.txt", "cat_front_left_x.txt", "dog.txt"], ("cat", "cat_front"),
             {"{item}_{view}.txt": ["cat_2.txt: cat, 2", "cat_front_left.txt: cat_front, left", "cat_front_left_x.txt: cat_front, left_x"]}),
            ("a name may be a folder", ["cat/cat_1.csv", "cat/dog_1.csv", "dog/dog_1.csv", "maps_a/cat.txt", "maps_b/dog.txt"], ("cat", "dog"),
             {"{item}/{item}_{viewer}.csv": ["cat/cat_1.csv: cat, 1", "dog/dog_1.csv: dog, 1"], "maps_*/{item}.txt": ["maps_a/cat.txt: cat, ", "maps_b/dog.txt: dog, "]}),
            ("nothing between", ["cup_01.txt", "cup_012.txt"], ("cup_0", "cup_01"), {"{item}{view}.txt": ["cup_01.txt: cup_0, 1", "cup_012.txt: cup_01, 2"]}),
            ("ends without a dot", ["gaze/cat/zl", "gaze/cat/zy"], ("cat",), {"gaze/{item}/{person}": ["gaze/cat/zl: cat, zl", "gaze/cat/zy: cat, zy"]}),
            ("characters of expressions", ["a+b (1).txt", "aab (1).txt"], ("a+b",), {"{item} (1).txt": ["a+b (1).txt: a+b, "]}),
        ]
        for why, names, items, patterns in cases:
            self.setUp()
            self.write({name: "" for name in names})
            for pattern, expected in patterns.items():
                with self.subTest(why, pattern=pattern):
                    self.assertEqual(sorted(self.found(pattern, *items)), sorted(expected))
                    self.assertEqual(self.found(pattern, *items), sorted(self.found(pattern, *items), key=lambda one: files.natural_order(one.split(": ")[0])))

    def test_placeholders_that_there_are_not_are_refused(self):
        for word in ("{Item}", "{category}"):
            self.assertRegex(self.error_of(files.match, self.root, f"{word}/*.off"), f"{word}.*{{item}}")

    def test_the_first_place_with_shapes_is_taken(self):
        self.write({"a/readme.txt": "", "b/10.off": off(), "b/9.obj": "", "b/notes.txt": "", "c/1.off": off()})
        number, shapes = files.first(self.root, ["a/*", "b/*", "c/*"])
        self.assertEqual((number, [*shapes]), (1, ["9", "10"]))
        self.assertEqual(files.first(self.root, ["a/*.txt"])[1], {"readme": f"{self.root}/a/readme.txt"})
        self.assertEqual(self.error_of(files.first, self.root, ["d/*", "a/*", "a/*.pcd"]), "ROOT: no .off, .obj or .ply meshes found, and no .ply, .pcd or .xyz "
                                                                                         "point clouds; looked in ROOT/a, ROOT/a/*.pcd, ROOT/d")

    def test_files_that_belong_to_nothing_are_noted(self):
        self.write({"maps/cat.txt": "", "maps/dgo.txt": "", "maps/readme.md": ""})
        used = files.by_name(files.match(self.root, "maps/{item}.txt", ["cat", "dog"]))
        self.assertEqual(files.left_over(self.root, "maps/*.txt", used.values()), [f"{self.root}/maps/dgo.txt: belongs to no item and was left out"])

    def test_clouds_are_told_from_meshes(self):
        header = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\n"
        for name, text, kind in [("a.xyz", "", "cloud"), ("a.PCD", "", "cloud"), ("a.off", "", "mesh"), ("a.obj", "", "mesh"), ("a.txt", "", "cloud"),
                                 ("a.ply", header + "end_header\n", "cloud"), ("a.ply", header + "element face 0\nend_header\n", "cloud"),
                                 ("a.ply", header + "element face 2\nend_header\n", "mesh"), ("a.ply", header + "element tristrips 0\nend_header\n", "mesh"),
                                 ("a.ply", header, "mesh"), ("a.ply", (header + "element face 012\nend_header\n").replace("\n", "\r"), "mesh")]:
            self.assertEqual(files.kind_of(str(self.write({name: text}))), kind, (name, text))
        self.assertEqual(files.kind_of(str(self.root / "absent.ply")), "mesh")


class NaturalOrder(unittest.TestCase):
    def test_runs_of_digits_are_numbers(self):
        expected = ["1b", "02", "2", "10", "99999999999999999999999", "a", "a_1", "a_1_2", "b", "b2", "b010", "b10"]
        for names in (expected[::-1], sorted(expected)):
            self.assertEqual(sorted(names, key=files.natural_order), expected)

    def test_other_characters_stand_where_their_bytes_do(self):
        self.assertEqual(sorted(["a1", "a!", "ab", "a", "a:", "\udcff", "é"], key=files.natural_order),
                         ["a", "a!", "a1", "a:", "ab", "é", "\udcff"])

    def test_different_names_are_never_equal(self):
        names = ["", "0", "00", "1", "01", "1a", "01a", "a1", "a01", "a1b", "a01b", "1a2", "1a02", "_", "1_"]
        for a, b in itertools.combinations(names, 2):
            self.assertNotEqual(files.natural_order(a), files.natural_order(b))
