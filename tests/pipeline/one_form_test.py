# SPDX-License-Identifier: GPL-3.0-or-later
"""`salbench import`: a miniature of each public archive in the one HDF5 form gives the tables of the archive, byte by byte, and the
scores of NumPy. What is written and refused is tested in tests/datasets."""

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
        return {path.name: path.read_bytes() for path in out.glob("*.csv") if path.name not in ("timeline.csv", "costs.csv")}  # of no scores

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
        for subcommand, further in (("run", ["--out", self.folder / "out"]), ("export", ["--to", self.folder / "maps", "--format", "maps"])):
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
        np.testing.assert_array_equal(self.item("Apple_v4")["truth/faces"][:], of_faces)
        index = pd.read_csv(self.data / "index.csv")
        self.assertEqual(index["split"].tolist(), ["train+train_80"] * 2 + ["train+test+train_80", "test+train_80", "test+test_20"])

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
