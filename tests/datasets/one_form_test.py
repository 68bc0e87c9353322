# SPDX-License-Identifier: GPL-3.0-or-later
"""The one form: what is written is read again, by anybody; files of others are read or refused with one line; nothing crashes or hangs."""

import io
import json
import os
import tempfile
import types
import unittest
from pathlib import Path

import h5py
import numpy as np

import salbench.datasets.one_form
from salbench import _core
from salbench.datasets import one_form, sets
from salbench._workers import Worker
from salbench.datasets.records import AsRead, Form, InputError, Truth
from support import FACES, NAN, POINTS, sphere

FUZZED = int(os.environ.get("SALBENCH_FUZZ", "150"))  # mutations of files; 2000 before a release

ABOUT = {"item": "a", "class": "cup", "split": "", "source": "own", "source_files": "", "viewers": "", "licence": ""}


def mesh():
    """With everything that a mesh can have."""
    whole = Truth("", np.array([1.5, NAN, 3, 0.1]), np.array([[1, 2, 3, 4], [2, NAN, 3, -1.0]]),
                  (np.array([3, 1], np.int32), np.array([], np.int32), np.array([0], np.int32)), np.array([0.5, NAN, 2, 3]))
    view = Truth("300", np.array([1, 2, NAN, NAN]), np.array([[1, 2, NAN, NAN], [0, 3, NAN, NAN]]), (),
                 None, (AsRead("a_300.txt", "vertex", np.array([1, 2, 7, 8.0]), None, np.array([1, 1, 0, 0.0])),))
    return Form(POINTS, FACES.astype(np.int32), polygons=(3, 1), truths=(whole, view), about=ABOUT)


def cloud():
    points, _ = sphere(6, 6)
    return Form(points, normals=points, viewpoint=np.array([0, 0, 5.0]), left_out=np.array([1, 4], np.int32),
                truths=(Truth("", points[:, 2].copy()),), about=ABOUT)


def contents(form):
    """Arrays by name, of which two equal forms have the same."""
    found = {name: getattr(form, name) for name in ("points", "faces", "normals", "viewpoint", "left_out", "polygons")}
    for truth in form.truths:
        found |= {f"{truth.view}/{name}": getattr(truth, name) for name in ("saliency", "viewers", "face_values")}
        found |= {f"{truth.view}/picks/{k}": picks for k, picks in enumerate(truth.picks)}
    return {name: value for name, value in found.items() if value is not None}


def names_in(group):
    found = []
    group.visititems(lambda name, entry: found.append(name) if isinstance(entry, h5py.Dataset) else None)
    return found


def of_others(form, change=None, **how):
    """The bytes of the same shape as h5py writes it."""
    with h5py.File(io.BytesIO(one_form.image(form))) as own:
        held = io.BytesIO()
        with h5py.File(held, "w") as file:
            file.attrs.update({name: value.decode() if isinstance(value, bytes) else value for name, value in own.attrs.items()})
            for name in names_in(own):
                file.create_dataset(name, data=own[name][()], **how)
            if change is not None:
                change(file)
        return held.getvalue()


def replaced(name, values):
    def change(file):
        del file[name]
        if values is not None:
            file[name] = values
    return change


def unallocated(file):
    del file["truth/saliency"]
    file.create_dataset("truth/saliency", (10**12,), np.float64)


def of_another_file(file):
    layout = h5py.VirtualLayout((4,), np.float64)
    layout[:] = h5py.VirtualSource("other.h5", "x", (4,))
    del file["truth/saliency"]
    file.create_virtual_dataset("truth/saliency", layout)


def with_a_cycle(file):
    file["views/again"] = file["views"]


NOWHERE = np.where(np.arange(12).reshape(4, 3) == 7, np.nan, POINTS)
REFUSED = (  # what is done to the file of the mesh, what the one line says
    (lambda file: file.attrs.__delitem__("form"), "has no attribute form = 'salbench item'"),
    (lambda file: file.attrs.__setitem__("form", [1, 2]), "attribute 'form' is not a single text or number"),
    (lambda file: file.attrs.__setitem__("form_version", 9), "is of version 9 of the form, and this program reads 1 to 3"),
    (replaced("shape/points", None), 'has no data set "shape/points"'),
    (replaced("shape/points", POINTS.astype("i4")), 'data set "shape/points": expected numbers of type float64'),
    (replaced("shape/points", POINTS.astype("f4")), 'data set "shape/points": expected numbers of type float64'),
    (replaced("shape/points", POINTS[:, :2]), 'data set "shape/points": its shape is (4, 2), expected (n, 3)'),
    (replaced("shape/points", np.ones((4, 3), np.longdouble)), "its numbers of 16 bytes are wider than float64 and int64"),
    (replaced("shape/points", NOWHERE), 'data set "shape/points": row 2 (0-based): a coordinate is not a finite number'),
    (replaced("shape/points", np.ones((1,) * 9)), "it has 9 dimensions, expected at most 8"),
    (replaced("shape/faces", FACES + 1), "of type int32"),
    (replaced("shape/faces", (FACES + 1).astype("i4")), 'data set "shape/faces": 4 is out of range: there are 4 points, numbered from 0'),
    (replaced("truth/saliency", np.ones(5)), 'data set "truth/saliency": its shape is (5), expected (4)'),
    (replaced("truth/saliency", np.full(4, np.inf)), "value 0 (0-based) is inf"),
    (replaced("truth/saliency", np.full(4, NAN)), '"truth/saliency": no point has a value'),
    (replaced("truth/saliency", np.zeros(4, [("a", "f8"), ("b", "i4")])), 'data set "truth/saliency": it does not hold numbers'),
    (replaced("truth/saliency", ["a", "bc", "d", "e"]), 'data set "truth/saliency": it does not hold numbers'),
    (replaced("truth/saliency", h5py.Empty("f8")), 'data set "truth/saliency": it has no values'),
    (unallocated, "it claims 8000000000000 bytes of values, and 0 are stored"),
    (of_another_file, "its values are in other files"),
    (replaced("truth/saliency", h5py.ExternalLink("other.h5", "/x")), '"truth/saliency" is a link, which is not followed'),
    (replaced("truth/saliency", h5py.SoftLink("/views/300/saliency")), '"truth/saliency" is a link, which is not followed'),
    (replaced("views", h5py.ExternalLink("other.h5", "/x")), '"views" is a link, which is not followed'),
    (replaced("truth/viewers", np.ones((2, 3))), 'data set "truth/viewers": its shape is (2, 3), expected (n, 4)'),
    (replaced("truth/faces", np.ones(3)), 'data set "truth/faces": its shape is (3), expected (4)'),
    (replaced("truth/picks", np.array([0, 4, 1], "i4")), 'data set "truth/picks": 4 is out of range'),
    (replaced("truth/picks_of", np.array([1], "i4")), 'the numbers in "truth/picks_of" do not sum'),
    (replaced("truth/picks_of", np.array([4, -1], "i4")), 'the numbers in "truth/picks_of" do not sum'),
    (replaced("truth/picks_of", None), 'has no data set "truth/picks_of"'),
    (lambda file: [file.pop(f"truth/{name}") for name in ("saliency", "viewers", "picks")],
     'has neither "truth/saliency" nor "truth/picks"'),
)


class OneForm(unittest.TestCase):
    def setUp(self):
        self.folder = Path(self.enterContext(tempfile.TemporaryDirectory()))

    def same(self, found, expected):
        found, expected = contents(found), contents(expected)
        self.assertEqual(found.keys(), expected.keys())
        for name, value in expected.items():
            np.testing.assert_array_equal(found[name], value, err_msg=name)

    def refusal(self, work):
        with self.assertRaises(ValueError) as caught:
            work()
        self.assertNotIn("\n", str(caught.exception))
        return str(caught.exception)

    def foreign(self, data):
        return one_form.read_foreign("a.h5", data)

    def test_what_is_written_is_read(self):
        for form in (mesh(), cloud()):
            path = self.folder / "a.h5"
            path.write_bytes(one_form.image(form))
            self.same(one_form.read(str(path)), form)
            self.assertEqual(one_form.read(str(path)).about, ABOUT)
            self.assertEqual(one_form.image(form), path.read_bytes(), "equal shapes, equal bytes")

    def test_h5py_finds_what_the_page_says(self):
        with h5py.File(io.BytesIO(one_form.image(mesh()))) as file:
            self.assertEqual((file.attrs["form"], file.attrs["form_version"], file.attrs["class"]), (b"salbench item", 2, b"cup"))
            self.assertEqual([file[name].dtype for name in ("shape/points", "shape/faces", "truth/picks")], ["<f8", "<i4", "<i4"])
            self.assertEqual((file["truth/picks"][:].tolist(), file["truth/picks_of"][:].tolist()), ([3, 1, 0], [2, 0, 1]))
            self.assertEqual(file["shape/polygons"][:].tolist(), [3, 1])
            np.testing.assert_array_equal(file["truth/faces"][:], mesh().truths[0].face_values)
            self.assertEqual(file["views/300/as_read/0/mask"][:].tolist(), [1, 1, 0, 0])
            self.assertTrue(file["truth/saliency"].attrs["unit"] and file["truth/saliency"].attrs["description"])

    # --- files of others ------------------------------------------------------------------------------------------

    def test_a_file_of_another_program_is_the_same_shape(self):
        for form in (mesh(), cloud()):
            self.same(self.foreign(of_others(form)), form)
        self.same(self.foreign(of_others(mesh(), lambda file: replaced("shape/points", POINTS.astype(">f8"))(file))), mesh())
        self.same(self.foreign(of_others(mesh(), with_a_cycle)), mesh())
        packed = of_others(cloud(), chunks=True, compression="gzip")
        self.assertIsNone(_core.read_one_form(packed, b"a.h5"), "no program of ours wrote this")
        (self.folder / "a.h5").write_bytes(packed)
        self.same(one_form.read(str(self.folder / "a.h5")), cloud())

    def test_version_one_is_read(self):
        def older(file):
            del file["shape/polygons"]
            file.attrs.update({"form_version": 1, "polygons_split": 3, "polygons_concave": 1})
        self.same(self.foreign(of_others(mesh(), older)), mesh())

    def test_what_is_wrong_is_one_line(self):
        for change, expected in REFUSED:
            with self.subTest(expected):
                message = self.refusal(lambda: self.foreign(of_others(mesh(), change)))  # noqa: B023: called at once
                self.assertTrue(message.startswith("a.h5: "), message)
                self.assertIn(expected, message)
        for data in (b"", b"no HDF5", of_others(mesh())[:3000]):
            self.assertIn("not a readable HDF5 file", self.refusal(lambda: self.foreign(data)))  # noqa: B023

    def test_damaged_files_crash_and_hang_nothing(self):
        """Whatever random changes make of a file, it is a shape or one line. A process that the library kills is one line, too."""
        rng, worker = np.random.default_rng(7), Worker()
        self.addCleanup(worker.close)
        wholes = [one_form.image(mesh()), of_others(mesh()), of_others(cloud(), chunks=True, compression="gzip", shuffle=True)]
        path, outcomes = self.folder / "a.h5", []
        for number in range(FUZZED):
            data = bytearray(wholes[number % len(wholes)])
            for _ in range(int(rng.integers(1, 9))):
                at = int(rng.integers(len(data)))
                kind = rng.integers(4)
                if kind == 0:
                    data[at] ^= 1 << int(rng.integers(8))
                elif kind == 1:
                    data[at:at + 8] = rng.choice([b"\xff" * 8, b"\0" * 8, b"\x7f" + b"\xff" * 7])
                elif kind == 2:
                    length = int(rng.integers(1, 64))
                    data[at:at + length] = data[int(rng.integers(len(data))):][:length]
                elif len(data) > 1000:
                    del data[at:at + int(rng.integers(1, 200))]
            path.write_bytes(data)
            made, problems = worker.ask({"do": "rewrite", "path": str(path)})
            self.assertNotEqual(made is None, not problems, number)
            self.assertLessEqual(len(problems), 1, problems)
            outcomes.append(made is not None)
            if made is not None:
                self.assertIsNotNone(_core.read_one_form(made, b"a.h5"), number)
        self.assertTrue(any(outcomes) and not all(outcomes))

    # --- a set of one's own ---------------------------------------------------------------------------------------

    def test_ten_lines_write_a_set(self):
        picked = [[0, 2], [], [3]]
        shapes = [salbench.Shape("a", POINTS, FACES, category="cups", split="test", ground_truth=[1, NAN, 3, 4], participants=picked),
                  types.SimpleNamespace(id="b", points=sphere()[0].tolist(), ground_truth=np.arange(len(sphere()[0])))]
        one_form.write(self.folder, iter(shapes))
        found = salbench.Dataset("hdf5", self.folder)
        self.assertEqual((found.ids, found.categories, found.splits), (("a", "b"), ("cups", ""), ("test",)))
        np.testing.assert_array_equal(found["a"].ground_truth, [1, NAN, 3, 4])
        self.assertEqual([picks.tolist() for picks in found["a"].participants], picked)
        self.assertIsNone(found["b"].faces)
        before = {path: (path.stat().st_mtime_ns, path.read_bytes()) for path in self.folder.rglob("*.*")}
        one_form.write(self.folder, shapes)
        self.assertEqual({path: (path.stat().st_mtime_ns, path.read_bytes()) for path in self.folder.rglob("*.*")}, before)
        one_form.write(self.folder, shapes[1:])
        self.assertEqual(sorted(path.name for path in self.folder.rglob("*.*")), ["b.h5", "index.csv"])

    def test_an_unknown_class_is_none(self):
        shapes = [types.SimpleNamespace(id=str(k), points=POINTS, faces=FACES, category=unknown, split=unknown) for k, unknown in enumerate((None, NAN, ""))]
        one_form.write(self.folder, shapes)
        found = salbench.Dataset("hdf5", self.folder)
        self.assertEqual((found.categories, found.splits), (("", "", ""), ()))

    def test_shapes_that_cannot_be_used_are_named(self):
        def shape(name="a", **more):
            return types.SimpleNamespace(**({"id": name, "points": POINTS, "faces": FACES} | more))
        for shapes, expected in (([shape(), shape()], "shape 'a': its id is given twice"),
                                 ([shape("../a")], "shape '../a': its id is no name of a file"),
                                 ([shape(faces=FACES + 1)], "shape 'a': faces must have numbers of points, 0 to 3, not 4"),
                                 ([shape(ground_truth=[1, 2])], "shape 'a': saliency must have shape (4,), not (2,)"),
                                 ([shape(viewers=np.ones((2, 4)))], "shape 'a': has viewers, but no ground_truth"),
                                 ([shape(points=POINTS * NAN)], "shape 'a': points must have finite coordinates"),
                                 ([shape(faces=None)], "shape 'a': a: the point cloud has 4 points with a position: it needs at least 9")):
            with self.subTest(expected), self.assertRaises(InputError) as caught:
                one_form.write(self.folder / "new", shapes)
            self.assertIn(expected, str(caught.exception))
            self.assertFalse((self.folder / "new/index.csv").exists())

    def test_a_folder_with_another_set_is_left_alone(self):
        one_form.write(self.folder, [types.SimpleNamespace(id="a", points=POINTS, faces=FACES)], source="theirs")
        before = {path: path.read_bytes() for path in self.folder.rglob("*.*")}
        with self.assertRaisesRegex(InputError, "holds another set, of source theirs; choose another folder"):
            one_form.write(self.folder, [])
        self.assertEqual({path: path.read_bytes() for path in self.folder.rglob("*.*")}, before)

    def test_a_folder_that_holds_anything_else_is_left_alone(self):
        for name in ("readme.txt", "items.csv", "folder/"):
            folder = self.folder / name.strip("/")
            (folder / name).parent.mkdir(parents=True)
            (folder / name).mkdir() if name.endswith("/") else (folder / name).write_text("mine")
            with self.subTest(name), self.assertRaisesRegex(InputError, 'holds ".+", and no data set; choose another folder'):
                one_form.write(folder, [types.SimpleNamespace(id="a", points=POINTS, faces=FACES)])
            self.assertEqual([path.name for path in folder.iterdir() if path.name[0] != "."], [name.strip("/")])

    # --- the index ------------------------------------------------------------------------------------------------

    def test_an_index_that_is_wrong_names_its_line(self):
        named = [types.SimpleNamespace(id=name, points=POINTS, faces=FACES, ground_truth=range(4)) for name in ("cat", "cow", "dog")]
        one_form.write(self.folder, named)
        whole = (self.folder / "index.csv").read_text()
        self.assertEqual(len(sets.listed("hdf5", str(self.folder))[1].items), 3)
        for before, after, expected in (("dog,", "../dog,", ':4: item is "../dog", expected the name of a file'),
                                        ("dog,", "cat,", ':4: item "cat" is listed already'), (",mesh,", ",cube,", ':2: kind is "cube"'),
                                        (",0,0,", ",0,-1,", ':2: viewers is "-1", expected a whole number'),
                                        (",split,", ",part,", "has no column 'split'"), (whole, "", "the file is empty")):
            with self.subTest(expected):
                (self.folder / "index.csv").write_text(whole.replace(before, after, 1))
                message = self.refusal(lambda: sets.listed("hdf5", str(self.folder)))
                self.assertIn("index.csv", message)
                self.assertIn(expected, message)
        for same in ("\ufeff" + whole, whole.replace("\n", "\r\n")):
            (self.folder / "index.csv").write_text(same, newline="")
            self.assertEqual([item.name for item in sets.listed("hdf5", str(self.folder))[1].items], ["cat", "cow", "dog"])

    def test_a_file_of_another_item_is_refused(self):
        """Whoever wrote it, by every way in; one that does not say whose it is, is believed."""
        points, faces = sphere(6, 6)

        def shape(name, people):
            return types.SimpleNamespace(id=name, points=points, faces=faces, ground_truth=np.arange(len(points)),
                                         participants=[[k] for k in range(people)])
        one_form.write(self.folder, [shape("cat", 3), shape("cow", 3), shape("dog", 3)])
        whole = {name: (self.folder / f"items/{name}.h5").read_bytes() for name in ("cat", "cow", "dog")}
        fewer = self.folder / "fewer"
        one_form.write(fewer, [shape("cow", 2)])
        cow = one_form.read(str(self.folder / "items/cow.h5"))
        is_of, remedy = "is of the item ", "put the right file there, or import the set again"
        config = self.folder / "c.yaml"
        config.write_text("dataset: {layout: hdf5, scans: false}\nmodels: {CB: }\nmetrics: {names: [cc], matching: none}\n")
        for name, data, expected in (
                ("another's", whole["cat"], is_of), ("another's, by h5py", of_others(one_form.read(str(self.folder / "items/cat.h5"))), is_of),
                ("in other capitals", of_others(cow, lambda file: file.attrs.update({"item": "Cow"})), is_of),
                ("of nobody", of_others(cow, lambda file: file.attrs.update({"item": ""})), is_of),
                ("of fewer people", (fewer / "items/cow.h5").read_bytes(), "has 2 picks of participants, and index.csv says 3"),
                ("its own", whole["cow"], ""), ("its own, by h5py", of_others(cow), ""),
                ("that does not say", of_others(cow, lambda file: file.attrs.__delitem__("item")), "")):
            (self.folder / "items/cow.h5").write_bytes(data)
            listing = sets.listed("hdf5", str(self.folder))[1]
            with self.subTest(name):
                if expected:
                    message = self.refusal(lambda: sets.read("hdf5", str(self.folder), listing.items[1]))  # noqa: B023
                    self.assertRegex(message, f"cow.h5: {expected}.*: {remedy}")
                    self.assertRegex(self.refusal(lambda: salbench.Dataset("hdf5", self.folder)["cow"]), f"cow.h5: {expected}")  # noqa: B023
                else:
                    self.same(sets.read("hdf5", str(self.folder), listing.items[1]), cow)
                self.assertEqual(salbench.Dataset("hdf5", self.folder)["dog"].points.tolist(), points.tolist())
            with self.subTest(name, layout="run"):
                results = salbench.run(config, data=self.folder, cache=self.folder / f"cache {name}", out=self.folder / "out")
                self.assertEqual({item for item, _, _ in results.failures}, {"cow"} if expected else set())
                self.assertTrue(not expected or expected in results.failures[0][2], results.failures)

    def test_many_rows_are_listed_in_seconds(self):
        header = "item,view,class,split,kind,truth,participants,viewers,source\n"
        (self.folder / "index.csv").write_text(header + "".join(f"{number},,,,mesh,no,0,0,own\n" for number in range(10**5)))
        self.assertEqual(len(_core.read_index(os.fsencode(self.folder / "index.csv"))), 10**5)


class MapsOfOthers(unittest.TestCase):
    """Maps in HDF5 files, which a worker reads for the program."""

    def setUp(self):
        self.path = Path(self.enterContext(tempfile.TemporaryDirectory())) / "maps.h5"
        self.worker = Worker()
        self.addCleanup(self.worker.close)

    def asked(self, do, **more):
        made, problems = self.worker.ask({"do": do, "path": str(self.path), **more})
        if made is None:
            return problems[0].replace(str(self.path), "maps.h5")
        return json.loads(made) if do == "maps" else np.frombuffer(made).tolist()

    def test_numbers_of_every_type_are_exact_or_refused(self):
        third, beyond = 1 / 3, (1 << 53) + 1
        for dtype, given, expected in (
                ("<f8", [third, -1e308, 5e-324], None), (">f8", [third, 1, 2], None), ("<f2", [0.5, -65504, 1], None), ("i1", [-128, 127, 0], None),
                ("u1", [255, 0, 1], None), (">u2", [65535, 0, 1], None), ("<u4", [4294967295, 0, 1], None), (">i8", [-(1 << 53), 1 << 53, 1], None),
                ("<i8", [1, beyond, 2], f"it holds {beyond}: whole numbers beyond 2^53 cannot be used, scale them"),
                ("<u8", [1, 1 << 63, 2], f"it holds {1 << 63}: whole numbers beyond 2^53 cannot be used, scale them"),
                (np.longdouble, [1, 2, 3], "its numbers of 16 bytes are wider than float64 and int64: write them as one of these")):
            with self.subTest(dtype):
                with h5py.File(self.path, "w") as file:
                    file["x"] = np.array(given, dtype)
                expected = f'maps.h5: data set "x": {expected}' if expected else given
                self.assertEqual(self.asked("values"), expected)
                self.assertEqual(self.asked("map", name="x"), expected)

    def test_one_value_per_point(self):
        for shape, expected in (((6,), None), ((6, 1), None), ((1, 6), None), ((1, 6, 1), None),
                                ((3, 2), 'maps.h5: data set "x": its shape is (3, 2), expected one value per point')):
            with h5py.File(self.path, "w") as file:
                file["x"] = np.arange(6.0).reshape(shape)
            self.assertEqual(self.asked("values"), expected or [0, 1, 2, 3, 4, 5])

    def test_data_sets_of_numbers_by_name(self):
        with h5py.File(self.path, "w") as file:
            file["b/saliency"], file["a"], file["text"] = [1.0], [2, 3], "no numbers"
            file["link"], file["b/cycle"] = h5py.SoftLink("/a"), file["b"]
        self.assertEqual(self.asked("maps"), ["a", "b/saliency"])
        self.assertEqual(self.asked("map", name="b/saliency"), [1])
        self.assertEqual(self.asked("map", name="c"), 'maps.h5: has no data set "c"')
        self.assertEqual(self.asked("map", name="text"), 'maps.h5: data set "text": it does not hold numbers')
        self.assertEqual(self.asked("values"), "maps.h5: it has 2 data sets of numbers, expected one, or one called 'saliency'")
