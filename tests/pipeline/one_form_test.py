# SPDX-License-Identifier: GPL-3.0-or-later
"""`salbench import`: a miniature of each public archive in the one HDF5 form gives the tables of the archive, byte by byte, and the
scores of NumPy; h5py reads what was in its files; and what is wrong with a converted file concerns its item alone."""

import json
import os
import re
import subprocess
import tempfile
import unittest
from pathlib import Path

import h5py
import numpy as np
import pandas as pd
import protocols_twin_test
from protocols_twin_test import PROGRAM, ROOT, bumpy_sphere

# Where the real sets lie below SALBENCH_DATA, and what of them is taken.
LAYOUT = r"(?m)^(dataset: {|  )layout: (\w+)"
REAL = {"sal3d": ("sal3d", "cart,camel,chair"), "zaragoza": ("eyetracking", "cow,fandisk"), "schelling": ("SchellingData", "9,125")}


def convert(layout, data, to, *further):
    return subprocess.run([PROGRAM, "import", layout, "--data", data, "--to", to, *further], capture_output=True, text=True)


class Converted(protocols_twin_test.Protocols):
    """The tests of the archives over what they are converted to."""

    def configured(self, protocol, layout=None):
        text = protocol if "\n" in protocol else (ROOT / f"configs/protocols/{protocol}.yaml").read_text()
        file = self.folder / "protocol.yaml"
        file.write_text(text if layout is None else re.sub(LAYOUT, rf"\1layout: {layout}", text))
        return file

    def tables(self, config, data, *further):
        out = self.folder / "tables"
        if "--items" in further:  # others, which the converted set lacks, say nothing
            further += ("--reference", "items")
        done = subprocess.run([PROGRAM, "run", config, "--data", data, "--cache", self.folder / "cache", "--out", out, "--quiet", *further],
                              capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        return {path.name: path.read_bytes() for path in out.glob("*.csv") if path.name != "timeline.csv"}

    def agrees_converted(self, protocol, data, *items):
        """Converts, compares all tables, and returns the folder of the converted set."""
        layout = re.search(LAYOUT, self.configured(protocol).read_text())[2]
        expected = self.tables(self.configured(protocol), data, *items)
        to = self.folder / "one_form"
        done = convert(layout, data, to, "--quiet", *items)
        self.assertEqual((done.returncode, done.stdout), (0, ""), done.stderr)
        found = self.tables(self.configured(protocol, "hdf5"), to, *items)
        self.assertIn("results.csv", expected)
        self.assertEqual(found.keys(), expected.keys())
        for name, table in expected.items():
            self.assertEqual(found[name], table, name)
        return to

    def scored(self, protocol):
        self.archive, self.data = self.data, self.agrees_converted(protocol, self.data)
        for subcommand, further in (("run", ["--out", self.folder / "out"]), ("maps", ["--to", self.folder / "maps"])):
            subprocess.run([PROGRAM, subcommand, self.configured(protocol, "hdf5"), "--data", self.data, "--cache", self.folder / "cache",
                            "--quiet", *further], check=True)
        found = {(path.parent.name, path.stem): np.loadtxt(path) for path in (self.folder / "maps").glob("*/*.val")}
        return pd.read_csv(self.folder / "out/results.csv", dtype={"item": str, "view": str}), found

    def item(self, name):
        file = h5py.File(self.data / f"items/{name}.h5")
        self.addCleanup(file.close)
        return file

    def test_participants_stay_apart(self):
        """One of them picked nothing, and one mesh has picks alone."""
        picked = {}
        for k, mesh in enumerate(("21", "22", "41")):
            points, faces = bumpy_sphere(k)
            self.write_mesh(f"Meshes/{mesh}.off", points, faces)
            picked[mesh] = [self.rng.choice(len(points), n, replace=False).tolist() for n in (5, 0, 7, 3)]
            for participant, picks in enumerate(picked[mesh]):
                self.write_lines(f"RawData/{mesh}_{participant}.pid", picks)
            if mesh != "22":
                self.write_lines(f"Distributions/{mesh}.val", self.rng.random(len(points)))
        table, _ = self.scored("schelling")
        self.assertEqual(set(table["class"]), {"cup", "glasses"})
        self.assertIn("HS", set(table["model"]))
        for mesh, picks in picked.items():
            truth = self.item(mesh)["truth"]
            self.assertEqual(truth["picks"][:].tolist(), [pick for participant in picks for pick in participant])
            self.assertEqual(truth["picks_of"][:].tolist(), [5, 0, 7, 3])
            self.assertEqual("saliency" in truth, mesh != "22")

    # --- what h5py finds --------------------------------------------------------------------------------------

    def test_a_mesh_as_it_was(self):
        looked, picks = self.rng.random(2000), [3, 1, 2]
        points, faces = bumpy_sphere(5)
        looked = looked[:len(points)]
        self.write_mesh("Meshes/cow.off", points, faces)
        self.write_lines("Distributions/cow.val", looked)
        self.write_lines("RawData/cow_0.pid", picks)
        self.assertEqual(convert("zaragoza", self.data, self.folder / "to").returncode, 0)
        self.data = self.folder / "to"
        file = self.item("cow")
        np.testing.assert_array_equal(file["shape/points"][:], points)
        np.testing.assert_array_equal(file["shape/faces"][:], faces)
        np.testing.assert_array_equal(file["truth/saliency"][:], looked)
        self.assertEqual(file["truth/picks"][:].tolist(), picks)
        self.assertEqual([file[name].dtype for name in ("shape/points", "shape/faces", "truth/picks")], ["<f8", "<i4", "<i4"])
        self.assertEqual((file.attrs["item"], file.attrs["source"]), (b"cow", b"zaragoza"))
        self.assertIn(b"ask the authors", file.attrs["licence"])
        self.assertEqual([line.split()[1] for line in file.attrs["source_files"].decode().splitlines()],
                         ["Distributions/cow.val", "Meshes/cow.off", "RawData/cow_0.pid"])
        for name in ("shape/points", "truth/saliency"):
            self.assertTrue(file[name].attrs["unit"] and file[name].attrs["description"])

    def test_views_keep_what_their_masks_hide(self):
        super().test_3dva()
        for mesh in ("bunny", "dragon"):
            for view in ("300", "413", "599"):
                looked = np.loadtxt(self.archive / f"FixationMaps/{mesh}_{view}norm.txt")
                seen = np.loadtxt(self.archive / f"CentricityAndVisibilityMaps/{mesh}_{view}_visibility.txt") == 1
                group = self.item(mesh)[f"views/{view}"]
                np.testing.assert_array_equal(group["saliency"][:], np.where(seen, looked, np.nan))
                np.testing.assert_array_equal(group["as_read/0/values"][:], looked)
                np.testing.assert_array_equal(group["as_read/0/mask"][:], seen)

    def test_values_of_faces_are_kept(self):
        super().test_meshmamba()
        of_faces = np.loadtxt(self.archive / "SaliencyMap/non_texture/Apple_v4.csv")
        np.testing.assert_array_equal(self.item("Apple_v4")["truth/as_read/0/values"][:], of_faces)
        index = pd.read_csv(self.data / "index.csv")
        self.assertEqual(index["split"].tolist(), ["train"] * 4 + ["test"])

    # --- calls ------------------------------------------------------------------------------------------------

    def clouds(self):
        truth = {}
        for k, name in enumerate(("cat", "cow", "dog")):
            points, _ = bumpy_sphere(k)
            truth[name] = self.rng.random(len(points))
            rows = np.column_stack([points, 6.28 * points, truth[name], truth[name] > 0.9])
            self.write(f"Gaze/{name}.txt", "".join(" ".join(map(repr, row)) + "\n" for row in rows.tolist()))
        self.write("splits.csv", "item,split\ncat,train\ncow,test\ndog,test\n")
        return truth

    def outcome(self, to, *further):
        done = convert("sal3d", self.data, to, "--quiet", "--format", "json", *further)
        document = json.loads(done.stdout)
        self.assertEqual((document["command"], document["layout"]), ("import", "sal3d"))
        return done.returncode, [(shape["name"], shape["outcome"]) for shape in document["shapes"]], document["removed"]

    def test_a_second_call_writes_what_changed(self):
        self.clouds()
        to = self.folder / "to"
        self.assertEqual(self.outcome(to, "--split", "test"), (0, [("cow", "written"), ("dog", "written")], 0))
        self.assertEqual(self.outcome(to, "--items", "cat,dog"), (0, [("cat", "written"), ("dog", "unchanged")], 0))
        self.assertEqual(pd.read_csv(to / "index.csv")["item"].tolist(), ["cat", "cow", "dog"])
        before = {path: (path.stat().st_mtime_ns, path.read_bytes()) for path in to.rglob("*.*")}
        self.assertEqual(self.outcome(to), (0, [("cat", "unchanged"), ("cow", "unchanged"), ("dog", "unchanged")], 0))
        self.assertEqual({path: (path.stat().st_mtime_ns, path.read_bytes()) for path in to.rglob("*.*")}, before)
        text = (self.data / "Gaze/dog.txt").read_text()
        (self.data / "Gaze/dog.txt").write_text(text + "1 2 3 4 5 6 7 0\n")
        (self.data / "Gaze/cat.txt").unlink()
        self.assertEqual(self.outcome(to), (0, [("cow", "unchanged"), ("dog", "written")], 1))
        self.assertEqual(sorted(path.name for path in to.rglob("*.*")), ["cow.h5", "dog.h5", "index.csv"])

    def test_an_item_that_fails_is_named_and_left_out(self):
        self.clouds()
        to = self.folder / "to"
        self.assertEqual(self.outcome(to)[0], 0)
        self.write("Gaze/cow.txt", "1 2 3 4 5 6 7\n")
        done = convert("sal3d", self.data, to, "--quiet")
        self.assertEqual(done.returncode, 1)
        self.assertEqual(done.stderr.count("error: "), 1)
        self.assertIn("error: cow: ", done.stderr)
        self.assertEqual(pd.read_csv(to / "index.csv")["item"].tolist(), ["cat", "dog"])
        self.assertFalse((to / "items/cow.h5").exists())

    def test_a_folder_with_another_set_is_left_alone(self):
        self.clouds()
        to = self.folder / "to"
        self.assertEqual(convert("sal3d", self.data, to).returncode, 0)
        before = {path: path.read_bytes() for path in to.rglob("*.*")}
        self.write("Meshes/ant.off", "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n")
        for data, layout, why in ((self.data / "Meshes", "folder", "another set, read with the layout sal3d"),
                                  (to, "hdf5", "hdf5 is the one form already")):
            done = convert(layout, data, to)
            self.assertEqual(done.returncode, 2)
            self.assertIn(why, done.stderr)
        (self.data / "Gaze").rename(self.data / "Other")
        (self.data / "Other/cat.txt").rename(self.data / "Other/eel.txt")
        for name in ("cow", "dog"):
            (self.data / f"Other/{name}.txt").unlink()
        (self.data / "Other").rename(self.data / "Gaze")
        done = convert("sal3d", self.data, to)
        self.assertEqual(done.returncode, 2)
        self.assertIn("holds another set, of which no item is in", done.stderr)
        self.assertEqual({path: path.read_bytes() for path in to.rglob("*.*")}, before)
        (to / "index.csv").write_text("name,age\neel,3\n")
        done = convert("sal3d", self.data, to)
        self.assertEqual(done.returncode, 2)
        self.assertIn("holds something else: ", done.stderr)

    # --- converted files that somebody spoilt ---------------------------------------------------------------------

    def problems(self, to):
        done = subprocess.run([PROGRAM, "inspect", "hdf5", "--data", to, "--format", "json"], capture_output=True, text=True)
        self.assertIn(done.returncode, (0, 1), done.stderr)
        return {item["name"]: item["problem"] for item in json.loads(done.stdout)["items"]}

    def test_a_spoilt_file_is_one_error_and_the_others_go_on(self):
        self.clouds()
        to = self.folder / "to"
        self.assertEqual(convert("sal3d", self.data, to).returncode, 0)
        file = to / "items/cow.h5"
        whole = file.read_bytes()

        def replaced(name, values):
            def spoil(h5):
                del h5[name]
                if values is not None:
                    h5[name] = values
            return spoil

        n = len(bumpy_sphere(1)[0])
        nowhere = np.full((n, 3), 1.0)
        nowhere[5, 1] = np.nan
        spoilt = {
            'data set "shape/points": row 5 (0-based): a coordinate is not a finite number': replaced("shape/points", nowhere),
            'has no data set "shape/points"': replaced("shape/points", None),
            'data set "shape/points": expected numbers of type float64': replaced("shape/points", np.ones((n, 3), "i4")),
            f'data set "shape/points": its shape is ({n}, 2), expected (n, 3)': replaced("shape/points", np.ones((n, 2))),
            f'data set "shape/normals": its shape is ({n - 1}, 3), expected ({n}, 3)': replaced("shape/normals", np.ones((n - 1, 3))),
            f'data set "truth/saliency": its shape is ({n + 1}), expected ({n})': replaced("truth/saliency", np.ones(n + 1)),
            "value 0 (0-based) is inf": replaced("truth/saliency", np.full(n, np.inf)),
            "'truth/saliency': no point has a value": replaced("truth/saliency", np.full(n, np.nan)),
            f'data set "truth/picks": {n} is out of range': replaced("truth/picks", np.array([0, n], "i4")),
            "the numbers in 'truth/picks_of' do not sum": replaced("truth/picks_of", np.array([1], "i4")),
            "expected whole numbers of type int32": replaced("truth/picks", np.array([1.5])),
            'has no data set "truth/picks_of"': replaced("truth/picks_of", None),
            "has no attribute form = 'salbench item'": lambda h5: h5.attrs.__delitem__("form"),
            "is of version 2 of the form": lambda h5: h5.attrs.__setitem__("form_version", 2),
            "it does not hold numbers": lambda h5: h5.__setitem__("text", "a text"),
        }
        for expected, spoil in spoilt.items():
            with self.subTest(expected):
                file.write_bytes(whole)
                with h5py.File(file, "r+") as h5:
                    spoil(h5)
                problems = self.problems(to)
                self.assertIn(expected, problems["cow"])
                self.assertIn("items/cow.h5", problems["cow"])
                self.assertEqual((problems["cat"], problems["dog"]), ("", ""))
        for length in (0, 7, 100, len(whole) // 2, len(whole) - 1):
            with self.subTest(length=length):
                file.write_bytes(whole[:length])
                problems = self.problems(to)
                self.assertNotEqual(problems["cow"], "")
                self.assertNotIn("\n", problems["cow"])
                self.assertEqual((problems["cat"], problems["dog"]), ("", ""))
        file.unlink()
        self.assertIn("items/cow.h5", self.problems(to)["cow"])

    def test_a_file_of_another_program_is_read(self):
        truth = self.clouds()
        to = self.folder / "to"
        self.assertEqual(convert("sal3d", self.data, to).returncode, 0)
        with h5py.File(to / "items/cow.h5") as h5:
            arrays, attributes = {name: h5[name][:] for name in ("shape/points", "truth/saliency")}, dict(h5.attrs)
        with h5py.File(to / "items/cow.h5", "w", libver="latest") as h5:
            for name, values in arrays.items():
                h5.create_dataset(name, data=values, chunks=True, compression="gzip")
            for name in ("form", "item"):
                h5.attrs[name] = attributes[name].decode()
            h5.attrs["form_version"] = 1
        done = subprocess.run([PROGRAM, "inspect", "hdf5", "--data", to, "--format", "json"], capture_output=True, text=True)
        (cow,) = [item for item in json.loads(done.stdout)["items"] if item["name"] == "cow"]
        self.assertEqual((cow["problem"], cow["seen"], float(cow["high"])), ("", len(truth["cow"]), truth["cow"].max()))

    def test_an_index_that_is_wrong_names_its_line(self):
        self.clouds()
        to = self.folder / "to"
        self.assertEqual(convert("sal3d", self.data, to).returncode, 0)
        whole = (to / "index.csv").read_text()
        for before, after, expected in (("dog,", "../dog,", ':4: item is "../dog", expected the name of a file'),
                                        ("dog,", "cat,", ':4: item "cat" is listed already'),
                                        (",cloud,", ",cube,", ':2: kind is "cube", expected cloud or mesh'),
                                        (",0,0,", ",0,-1,", ':2: viewers is "-1", expected a whole number'),
                                        (",split,", ",part,", "has no column 'split'")):
            with self.subTest(expected):
                (to / "index.csv").write_text(whole.replace(before, after, 1))
                done = subprocess.run([PROGRAM, "inspect", "hdf5", "--data", to], capture_output=True, text=True)
                self.assertEqual(done.returncode, 2)
                self.assertEqual(done.stderr.count("\n"), 1)
                self.assertIn("index.csv", done.stderr)
                self.assertIn(expected, done.stderr)

    # --- real data ----------------------------------------------------------------------------------------------

    @unittest.skipUnless(os.environ.get("SALBENCH_DATA"), "SALBENCH_DATA is not set")
    def test_real_sets_give_the_same_tables(self):
        for protocol, (folder, items) in REAL.items():
            with self.subTest(protocol):
                holder = tempfile.TemporaryDirectory()
                self.addCleanup(holder.cleanup)
                self.folder = Path(holder.name)
                self.agrees_converted(protocol, Path(os.environ["SALBENCH_DATA"]) / folder, "--items", items)


if __name__ == "__main__":
    unittest.main()
