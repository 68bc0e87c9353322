# SPDX-License-Identifier: GPL-3.0-or-later
"""Descriptions in YAML: what they say is read, and what is wrong is told with file, line and key."""

import time
import unittest

from salbench import datasets
from salbench.datasets import _section
from salbench.datasets._description import layout_of
from salbench.datasets.records import InputError

ALL = "places: [{meshes: '*'}]\n"  # a whole description


def error_of(text):
    try:
        layout_of(_section.Section.of_text(text, "own.yaml"), "own")
    except InputError as error:
        return str(error)
    return "no error"


class Descriptions(unittest.TestCase):
    def test_what_a_file_says_is_read(self):
        layout = layout_of(_section.Section.of_text(
            "classes: folder\nplaces:\n  - needs: maps\n    meshes: shapes/*/*.obj\n    truth: &it {saliency: 'maps/{item}_{viewer}.csv'}\n"
            "  - {meshes: '*', truth: *it, root_is: all}\n"
            "values: {per: point, column: s, points: [x, y, z], max_distance: 0.1, positives: top 20%}\nindices: {base: 1}\n"
            "units: mm\nsplits: {list: a.txt, shares: {train: 80%, test: 0.2}}\nlicence: ask\n", "own.yaml"), "own")
        place, other = layout.places
        self.assertEqual((layout.name, layout.classes, layout.needs_truth, layout.licence), ("own", "folder", True, "ask"))
        self.assertEqual((place.needs, place.meshes, place.meshes.where), ("maps", "shapes/*/*.obj", "own.yaml:4"))
        self.assertEqual((place.truth, other.root_is), (other.truth, "all"))
        self.assertEqual(place.truth[0].saliency, "maps/{item}_{viewer}.csv")
        self.assertEqual((layout.values.per, layout.values.column, layout.values.points), ("point", "s", ("x", "y", "z")))
        self.assertEqual((layout.indices.base, layout.scale, layout.unit_where), (1, 0.001, "own.yaml:9"))
        self.assertEqual((layout.splits.shares, layout.splits.where), ((("train", 0.8), ("test", 0.2)), "own.yaml:10"))

    def test_file_line_key_and_what_was_expected(self):
        in_place = "places:\n  - "
        of_truth = in_place + "meshes: off/*\n    truth:\n      "
        for text, expected in [
                ("classes: none\n", "1: places is missing; expected a list of places with meshes"),
                ("place: []\n", "1: place is not a known key; did you mean 'places'?"),
                ("\nplaces: off\n", "2: places must be a list of mappings"),
                (in_place + "off\n", "2: places[0] must be a mapping of keys to values"),
                (in_place + "truth: {picks: '{item}.pid'}\n", "2: places[0].meshes is missing; expected a pattern such as Meshes/*"),
                (in_place + "{meshes: 'off/*', truht: }\n", "2: places[0].truht is not a known key; did you mean 'truth'?"),
                (in_place + "meshes: /off/*\n", "2: places[0].meshes '/off/*' must be relative to the folder of the data set, without an empty "
                                                "name in it"),
                (of_truth + "saliency: maps/{itm}.csv\n", "4: places[0].truth.saliency 'maps/{itm}.csv' has braces around something other than "
                                                          "item, participant, view, viewer or person"),
                (of_truth + "picks: maps/*.pid\n", "4: places[0].truth.picks 'maps/*.pid' must have {item} in place of the name of the item"),
                (in_place + "meshes: off/*\n    truth: {}\n", "3: places[0].truth names neither saliency nor picks"),
                (in_place + "{meshes: 'o/*', views: scored, truth: {saliency: 'f/{item}.txt'}}\n", "2: places[0].views is 'scored', but saliency "
                                                                                                "has no {view} in its pattern"),
                (in_place + "{meshes: 'o/*', truth: {saliency: 'f/{item}_{view}_{viewer}.txt'}}\n",
                 "2: places[0].views must be 'scored' where saliency or viewers has both {view} and {viewer}: people are told apart in each view"),
                (in_place + "{meshes: 'o/*', truth: {saliency: 'f/{item}_{view}.txt', viewers: 'p/{item}_{view}_{viewer}.txt'}}\n",
                 "2: places[0].views must be 'scored' where saliency or viewers has both {view} and {viewer}: people are told apart in each view"),
                (in_place + "{meshes: 'o/*', truth: {saliency: 'f/{item}.txt', mask: 'm/{item}_{view}'}}\n",
                 "2: places[0].truth.mask 'm/{item}_{view}' must have the {view} or {viewer} that `saliency` has, or none"),
                (in_place + "{meshes: 'o/*', truth: {picks: 'f/{item}.txt', mask: 'm/{item}'}}\n",
                 "2: places[0].truth.mask is there without saliency: expected a pattern of the files that it masks"),
                (ALL + "values:\n  per: edge\n", "3: values.per is 'edge', not one of vertex, face, point"),
                (ALL + "values: {unseen: none}\n", "2: values.unseen is 'none', not a number or nan"),
                (ALL + "values: {per: point}\n", "2: values.column is missing; values per point stand beside coordinates: expected a column"),
                (ALL + "values: {points: [x, y]}\n", "2: values.points must be three columns, of x, y and z"),
                (ALL + "values: {scale: 0}\n", "2: values.scale must be a number above 0, not 0"),
                (ALL + "values: {scale: .nan}\n", "2: values.scale is '.nan', not a finite number"),
                (ALL + "values: {max_distance: 1_0}\n", "2: values.max_distance is '1_0', not a finite number"),
                (ALL + "values: {positives: top 0%}\n", "2: values.positives is 'top 0%', not picks, above mean, or a share such as top 20%"),
                ("places: [{meshes: '*', truth: {picks: '{item}.pid'}}]\nvalues: {positives: above mean}\n",
                 "2: values.positives is 'above mean', but there are picks: leave one of them out"),
                (ALL + "indices: {base: 2}\n", "2: indices.base must be between 0 and 1, not 2"),
                (ALL + "columns: {density: 3}\n", "2: columns.position is missing; expected the columns of x, y and z"),
                (ALL + "columns: {position: [1, 2]}\n", "2: columns.position must be three columns, of x, y and z"),
                (ALL + "columns: {normalise_normals: yes}\n", "2: columns.normalise_normals is 'yes', not true or false"),
                ("domain: faces\n" + ALL, "1: domain is 'faces', not one of any, meshes, points"),
                (ALL + "units: miles\n", "2: units is 'miles', expected one of m, dm, cm, mm, um, in, ft; or use scale"),
                (ALL + "scale: -1\n", "2: scale must be a number above 0, not -1"),
                (ALL + "scale: .inf\n", "2: scale is '.inf', not a finite number"),
                (ALL + "scale: 2\nunits: mm\n", "2: scale is there beside units: expected one of them"),
                (ALL + "splits: {file: a.csv, list: b.txt}\n", "2: splits must have one of file (a CSV file), list (with shares), or items"),
                (ALL + "splits: {list: b.txt, shares: {train: 80%, test: 30%}}\n", "2: splits.shares must name each split's share of the lines of "
                                                                                  "`list`, which sum to 1"),
                (ALL + "splits: {list: b.txt, shares: {train: 180%}}\n", "2: splits.shares.train is not a share of the lines, such as 80% or 0.8"),
                (ALL + "splits: {items: }\n", "2: splits.items names no split"),
                (ALL + "splits: {fle: b.txt}\n", "2: splits.fle is not a known key; did you mean 'file'?")]:
            self.assertEqual(error_of(text), f"own.yaml:{expected}", text)

    def test_what_is_no_yaml_of_a_description(self):
        for text, line, wrong in [
                ("a: [1\n", 2, "not valid YAML: "), ("a: *b\n", 1, "not valid YAML: "), ("- a\n", 1, "the file must be a mapping of keys to values"),
                ("places: !!null {a: 1}\n", 1, "places.a is not a known key"), ("a: &x 1\nb: &x 2\n", 2, "not valid YAML: "), ("", 1, "places is missing"), ("places: x\n\nplaces: y\n", 3, "the key 'places' is given twice"),
                ("? [a]\n: b\n", 1, "the file has a key that is not a plain word"), ("a: \x07\n", 1, "not valid YAML: "),
                ("\"a\\nb\": 1\n", 1, "a?b is not a known key"), ("? " + "x" * 100000 + "\n: 1\n", 1, "is not a known key"),
                ("[" * 100000, 1, "more than 32 levels of mappings and lists"), ("a: " * 40, 1, "not valid YAML: "),
                ("#" * (_section.MAX_BYTES + 1), 1, "characters: at most 1048576 can be read"),
                ("p: &p {meshes: '*'}\nplaces: !!python/object/apply:os.system [ls]\n", 1, "p is not a known key")]:
            found = error_of(text)
            self.assertTrue(found.startswith(f"own.yaml:{line}: "), found[:200])
            self.assertIn(wrong, found)

    def test_aliases_that_explode_end_soon(self):
        bomb = "a0: &a0 {meshes: '*', truth: {picks: '{item}'}}\n" + "".join(f"a{k + 1}: &a{k + 1} [{', '.join([f'*a{k}'] * 9)}]\n" for k in range(30))
        started = time.monotonic()
        self.assertIn("is not a known key", error_of(bomb))
        many = f"places: [&p {{meshes: '*', truth: [&t {{picks: '{{item}}'}}{', *t' * 500}]}}{', *p' * 500}]\n"
        self.assertEqual(error_of(many), "own.yaml:1: more than 10000 mappings in lists: fewer aliases will do")
        self.assertEqual(error_of("places: &p [*p]\n"), "own.yaml:1: places[0] must be a mapping of keys to values")
        self.assertLess(time.monotonic() - started, 5)

    def test_names_of_layouts(self):
        for name in datasets.ARCHIVES:
            self.assertEqual(datasets.find(name).LAYOUT.name, name)
        with self.assertRaisesRegex(InputError, "^there is no layout '3dav'; did you mean '3dva'\\?$"):
            datasets.find("3dav")
        with self.assertRaisesRegex(InputError, "^/no/such/own.yaml: cannot be read: No such file or directory$"):
            datasets.find("/no/such/own.yaml")
