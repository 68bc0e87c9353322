# SPDX-License-Identifier: GPL-3.0-or-later
"""The native program, which needs no Python: it is what builds with a sanitizer run."""

import shutil
import signal
import tempfile
import unittest
from pathlib import Path

import native
from tests.support import toy_data

MESHES = "dataset: {scans: false}\nmodels: {PS: , RS: }\n"
TABLES = ("results.csv", "means.csv")


class Engine(unittest.TestCase):
    def setUp(self):
        self.folder = Path(self.enterContext(tempfile.TemporaryDirectory(dir=toy_data.MEMORY)))
        self.data, self.cache, self.out, self.config = (self.folder / name for name in ("data set", "cache", "out", "toy.yaml"))
        toy_data.study(self.data, (1, 2))
        native.without_symmetry(self.data)
        self.config.write_text("scan: {step_degrees: 1}\nmodels: {PS: , RS: }\n")

    def line(self, *further):
        return [native.ENGINE, self.config, self.data, self.cache, self.out, *further]

    def run_engine(self, *further, status=0, **environment):
        done = native.called(self.line(*further), **environment)
        self.assertEqual(done.returncode, status, done.stderr)
        return done

    def tables(self):
        return [(self.out / name).read_bytes() for name in TABLES]

    def state(self):
        return self.tables(), native.contents(self.cache), native.left_over(self.cache, self.out)

    def computed(self):
        return native.computed(self.out / "run.yaml")

    def forget(self):
        for folder in (self.cache, self.out):
            shutil.rmtree(folder, ignore_errors=True)

    def test_it_scores_the_data_set_and_computes_nothing_twice(self):
        run = self.run_engine()
        self.assertRegex(run.stdout, r"(?s)\nmeshes   auc        PS .*2 meshes: ")
        before = self.state()
        self.assertEqual((before[0][0].count(b"\nmeshes,1,"), self.computed(), before[2]), (2, len(before[1]), []))
        self.run_engine()
        self.assertEqual((self.computed(), self.state()), (0, before))
        self.forget()
        self.run_engine("1")
        self.assertEqual(self.state(), before, "by one thread")

    def goes_on(self, whole, moment, number):
        """Ends an engine by this signal at this rename, unless it finishes first, and checks that the next one continues. True if it was ended."""
        self.forget()
        done = native.called(self.line("1"), **native.at_rename(moment, number))
        if done.returncode == 0:
            return False
        self.assertEqual(done.returncode, -number if number == signal.SIGKILL else 130, done.stderr)
        self.assertFalse(number != signal.SIGKILL and (self.out / "results.csv").exists())
        stored = len(native.contents(self.cache))
        self.run_engine()
        self.assertEqual((self.computed(), self.state()), (len(whole[1]) - stored, whole))
        return True

    def test_interrupted_it_goes_on_from_there(self):
        self.run_engine()
        whole = self.state()
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGKILL):
            with self.subTest(number):
                self.assertTrue(self.goes_on(whole, "5 after", number))

    def test_killed_at_each_rename_nothing_is_lost_that_had_its_name(self):
        """Every moment at which a file comes into being, hit from either side."""
        self.config.write_text(MESHES)
        self.run_engine()
        whole = self.state()
        for side in ("before", "after"):
            at = 1
            while self.goes_on(whole, f"{at} {side}", signal.SIGKILL):
                at += 1
            self.assertGreater(at, 6, "segments and tables")

    def test_a_bad_item_costs_itself_alone(self):
        self.config.write_text(MESHES)
        (self.data / "Meshes/2.off").write_text("OFF\n1 2\n")
        self.assertEqual(self.run_engine(status=1).stderr.count("error: 2: mesh: "), 1)
        self.assertEqual(self.tables()[0].count(b"\nmeshes,1,"), 2)

    def test_what_it_cannot_do_is_refused(self):
        """In one line, before anything is written."""
        for further, text, named in (
                (("2", "3"), "", "CONFIG DATA CACHE OUT"), *(((threads,), "", f"THREADS is {threads}") for threads in ("0", "many", "-1", "2000")),
                ((), 'models: {PS: , MINE: {command: "cp {mesh} {out}"}}\n', "models.MINE"),
                ((), "dataset: {layout: sal3d}\nmodels: {PS: }\n", "'sal3d'"),
                ((), "models: {NOSUCH: }\n", "toy.yaml:1: ")):
            with self.subTest(named):
                self.config.write_text(text or MESHES)
                done = self.run_engine(*further, status=2)
                self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
                self.assertIn(named, done.stderr)
        self.assertIn("CONFIG DATA CACHE OUT", native.called([native.ENGINE]).stderr)
        self.assertFalse(self.cache.exists() or self.out.exists())

    def test_a_folder_that_cannot_be_made_is_named(self):
        self.cache.write_text("")
        errors = [line for line in self.run_engine(status=3).stderr.splitlines() if line.startswith("error: ")]
        self.assertEqual(len(errors), 1, errors)
        self.assertIn(str(self.cache), errors[0])
