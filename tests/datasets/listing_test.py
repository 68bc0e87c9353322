# SPDX-License-Identifier: GPL-3.0-or-later
"""Listings of folders by the layouts of the Schelling study's files, by those that C++ lists, and by none: then one error."""

import os

import salbench
from salbench.datasets import sets
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

    def test_every_layout_is_found_by_its_name(self):
        for name in sets.SETS:
            found = sets.find(name)
            self.assertEqual((found.name, found.layout, found.key.partition(",")[0]), (name, name, name))
            self.assertTrue(found.licence)
