# SPDX-License-Identifier: GPL-3.0-or-later
"""`import` and `inspect`, ended while their workers read: no process and no scratch folder is left, and the next call makes the whole set."""

import os
import shutil
import signal
import subprocess
import sys

import salbench
from support import WithArchive, lines, off
from tests.support.stopped import Stopped

READING = """
from salbench import _workers
_workers._START = HERE + '''
import sys
sys.path.insert(0, sys.argv[1])
from salbench.datasets import sets, worker
sets.read = before(sets.read)
sys.exit(worker.main(int(sys.argv[2])))
'''
"""
ITEMS = ("cat", "cow", "dog", "eel", "fly", "gnu")


class Ended(WithArchive):
    def setUp(self):
        super().setUp()
        for name in ITEMS:
            self.write({f"Meshes/{name}.off": off(), f"Distributions/{name}.val": lines([1, 2, 3, 4]), f"RawData/{name}_0.pid": lines([0, 3])})
        self.to = self.root.parent / "to"

    def words(self, command):
        return [command, "zaragoza", "--data", str(self.root), *(["--to", str(self.to)] if command == "import" else [])]

    def done(self, command, **environment):
        line = [sys.executable, "-P", "-m", "salbench", *self.words(command)]
        done = subprocess.run(line, capture_output=True, text=True, env=os.environ | environment)
        self.assertEqual((done.returncode, done.stderr.count("Traceback")), (0, 0), done.stderr)
        return done.stdout

    def files(self):
        return {str(path.relative_to(self.to)): path.read_bytes() for path in self.to.rglob("*") if path.is_file()}

    def test_by_a_signal_that_asks(self):
        """What is being read is read to its end."""
        for command in ("import", "inspect"):
            for number, to_all in ((signal.SIGINT, True), (signal.SIGTERM, False), (signal.SIGHUP, False)):
                shutil.rmtree(self.to, ignore_errors=True)
                with self.subTest(command, number=number), Stopped(READING, *self.words(command)) as call:
                    call.signal(number, to_all)
                    call.go()
                    status, errors = call.ended()
                    self.assertEqual((status, call.scratch_left(), errors.count("Traceback")), (130, [], 0), errors)
                    self.assertIn(f"o go on:\n  salbench {' '.join(self.words(command))}\n", errors)
                    if command == "import":
                        self.assertLess(0, len(salbench.Dataset("hdf5", self.to)))

    def test_by_force(self):
        self.done("import")
        whole = self.files()
        shutil.rmtree(self.to)
        shown = self.done("inspect")
        for command in ("import", "inspect"):
            with self.subTest(command), Stopped(READING, *self.words(command)) as call:
                call.signal(signal.SIGKILL)
                self.assertEqual(call.ended(), (-signal.SIGKILL, ""))
                self.assertNotEqual(call.scratch_left(), [])
                self.assertEqual(self.done(command, TMPDIR=str(call.scratch)) == shown, command == "inspect")
                self.assertEqual(call.scratch_left(), [])
        self.assertEqual(self.files(), whole)


if __name__ == "__main__":
    import unittest

    unittest.main()
