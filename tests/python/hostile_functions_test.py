# SPDX-License-Identifier: GPL-3.0-or-later
"""Functions that do what none should, a row each: the run says so, or ends with them, and the next one over the same cache comes to the same bytes."""

import os
import re
import signal
import sys

import salbench.runs.results  # noqa: F401: there before each process starts
import salbench.runs.run  # noqa: F401
import toy
from tests.support import forked

PROGRAM = """
import ctypes, os, shutil, signal, sys, threading, time
import numpy as np
import salbench
data, cache, out = sys.argv[1:]
def recurse():
    recurse()
class Lying:
    def __len__(self): return 10**9
    def __getitem__(self, i): return 1.0
class Raising:
    def __array__(self, *_, **__): raise OSError("no array")
def predict(shape):
    if shape.id == "2":
        {body}
    return shape.points[:, 2].copy()
try:
    results = salbench.run({{"dataset": {{"layout": "folder", "participants": "simulated", "scans": False}}}}, data=data, cache=cache, out=out, progress=False,
                           models={{"MINE": salbench.Model(predict, version={version}), "CB": {{}}}})
    print("failed:", sorted({{f"{{row.item}} {{row.stage}} {{row.cause.splitlines()[0]}}" for row in results.failures}}))
except BaseException as error:
    print("raised:", type(error).__name__, error)
"""
FAILED = r"failed: \['2 map.MINE MINE\(\) raised "
NO_MAP = r"failed: \['2 map.MINE .*(the map must|real numbers|array)"
# Action: exit status and output; None: not checked.
ROWS = {
    "raise BaseException('x')": (0, r"(failed: \['2 map.MINE .*BaseException|raised: BaseException)"),
    "raise SystemExit(3)": (0, r"(failed: \['2 map.MINE .*SystemExit|raised: SystemExit)"),
    "raise MemoryError": (0, FAILED + "MemoryError"),
    "recurse()": (0, FAILED + "RecursionError"),
    "os._exit(5)": (5, None), "os.kill(os.getpid(), signal.SIGKILL)": (-9, None), "ctypes.string_at(0)": (-11, None),
    "return np.broadcast_to(1.0, 10**13)": (0, NO_MAP), "return np.zeros(1 << 30, np.float16)": (0, NO_MAP),
    "return Lying()": (0, r"failed: .*the map has 1000000000 elements: give an array of NumPy"),
    "return Raising()": (0, r"failed: \['2 map.MINE "), "return (x for x in shape.points)": (0, NO_MAP),
    "return np.ma.masked_all(len(shape))": (0, None), "return {0: 1}": (0, NO_MAP), "return shape": (0, NO_MAP),
    "shape.points[:] = 0": (0, FAILED + "ValueError"), "shape.points.flags.writeable = True; shape.points[:] = 0": (0, None),
    "shape.id = '1'": (0, r"failed: .*raised FrozenInstanceError"),
    "[threading.Thread(target=time.sleep, args=(.01,)).start() for _ in range(50)]": (0, r"failed: \[\]"),
    "os.chdir('/')": (0, r"failed: \[\]"), "shutil.rmtree(cache)": (0, None),
    "shutil.rmtree(out, ignore_errors=True)": (0, r"failed: \[\]|raised: StorageError .*cannot be written to"),
    "os.environ.clear()": (0, r"failed: \[\]"), "sys.stdout.close(); sys.stdout = sys.stderr": (0, None), "sys.setrecursionlimit(50)": (0, None),
    "sys.modules.pop('salbench')": (0, None), "globals().clear()": (None, None),
}


class HostileFunctions(toy.InAFolder):
    def setUp(self):
        super().setUp()
        self.meshes = toy.meshes(self.folder / "meshes", 3)

    def ended(self, body, version, name):
        words = [str(self.folder / part) for part in ("meshes", f"cache {name}", f"out {name}")]

        def work():
            signal.signal(signal.SIGSEGV, signal.SIG_DFL)  # a sanitizer would end the process with a status of its own
            os.chdir(self.folder)
            sys.argv[1:] = words
            exec(PROGRAM.format(body=body, version=version), {"__name__": "hostile"})
            sys.exit(0)

        return forked.salbench(before=work)

    def results(self, name):
        return (self.folder / f"out {name}/results.csv").read_bytes()

    def test_each_is_told_or_ends_with_the_run(self):
        self.assertEqual(self.ended("pass", 2, "sound").stdout, "failed: []\n")
        sound = self.results("sound")
        for number, (body, (status, said)) in enumerate(ROWS.items()):
            with self.subTest(body):
                done = self.ended(body, 1, number)
                if status is not None:
                    self.assertEqual(done.returncode, status, done.stderr)
                if said is not None:
                    self.assertRegex(done.stdout, said)
                self.assertIsNone(re.search("defect|Assertion|terminate called", done.stdout + done.stderr), done.stderr)
                if done.returncode or not done.stdout.startswith("failed: ['2 map.MINE "):  # what else it may have harmed
                    again = self.ended("pass", 2, number)
                    self.assertEqual((again.returncode, again.stdout), (0, "failed: []\n"), again.stderr)
                    self.assertEqual(self.results(number), sound)
