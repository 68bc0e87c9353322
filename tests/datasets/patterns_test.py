# SPDX-License-Identifier: GPL-3.0-or-later
"""Names of files as descriptions have them."""

import itertools
import unittest

from salbench.datasets import _patterns
from support import WithArchive

VIEWS = ("{view}", "{viewer}")


class Patterns(WithArchive):
    def found(self, pattern, *items):
        """ "michael_1/front.txt: michael_1, front" of each file that fits, then "- readme.txt" of those left out."""
        files = _patterns.files_like(str(self.root), pattern, set(items))
        relative = [f"{file.path.removeprefix(str(self.root))[1:]}: {file.item}, {file.part or file.viewer}" for file in files.fit]
        return relative + [f"- {path.removeprefix(str(self.root))[1:]}" for path in files.left_out]

    def test_files_that_fit(self):
        cases = [
            ("natural order, without hidden files", ["off/10.off", "off/2.off", "off/.hidden.off", "off/2.obj", "off/below/3.off", "1.off"], (),
             {"off/*.off": ["off/2.off: , ", "off/10.off: , "], "off/*": ["off/2.obj: , ", "off/2.off: , ", "off/10.off: , "],
              "*/*/*.off": ["off/below/3.off: , "], "absent/*": [], "off/../1.off": ["1.off: , "]}),
            ("the longest item that there is", ["a_1.pid", "a_1_2.pid", "a_1_2_3.pid", "b_7.pid", "b_x.pid", "b_7.txt"], ("a", "a_1"),
             {"{item}_{participant}.pid": ["a_1.pid: a, 1", "a_1_2.pid: a_1, 2", "a_1_2_3.pid: a_1_2, 3", "b_7.pid: b, 7", "- b_x.pid"]}),
            ("a view is any text", ["cat_front_left.txt", "cat_2.txt", "cat_front_left_x.txt", "dog.txt"], ("cat", "cat_front"),
             {"{item}_{view}.txt": ["cat_2.txt: cat, 2", "cat_front_left.txt: cat_front, left", "cat_front_left_x.txt: cat_front, left_x",
                                    "- dog.txt"]}),
            ("an item may be a folder", ["cat/cat_1.csv", "cat/dog_1.csv", "dog/dog_1.csv", "maps_a/cat.txt", "maps_b/dog.txt"], ("cat", "dog"),
             {"{item}/{item}_{viewer}.csv": ["cat/cat_1.csv: cat, 1", "dog/dog_1.csv: dog, 1", "- cat/dog_1.csv"],
              "maps_*/{item}.txt": ["maps_a/cat.txt: cat, ", "maps_b/dog.txt: dog, "]}),
        ]
        for why, files, items, patterns in cases:
            self.setUp()
            self.write({file: "" for file in files})
            for pattern, expected in patterns.items():
                with self.subTest(why, pattern=pattern):
                    self.assertEqual(self.found(pattern, *items), expected)

    def test_whether_there_is_a_folder(self):
        self.write({"maps_a/cat.txt": "", "file": ""})
        for pattern in ("maps_a/{item}.txt", "maps_*/{item}.txt", "{item}.txt"):
            self.assertTrue(_patterns.has_folder_for(str(self.root), pattern), pattern)
        for pattern in ("maps/{item}.txt", "dataset_*/{item}.txt", "file/{item}.txt", ""):
            self.assertFalse(_patterns.has_folder_for(str(self.root), pattern), pattern)


class Wrong(unittest.TestCase):
    def test_patterns_of_meshes(self):
        for pattern, wrong in [("*", ""), ("off/*.off", ""), ("../off/*", ""), ("a/*/*.obj", ""), ("one.off", ""), ("", "is empty"),
                               ("/off/*", "must be relative"), ("off//*", "must be relative"), ("off/{item}.off", "must have * where"),
                               ("*a*b*c*", "more than 3 placeholders")]:
            found = _patterns.wrong_with_mesh_pattern(pattern)
            self.assertTrue(found.startswith(wrong) or wrong in found, (pattern, found))
            self.assertEqual(bool(found), bool(wrong), pattern)

    def test_patterns_of_ground_truth(self):
        for pattern, wrong in [("a/{item}_{view}.txt", ""), ("a/*.txt", "must have {item}"), ("a/{itm}.txt", "braces around something other"),
                               ("a/{item}}.txt", "braces around something other"), ("{item}_{participant}.pid", "cannot have {participant} here"),
                               ("{item}_{view}_{viewer}", "")]:
            found = _patterns.wrong_with_truth_pattern(pattern, VIEWS)
            self.assertIn(wrong, found)
            self.assertEqual(bool(found), bool(wrong), pattern)

    def test_what_is_expected_is_named(self):
        self.assertEqual(_patterns.expected_name("RawData/{item}_{participant}.pid"), "NAME_NUMBER.pid")
        self.assertEqual(_patterns.expected_name("a/{item}_{view}*.txt"), "NAME_VIEW*.txt")
        self.assertEqual(_patterns.place_of("/data", "off/*"), "/data/off")
        self.assertEqual(_patterns.place_of("/data", "../off/*.off"), "/off/*.off")


class NaturalOrder(unittest.TestCase):
    def test_runs_of_digits_are_numbers(self):
        expected = ["1b", "02", "2", "10", "99999999999999999999999", "a", "a_1", "a_1_2", "b", "b2", "b010", "b10"]
        for names in (expected[::-1], sorted(expected)):
            self.assertEqual(sorted(names, key=_patterns.natural_order), expected)

    def test_other_characters_stand_where_their_bytes_do(self):
        self.assertEqual(sorted(["a1", "a!", "ab", "a", "a:", "\udcff", "é"], key=_patterns.natural_order),
                         ["a", "a!", "a1", "a:", "ab", "é", "\udcff"])

    def test_different_names_are_never_equal(self):
        names = ["", "0", "00", "1", "01", "1a", "01a", "a1", "a01", "a1b", "a01b", "1a2", "1a02", "_", "1_"]
        for a, b in itertools.combinations(names, 2):
            self.assertNotEqual(_patterns.natural_order(a), _patterns.natural_order(b))
