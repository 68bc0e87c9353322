# SPDX-License-Identifier: GPL-3.0-or-later
"""scripts/slurm/submit with the real program and a stand-in for sbatch; slurm_test.sh has a real Slurm."""

import os
import shutil
import subprocess
import tempfile
import unittest
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[2]
SBATCH = """#!/bin/sh
for word; do printf '%s\\0' "$word"; done >> "$SUBMITTED"
printf '\\n' >> "$SUBMITTED"
echo "$(wc -l < "$SUBMITTED");cluster"
"""


class SlurmSubmitTest(unittest.TestCase):
    """Each test has a tree that holds copies of the scripts and, where submit expects it, the program under test."""

    def setUp(self):
        self.folder = Path(self.enterContext(tempfile.TemporaryDirectory(prefix="100% (toys) ")))
        shutil.copytree(SOURCE / "scripts/slurm", self.folder / "tree/scripts/slurm")
        program = self.folder / "tree/build/release/salbench"
        program.parent.mkdir(parents=True)
        program.symlink_to(os.environ["SALBENCH_PROGRAM"])
        self.work = self.folder / "my work (2)"
        self.work.mkdir()
        subprocess.run([SOURCE / "scripts/toy_meshes.py", self.work / "data set", "1", "16", "8"], check=True)
        (self.work / "toy set (a).yaml").write_text(
            "dataset: {layout: folder, participants: simulated, scans: false}\nmodels: {PS: }\n")
        tools = self.folder / "tools"
        tools.mkdir()
        (tools / "sbatch").write_text(SBATCH)
        (tools / "sbatch").chmod(0o755)
        self.submitted = self.folder / "submitted"
        self.environment = {**os.environ, "PATH": f"{tools}:{os.environ['PATH']}", "SUBMITTED": str(self.submitted)}
        del self.environment["SALBENCH_PROGRAM"]  # the program is that of the tree, unless it names one

    def options(self, out):
        return ["--data", "data set", "--cache", "cache", *(["--out", out] if out else [])]

    def submit(self, *arguments):
        return subprocess.run([self.folder / "tree/scripts/slurm/submit", *arguments], cwd=self.work,
                              env=self.environment, capture_output=True, text=True)

    def jobs(self):
        """The words of each call of sbatch."""
        return [line.split("\0")[:-1] for line in self.submitted.read_text().splitlines()]

    def logs_and_folders(self, out):
        """Where the two jobs log, and what the folder of results is by the last line of submit's first sentence."""
        self.submitted.unlink(missing_ok=True)
        done = self.submit("toy set (a).yaml", "--tasks", "2", "--", *self.options(out))
        self.assertEqual(done.returncode, 0, done.stderr)
        logs = [word.removeprefix("--output=").replace("%%", "%") for job in self.jobs() for word in job
                if word.startswith("--output=")]
        return logs, done.stdout.splitlines()[0].split(" writes the tables to ")[1]

    def test_jobs_log_into_the_results_folder_before_and_after_a_run(self):
        for out, folder in ((None, "salbench-out/toy set (a)"), ("a; results: b", "a; results: b"), ("50% (partial, 1 of 2)/x ", "50% (partial, 1 of 2)/x ")):
            expected = str(self.work / folder)
            with self.subTest(out=out):
                names = [expected + "/slurm/%A_%a.log", expected + "/slurm/merge_%j.log"]
                self.assertEqual(self.logs_and_folders(out), (names, expected))
                ran = subprocess.run([os.environ["SALBENCH_PROGRAM"], "run", "toy set (a).yaml", "--quiet", *self.options(out)],
                                     cwd=self.work, capture_output=True, text=True)
                self.assertEqual(ran.returncode, 0, ran.stderr)
                self.assertEqual(self.logs_and_folders(out), (names, expected))
                self.assertFalse(os.path.exists(expected + " (finished)"))

    def test_the_jobs_are_an_array_and_one_that_follows_it_with_the_options_of_the_run(self):
        done = self.submit("toy set (a).yaml", "--tasks=3", "--restarts", "7", "--time=1:00", "--", "--threads", "2", "--quiet", *self.options("o u t"))
        self.assertEqual(done.returncode, 0, done.stderr)
        array, merge = self.jobs()
        self.assertIn("--array=1-3", array)
        self.assertIn("--dependency=afterany:1", merge)
        for job in (array, merge):
            self.assertIn("--time=1:00", job)
            script = job.index(str(self.folder / "tree/scripts/slurm/submit"))
            self.assertEqual(job[script + 1:], ["--job", os.path.realpath(os.environ["SALBENCH_PROGRAM"]), "3", "7",
                                                str(self.work / "toy set (a).yaml"), "--threads", "2", "--quiet", *self.options("o u t")])

    def test_what_cannot_run_is_refused_and_nothing_is_submitted(self):
        for named, *further in (("nothing.yaml", "--tasks", "4"), ("--tasks", "--tasks=0"), ("--tasks",), ("--array", "--tasks", "4", "--array=1-9"),
                                ("--threads", "--tasks", "4", "--", *self.options("out"), "--threads"), ("data set", "--tasks", "4"),
                                ("'--shrad'", "--tasks", "4", "--", *self.options("out"), "--shrad", "1/2")):
            with self.subTest(further):
                done = self.submit("nothing.yaml" if named == "nothing.yaml" else "toy set (a).yaml", *further)
                self.assertEqual((done.returncode, named in done.stderr), (2, True), done.stderr)
                self.assertFalse(self.submitted.exists())
