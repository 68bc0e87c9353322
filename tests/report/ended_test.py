# SPDX-License-Identifier: GPL-3.0-or-later
"""A call that is ended in the middle of drawing leaves no process and no scratch folder, and the next one makes what it would have made."""

import os
import signal
import subprocess
import sys
import unittest

import fixture
import support
from folder_test import files_of
from tests.support.stopped import MAIN, Stopped

# Shapes are drawn, figures are not: those take most of the time, and it is shapes that are drawn in several processes.
QUICK = "from salbench.report import drawing, style\ndrawing.Drawing.real = lambda _: None\nstyle.save = lambda _, *files: [file.touch() for file in files]\n"
DRAWING = QUICK + "from salbench.report import shape_files\nshape_files.draw = before(shape_files.draw)"
ITEMS = fixture.eight_meshes()[:2]


class Ended(support.ReportTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.out = cls.folder / "out"
        fixture.write_results(cls.out, ITEMS, ("LS", "RS"), results=fixture.results_table(ITEMS, ("LS", "RS"), views=1))
        fixture.write_export(cls.out / "shapes.h5", ITEMS, ("LS",), views=1, size=32)
        made = subprocess.run(cls.line("anew"), capture_output=True, text=True)
        assert (made.returncode, made.stderr) == (0, ""), made.stderr
        cls.anew = files_of(cls.folder / "anew")

    @classmethod
    def words(cls, name):
        return [*map(str, ("report", cls.out, "--processes", "2", "--to", cls.folder / name))]

    @classmethod
    def line(cls, name):
        return [sys.executable, "-P", "-B", "-c", QUICK + MAIN, *cls.words(name)]

    def started(self, name, **environment):
        return subprocess.Popen(self.line(name), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=os.environ | environment)

    def expect_anew(self, name, **environment):
        process = self.started(name, **environment)
        self.assertEqual((process.communicate()[1], process.returncode), ("", 0))
        files = files_of(self.folder / name)
        self.assertEqual(sorted(files), sorted(self.anew))
        self.assertEqual([path for path in files if files[path] != self.anew[path]], [])

    def test_by_a_signal_that_asks(self):
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            for to_all in (False, True):
                with self.subTest(number, to_all=to_all), Stopped(DRAWING, *self.words("asked")) as call:
                    call.signal(number, to_all)
                    status, errors = call.ended()
                    self.assertEqual((status, call.scratch_left(), errors.count("\n")), (130, [], 3), errors)
                    self.assertIn(f"\n  salbench {' '.join(self.words('asked'))}\n", errors)
        self.expect_anew("asked")

    def test_by_force(self):
        with Stopped(DRAWING, *self.words("killed")) as call:
            call.signal(signal.SIGKILL)
            self.assertEqual(call.ended(), (-signal.SIGKILL, ""))
            self.assertEqual(len(call.scratch_left()), 1)
            self.expect_anew("killed", TMPDIR=str(call.scratch))
            self.assertEqual(call.scratch_left(), [])

    def test_while_modules_are_imported(self):
        """Where the interpreter's own hook stops it, the program has handed over."""
        call = Stopped("", *self.words("imports"), line=[os.environ["SALBENCH_PROGRAM"]], PYTHONPATH=str(self.folder))
        (self.folder / "sitecustomize.py").write_text(f"{call.here}\nhere()\n")
        with call:
            call.signal(signal.SIGINT)
            call.go()
            status, errors = call.ended()
        self.assertEqual((status, errors.count("Traceback")), (130, 0), errors)

    def test_a_second_call_waits_for_the_first(self):
        with Stopped(DRAWING, *self.words("both")) as first:
            second = self.started("both")
            self.assertIn("another call writes to this folder; waiting for its end", second.stderr.readline())
            first.go()
            self.assertEqual(first.ended(), (0, ""))
            self.assertEqual((second.communicate()[1], second.returncode), ("", 0))
        self.expect_anew("both")


if __name__ == "__main__":
    unittest.main()
