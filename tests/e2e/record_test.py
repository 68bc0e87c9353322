# SPDX-License-Identifier: GPL-3.0-or-later
"""run.yaml and costs.csv: on which data a run was, how it is repeated, and what it took."""

import shutil
import subprocess

import h5py
from support import MESHES, POINTS, Workspace
from tests.support import toy_data
from tests.support.cache_files import segments


class Record(Workspace):
    def data_set(self, *words):
        self.salbench("run", *words)
        return self.record()["data_set"]

    def test_the_data_are_identified_by_their_content(self):
        found = self.data_set()
        self.assertEqual((found["folder"], found["layout"], found["meshes"], found["files"], found["participants"]),
                         (str(self.data), "schelling", 2, 10, [3, 3]))
        copy = self.folder / "copy"
        shutil.copytree(self.data, copy)
        self.assertEqual(self.data_set("--data", str(copy))["digest"], found["digest"], "wherever they lie")
        self.assertNotEqual(self.data_set("--items", "1")["digest"], found["digest"])
        (copy / "RawData/2_2.pid").unlink()
        fewer = self.data_set("--data", str(copy))
        self.assertEqual((fewer["participants"], fewer["digest"] == found["digest"]), ([2, 3], False))
        results = self.results()
        (copy / "RawData/2_2.pid").write_text("")  # as whoever was not there, one who picked nothing counts for nothing
        self.data_set("--data", str(copy))
        self.assertEqual(self.results(), results)

    def test_its_configuration_alone_repeats_the_run_in_its_folders(self):
        self.configure("protocol: text\nseed: 9\nscan: {step_degrees: 2}\nmodels: {RS: , PS: {absolute: false}}\n")
        self.salbench("run")
        results, record = self.results(), (self.out / "run.yaml").read_text()
        _, _, lines = record.partition("\nconfiguration:\n")
        self.configure("".join(line[2:] + "\n" for line in lines.splitlines() if line.startswith("  ")))
        shutil.rmtree(self.out)
        self.said("run", self.config)
        self.assertEqual((self.computed(), self.results()), (0, results))

    def test_remarks_on_odd_shapes_are_there_whether_they_were_read_now_or_before(self):
        self.salbench("run")
        self.assertEqual(self.record()["remarks"], [])
        mesh = self.data / "Meshes/2.off"
        head, counts, *rows = mesh.read_text().splitlines()
        mesh.write_text("\n".join([head, f"{POINTS + 1} {2 * POINTS} 0", *rows[:POINTS], "9 0 0", *rows[POINTS:]]) + "\n")
        truth = self.data / "Distributions/2.val"
        truth.write_text(truth.read_text() + "0\n")
        said = self.salbench("run").stderr
        for verb in ("run", "gc", "run"):
            (remark,) = self.record()["remarks"]
            self.assertEqual(remark["item"], "2")
            self.assertRegex(remark["remark"], rf"1 isolated vertices kept: no face uses them, the first is vertex {POINTS} .*; R is ")
            self.assertIn(f"warning: 2: {remark['remark'][:20]}", said)
            self.salbench(verb)
        self.assertEqual(self.computed(), 0)

    def test_what_a_run_took_and_how_its_metrics_read_maps(self):
        self.configure(MESHES + "metrics: {names: [nss, kl, sim, cc_area], matching: {sim: histogram}}\n")
        self.salbench("run")
        record = self.record()
        self.assertTrue(record["hdf5_seconds"]["held"] > 0 and record["hdf5_seconds"]["waited"] >= 0)
        read = {name: (metric["better"], metric["matching"], metric["weighting"]) for name, metric in record["metrics"].items()}
        self.assertEqual(read, {"nss": ("higher", "histogram", "equal"), "kl": ("lower", "none", "equal"), "sim": ("higher", "histogram", "equal"),
                                "cc_area": ("higher", "histogram", "area")})
        stored = 0
        for path in segments(self.cache):
            with h5py.File(path) as file:
                stored += sum(array.id.get_storage_size() for group in file.get("fpfh", {}).values() for array in group.values())
        self.assertEqual(record["cache_bytes"]["fpfh"], stored)
        self.salbench("run")
        self.assertEqual((self.computed(), self.record()["cache_bytes"]["fpfh"]), (0, stored), "those of the run, not what was computed")

    def test_memory_is_that_of_the_run_and_not_of_what_started_it(self):
        held = b"x" * 400_000_000
        words = ["run", self.config, "--data", self.data, "--cache", self.cache, "--out", self.out, "--quiet"]
        subprocess.run([toy_data.PROGRAM, *words], check=True, capture_output=True)
        self.assertTrue(5 < self.record()["peak_memory_mb"] < 400, self.record()["peak_memory_mb"])
        self.assertEqual(len(held), 400_000_000)

    def test_costs_are_those_of_the_time_when_maps_were_computed(self):
        command = "n=$(grep -a -m1 'element vertex' {mesh} | cut -d' ' -f3); seq $n > {out}"
        models = f'models: {{PS: , HS: , MINE: {{command: "{command}"}}}}\n'
        self.configure("dataset: {scans: false}\n" + models)
        self.salbench("run")
        costs = (self.out / "costs.csv").read_bytes()
        rows = self.rows("costs")
        self.assertEqual([*rows[0]][:7], ["dataset", "item", "view", "model", "seconds", "processor_seconds", "input_seconds"])
        self.assertEqual([(row["item"], row["model"]) for row in rows], [(item, model) for item in "12" for model in ("PS", "MINE")])
        for row in rows:
            self.assertGreater(float(row["seconds"]), 0)
            self.assertEqual(row["processor_seconds"] in ("", "nan"), row["model"] == "MINE", "that of a command is not known")
        self.assertRegex(self.salbench("run").stdout, "; 0 artefacts computed")
        self.assertEqual((self.out / "costs.csv").read_bytes(), costs)
        self.configure("dataset: {scans: false}\nmodels: {RS: , PS: }\n")
        self.salbench("run", "--items", "1")
        self.assertEqual(self.rows("costs", model="PS"), [rows[0]], "of a part, with another model beside")
