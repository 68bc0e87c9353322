# SPDX-License-Identifier: GPL-3.0-or-later
"""The HDF5 form: what is written is read again, by anybody; files of others are read or refused with one line; nothing crashes or hangs."""

import io
import os
import tempfile
import types
import unittest
from pathlib import Path

import h5py
import numpy as np

import salbench
from salbench import _core
from salbench.datasets import Item, Shape, one_form, sets, write
from salbench.datasets.records import InputError, shape_of
from salbench.system import hdf5
from salbench.system.workers import Pool, Question
from support import FACES, NAN, POINTS, sphere

FUZZED = int(os.environ.get("SALBENCH_FUZZ", "150"))  # mutations of files; 2000 before a release
ABOUT = one_form.about(Item("a", category="cup"), "own")


def mesh():
    """With everything that a mesh can have: the shape, and ground truth by view."""
    shape = Shape(POINTS, FACES.astype(np.int32), polygons=(3, 1))
    whole = Shape(POINTS, ground_truth=np.array([1.5, NAN, 3, 0.1]), viewers=np.array([[1, 2, 3, 4], [2, NAN, 3, -1.0]]), face_truth=np.array([0.5, NAN, 2, 3]),
                  participants=(np.array([3, 1], np.int32), np.array([], np.int32), np.array([0], np.int32)))
    return shape, {"": whole, "300": Shape(POINTS, ground_truth=np.array([1, 2, NAN, NAN]), viewers=np.array([[1, 2, NAN, NAN], [0, 3, NAN, NAN]]))}


def cloud():
    points, _ = sphere(6, 6)
    return Shape(points, normals=points, viewpoint=np.array([0, 0, 5.0]), left_out=np.array([1, 4], np.int32)), {"": Shape(points, ground_truth=points[:, 2].copy())}


def image(made):
    return one_form.image(*made, ABOUT)


def of_others(made, change=None, **how):
    """The bytes of the same shape as h5py writes it."""
    with h5py.File(io.BytesIO(image(made))) as own:
        held, names = io.BytesIO(), []
        own.visititems(lambda name, entry: names.append(name) if isinstance(entry, h5py.Dataset) else None)
        with h5py.File(held, "w") as file:
            file.attrs.update({name: value.decode() if isinstance(value, bytes) else value for name, value in own.attrs.items()})
            for name in names:
                file.create_dataset(name, data=own[name][()], **how)
            if change is not None:
                change(file)
        return held.getvalue()


def replaced(name, values=None):
    def change(file):
        del file[name]
        if values is not None:
            file[name] = values
    return change


def attribute(name, value=None):
    return lambda file: file.attrs.__delitem__(name) if value is None else file.attrs.__setitem__(name, value)


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


P, T = "shape/points", "truth/saliency"
REFUSED = (  # what is done to the file of the mesh, what the one line names
    (attribute("form"), "form"), (attribute("form", [1, 2]), "'form'"), (attribute("form_version", 9), "version 9"), (replaced(P), P),
    (replaced(P, POINTS.astype("i4")), P), (replaced(P, POINTS.astype("f4")), P), (replaced(P, POINTS[:, :2]), "(4, 2)"),
    (replaced(P, np.ones((4, 3), np.longdouble)), "16 bytes"), (replaced(P, np.where(np.arange(12).reshape(4, 3) == 7, NAN, POINTS)), "row 2 (0-based)"),
    (replaced(P, np.ones((1,) * 9)), "9 dimensions"), (replaced("shape/faces", FACES + 1), "int32"),
    (replaced("shape/faces", (FACES + 1).astype("i4")), "4 is out of range"),
    (replaced(T, np.ones(5)), "(5)"), (replaced(T, np.full(4, np.inf)), "value 0 (0-based) is inf"), (replaced(T, np.full(4, NAN)), T),
    (replaced(T, np.zeros(4, [("a", "f8"), ("b", "i4")])), T), (replaced(T, ["a", "bc", "d", "e"]), T), (replaced(T, h5py.Empty("f8")), T),
    (unallocated, "0 are stored"), (of_another_file, T), (replaced(T, h5py.ExternalLink("other.h5", "/x")), "link"),
    (replaced(T, h5py.SoftLink("/views/300/saliency")), "link"), (replaced("views", h5py.ExternalLink("other.h5", "/x")), "link"),
    (replaced("truth/viewers", np.ones((2, 3))), "(2, 3)"), (replaced("truth/faces", np.ones(3)), "(3)"),
    (replaced("truth/picks", np.array([0, 4, 1], "i4")), "4 is out of range"), (replaced("truth/picks_of", np.array([1], "i4")), "truth/picks_of"),
    (replaced("truth/picks_of", np.array([4, -1], "i4")), "truth/picks_of"), (replaced("truth/picks_of"), "truth/picks_of"),
    (lambda file: [file.pop(f"truth/{name}") for name in ("saliency", "viewers", "picks")], '"truth/'))


class Form(unittest.TestCase):
    def setUp(self):
        self.folder = Path(self.enterContext(tempfile.TemporaryDirectory()))

    def same(self, found, expected):
        """found: arrays of a file, and texts."""
        shape, truths = expected
        arrays, _ = found
        for name in ("points", "faces", "normals", "viewpoint", "left_out", "polygons"):
            np.testing.assert_equal(getattr(shape_of(arrays), name), getattr(shape, name), name)
        self.assertEqual({name.split("/")[1] if name.startswith("views/") else "" for name in arrays if not name.startswith("shape/")}, {*truths})
        for view, truth in truths.items():
            of_view = shape_of(arrays, view)
            for name in ("ground_truth", "viewers", "face_truth"):
                np.testing.assert_equal(getattr(of_view, name), getattr(truth, name), f"{view} {name}")
            np.testing.assert_equal([*of_view.participants], [*truth.participants])

    def refusal(self, work):
        with self.assertRaises(ValueError) as caught:
            work()
        self.assertNotIn("\n", str(caught.exception))
        return str(caught.exception)

    def test_what_is_written_is_read(self):
        for made in (mesh(), cloud()):
            found = _core.read_form(image(made), b"a.h5")
            self.same(found, made)
            self.assertEqual(found[1]["item"], "a")
            self.assertEqual(image(made), image(made), "equal shapes, equal bytes")

    def test_h5py_finds_what_the_page_says(self):
        with h5py.File(io.BytesIO(image(mesh()))) as file:
            self.assertEqual((file.attrs["form"], file.attrs["form_version"], file.attrs["class"]), (b"salbench item", 2, b"cup"))
            self.assertEqual([file[name].dtype for name in (P, "shape/faces", "truth/picks")], ["<f8", "<i4", "<i4"])
            self.assertEqual((file["truth/picks"][:].tolist(), file["truth/picks_of"][:].tolist()), ([3, 1, 0], [2, 0, 1]))
            self.assertEqual(file["shape/polygons"][:].tolist(), [3, 1])
            np.testing.assert_array_equal(file["truth/faces"][:], mesh()[1][""].face_truth)
            self.assertEqual([*file["views/300"]], ["saliency", "viewers"])
            self.assertTrue(file[T].attrs["unit"] and file[T].attrs["description"])

    # --- files of others ------------------------------------------------------------------------------------------

    def test_a_file_of_another_program_is_the_same_shape(self):
        def older(file):
            del file["shape/polygons"]
            file.attrs.update({"form_version": 1, "polygons_split": 3, "polygons_concave": 1})

        def of_1_x(file):
            file["truth/as_read/0/values"] = [1.0, 2]

        for made, change, how in ((mesh(), None, {}), (cloud(), None, {}), (mesh(), replaced(P, POINTS.astype(">f8")), {}),
                                  (mesh(), with_a_cycle, {}), (mesh(), older, {}),
                                  (mesh(), of_1_x, {}), (cloud(), None, {"chunks": True, "compression": "gzip"})):
            data = of_others(made, change, **how)
            self.assertIsNone(_core.read_form(data, b"a.h5"), "no program of ours wrote this")
            self.same(one_form.foreign_form("a.h5", data), made)

    def test_what_is_wrong_is_one_line(self):
        for number, (change, named) in enumerate(REFUSED):
            with self.subTest(number, named=named):
                message = self.refusal(lambda: one_form.foreign_form("a.h5", of_others(mesh(), change)))  # noqa: B023: called at once
                self.assertTrue(message.startswith("a.h5: "), message)
                self.assertIn(named, message)
        for data, said in ((b"", "not an"), (b"no HDF5", "not an"), (of_others(mesh())[:3000], "not a readable")):
            self.assertIn(f"a.h5: {said} HDF5 file", self.refusal(lambda: one_form.foreign_form("a.h5", data)))  # noqa: B023

    def test_damaged_files_crash_and_hang_nothing(self):
        """Whatever random changes make of a file, it is a shape or one line. A process that the library kills is one line, too."""
        rng, pool = np.random.default_rng(7), Pool()
        self.addCleanup(pool.close)
        wholes = [image(mesh()), of_others(mesh()), of_others(cloud(), chunks=True, compression="gzip", shuffle=True)]
        path, readable = str(self.folder / "a.h5"), 0
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
            Path(path).write_bytes(data)
            try:
                arrays = pool.ask(Question("salbench.datasets.one_form:foreign_arrays", (path, "a"), path))
            except (ValueError, MemoryError) as error:
                self.assertNotIn("\n", str(error))
            else:
                readable += 1
                self.assertIsNotNone(_core.read_form(_core.form_image(arrays, ABOUT, b"a.h5"), b"a.h5"), number)
        self.assertTrue(0 < readable < FUZZED)

    # --- a set of one's own ---------------------------------------------------------------------------------------

    def contents(self):
        return {path: (path.stat().st_mtime_ns, path.read_bytes()) for path in self.folder.rglob("*.*")}

    def test_ten_lines_write_a_set(self):
        picked = [[0, 2], [], [3]]
        shapes = [salbench.Shape("a", POINTS, FACES, category="cups", split="test", ground_truth=[1, NAN, 3, 4], participants=picked),
                  types.SimpleNamespace(id="b", points=sphere()[0].tolist(), ground_truth=np.arange(len(sphere()[0])))]
        write(self.folder, iter(shapes))
        found = salbench.Dataset("hdf5", self.folder)
        self.assertEqual((found.ids, found.categories, found.splits), (("a", "b"), ("cups", ""), ("test",)))
        np.testing.assert_array_equal(found["a"].ground_truth, [1, NAN, 3, 4])
        self.assertEqual(([picks.tolist() for picks in found["a"].participants], found["b"].faces), (picked, None))
        before = self.contents()
        write(self.folder, shapes)
        self.assertEqual(self.contents(), before)
        write(self.folder, shapes[1:])
        self.assertEqual(sorted(path.name for path in self.contents()), ["b.h5", "index.csv"])

    def test_an_item_with_what_read_returned_is_a_shape(self):
        """As a set of functions hands them over; an unknown class is none."""
        write(self.folder, [(Item("a", category="cups"), Shape(POINTS, FACES, ground_truth=[1, 2, 3, 4], face_truth=[1, 2, 3, 4])),
                            *(types.SimpleNamespace(id=f"{k}", points=POINTS, faces=FACES, category=none, split=none) for k, none in enumerate((None, NAN, "")))])
        found = salbench.Dataset("hdf5", self.folder)
        self.assertEqual((found.ids, found.categories, found.splits), (("a", "0", "1", "2"), ("cups", "", "", ""), ()))
        with h5py.File(self.folder / "items/a.h5") as file:
            self.assertEqual(file["truth/faces"][:].tolist(), [1, 2, 3, 4])

    def test_shapes_that_cannot_be_used_are_named(self):
        def shape(name="a", **more):
            return types.SimpleNamespace(**({"id": name, "points": POINTS, "faces": FACES} | more))
        for shapes, named in (([shape(), shape()], "'a': .*twice"), ([shape("../a")], "'../a'"), ([shape(faces=FACES + 1)], "'a': .*shape/faces.*: 4 is out of range: there are 4 points"),
                              ([shape(ground_truth=[1, 2])], r"'a': .*ground_truth .*\(2,\), .* 4 points$"), ([shape(viewers=np.ones((2, 4)))], "'a': .*ground_truth"),
                              ([shape(points=POINTS * NAN)], "'a': .*shape/points.*not a finite number"), ([shape(faces=None)], "'a': .*4 points"),
                              ([shape(category="x\ny")], "'a': .*category"), ([(Item("a_1", shape="a", view="1"), Shape(POINTS, FACES))], "'a_1': .*view")):
            with self.subTest(named), self.assertRaisesRegex(InputError, f"^shape {named}"):
                write(self.folder / "new", shapes)
            self.assertFalse((self.folder / "new/index.csv").exists())

    def test_a_folder_that_holds_anything_else_is_left_alone(self):
        write(self.folder, [types.SimpleNamespace(id="a", points=POINTS, faces=FACES)], source="theirs")
        before = self.contents()
        with self.assertRaisesRegex(InputError, "another set, of source theirs"):
            write(self.folder, [])
        self.assertEqual(self.contents(), before)
        for name in ("readme.txt", "items.csv", "folder/"):
            folder = self.folder / name.strip("/")
            (folder / name).parent.mkdir(parents=True)
            (folder / name).mkdir() if name.endswith("/") else (folder / name).write_text("mine")
            with self.subTest(name), self.assertRaisesRegex(InputError, "no data set"):
                write(folder, [types.SimpleNamespace(id="a", points=POINTS, faces=FACES)])
            self.assertEqual([path.name for path in folder.iterdir() if path.name[0] != "."], [name.strip("/")])

    # --- the index ------------------------------------------------------------------------------------------------

    def test_an_index_that_is_wrong_names_its_line(self):
        write(self.folder, [types.SimpleNamespace(id=name, points=POINTS, faces=FACES, ground_truth=range(4)) for name in ("cat", "cow", "dog")])
        whole = (self.folder / "index.csv").read_text()
        for before, after, named in (("dog,", "../dog,", ':4: item is "../dog"'), ("dog,", "cat,", ':4: item "cat"'), (",mesh,", ",cube,", ':2: kind is "cube"'),
                                     (",0,0,", ",0,-1,", ':2: viewers is "-1"'), (",split,", ",part,", "'split'"), (whole, "", "empty")):
            with self.subTest(named):
                (self.folder / "index.csv").write_text(whole.replace(before, after, 1))
                self.assertRegex(self.refusal(lambda: sets.listed("hdf5", str(self.folder))), f"index.csv.*{named}")
        for same in ("\ufeff" + whole, whole.replace("\n", "\r\n")):
            (self.folder / "index.csv").write_text(same, newline="")
            self.assertEqual([item.name for item in sets.listed("hdf5", str(self.folder))[1].items], ["cat", "cow", "dog"])

    def test_a_file_of_another_item_is_refused(self):
        """Whoever wrote it, by every way in; one that does not say whose it is, is believed."""
        points, faces = sphere(6, 6)

        def shape(name, people):
            return types.SimpleNamespace(id=name, points=points, faces=faces, ground_truth=np.arange(len(points)), participants=[[k] for k in range(people)])

        def by_h5py(name, change):
            shape = shape_of(_core.read_form(whole[name], b"")[0])
            return of_others((shape, {"": shape}), change)

        write(self.folder, [shape("cat", 3), shape("cow", 3), shape("dog", 3)])
        whole = {name: (self.folder / f"items/{name}.h5").read_bytes() for name in ("cat", "cow", "dog")}
        fewer = self.folder / "fewer"
        write(fewer, [shape("cow", 2)])
        config = {"dataset": {"layout": "hdf5", "scans": False}, "models": {"CB": None}, "metrics": {"names": ["cc"], "matching": "none"}}
        for name, data, named in (
                ("another's", whole["cat"], '"cat"'), ("another's, by h5py", by_h5py("cat", attribute("item", "cat")), '"cat"'),
                ("of nobody", by_h5py("cow", attribute("item", "")), '""'), ("of fewer people", (fewer / "items/cow.h5").read_bytes(), "2 picks .* 3"),
                ("its own, by h5py", by_h5py("cow", attribute("item", "cow")), ""), ("that does not say", by_h5py("cow", attribute("item")), "")):
            (self.folder / "items/cow.h5").write_bytes(data)
            dataset, listing = sets.listed("hdf5", str(self.folder))
            with self.subTest(name):
                for read in (lambda: dataset.read(listing.items[1]), lambda: salbench.Dataset("hdf5", self.folder)["cow"]):  # noqa: B023
                    if named:
                        self.assertRegex(self.refusal(read), f"cow.h5: .*{named}.*: put the right file there")
                    else:
                        np.testing.assert_array_equal(read().points, points)
                self.assertEqual(salbench.Dataset("hdf5", self.folder)["dog"].points.tolist(), points.tolist())
                results = salbench.run(config, data=self.folder, cache=self.folder / f"cache {name}", out=self.folder / "out", progress=False)
                self.assertEqual({failure.item for failure in results.failures}, {"cow"} if named else set())
                self.assertRegex("".join(failure.cause for failure in results.failures), named or "^$")

    def test_many_rows_are_listed_in_seconds(self):
        header = "item,view,class,split,kind,truth,participants,viewers,source\n"
        (self.folder / "index.csv").write_text(header + "".join(f"{number},,,,mesh,no,0,0,own\n" for number in range(50_000)))
        self.assertEqual(len(sets.listed("hdf5", str(self.folder))[1].items), 50_000)


class MapsOfOthers(unittest.TestCase):
    """Maps in HDF5 files, which a process of its own reads for the program."""

    def setUp(self):
        self.path = str(Path(self.enterContext(tempfile.TemporaryDirectory())) / "maps.h5")

    def written(self, **values):
        with h5py.File(self.path, "w") as file:
            file.update(values)

    def test_numbers_of_every_type_are_exact_or_refused(self):
        third, beyond = 1 / 3, (1 << 53) + 1
        for dtype, given, wrong in (
                ("<f8", [third, -1e308, 5e-324], ""), (">f8", [third, 1, 2], ""), ("<f2", [0.5, -65504, 1], ""), ("i1", [-128, 127, 0], ""), ("u1", [255, 0, 1], ""),
                (">u2", [65535, 0, 1], ""), ("<u4", [4294967295, 0, 1], ""), (">i8", [-(1 << 53), 1 << 53, 1], ""), ("<i8", [1, beyond, 2], "beyond 2.53"),
                ("<u8", [1, 1 << 63, 2], "beyond 2.53"), (np.longdouble, [1, 2, 3], "16 bytes")):
            self.written(x=np.array(given, dtype))
            for read in (lambda: hdf5.only_values(self.path), lambda: hdf5.map_in(self.path, "x")):
                with self.subTest(dtype):
                    if wrong:
                        self.assertRaisesRegex(InputError, f'maps.h5: data set "x": .*{wrong}', read)
                    else:
                        self.assertEqual(read().tolist(), given)

    def test_one_value_per_point(self):
        for shape, fits in (((6,), True), ((1, 6, 1), True), ((3, 2), False)):
            self.written(x=np.arange(6.0).reshape(shape))
            if fits:
                self.assertEqual(hdf5.only_values(self.path).tolist(), [0, 1, 2, 3, 4, 5])
            else:
                self.assertRaisesRegex(InputError, r'maps.h5: data set "x": .*\(3, 2\)', hdf5.only_values, self.path)

    def test_data_sets_of_numbers_by_name(self):
        with h5py.File(self.path, "w") as file:
            file["b/saliency"], file["a"], file["text"] = [1.0], [2, 3], "no numbers"
            file["link"], file["b/cycle"] = h5py.SoftLink("/a"), file["b"]
        self.assertEqual(hdf5.names_in(self.path), ["a", "b/saliency"])
        self.assertEqual(hdf5.map_in(self.path, "b/saliency").tolist(), [1])
        for work, named in ((lambda: hdf5.map_in(self.path, "c"), '"c"'), (lambda: hdf5.map_in(self.path, "text"), '"text"'),
                            (lambda: hdf5.only_values(self.path), "2 data sets of numbers")):
            self.assertRaisesRegex(InputError, f"maps.h5: .*{named}", work)
