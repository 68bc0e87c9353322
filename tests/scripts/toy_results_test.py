# SPDX-License-Identifier: GPL-3.0-or-later
"""Scripts that read results, and those that make data of their own, over toys."""

import os
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SCRIPTS = ROOT / "scripts"
PROGRAM = Path(os.environ["SALBENCH_PROGRAM"])
PYTHON = ["/usr/bin/python3", "-B"]
sys.path.insert(0, str(ROOT / "tests/report"))

import browser  # noqa: E402
from tests.support import toy_data, without_figures  # noqa: E402


def ran(*command):
    """Output of a command that has to succeed."""
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, f"{command}: {done.returncode}\n{done.stdout[-2000:]}{done.stderr[-2000:]}"
    return done.stdout


class ToyResultsTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = Path(cls.enterClassContext(tempfile.TemporaryDirectory(prefix="toy results ")))
        cls.out, cls.export = folder / "out", folder / "out/shapes.h5"
        toy_data.meshes(folder / "meshes", 2, 24, 12)
        (folder / "toy.yaml").write_text("dataset: {layout: folder, participants: simulated}\nscan: {step_degrees: 1}\nmodels: {LS: , HS: , RS: }\n")
        options = [folder / "toy.yaml", "--data", folder / "meshes", "--cache", folder / "cache", "--quiet"]
        ran(PROGRAM, "run", *options, "--out", cls.out)
        ran(PROGRAM, "export", *options, "--to", cls.export, "--pictures")

    def test_pictures_of_the_report(self):
        report = self.out / "report"
        ran(without_figures.PROGRAM, "report", self.out, "--metrics", "auc")
        self.assertIn("</html>", (report / "shapes/1.html").read_text(encoding="utf-8"))
        if browser.AVAILABLE:
            ran(*PYTHON, SCRIPTS / "figures", "pictures", self.out.parent, self.out / "pictures")
            self.assertEqual([path.stat().st_size > 10_000 for path in (self.out / "pictures").glob("*.png")], [True] * 2)

    def test_compare(self):
        compare = [*PYTHON, SCRIPTS / "compare"]
        self.assertRegex(ran(*compare, self.export, self.export, "0"), r"\n\| `map.\*` \| (\d+) \| \1 \| 0 \| - \|\n")
        self.assertRegex(ran(*compare, self.out, self.out, "0"), r"\n\| the \d\d without a difference \| (\d+) \| \1 \| 0 \| - \|\n")
        other = self.out.with_name("other")
        shutil.copytree(self.out, other)
        table = (other / "summary.csv").read_text()
        (other / "summary.csv").write_text(table.replace("0.", "0.1", 1))
        done = subprocess.run([*compare, self.out, other], capture_output=True, text=True)
        self.assertEqual(done.returncode, 1)
        self.assertIn("| `summary.csv` |", done.stdout)


class OwnDataTest(unittest.TestCase):
    def test_scale(self):
        said = ran(*PYTHON, SCRIPTS / "scale", "--shapes", "1", "2", "--points", "100", "--threads", "1", "2", "--rounds", "1",
                   "--build", PROGRAM.parent)
        cost, cache = r" +\d+\.\d\d s wall +\d+\.\d\d s processor +\d+ MB\n", r"  cache +\d+ files, \d+ MB\n"
        measured, medians = said.split("\nmedians of 1\n")
        self.assertRegex(measured, rf"\n1/1: 2 meshes of 42 vertices\n(  (run|rerun|verify|item){cost}){{4}}{cache}"
                         rf"(  (all shares|a share again|merge){cost}){{3}}1/1: one mesh of \d+ vertices\n  run{cost}{cache}1/1: ")
        self.assertRegex(medians, rf"\n2 meshes of 42 vertices\n(  [a-z ]+{cost}){{7}}one mesh of \d+ vertices\n  run{cost}")
        self.assertRegex(medians, rf"(  \d threads{cost}){{2}}  the same bytes; times as fast as by 1: 1: 1\.00, 2: ")
        self.assertRegex(medians, r"\nfrom 1 to 2 shapes, and 1000000 on paper\n(  .*exponents: wall .*\n){7}  each of 1000 tasks: .*\n$")

    def test_scale_tells_no_memory_that_it_held_itself(self):
        """A process counts as the one that starts it until it is the command, so that the peak of either may be what is told."""
        holding = ("import runpy, sys; held = b'1' * 300_000_000; sys.argv = sys.argv[1:]; "
                   f"sys.path.insert(0, {str(SCRIPTS)!r}); runpy.run_path(sys.argv[0], run_name='__main__')")
        done = subprocess.run([*PYTHON, "-c", holding, SCRIPTS / "scale", "--shapes", "1", "--points", "0", "--threads", "0", "--rounds", "1",
                               "--build", PROGRAM.parent], capture_output=True, text=True)
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stderr, r"^run: its memory is not known, since it is no more than the \d{6} KiB that scripts/scale has held itself\n$")

    def test_scale_over_some_items(self):
        with tempfile.TemporaryDirectory(prefix="toy study ") as folder:
            toy_data.study(Path(folder) / "SchellingData", (7,), 12, 6)
            said = ran(*PYTHON, SCRIPTS / "scale", folder, "--items", "7", "--threads", "1", "2", "--rounds", "1", "--build", PROGRAM.parent)
        self.assertRegex(said, r"1/1: .*\n(  \d threads .*\n    HDF5: 0\.\d\d s in the library, \d\.\d\d s waited, "
                         r"\d+\.\d\d % of the threads' time\n){2}")
        self.assertRegex(said, r"\nmedians of 1\n.*\n(  \d threads .*\n){2}  the same scores; times as fast as by 1: 1: 1\.00, 2: \d+\.\d\d\n$")

    def test_scale_against_another_program(self):
        with tempfile.TemporaryDirectory(prefix="toy study ") as folder:
            toy_data.study(Path(folder) / "SchellingData", (7,), 12, 6)
            said = ran(*PYTHON, SCRIPTS / "scale", folder, "--against", PROGRAM, "--items", "7", "--rounds", "1", "--build", PROGRAM.parent)
        self.assertRegex(said, r"\n  1 threads: the other takes \d\.\d{3} times as much processor time, by round from .*\n  2 threads: .*\n$")
