# SPDX-License-Identifier: GPL-3.0-or-later
"""What a folder holds: items in natural order with their files, notes on the rest, and one error where nothing fits."""

import os
import subprocess
import sys
import unittest

from salbench import _wire
from salbench.datasets import listing
from salbench.datasets.records import Item
from support import POINTS, WithArchive, off, real

MAPS = "places: [{meshes: 'off/*', truth: {saliency: 'maps/{item}.csv'}}]\n"
BARE = "ground_truth: optional\nplaces: [{meshes: '*'}]\n"


class Folders(WithArchive):
    def rows(self, layout, below="."):
        """ "2 cup Meshes/22.off RawData/22_0.pid" of each item, of a folder in it."""
        rows, root = [], self.root
        self.root = self.root / below
        for item in self.list(layout).items:
            rows.append(" ".join([item.name, item.category or "-", *(file.path.replace(f"{root}/", "") for file in item.files)]))
        self.root = root
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
        self.empty(*(f"off/{name}.off" for name in ("1", "20", "261", "400", "0", "401", "007", "1b")))
        self.assertEqual([row.rpartition(" ")[0] for row in self.rows("princeton")],
                         ["0 -", "1 human", "1b -", "007 -", "20 human", "261 spring", "400 four-legged", "401 -"])
        self.assertEqual(self.list("princeton").notes, [])
        self.assertEqual([row.split()[1] for row in self.rows("classes: folder\nground_truth: optional\nplaces: [{meshes: '*/*'}]\n")], ["off"] * 8)

    def test_meshes_of_the_benchmark_that_are_missing_are_noted(self):
        self.empty(*(f"off/{k}.off" for k in range(1, 401) if not 261 <= k <= 280 and k != 399))
        self.assertEqual(self.list("princeton").notes, ["379 of the 400 meshes of SHREC'07 are here, without 261-280, 399"])

    def test_names_may_have_digits_and_underscores(self):
        self.empty("Meshes/michael3.off", "Meshes/michael.off", "Meshes/a_1.off", "Meshes/a.off", "Distributions/x", "RawData/michael3_0.pid",
                   "RawData/michael_30.pid", "RawData/a_1.pid", "RawData/a_1_2.pid")
        self.assertEqual(self.rows("ground_truth: optional\nplaces: [{meshes: 'Meshes/*', truth: {picks: 'RawData/{item}_{participant}.pid'}}]\n"),
                         ["a - Meshes/a.off RawData/a_1.pid", "a_1 - Meshes/a_1.off RawData/a_1_2.pid",
                          "michael - Meshes/michael.off RawData/michael_30.pid", "michael3 - Meshes/michael3.off RawData/michael3_0.pid"])

    def test_ground_truth_without_a_mesh_is_noted(self):
        self.empty("Meshes/horse.off", "Distributions/261.val", "Distributions/horse.val", "RawData/261_0.pid", "RawData/horse_1.pid",
                   "RawData/cow_0.pid", "RawData/readme.pid", "RawData/notes.txt")
        notes = [note.replace(f"{self.root}/", "") for note in self.list("zaragoza").notes]
        self.assertEqual(notes, ["RawData/readme.pid: is not named NAME_NUMBER.pid and was left out",
                                 "261: ground truth without a mesh or point cloud (Distributions/261.val)",
                                 "cow: ground truth without a mesh or point cloud (RawData/cow_0.pid)"])

    def test_two_files_of_one_name_are_an_error(self):
        for files, pair, layout in ((("a.off", "a.ply", "b.off"), "ROOT/a.off and ROOT/a.ply", BARE), (("a.ply", "a.PLY"), "ROOT/a.PLY and ROOT/a.ply", BARE),
                                    (("cat/1.off", "dog/1.off"), "ROOT/cat/1.off and ROOT/dog/1.off", BARE.replace("'*'", "'*/*.off'"))):
            self.setUp()
            self.empty(*files)
            self.assertEqual(self.error_of(lambda layout=layout: self.list(layout)), f"{pair} have the same name: rename or remove one of them")

    def test_extensions_may_be_in_upper_or_lower_case(self):
        own = "places: [{meshes: 'off/*.off', truth: {saliency: 'maps/{item}.csv', picks: 'p/{item}_{participant}.pid', mask: 'm/{item}_seen.txt'}}]\n"
        self.empty("off/1.OFF", "off/2.off", "maps/1.CSV", "maps/2.csv", "p/1_0.PID", "p/1_1.Pid", "p/readme.PID", "m/1_seen.TXT", "m/2_seen.txt", "m/2_SEEN.txt")
        self.assertEqual(self.rows(own), ["1 - off/1.OFF maps/1.CSV m/1_seen.TXT p/1_0.PID p/1_1.Pid", "2 - off/2.off maps/2.csv m/2_seen.txt"])
        self.assertEqual(self.list(own).notes, [f"{self.root}/p/readme.PID: is not named NAME_NUMBER.pid and was left out"])
        self.setUp()
        self.empty("Meshes/1.OFF", "Distributions/1.VAL", "RawData/1_0.PID")
        self.assertEqual(self.rows("zaragoza"), ["1 - Meshes/1.OFF Distributions/1.VAL RawData/1_0.PID"])

    def test_files_that_differ_by_case_alone_are_named(self):
        own = "places: [{meshes: 'off/*.off', truth: {saliency: 'maps/{item}.csv', picks: 'p/{item}_{participant}.pid'}}]\n"
        for one, other in [("off/1.OFF", "off/1.off"), ("maps/1.CSV", "maps/1.csv"), ("p/1_0.PID", "p/1_0.pid")]:
            self.setUp()
            self.empty("off/1.off", "maps/1.csv", "p/1_0.pid", one, other)
            self.assertEqual(self.error_of(lambda: self.list(own)), f"ROOT/{one} and ROOT/{other} differ by case alone: keep one of them")

    def test_what_was_looked_for_and_where(self):
        self.write({"off/cat.off": off(), "maps/cat.csv": "1\n2\n3\n4\n", "more_maps/cat.csv": "1\n2\n3\n4\n"})
        none = "ROOT: no .off, .obj or .ply meshes found, and no .ply, .pcd or .xyz point clouds; looked in "
        for layout, expected in [
                ("# own\nplaces:\n  - meshes: of/*.off\n", none + "own: ROOT/of/*.off (own.yaml:3)"),
                ("gs", none + "gs: ROOT (with neither GS/ nor Saliency/ in it)"),
                ("places: [{meshes: '*', root_is: all}]\n", none + "own: ROOT (is not named all)"),
                ("sal3d_meshes", none + "sal3d_meshes: ROOT/Meshes/*.obj"),
                ("domain: points\n" + MAPS, none + "own: ROOT/off (own.yaml:2)"),
                (MAPS.replace("csv", "val"), "own.yaml:1: 'maps/{item}.val' fits no file of an item; expected are such as ROOT/maps/{item}.val"),
                (MAPS.replace("maps", "absent"), "own.yaml:1: 'absent/{item}.csv' fits no file of an item; expected are such as ROOT/absent/{item}.csv"),
                (MAPS.replace("maps", "'*maps").replace("''*", "'*"), "ROOT/more_maps/cat.csv: cat has a file already, ROOT/maps/cat.csv, and own.yaml:1 means "
                                                                      "one: keep one of them")]:
            self.assertEqual(self.error_of(lambda: self.list(layout)), expected)
        for missing in ("absent", "off/cat.off"):
            self.root = self.root / missing
            self.assertEqual(self.error_of(lambda: self.list(MAPS)), "ROOT: there is no such folder")
            self.root = self.root.parent if missing == "absent" else self.root

    def test_kinds_of_shapes(self):
        ply = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\n"
        self.write({"a.off": "", "b.OBJ": "", "c.pcd": "", "d.xyz": "", "e.ply": ply + "end_header\n", "f.ply": ply + "element face 0\nend_header\n",
                    "g.ply": ply + "element face 12\nend_header\n", "h.ply": ply + "element tristrips 1\nend_header\n", "i.ply": "", "j.ply": ply,
                    "k.txt": ""})
        self.assertEqual("".join(item.kind[0] for item in self.list(BARE).items), "mmccccmmmm")
        self.assertEqual([item.name for item in self.list("domain: points\n" + BARE).items], list("cdefghij"))
        self.assertEqual([item.name for item in self.list("domain: points\ncolumns: {position: [1, 2, 3]}\n" + BARE).items], list("cdefghijk"))
        self.assertEqual([item.name for item in self.list("domain: meshes\ncolumns: {position: [1, 2, 3]}\n" + BARE).items], list("abefghij"))

    def test_rows_are_native_where_c_plus_plus_reads_all_of_it(self):
        self.write({"off/a.off": off(), "m/a.val": "1\n", "m/a_1.val": "1\n", "m/a_1.pid": "", "m/a.txt": ""})
        place = "places: [{meshes: 'off/*', truth: {%s}}]\n"
        for truth, more, native in [
                ("saliency: 'm/{item}.val', picks: 'm/{item}_{participant}.pid'", "", True), ("picks: 'm/{item}_{participant}.pid'", "", True),
                ("saliency: 'm/{item}.val'", "splits: {items: {test: [a]}}\n", True), ("saliency: 'm/{item}.txt'", "", False),
                ("saliency: 'm/{item}_{view}.val'", "", False), ("saliency: 'm/{item}.val', mask: 'm/{item}.val'", "", False),
                ("saliency: 'm/{item}.val'", "values: {positives: top 20%}\n", False),
                ("picks: 'm/{item}_{participant}.pid'", "indices: {base: 1}\n", False)]:
            item = self.list(place % truth + more).items[0]
            self.assertEqual(item.native, native, truth + more)
            self.assertEqual({"native", "files", "how"} & {*item.to_json()}, {"native"} if native else {"files", "how"})

    def test_how_files_are_read_is_part_of_their_names(self):
        self.write({"off/a.off": off(), "m/a_7.txt": "1\n", "m/a_8.txt": "1\n", "m/s_7": "", "p/a_0.pid": "0\n"})

        def names(truth, more=""):
            places = "places: [{meshes: 'off/*', truth: {saliency: 'm/{item}_%s', picks: 'p/{item}_{participant}.pid'}}]\n" % truth
            return [[file.name for file in item.files] for item in self.list(places + more).items]

        self.assertEqual(names("{viewer}.txt"), [["mesh file .off", "saliency of viewer 0, 7", "saliency of viewer 1, 8", "picks 0"]])
        self.assertEqual(names("{view}.txt", "values: {column: 2, unseen: -1}\nindices: {base: 1}\n"),
                         [["mesh file .off", "saliency file 0 (column: 2, unseen: -1), rows by their numbers",
                           "saliency file 1 (column: 2, unseen: -1), rows by their numbers",
                           "picks 0 (base: 1) of what was seen"]])

    def test_views_that_are_scored_are_items(self):
        self.write({"off/a.off": off(), "m/a_7.txt": "1\n", "m/a_8.txt": "1\n"})
        items = self.list("places: [{meshes: 'off/*', views: scored, truth: {saliency: 'm/{item}_{view}.txt'}}]\n").items
        self.assertEqual([(item.name, item.shape, item.view, item.files[0].name) for item in items],
                         [("a_7", "a", "7", "mesh file .off, view 7"), ("a_8", "a", "8", "mesh file .off, view 8")])

    def test_shapes_in_another_unit_fail_where_a_description_names_one(self):
        self.write({f"off/{name}.off": off(POINTS * (1000 if name == "cat" else 1)) for name in ("ant", "bee", "cat", "dog")}
                   | {f"maps/{name}.csv": "1\n2\n3\n4\n" for name in ("ant", "bee", "cat", "dog")})
        self.assertEqual([item.problem for item in self.list(MAPS).items], [""] * 4)
        listed = self.list(MAPS + "units: mm\n")
        self.assertEqual((listed.scale, [bool(item.problem) for item in listed.items]), (0.001, [False, False, True, False]))
        self.assertRegex(listed.items[2].problem,
                         f"^{self.root}/off/cat.off: its diagonal, 1732, is 1e\\+03 times the median .*/own.yaml:2 says: scale it")


class Documents(WithArchive):
    def test_rows_come_back_from_json(self):
        name = b"caf\xe9".decode("utf-8", "surrogateescape")
        self.write({f"off/{name}.off": off(), f"maps/{name}.csv": "1\n"})
        for layout in (MAPS, MAPS.replace(".csv", ".val").replace("places", "ground_truth: optional\nplaces")):
            self.own.write_text(layout)
            document = _wire.loads(_wire.dumps(listing.document(str(self.own), str(self.root))))
            self.assertEqual(document["items"], [Item.from_json(row).to_json() for row in document["items"]])
            item = Item.from_json(document["items"][0])
            self.assertEqual((item.name, item.shape, item), (name, name, self.list(layout).items[0]))
            self.assertTrue(all(os.path.isfile(file.path) for file in item.files))

    def test_wrong_arguments(self):
        self.assertIn("did you mean 'sal3d'", self.error_of(lambda: listing.document("sald3d", str(self.root))))

    def test_a_listing_imports_no_numpy(self):
        self.write({"Meshes/a.obj": "", "Gaze/a.txt": ""})
        code = ("import sys, types; package = types.ModuleType('salbench'); package.__path__ = [sys.argv[1]]; sys.modules['salbench'] = package\n"
                "from salbench.datasets import listing; listing.document('sal3d_meshes', sys.argv[2])\n"
                "print('numpy' in sys.modules, 'yaml' in sys.modules)")
        import salbench
        found = subprocess.run([sys.executable, "-c", code, os.path.dirname(salbench.__file__), self.root], capture_output=True, text=True, check=True)
        self.assertEqual(found.stdout, "False False\n")


class RealFolders(unittest.TestCase):
    def test_zaragoza(self):
        root = real("eyetracking")
        if root is None:
            self.skipTest("no real data")
        from salbench import datasets
        items = datasets.find("zaragoza").items(str(root)).items
        self.assertEqual((len(items), {len(item.native_files[2]) for item in items}, {len(item.native_files[1]) for item in items}), (23, {1}, {1}))


