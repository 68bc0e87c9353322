# SPDX-License-Identifier: GPL-3.0-or-later
"""`salbench import`: what is written, left alone, taken out and refused. Items that harm their process: sets_test.py; what
is interrupted: tests/python/ended_test.py."""

import json
import os
import shutil
import subprocess
from unittest import mock

import h5py
import numpy as np

import own_sets
import salbench
from archives_test import MINIATURES
from salbench.datasets import importing, sets
from salbench.datasets.records import InputError
from support import FACES, NAN, POINTS, WithArchive, lines, off, read_here, sphere
from tests.support import forked
from tests.support.shapes import rows

class Importing(WithArchive):
    def setUp(self):
        super().setUp()
        self.to = self.root.parent / "to"
        self.mine = self.root.parent / "mine.py"

    def imported(self, layout="sal3d", items="", split=""):
        """Outcomes by shape, with what is said of those that fail. layout: a name, or the text of a file of Python."""
        if layout not in sets.LAYOUTS:
            self.mine.write_text(layout)
            layout = str(self.mine)
        with mock.patch.object(importing, "ask_all", read_here):
            self.done = importing.import_set(layout, str(self.root), str(self.to), items, split)
        return {shape.name: shape.problem.replace(str(self.root), "ROOT") or shape.outcome for shape in self.done.shapes}

    def files(self):
        return {path.name: (path.stat().st_mtime_ns, path.read_bytes()) for path in self.to.rglob("*.*")}

    def names(self):
        return [item.name for item in sets.listed("hdf5", str(self.to))[1].items]

    def item(self, name):
        file = h5py.File(self.to / f"items/{name}.h5")
        self.addCleanup(file.close)
        return file

    def clouds(self, *names):
        points, _ = sphere(5, 6)
        rng = np.random.default_rng(1)
        for name in names or ("cat", "cow", "dog"):
            values = rng.random(len(points))
            self.write({f"Gaze/{name}.txt": rows(points, 6.28 * points, values, values > 0.9)})
        self.write({"splits.csv": "item,split\ncat,train\ncow,test\ndog,test\n"})

    def test_a_mesh_as_it_was(self):
        picks = [[3, 1, 2], [], [0]]
        self.write({"Meshes/cow.off": off(), "Distributions/cow.val": lines([1, 2, 3, 4])}
                   | {f"RawData/cow_{k}.pid": lines(picked) for k, picked in enumerate(picks)})
        self.assertEqual(self.imported("zaragoza"), {"cow": "written"})
        file = self.item("cow")
        for name, values in (("shape/points", POINTS), ("shape/faces", FACES), ("truth/saliency", [1, 2, 3, 4]),
                             ("truth/picks", [3, 1, 2, 0]), ("truth/picks_of", [3, 0, 1])):
            self.equal(file[name][:], values)
        self.assertEqual((file.attrs["item"], file.attrs["source"], file.attrs["licence"]), (b"cow", b"zaragoza", sets.find("zaragoza").licence.encode()))
        read = file.attrs["source_files"].decode().splitlines()
        self.assertEqual([line.split("  ")[1] for line in read], ["Distributions/cow.val", "Meshes/cow.off", *(f"RawData/cow_{k}.pid" for k in range(3))])
        if shutil.which("xxh128sum"):
            self.assertEqual(subprocess.run(["xxh128sum", "Meshes/cow.off"], cwd=self.root, capture_output=True, text=True).stdout, read[1] + "\n")

    def test_polygons_and_picks_alone(self):
        points = np.vstack([POINTS, [[1, 1, 0]]])
        self.write({"Meshes/7.off": off(points, FACES).replace("5 4 0", "5 5 0") + "4 0 1 4 2\n", "RawData/7_0.pid": "1\n"})
        self.assertEqual(self.imported("schelling"), {"7": "written"})
        self.assertEqual(self.item("7")["shape/polygons"][:].tolist(), [1, 0])
        self.assertNotIn("saliency", self.item("7")["truth"])

    def test_views_are_of_one_shape_and_one_that_fails_is_left_out(self):
        self.write({"m/a.off": off(), "v/a_300.txt": lines([1, 2, 3, 4]), "seen/a_300.txt": lines([1, 1, 1, 0]),
                    "v/a_413.txt": lines([5, 6, 7, 8]), "seen/a_413.txt": lines([0, 1, 1, 1])})
        self.assertEqual((self.imported(own_sets.VIEWS), self.names()), ({"a": "written"}, ["a_300", "a_413"]))
        self.equal(self.item("a")["views/413/saliency"][:], [NAN, 6, 7, 8])
        self.write({"v/a_300.txt": lines([1, 2])})
        self.assertIn("ROOT/v/a_300.txt", self.imported(own_sets.VIEWS)["a"])
        self.assertEqual((self.names(), self.done.shapes[0].outcome, self.done.problems), (["a_413"], "written", 1))
        self.assertEqual([line.split("  ")[1] for line in self.item("a").attrs["source_files"].decode().splitlines()], ["m/a.off", "seen/a_413.txt", "v/a_413.txt"])

    def test_values_of_faces_are_kept_and_names_need_not_be_utf8(self):
        name = os.fsdecode(b"caf\xe9")
        self.write({f"m/{name}.off": off(), f"v/{name}.txt": lines([1, 2, 3, 4])})
        self.assertEqual(self.imported(own_sets.FACES), {name: "written"})
        self.equal(self.item(name)["truth/faces"][:], [1, 2, 3, 4])
        self.assertIn(b"m/caf\xe9.off", (self.to / f"items/{name}.h5").read_bytes())

    def test_a_second_call_writes_what_changed(self):
        self.clouds()
        self.assertEqual(self.imported(split="test"), {"cow": "written", "dog": "written"})
        self.assertEqual(self.imported(items="cat,dog"), {"cat": "written", "dog": "unchanged"})
        self.assertEqual(self.names(), ["cat", "dog"])
        self.imported()
        before = self.files()
        self.assertEqual(self.imported(), dict.fromkeys(("cat", "cow", "dog"), "unchanged"))
        self.assertEqual(self.files(), before)
        self.clouds("dog")
        (self.root / "Gaze/cat.txt").unlink()
        self.assertEqual(self.imported(), {"cow": "unchanged", "dog": "written"})
        self.assertEqual((self.done.removed, sorted(self.files())), (1, ["cow.h5", "dog.h5", "index.csv"]))

    def test_an_item_that_fails_is_named_and_taken_out(self):
        self.clouds()
        self.imported()
        self.write({"Gaze/cow.txt": "1 2 3 4 5 6 7\n"})
        found = self.imported()
        self.assertIn("ROOT/Gaze/cow.txt:1: ", found.pop("cow"))
        self.assertEqual(found, {"cat": "unchanged", "dog": "unchanged"})
        self.assertEqual(sorted(self.files()), ["cat.h5", "dog.h5", "index.csv"])

    def test_a_folder_with_another_set_is_left_alone(self):
        self.clouds()
        self.imported()
        before = self.files()
        self.write({"m/a.off": off()})
        for layout, root, why in (("folder", self.root / "m", "another set, of source sal3d"), ("hdf5", self.to, "is the HDF5 form already")):
            with self.assertRaisesRegex(InputError, why):
                importing.import_set(layout, str(root), str(self.to))
        self.assertEqual(self.files(), before)
        (self.to / "index.csv").write_text("name,age\neel,3\n")
        with self.assertRaisesRegex(InputError, "holds something else: "):
            self.imported()

    def test_the_data_set_itself_is_not_written_to(self):
        self.clouds()
        before = {path: path.read_bytes() for path in self.root.rglob("*.*")}
        self.to.symlink_to(self.root)
        for to in (self.root, self.root / ".", self.root / "Gaze", self.root / "Gaze/..", self.to, self.to / "Gaze"):
            with self.subTest(to), self.assertRaisesRegex(InputError, "is a folder of the data set itself; choose another"):
                importing.import_set("sal3d", str(self.root), str(to))
        self.to.unlink()
        self.to.mkdir()
        (self.to / "items").symlink_to(self.root / "Gaze")
        with self.assertRaisesRegex(InputError, "is a folder of the data set itself"):
            self.imported()
        self.assertEqual({path: path.read_bytes() for path in self.root.rglob("*.*")}, before)
        self.assertEqual(self.files(), {})

    def test_no_link_is_followed(self):
        self.clouds()
        self.imported()
        whole = {name: data for name, (_, data) in self.files().items()}
        theirs = self.root.parent / "theirs"
        theirs.mkdir()
        (theirs / "cat.h5").write_text("years\nof work\n")
        for name in ("items/cat.h5", "index.csv"):
            for what, make in (("a link", lambda path: path.symlink_to(theirs / "cat.h5")), ("a pipe", os.mkfifo)):
                (self.to / name).unlink()
                make(self.to / name)
                with self.subTest(name, what=what):
                    if name == "index.csv":  # whose set it is cannot be told
                        self.assertRaisesRegex(InputError, "holds something else", self.imported)
                        (self.to / name).unlink()
                        (self.to / name).write_bytes(whole[name])
                    self.imported()
                    self.assertEqual({name: data for name, (_, data) in self.files().items()}, whole)
        self.assertEqual((theirs / "cat.h5").read_text(), "years\nof work\n")

    def test_what_is_imported_is_the_same_data_set(self):
        viewers = {"off/a.off": off(), "maps/a_anna.csv": lines([3, 1, 4, 1]), "maps/a_ben.csv": lines([-1, 5, 9, -1])}
        for layout, files in {**{name: files for name, (files, _) in MINIATURES.items()}, own_sets.VIEWERS: viewers}.items():  # of recordings: recordings_test.py
            self.setUp()
            self.write(files)
            with self.subTest(layout[:20]):
                self.imported(layout)
                before, after = salbench.Dataset(layout if layout in sets.LAYOUTS else self.mine, self.root), salbench.Dataset("hdf5", self.to)
                self.assertEqual((after.ids, after.categories, after.splits), (before.ids, before.categories, before.splits))
                for shape, expected in zip(after, before, strict=True):
                    for name in ("points", "faces", "normals", "ground_truth"):
                        self.equal(getattr(shape, name), getattr(expected, name))
                    for name in ("participants", "viewers"):
                        for own, theirs in zip(getattr(shape, name), getattr(expected, name), strict=True):
                            self.equal(own, theirs)
        self.assertEqual((len(shape.viewers), np.isnan(shape.viewers[1]).sum()), (2, 2))

    # --- the command ----------------------------------------------------------------------------------------------

    def ended(self, *arguments):
        done = forked.salbench("import", *arguments)
        return done.returncode, done.stdout, done.stderr

    def test_status_and_document(self):
        self.clouds()
        data = "sal3d", "--data", self.root, "--to", self.to
        status, out, _ = self.ended(*data)
        self.assertEqual((status, out), (0, f"3 of 3 shapes written to {self.to}, 0 unchanged, 0 removed, 0 with problems\n"))
        self.write({"Gaze/cow.txt": "1 2 3 4 5 6 7\n"})
        status, out, err = self.ended(*data, "--quiet", "--format", "json")
        document = json.loads(out)
        self.assertEqual((status, document["command"], document["layout"], document["n_problems"]), (1, "import", "sal3d", 1))
        self.assertEqual([(shape["name"], shape["outcome"]) for shape in document["shapes"]], [("cat", "unchanged"), ("cow", "failed"), ("dog", "unchanged")])
        note, error = err.splitlines()
        self.assertTrue(error.startswith("error: cow: "), error)
        self.assertEqual(sets.listed("hdf5", str(self.to))[1].remark, sets.listed("sal3d", str(self.root))[1].remark)
        self.assertTrue(note.startswith("warning: TRUTH: "), note)

    def test_unusable_arguments_and_folders(self):
        self.clouds()
        for arguments, status, named in (
                (("sal3dd", "--data", self.root, "--to", self.to), 2, "did you mean 'sal3d'?"),
                (("own.yaml", "--data", self.root, "--to", self.to), 2, "docs/upgrading.md"),
                (("sal3d", "--to", self.to), 2, "--data DIR"), (("sal3d", "--data", self.root), 2, "--to"),
                (("sal3d", "--data", self.root, "--to", self.to, "--format", "xml"), 2, "json"),
                (("sal3d", "--data", self.root / "none", "--to", self.to), 2, "none"),
                (("sal3d", "--data", self.root, "--to", self.to, "--items", "coww"), 2, "--items coww"),
                (("sal3d", "--data", self.root, "--to", self.root), 2, "the data set itself"),
                (("sal3d", "--data", self.root, "--to", self.root / "splits.csv"), 3, "choose another with --to")):
            with self.subTest(named):
                found, out, err = self.ended(*arguments)
                self.assertEqual((found, out, err.count("\n")), (status, "", 1), err)
                self.assertIn(named, err)
