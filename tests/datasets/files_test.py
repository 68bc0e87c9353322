# SPDX-License-Identifier: GPL-3.0-or-later
"""Names of files: patterns, shapes of a folder, and natural order."""

import itertools
import unittest

from salbench.datasets import files
from support import WithArchive, off


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
