# SPDX-License-Identifier: GPL-3.0-or-later
"""`salbench import`: what is written, left alone, taken out and refused; interrupted and started again."""

import contextlib
import csv
import json
import os
import signal
import subprocess
import sys
import time
from unittest import mock

import h5py
import numpy as np

import salbench
from salbench.datasets import importing, one_form, sets
from salbench.datasets.records import InputError
from archives_test import MINIATURES
from support import FACES, NAN, POINTS, WithArchive, lines, off, sphere


class Importing(WithArchive):
    def setUp(self):
        super().setUp()
        self.to = self.root.parent / "to"

    def imported(self, layout="sal3d", items="", split=""):
        """Outcomes by shape, with what is said of those that fail."""
        done = importing.import_set(layout if layout in sets.LAYOUTS else self._layout(layout), str(self.root), str(self.to), items, split)
        self.done = done
        return {shape.name: shape.problem.replace(str(self.root), "ROOT") or shape.outcome for shape in done.shapes}

    def files(self):
        return {path.name: (path.stat().st_mtime_ns, path.read_bytes()) for path in self.to.rglob("*.*")}

    def item(self, name):
        file = h5py.File(self.to / f"items/{name}.h5")
        self.addCleanup(file.close)
        return file

    def clouds(self, *names):
        points, _ = sphere(5, 6)
        rng = np.random.default_rng(1)
        for name in names or ("cat", "cow", "dog"):
            values = rng.random(len(points))
            rows = np.column_stack([points, 6.28 * points, values, values > 0.9])
            self.write({f"Gaze/{name}.txt": "".join(" ".join(map(repr, row)) + "\n" for row in rows.tolist())})
        self.write({"splits.csv": "item,split\ncat,train\ncow,test\ndog,test\n"})

    def test_a_mesh_as_it_was(self):
        picks = [[3, 1, 2], [], [0]]
        self.write({"Meshes/cow.off": off(), "Distributions/cow.val": lines([1, 2, 3, 4])})
        self.write({f"RawData/cow_{k}.pid": lines(picked) for k, picked in enumerate(picks)})
        self.assertEqual(self.imported("zaragoza"), {"cow": "written"})
        file = self.item("cow")
        self.equal(file["shape/points"][:], POINTS)
        self.equal(file["shape/faces"][:], FACES)
        self.equal(file["truth/saliency"][:], [1, 2, 3, 4])
        self.assertEqual((file["truth/picks"][:].tolist(), file["truth/picks_of"][:].tolist()), ([3, 1, 2, 0], [3, 0, 1]))
        self.assertEqual((file.attrs["item"], file.attrs["source"]), (b"cow", b"zaragoza"))
        self.assertIn(b"ask the authors", file.attrs["licence"])
        read = file.attrs["source_files"].decode().splitlines()
        self.assertEqual([line.split("  ")[1] for line in read], ["Distributions/cow.val", "Meshes/cow.off", *(f"RawData/cow_{k}.pid" for k in range(3))])
        printed = subprocess.run(["xxh128sum", "Meshes/cow.off"], cwd=self.root, capture_output=True, text=True) if _has("xxh128sum") else None
        self.assertTrue(printed is None or printed.stdout == read[1] + "\n")

    def test_polygons_and_picks_alone(self):
        points = np.vstack([POINTS, [[1, 1, 0]]])
        self.write({"Meshes/7.off": off(points, FACES).replace("5 4 0", "5 5 0") + "4 0 1 4 2\n", "RawData/7_0.pid": "1\n"})
        self.assertEqual(self.imported("schelling"), {"7": "written"})
        self.assertEqual(self.item("7")["shape/polygons"][:].tolist(), [1, 0])
        self.assertNotIn("saliency", self.item("7")["truth"])

    def test_views_keep_what_their_masks_hide(self):
        described = "places:\n  - meshes: 'm/*'\n    truth: {saliency: 'v/{item}_{view}.txt', mask: 'seen/{item}_{view}.txt'}\n    views: scored\n"
        self.write({"m/a.off": off(), "v/a_300.txt": lines([1, 2, 3, 4]), "seen/a_300.txt": lines([1, 1, 1, 0]),
                    "v/a_413.txt": lines([5, 6, 7, 8]), "seen/a_413.txt": lines([0, 1, 1, 1])})
        self.assertEqual(self.imported(described), {"a": "written"})
        view = self.item("a")["views/413"]
        self.equal(view["saliency"][:], [NAN, 6, 7, 8])
        self.equal(view["as_read/0/values"][:], [5, 6, 7, 8])
        self.equal(view["as_read/0/mask"][:], [0, 1, 1, 1])
        self.assertEqual([row[:2] for row in one_form.read_index(str(self.to))], [("a", "300"), ("a", "413")])
        self.write({"v/a_300.txt": lines([1, 2])})
        self.assertIn("ROOT/v/a_300.txt", self.imported(described)["a"])
        self.assertEqual([row[:2] for row in one_form.read_index(str(self.to))], [("a", "413")], "a view that fails is left out")
        self.assertEqual((self.done.shapes[0].outcome, self.done.problems), ("written", 1))

    def test_values_of_faces_are_kept(self):
        described = "places: [{meshes: 'm/*', truth: {saliency: 'v/{item}.txt'}}]\nvalues: {per: face}\n"
        self.write({"m/a.off": off(), "v/a.txt": lines([1, 2, 3, 4])})
        self.assertEqual(self.imported(described), {"a": "written"})
        self.equal(self.item("a")["truth/faces"][:], [1, 2, 3, 4])

    def test_a_second_call_writes_what_changed(self):
        self.clouds()
        self.assertEqual(self.imported(split="test"), {"cow": "written", "dog": "written"})
        self.assertEqual(self.imported(items="cat,dog"), {"cat": "written", "dog": "unchanged"})
        self.assertEqual([row[0] for row in one_form.read_index(str(self.to))], ["cat", "cow", "dog"])
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
        for work, why in ((lambda: importing.import_set("folder", str(self.root / "m"), str(self.to)), "another set, read with the layout sal3d"),
                          (lambda: importing.import_set("hdf5", str(self.to), str(self.to)), "hdf5 is the one form already")):
            with self.assertRaisesRegex(InputError, why):
                work()
        for path in (self.root / "Gaze").iterdir():
            path.unlink()
        self.clouds("eel")
        with self.assertRaisesRegex(InputError, "holds another set, of which no item is in .*; choose another folder"):
            self.imported()
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
            for what, make in (("a link", lambda path: path.symlink_to(theirs / "cat.h5")), ("zeros", lambda path: path.symlink_to("/dev/zero")),
                               ("a pipe", os.mkfifo)):
                (self.to / name).unlink()
                make(self.to / name)
                with self.subTest(name, what=what):
                    if name == "index.csv":  # whose set it is cannot be told
                        with self.assertRaisesRegex(InputError, "holds something else"):
                            self.imported()
                        (self.to / name).unlink()
                        (self.to / name).write_bytes(whole[name])
                    self.imported()
                    self.assertEqual({name: data for name, (_, data) in self.files().items()}, whole)
        (self.root / "Gaze/cat.txt").unlink()
        (self.to / "items").rename(self.to / "before")
        (self.to / "items").symlink_to(theirs)
        with self.assertRaisesRegex(InputError, "items: is a link, and is not followed"):
            self.imported()
        self.assertEqual([path.name for path in theirs.iterdir()], ["cat.h5"])

    def test_one_file_that_kills_its_worker_harms_no_other(self):
        self.clouds()
        with mock.patch("salbench._workers._START", "import os; from salbench.datasets import sets\nread = sets.read\n"
                        "def dying(layout, root, item, licence=''):\n    return os.abort() if item.name == 'cow' else read(layout, root, item, licence)\n"
                        "sets.read = dying\nfrom salbench.datasets.worker import main; main()"):
            found = self.imported()
        self.assertIn("crashed (signal 6: Aborted)", found.pop("cow"))
        self.assertEqual(found, {"cat": "written", "dog": "written"})

    def test_what_is_imported_is_the_same_data_set(self):
        viewers = {"off/a.off": off(), "maps/a_anna.csv": lines([3, 1, 4, 1]), "maps/a_ben.csv": lines([-1, 5, 9, -1])}
        # Of recordings, whose ground truth a run makes, recordings_test.py.
        sets_of_files = {name: files for name, (files, _) in MINIATURES.items() if name != "saliency3d"} | {
            "places: [{meshes: 'off/*', truth: {saliency: 'maps/{item}_{viewer}.csv'}}]\nvalues: {unseen: -1}\n": viewers}
        for layout, files in sets_of_files.items():
            self.setUp()
            self.write(files)
            with self.subTest(layout):
                self.imported(layout)
                before, after = salbench.Dataset(self._layout(layout), self.root), salbench.Dataset("hdf5", self.to)
                self.assertEqual((after.ids, after.categories, after.splits), (before.ids, before.categories, before.splits))
                for shape, expected in zip(after, before, strict=True):
                    for name in ("points", "faces", "normals", "ground_truth"):
                        self.equal(getattr(shape, name), getattr(expected, name))
                    for name in ("participants", "viewers"):
                        for own, theirs in zip(getattr(shape, name), getattr(expected, name), strict=True):
                            self.equal(own, theirs)
                    self.assertEqual((shape.category, shape.split), (expected.category, expected.split))
        self.assertEqual((len(shape.viewers), np.isnan(shape.viewers[1]).sum()), (2, 2))


# A worker that is held at every shape from a number on, as long as a file is there: so that a run stays in the middle.
HELD = """import os, pathlib, time
from salbench.datasets import sets
read = sets.read
def held(layout, root, item, licence=""):
    if int(item.name[1:]) >= {first}:
        pathlib.Path({folder!r}, "held").touch()
        while os.path.exists({folder!r} + "/hold"):
            time.sleep(.01)
    return read(layout, root, item, licence)
sets.read = held
from salbench.datasets.worker import main
main()"""
# The command over such workers, which leaves a file when it hears Ctrl-C.
COMMAND = """import pathlib, signal, sys
from salbench import _workers
def interrupted(*_):
    pathlib.Path({folder!r}, "interrupted").touch()
    raise KeyboardInterrupt
signal.signal(signal.SIGINT, interrupted)
_workers._START = {held!r}
from salbench.__main__ import main
sys.exit(main(sys.argv[1:]))"""


class Command(Importing):
    def started(self, *arguments, **how):
        return subprocess.Popen([sys.executable, "-P", *map(str, arguments)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, **how)

    def held(self, shapes):
        """The command in the middle of so many shapes, which waits until the file `hold` is gone."""
        self.clouds(*(f"c{number}" for number in range(shapes)))
        folder = str(self.root.parent)
        self.hold = self.root.parent / "hold"
        self.hold.touch()
        code = COMMAND.format(folder=folder, held=HELD.format(folder=folder, first=shapes // 2))
        process = self.started("-c", code, "import", "sal3d", "--data", self.root, "--to", self.to, "--quiet", start_new_session=True)
        self.wait(process, "held")
        return process

    def wait(self, process, name):
        while not (self.root.parent / name).exists():
            self.assertIsNone(process.poll(), f"ended before it was {name}")
            time.sleep(.01)

    def ended(self, *arguments):
        process = self.started("-m", "salbench", "import", *arguments)
        out, err = process.communicate()
        return process.returncode, out, err

    def test_status_and_document(self):
        self.clouds()
        data = "sal3d", "--data", self.root, "--to", self.to
        status, out, _ = self.ended(*data)
        self.assertEqual((status, out), (0, f"3 of 3 shapes written to {self.to}, 0 unchanged, 0 removed, 0 with problems\n"))
        self.write({"Gaze/cow.txt": "1 2 3 4 5 6 7\n"})
        status, out, err = self.ended(*data, "--quiet", "--format", "json")
        document = json.loads(out)
        self.assertEqual((status, document["command"], document["layout"], document["n_problems"]), (1, "import", "sal3d", 1))
        self.assertEqual([(shape["name"], shape["outcome"]) for shape in document["shapes"]],
                         [("cat", "unchanged"), ("cow", "failed"), ("dog", "unchanged")])
        note, error = err.splitlines()
        self.assertTrue(note.startswith("warning: TRUTH: raw gaze densities; "), note)
        self.assertTrue(error.startswith("error: cow: "), error)
        with open(self.to / "index.csv", newline="") as file:
            self.assertEqual([row["remarks"] for row in csv.DictReader(file)], [note.removeprefix("warning: ")] * 2)

    def test_unusable_arguments_and_folders(self):
        self.clouds()
        for arguments, status, expected in (
                (("sal3dd", "--data", self.root, "--to", self.to), 2, "error: import: there is no layout 'sal3dd'; did you mean 'sal3d'?"),
                (("sal3d", "--to", self.to), 2, "error: import: names no data set: give --data DIR"),
                (("sal3d", "--data", self.root), 2, "--to"), (("sal3d", "--data", self.root, "--to", self.to, "--format", "xml"), 2, "must be text or json"),
                (("sal3d", "--data", self.root / "none", "--to", self.to), 2, "none"),
                (("sal3d", "--data", self.root, "--to", self.to, "--items", "coww"), 2, "error: --items coww: the data set has no item 'coww'; did you"),
                (("sal3d", "--data", self.root, "--to", ""), 2, "error: --to: is empty: name a file or a folder"),
                (("sal3d", "--data", "", "--to", self.to), 2, "error: --data: is empty: name a file or a folder"),
                (("sal3d", "--data", self.root, "--to", self.root), 2, "is a folder of the data set itself"),
                (("sal3d", "--data", self.root, "--to", self.root / "splits.csv"), 3, "choose another with --to")):
            with self.subTest(expected):
                found, out, err = self.ended(*arguments)
                self.assertEqual((found, out), (status, ""), err)
                self.assertIn(expected, err)
                self.assertEqual(err.count("\n"), 1, err)

    def test_what_was_done_before_ctrl_c_is_kept(self):
        process = self.held(100)
        os.killpg(process.pid, signal.SIGINT)
        self.wait(process, "interrupted")
        self.hold.unlink()
        out, err = process.communicate()
        self.assertEqual((process.returncode, out), (130, ""), err)
        self.assertIn(f"salbench import sal3d --data {self.root}", err)
        rows = one_form.read_index(str(self.to))
        self.assertTrue(0 < len(rows) < 100)
        self.assertEqual({f"{row[0]}.h5" for row in rows}, set(os.listdir(self.to / "items")))
        self.assertEqual(len(self.imported()), 100)
        self.assertEqual(self.done.count("unchanged"), len(rows))

    def test_a_kill_leaves_a_folder_that_the_next_call_completes(self):
        process = self.held(100)
        os.killpg(process.pid, signal.SIGKILL)
        process.communicate()
        self.assertEqual(set(self.imported().values()), {"written", "unchanged"})
        self.assertEqual(len(salbench.Dataset("hdf5", self.to)), 100)


del Importing  # its tests, which `Command` has, too, run once


def _has(program):
    with contextlib.suppress(FileNotFoundError):
        return subprocess.run([program, "--version"], capture_output=True).returncode == 0
    return False
