# SPDX-License-Identifier: GPL-3.0-or-later
"""`submit` and `leaderboard`, ended while an archive is checked, and two of them at once: no process, no scratch folder and no half of a file
is left, and the next call writes what it would have written."""

import os
import shutil
import signal
import tempfile
import unittest
from pathlib import Path

import toy
from tests.support.stopped import Stopped

CHECKING = """
from salbench.leaderboard import submission
submission._START = HERE + '''
import sys
sys.path.insert(0, sys.argv[1])
from salbench.leaderboard import submission
submission._checked = before(submission._checked)
sys.exit(submission.main(int(sys.argv[2])))
'''
"""


class Ended(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        holder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(holder.cleanup)
        cls.toy = toy.Toy(Path(holder.name))
        cls.mine = cls.toy.maps("G0", 0.5)
        cls.file = cls.toy.submissions / "G0.zip"
        assert cls.toy.submit("G0", 0.5).returncode == 0
        assert cls.toy.rank().returncode == 0
        cls.archive, cls.site = cls.file.read_bytes(), toy.everything(cls.toy.site)

    def setUp(self):
        self.file.write_bytes(self.archive)
        shutil.rmtree(self.toy.site, ignore_errors=True)

    def words(self, command):
        what = (self.mine, "--to", self.file) if command == "submit" else (self.toy.submissions, "--to", self.toy.site)
        return [*map(str, (command, *what, "-c", self.toy.config, "--data", self.toy.data, "--cache", self.toy.folder / "cache", "--threads", "2"))]

    def expect_as_before(self, command, **environment):
        done = self.toy.salbench(*self.words(command)[:6], env=os.environ | environment)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(os.listdir(self.toy.submissions), ["G0.zip"])
        self.assertEqual(self.file.read_bytes(), self.archive)
        if command == "leaderboard":
            self.assertEqual(toy.everything(self.toy.site), self.site)

    def test_by_a_signal_that_asks(self):
        for command in ("submit", "leaderboard"):
            for number, to_all in ((signal.SIGINT, True), (signal.SIGTERM, False), (signal.SIGHUP, False)):
                with self.subTest(command, number=number), Stopped(CHECKING, *self.words(command)) as call:
                    call.signal(number, to_all)
                    status, errors = call.ended()
                    self.assertEqual((status, call.scratch_left(), errors.count("Traceback")), (130, [], 0), errors)
                    self.assertIn("To go on:\n  salbench " + " ".join(self.words(command)[:2]), errors)
            self.expect_as_before(command)

    def test_by_force(self):
        for command in ("submit", "leaderboard"):
            with self.subTest(command), Stopped(CHECKING, *self.words(command)) as call:
                call.signal(signal.SIGKILL)
                self.assertEqual(call.ended()[0], -signal.SIGKILL)
                self.assertNotEqual(call.scratch_left(), [])
                self.expect_as_before(command, TMPDIR=str(call.scratch))
                self.assertEqual(call.scratch_left(), [])

    def test_two_submit_at_once(self):
        self.file.unlink()
        with Stopped(CHECKING, *self.words("submit")) as first:
            self.expect_as_before("submit")
            first.go()
            self.assertEqual(first.ended()[0], 0)
        self.expect_as_before("submit")


if __name__ == "__main__":
    unittest.main()
