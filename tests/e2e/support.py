# SPDX-License-Identifier: GPL-3.0-or-later
"""The program over two meshes with ground truth, as the Schelling study has them, and what its runs leave."""

import csv
import ctypes
import os
import shutil
import signal
import struct
import sys
import tempfile
import unittest
from collections import Counter
from pathlib import Path

import h5py
import yaml

import native
import salbench.conclusions  # noqa: F401  and with it libraries that each run would import
from tests.support import forked, toy_data
from tests.support.cache_files import segments

MESHES = "dataset: {scans: false}\nmodels: {PS: , RS: }\n"
SCANS = "scan: {step_degrees: 1}\nmodels: {PS: , RS: }\n"
VIEWS, POINTS = 12, 128  # of each mesh
MEMORY = toy_data.MEMORY
CLAIMS = "claims"
_FOLDERS = {"run": ("data", "cache", "out"), "plan": ("data", "cache", "out"), "export": ("data", "cache"), "verify": ("data", "cache"),
            "gc": ("data", "cache"), "config": ()}


class Workspace(unittest.TestCase):
    CONFIG = MESHES

    @classmethod
    def setUpClass(cls):
        cls.shared = Path(cls.enterClassContext(tempfile.TemporaryDirectory(dir=MEMORY)))
        toy_data.study(cls.shared, (1, 2))

    def setUp(self):
        self.folder = Path(self.enterContext(tempfile.TemporaryDirectory(dir=MEMORY, prefix="with a blank ")))
        self.data, self.cache, self.out, self.config = (self.folder / name for name in ("data set", "cache", "out", "toy.yaml"))
        shutil.copytree(self.shared, self.data)
        self.configure(self.CONFIG)

    def write(self, name, text=""):
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
        return path

    def configure(self, text):
        self.config.write_text(text)

    def salbench(self, verb, *words, status=0, before=None):
        """`salbench VERB CONFIG WORDS` over the folders, unless others are named."""
        return self.said(*self.line(verb, *words), status=status, before=before)

    def line(self, verb, *words):
        folders = {"data": self.data, "cache": self.cache, "out": self.out}
        over = []
        for name in _FOLDERS[verb]:
            if f"--{name}" not in words and not (name == "out" and "--graph" in words):
                over += [f"--{name}", folders[name]]
        return [verb, self.config, *words, *over]

    def started(self, verb, *words, **environment):
        """The same by the program itself, which can be ended."""
        process = native.started([native.PROGRAM, *self.line(verb, *words)], **environment)
        self.addCleanup(self.end, process)
        return process

    def end(self, process):
        if process.returncode is None:
            process.kill()
            process.communicate()

    def holding(self, items, verb="run", moment="3 before"):
        """A call over these items, stopped while it stores what it made of the first, which stays claimed until the call is ended."""
        into = ("--reference", "items", "--out", self.folder / "held") if verb == "run" else ("--to", self.folder / "held.h5")
        process = self.started(verb, "--items", items, "--threads", "1", *into, **native.at_rename(moment, signal.SIGSTOP))
        os.waitid(os.P_PID, process.pid, os.WSTOPPED | os.WEXITED | os.WNOWAIT)
        claims = f":{(self.cache / CLAIMS).stat().st_ino} "
        self.assertTrue([lock for lock in Path("/proc/locks").read_text().splitlines() if claims in lock and "WRITE" in lock])
        return process

    def tries_to_claim(self, process, times):
        """Waits until work has been claimed, or tried to be, so many more times; False where the process ends. Each try opens the file of claims."""
        opened, closed = 0x20, 0x08  # IN_OPEN, IN_CLOSE_WRITE take turns: the kernel merges equal events
        libc, seen = ctypes.CDLL(None), 0
        with open(libc.inotify_init1(os.O_NONBLOCK), "rb", buffering=0) as watch:
            self.assertGreater(libc.inotify_add_watch(watch.fileno(), os.fsencode(self.cache / CLAIMS), opened | closed), 0)

            def tried():
                nonlocal seen
                for _, mask, _, _ in struct.iter_unpack("iIII", watch.read(16 * 1024) or b""):  # of a file: no name follows
                    seen += bool(mask & opened)
                return seen >= times
            return native.soon(tried, process)

    def said(self, *words, status=0, before=None):
        done = forked.salbench(*words, before=before)
        self.assertEqual(done.returncode, status, f"{words}\n{done.stderr}")
        return done

    def fails(self, *words, status=1, **more):
        """The lines of errors."""
        return [line for line in self.salbench("run", *words, status=status, **more).stderr.splitlines() if line.startswith("error: ")]

    def forget(self):
        for folder in (self.cache, self.out):
            shutil.rmtree(folder, ignore_errors=True)

    def record(self):
        return yaml.safe_load((self.out / "run.yaml").read_text(errors="replace"))

    def computed(self):
        return self.record()["artefacts_computed"]

    def results(self):
        return (self.out / "results.csv").read_bytes()

    def rows(self, table="results", folder=None, **wanted):
        """Rows with these cells, each a dict."""
        with open((folder or self.out) / f"{table}.csv", encoding="utf-8", newline="") as file:
            return [row for row in csv.DictReader(file) if all(row[column] == cell for column, cell in wanted.items())]

    def scores(self, model, *columns, folder=None):
        """Scores of each shape."""
        return [[row[column] for column in ("dataset", "item", "view", *columns)] for row in self.rows(folder=folder, model=model)]

    def artefacts(self):
        """Number of artefacts by stage."""
        count = Counter()
        for path in segments(self.cache):
            with h5py.File(path) as file:
                count.update({stage: len(file[stage]) for stage in file})
        return count


def without(library):
    """In the process of a run: what conclusions need is not installed."""
    for name in [*sys.modules]:
        if name.startswith("salbench.conclusions") or name.partition(".")[0] in (library, "pandas"):
            del sys.modules[name]
    if hasattr(salbench, "conclusions"):
        del salbench.conclusions
    sys.modules[library] = None
