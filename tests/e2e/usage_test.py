# SPDX-License-Identifier: GPL-3.0-or-later
"""Arguments and configurations: the exit status says who has to act, one line what is wrong; and what each subcommand prints of a sound run."""

import contextlib
import fcntl
import os
import pty
import shlex
import signal
import struct
import subprocess
import sys
import termios
from collections import Counter
from unittest import mock

from salbench.system.progress import Progress
from support import MESHES, Workspace
from tests.support import toy_data

OVER = "--data data --cache cache --out out"
# Words of the subcommand in a folder with a data set and the files of `setUp`; and what the line names.
UNUSABLE = {
    "": "", "run": "CONFIG", "rnu toy.yaml": "there is no subcommand 'rnu'; did you mean 'run'", "run toy.yaml --item 1": "did you mean '--items'",
    "status toy.yaml": "there is no status any more: salbench plan", f"run toy.yaml {OVER} more": "more",
    f"run none.yaml {OVER}": "none.yaml", f"run tyo.yaml {OVER}": "did you mean 'toy'", f"run wrong.yaml {OVER}": "wrong.yaml:2: ",
    f"run ended/run.yaml {OVER}": "is the record of a run that was ended", f"run described.yaml {OVER}": "no longer described in YAML",
    f"run toy.yaml {OVER} --data nowhere": "given twice", "run toy.yaml --data nowhere --cache cache --out out": "no such folder in /",
    "run toy.yaml --data empty --cache cache --out out": "empty", f"run toy.yaml {OVER} --items 1,7": "no item '7'",
    f"run toy.yaml {OVER} --items ,": "no item",
    f"run toy.yaml {OVER} --split test": "the data set has no splits", f"run toy.yaml {OVER} --models NOSUCH": "NOSUCH",
    f"run toy.yaml {OVER} --maps mine --name rs": "rs", f"run toy.yaml {OVER} --maps mine --name 'a b'": "letters",
    f"run toy.yaml {OVER} --maps empty --name OWN": "such as empty/1.val", f"run toy.yaml {OVER} --maps cases --name OWN": "differ by case alone",
    f"run toy.yaml {OVER} --maps none.h5 --name OWN": "none.h5", f"run toy.yaml {OVER} --reference bad.csv": "bad.csv:3: ",
    f"run toy.yaml {OVER} --reference none.csv": "none.csv", f"run toy.yaml {OVER} --reference negative.csv": "negative.csv:3: ",
    f"run toy.yaml {OVER} --reference zeros.csv": "sums to 0", f"run toy.yaml {OVER} --reference short.csv": "99 rows",
    f"run toy.yaml {OVER} --reference scores.csv": "GS",
    f"plan toy.yaml {OVER} 3000": "3000", f"plan toy.yaml {OVER} 1 map.NOSUCH": "map.NOSUCH", f"plan toy.yaml {OVER} --format dot": "--graph",
    f"run parts.yaml {OVER}": "parts.yaml:3: ", f"run leading.yaml {OVER}": "did you mean 'auc'", f"run kept {OVER}": "did you mean 'kept/run.yaml'",
    "run toy.yaml --data bad.csv --cache cache --out out": "is a file", "run toy.yaml --data '$HOME' --cache cache --out out": "whole path",
    "run classes.yaml --data data/Meshes --cache cache --out out": "no item has a class", f"plan toy.yaml {OVER} 1 map.SP": "did you mean 'map.PS'",
    "gc --cache cache": "name the configurations to keep", "gc --stage map": "of a --cache",
    "verify": "name a configuration", "conclude kept/toy.yaml": "", "conclude scores.csv --unit view": "view",
    "export toy.yaml --data data --cache cache --to x --stage maps": "'maps'",
    "export toy.yaml --data data --cache cache --to bad.csv": "no HDF5 file",
}
NO_STORAGE = {  # 3
    "run toy.yaml --data data --cache bad.csv --out out": "bad.csv", "run toy.yaml --data data --cache cache --out bad.csv/below": "bad.csv",
    "verify --cache empty": "empty", "gc toy.yaml --data data --cache empty": "empty", "gc --cache empty --stage map": "not a salbench cache",
}


class Usage(Workspace):
    def setUp(self):
        super().setUp()
        os.rename(self.data, self.folder / "data")
        self.data = self.folder / "data"
        for name, text in (("wrong.yaml", "seed: 7\nscann: {step_degrees: 1}\n"), ("described.yaml", "dataset: {layout: own.yaml}\n"),
                           ("ended/run.yaml", "# a run is under way, or was ended before its end\n"), ("own.yaml", "places: []\n"),
                           ("parts.yaml", "seed: 7\n---\nmodels: {RS: }\n"), ("leading.yaml", "statistics: {leading: AUC}\n"), ("kept/run.yaml", ""),
                           ("classes.yaml", "dataset: {scans: false}\nmodels: {RS: }\nstatistics: {unit: class}\n"),
                           ("empty/readme.txt", ""), ("mine/1.val", "1\n"), ("cases/1.val", "1\n"), ("cases/1.VAL", "1\n"), ("none.h5", "not HDF5"),
                           ("bad.csv", "GS\n1\nmany\n"), ("kept/toy.yaml", MESHES), ("scores.csv", "item,model,auc\n1,A,.5\n"),
                           ("negative.csv", "GS\n1\n-0.5\n" + "1\n" * 98), ("zeros.csv", "GS\n" + "0\n" * 100), ("short.csv", "GS\n" + "1\n" * 99)):
            self.write(name, text)
        self.before = sorted(map(str, self.folder.rglob("*")))

    def refused(self, status, rows):
        for words, said in rows.items():
            with self.subTest(words):
                done = self.said(*shlex.split(words), status=status, before=lambda: os.chdir(self.folder))
                (line,) = [line for line in done.stderr.splitlines() if not line.startswith("warning: ")]
                self.assertEqual((done.stdout, line[:7]), ("", "error: "))
                self.assertIn(said, line)
                left = sorted(str(path) for path in self.folder.rglob("*") if status == 2 or self.cache not in (path, *path.parents))
                self.assertEqual(left, self.before, "nothing is left behind")

    def test_what_is_unusable_from_the_start_is_refused(self):
        self.refused(2, UNUSABLE)

    def test_a_folder_that_cannot_be_used_is_named(self):
        self.refused(3, NO_STORAGE)

    def test_a_leading_tilde_is_the_home(self):
        self.configure("cache: ~/of mine\noutput: ~/tables\nmodels: [RS]\ndataset: {scans: no}\n")
        with mock.patch.dict(os.environ, HOME=str(self.folder)):
            self.said("run", self.config, "--data=~/data")
        self.assertTrue((self.folder / "tables/results.csv").is_file() and (self.folder / "of mine").is_dir())
        self.assertIn(f'data: "{self.data}"\n', (self.folder / "tables/run.yaml").read_text())
        with mock.patch.dict(os.environ):
            del os.environ["HOME"]
            self.assertIn("HOME is not set", self.said("run", self.config, "--data", self.data, status=2).stderr)

    def test_a_bar_fits_the_terminal(self):
        read, terminal = pty.openpty()
        self.addCleanup(os.close, read)
        fcntl.ioctl(terminal, termios.TIOCSWINSZ, struct.pack("HHHH", 24, 50, 0, 0))
        with open(terminal, "w") as stderr, mock.patch("sys.stderr", stderr), Progress(False) as progress:
            for done in (0, 1, 20_000):
                progress("evaluation", done, 20_000, "map.PS of 52_11")
        written = b""
        with contextlib.suppress(OSError):  # at the end of a terminal that was closed
            while piece := os.read(read, 9999):
                written += piece
        lines = written.decode().replace("\033[K", "").split("\r")
        self.assertEqual([line for line in lines if len(line.strip()) >= 50], [])
        self.assertIn("20000/20000 jobs", lines[-2])

    def test_help_and_version(self):
        self.assertIn("\nExit status: 0 ", self.said("--help").stdout)
        self.assertIn("--reference", self.said("run", "--help").stdout)
        self.assertRegex(self.said("--version").stdout, r"^salbench \d+\.\d+\.\d+\n.*oneTBB .*HDF5 .*Embree .*CGAL ")

    def test_the_package_is_that_of_the_program(self):
        """Modules of the user stay on the path, behind it."""
        self.write("modules/salbench.py", "raise SystemExit('not this one')\n")
        with mock.patch.dict(os.environ, PYTHONPATH=str(self.folder / "modules")):
            done = subprocess.run([toy_data.PROGRAM, "--help"], cwd=self.folder / "modules", capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_a_plan_changes_nothing_and_foretells_a_run(self):
        planned = self.salbench("plan").stdout
        self.assertRegex(planned, rf"(?s)map.PS.*\nresults: {self.out}\n[1-9]\d* jobs to do")
        self.assertFalse(self.cache.exists() or self.out.exists())
        progress = self.salbench("run").stderr
        self.assertRegex(progress, r"(?m)^evaluation: (\d+)/\1 jobs, ")
        before = sorted(self.folder.rglob("*"))
        self.assertRegex(self.salbench("plan").stdout, rf"\nlast run: finished\nresults: {self.out}\n0 jobs to do")
        self.assertNotIn("to compute", self.salbench("plan", "2").stdout.partition("\n")[2])
        self.configure("dataset: {scans: false}\nmodels: {PS: {absolute: true}}\n")
        one = self.salbench("plan", "2", "map.PS").stdout
        self.assertRegex(one, r"(?s)map.PS +to compute.*\n  - absolute: false\n  \+ absolute: true\n")
        self.assertNotIn("matched.PS", one)
        beside = "also in the cache, of no stage of this configuration: "
        own, every = (self.salbench("plan", *words).stdout for words in ((), ("--all",)))
        self.assertRegex(own, rf"(?m)^{beside}\d+ artefacts, [0-9.]+ MB, of .*map.RS, .*--all lists them")
        self.assertNotIn("\nmap.RS ", own)
        self.assertIn("\nmap.RS ", every)
        self.assertNotIn(beside, every)
        self.assertTrue(self.salbench("plan", "--graph", "--format", "dot").stdout.startswith("digraph salbench {"))
        self.assertEqual(sorted(self.folder.rglob("*")), before)

    def test_gc_removes_the_stages_that_are_named_and_no_others(self):
        self.salbench("run")
        before = self.artefacts()
        self.said("gc", "--cache", self.cache, "--stage", "map.PS")
        self.assertEqual(self.artefacts(), before - Counter({"map.PS": 2}))
        self.salbench("run")
        self.assertEqual(self.computed(), 2, "what was made of them comes out as before")
        self.salbench("gc", "--stage", "map,fpfh", "--dry-run")
        self.assertEqual(self.artefacts(), before)
        self.salbench("gc", "--stage", "map,fpfh")
        self.assertEqual(self.artefacts(), Counter({stage: n for stage, n in before.items() if stage not in ("map.PS", "map.RS", "fpfh")}))
        self.assertIn("there is no stage 'maps'", self.said("gc", "--cache", self.cache, "--stage", "maps", status=2).stderr)

    def test_what_is_odd_about_the_data_set_is_said_by_runs_alone(self):
        (self.data / "Distributions/9.val").write_text("1\n")
        odd = "ground truth without a mesh or point cloud: 9"
        for _ in range(2):
            self.assertEqual(self.salbench("run").stderr.count(odd), 1)
        self.assertEqual(len(self.record()["remarks"]) + str(self.record()).count(odd), 1)
        self.assertEqual(self.salbench("plan").stderr, "")

    def test_an_output_that_cannot_be_written_is_an_error_and_one_that_nobody_reads_is_none(self):
        def printing_to(file):
            os.dup2(file, 1)
            sys.stdout = open(1, "w", closefd=False)

        def full():
            printing_to(os.open("/dev/full", os.O_WRONLY))

        def unread():
            reading, writing = os.pipe()
            os.close(reading)
            printing_to(writing)

        for words in (("run",), ("plan",), ("config",)):
            with self.subTest(words):
                self.assertRegex(self.salbench(*words, status=3, before=full).stderr, "(?m)^error: standard output: .*No space left")
                self.assertNotIn("error: ", self.salbench(*words, status=-signal.SIGPIPE, before=unread).stderr)
        self.assertIn("last run: finished", self.salbench("plan").stdout)
        self.assertEqual(self.salbench("run", "--quiet", before=full).stdout, "")
        self.assertEqual(self.computed(), 0)

    def test_a_defect_is_not_the_users_fault(self):
        """A library is not what it was built with."""
        preloaded = os.environ["SALBENCH_NO_EMBREE"]
        self.configure("scan: {step_degrees: 1}\nmodels: {RS: }\n")
        words = ["run", self.config, "--data", self.data, "--cache", self.cache, "--out", self.out]
        with mock.patch.dict(os.environ, LD_PRELOAD=preloaded):
            done = subprocess.run([toy_data.PROGRAM, *words], capture_output=True, text=True)
        self.assertEqual(done.returncode, 70, done.stderr)
        self.assertRegex(done.stderr, "(?m)^error: 1_3: scan: a defect of salbench: Embree")
        self.assertEqual(len(self.rows(dataset="meshes")), 2, "the other items go on")
