# SPDX-License-Identifier: GPL-3.0-or-later
"""Saliency maps from outside are scored as if the program had computed them. What a file may hold: tests/python/maps_test.py."""

import csv
import os
import shutil

import h5py
import numpy as np
import yaml
from support import MESHES, POINTS, SCANS, VIEWS, Workspace

METRICS = ("auc", "auc_exact", "nss", "cc", "lcc")


class GivenMaps(Workspace):
    def written(self, *words):
        """The maps of PS, written by the program itself: what comes of them is known."""
        self.salbench("export", "--format", "maps", "--models", "PS", "--to", self.folder / "maps", *words)
        return self.folder / "maps/PS"

    def given(self, maps, *words, status=0):
        return self.salbench("run", "--maps", maps, "--name", "OWN", *words, status=status)

    def expect_level(self):
        own, inside = (self.scores(model, *METRICS) for model in ("OWN", "PS"))
        self.assertTrue(own)
        self.assertEqual(own, inside)

    def test_those_that_the_program_wrote_score_as_they_did_inside(self):
        self.configure(SCANS)
        maps = self.written()
        self.assertIn("OWN", self.given(maps).stdout)
        self.assertEqual(len(self.rows(model="OWN")), 2 * (1 + VIEWS))
        self.expect_level()
        for table in ("summary", "per_class", "significance"):
            self.assertIn("OWN", (self.out / f"{table}.csv").read_text(), table)
        self.assertEqual(*([row[model] for row in self.rows("mean_histograms_scans")] for model in ("OWN", "PS")))
        self.assertEqual(self.record()["evaluated"]["model"], "OWN")
        for scan in maps.glob("*_*.val"):
            scan.unlink()
        self.given(maps)
        self.assertEqual([row["dataset"] for row in self.rows(model="OWN")], ["meshes"] * 2, "of a kind that has no map none is expected")

    def test_matched_ones_are_not_matched_again(self):
        maps = self.written("--stage", "matched")
        self.given(maps, "--matched")
        self.expect_level()
        found = self.artefacts()
        self.assertEqual((found["map.OWN"], found["matched.OWN"]), (0, 2))
        first = maps / "1.val"
        first.write_text("-0.5" + first.read_text()[first.read_text().index("\n"):])
        self.assertRegex(self.given(maps, "--matched", status=1).stderr, "(?m)^error: 1: matched.OWN: .*-0.5.*leave out --matched")

    def test_those_in_an_hdf5_file_are_found_equal_and_a_changed_one_concerns_itself(self):
        self.salbench("run")
        alone, maps = self.results(), self.written()
        self.given(maps)
        self.assertEqual(self.computed(), 2 * 3 + 2, "map, matched map and scores of each mesh, the mean and the table")
        with h5py.File(self.folder / "own maps.h5", "w") as file:
            for path in maps.iterdir():
                file[path.stem] = np.array(path.read_text().split(), float)
        self.given(self.folder / "own maps.h5")
        self.expect_level()
        self.assertEqual(self.computed(), 2, "maps read again, found equal, and no further")
        (maps / "1.val").write_text("0.125\n" * 3 + "".join(f"{i}\n" for i in range(POINTS - 3)))
        self.given(maps)
        self.assertEqual(self.computed(), 3 + 2, "of one mesh")
        self.salbench("run")
        self.assertEqual((self.computed(), self.results()), (0, alone))

    def test_files_may_be_text_or_npy(self):
        """Two for one item fail it; files of no item may have any name."""
        written = self.written()
        self.given(written)
        before, maps = self.scores("OWN", *METRICS), self.folder / "maps/mixed"
        maps.mkdir()
        (maps / "1.TXT").write_text("saliency\n" + (written / "1.val").read_text())
        np.save(maps / "2.npy", np.array((written / "2.val").read_text().split(), float))
        self.write("maps/mixed/names.txt", "1\n")
        self.write("maps/mixed/names.csv", "1\n")
        self.given(maps)
        self.assertEqual(self.scores("OWN", *METRICS), before)
        self.write("maps/mixed/2.csv", "1\n")
        self.assertRegex(self.given(maps, status=1).stderr, "(?m)^error: 2: map.OWN: .*mixed/2.(csv|npy) and .*mixed/2.(csv|npy): keep one")
        shutil.copy(written / "2.val", maps)  # taken before the others
        self.given(maps)

    def test_a_scan_and_a_mesh_of_one_name_cannot_share_one(self):
        self.configure(SCANS)
        for file in ("Meshes/2.off", "Distributions/2.val"):
            os.rename(self.data / file, self.data / file.replace("2.", "1_1."))
        for item in ("1", "1_1"):
            self.write(f"own/{item}.val", "1\n" * POINTS)
        self.assertRegex(self.given(self.folder / "own", status=2).stderr, "own/1_1.val: .*scans: false")

    def test_what_is_wrong_with_one_is_said_in_one_line_and_the_others_are_scored(self):
        good = "".join(f"{i % 17}\n" for i in range(POINTS))
        self.write("own/1.val", good)
        for text, said in ((good + "3\n", f"2.val: {POINTS + 1} values, but the shape has {POINTS} points"), ("nan\n" + good[2:], "2.val:1"),
                           (None, "2.val")):
            if text is None:
                (self.folder / "own/2.val").unlink()
            else:
                self.write("own/2.val", text)
            lines = [line for line in self.given(self.folder / "own", status=1).stderr.splitlines() if line.startswith("error: ")]
            self.assertEqual(len(lines), 1, lines)
            self.assertRegex(lines[0], f"^error: 2: map.OWN: .*{said}")
            self.assertEqual((len(self.rows(model="OWN")), len(self.rows(model="PS"))), (1, 2))

    def test_a_record_is_run_again_with_further_ones(self):
        """With the maps and items that it had."""
        maps, second = self.written(), self.folder / "second"
        self.given(maps, "--items", "1")
        first = self.scores("OWN", *METRICS)
        for record, name in ((self.out, "TWO"), (second, "THREE")):
            self.said("run", record / "run.yaml", "--maps", maps, "--name", name, "--out", second)
            self.assertEqual(self.scores(name, *METRICS, folder=second), first)
        record = yaml.safe_load((second / "run.yaml").read_text())
        self.assertEqual([one["model"] for one in record["evaluated"]], ["OWN", "TWO", "THREE"])
        maps.rename(self.folder / "elsewhere")
        self.assertRegex(self.said("run", self.out / "run.yaml", status=2).stderr, "run.yaml:.*put the maps back")

    def test_a_constant_one_is_level_with_that_of_the_remarks(self):
        """By every metric."""
        self.configure("dataset: {scans: false}\nmodels: {PS: }\nmetrics: all\n")
        for item in "12":
            self.write(f"flat/{item}.val", "7\n" * POINTS)
        self.salbench("run", "--maps", self.folder / "flat", "--name", "FLAT")
        with open(self.out / "chance.csv", newline="") as file:
            remarks = {row["metric"]: row["remark"] for row in csv.DictReader(file) if row["dataset"] == "meshes"}
        self.assertEqual({metric for metric in self.record()["metrics"] if "FLAT (level)" not in remarks.get(metric, "")}, set())

    def test_items_with_ground_truth_are_enough(self):
        shape = (self.data / "Meshes/1.off").read_text().splitlines()
        (self.data / "Meshes/3.off").write_text("\n".join([*shape[:2], "0.01 0.02 0.5", *shape[3:]]) + "\n")
        maps = self.written()
        (maps / "3.val").unlink()
        self.given(maps)
        self.assertEqual(self.artefacts()["map.PS"], 3, "of the export")
        self.configure(MESHES.replace("scans: false", "scans: false, participants: simulated"))
        self.salbench("run", "--items", "scored")
        self.assertEqual(len(self.rows(item="3")), 2, "all have it where participants are simulated")
