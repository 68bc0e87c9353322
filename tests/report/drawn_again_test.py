# SPDX-License-Identifier: GPL-3.0-or-later
"""A report made again draws what changed and nothing else, and has the bytes of one made anew by any number of processes."""

import errno
import json
import os
import shutil
import unittest
import unittest.mock

import h5py
import numpy

import fixture
import support
from folder_test import files_of
from salbench.report import shape_files, style
from salbench.report.folder import LEDGER

ITEMS = fixture.eight_meshes()[:3]


class DrawnAgain(support.ReportTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.out = cls.folder / "out"
        fixture.write_results(cls.out, ITEMS, results=fixture.results_table(ITEMS, views=2))
        fixture.write_export(cls.out / "shapes.h5", ITEMS[:2], views=2, size=48)
        cls.anew = files_of(cls.made("anew", 2))

    @classmethod
    def made(cls, name, processes=1, out=None):
        status, errors = support.make(out or cls.out, cls.folder / name, "--processes", processes)
        assert status == 0, errors
        return cls.folder / name

    def drawn(self, name, out=None):
        """Makes a report again in one process: the names of the shapes and the figures that are drawn."""
        shapes, figures = [], []

        def draw(work, original=shape_files.draw):
            shapes.append(work[0].shape.name)
            return original(work)

        def save(figure, svg, pdf, original=style.save):
            figures.append(svg.name.partition(".")[0])
            original(figure, svg, pdf)
        with unittest.mock.patch("salbench.report.shape_files.draw", draw), unittest.mock.patch("salbench.report.style.save", save):
            self.made(name, out=out)
        return shapes, figures

    def copied(self, name):
        shutil.copytree(self.folder / "anew", self.folder / name)
        return self.folder / name

    def expect_anew(self, name):
        files = files_of(self.folder / name)
        self.assertEqual(sorted(files), sorted(self.anew))
        self.assertEqual([path for path in files if files[path] != self.anew[path]], [])

    def test_any_number_of_processes_makes_the_same(self):
        self.made("one", 1)
        self.expect_anew("one")

    def test_nothing_is_drawn_twice(self):
        self.copied("again")
        self.assertEqual(self.drawn("again"), ([], []))
        self.expect_anew("again")

    def test_what_was_tampered_with_is_drawn_again(self):
        to = self.copied("tampered")
        picture, script = to / "pictures/1/mesh-LS-after.webp", to / "shapes/2_1.js"
        picture.write_bytes(picture.read_bytes()[:-1] + b"x")
        script.write_bytes(script.read_bytes()[:100])
        (to / "figures/human-curves.pdf").unlink()
        self.assertEqual(self.drawn("tampered"), (["1", "2_1"], ["human-curves"]))
        self.expect_anew("tampered")

    def test_a_changed_shape_and_a_changed_row_are_drawn_alone(self):
        to, out = self.copied("changed"), self.folder / "changed-out"
        shutil.copytree(self.out, out)
        with h5py.File(out / "shapes.h5", "r+") as file:
            file["1_0/map.LS/saliency"][0] += 0.25
        curve = (out / "human_curve.csv").read_text().splitlines(keepends=True)
        (out / "human_curve.csv").write_text("".join(curve[:-1]))
        shapes, figures = self.drawn("changed", out)
        self.assertEqual(shapes, ["1_0"])
        self.assertIn("human-curves", figures)
        self.assertTrue(set(figures) <= {"human-curves", "examples-scans"}, figures)
        self.assertNotEqual((to / "shapes/1_0.js").read_bytes(), self.anew["shapes/1_0.js"])

    def test_the_digest_that_an_export_has_of_an_artefact_is_believed(self):
        with h5py.File(self.folder / "digests.h5", "w") as file:
            for name, of_first in (("a", "00"), ("b", "00"), ("c", "01")):
                file[f"{name}/map.LS/saliency"] = numpy.arange(3.0) + ord(name)
                file[f"{name}/map.LS"].attrs["content"] = of_first
            found = [shape_files.content(file[name], "map.LS") for name in "abc"]
        self.assertEqual(found, [["00"], ["00"], ["01"]])

    def test_a_call_that_was_ended_is_gone_on_with(self):
        self.copied("ended")
        with unittest.mock.patch("salbench.report.front.front", side_effect=KeyboardInterrupt):
            self.assertEqual(support.make(self.out, self.folder / "ended")[0], 130)
        (self.folder / "ended" / "pictures/1/mesh-LS-before.webp.part").write_text("half of a")
        with open(self.folder / "ended" / LEDGER, "a") as ledger:
            ledger.write('["cut')
        self.assertEqual(self.drawn("ended"), ([], []))
        self.assertEqual({path.name for path in (self.folder / "ended").rglob("*.part")}, set())
        self.expect_anew("ended")

    def test_a_ledger_leads_to_no_other_file(self):
        to, precious = self.copied("spoilt"), self.folder / "precious"
        precious.write_text("years of work")
        lines = (to / LEDGER).read_text().splitlines()
        spoilt = [json.dumps([*json.loads(line)[:2], ["../precious", str(precious)], None]) for line in lines]
        (to / LEDGER).write_text("\n".join([*spoilt, "3", "[]", "{}"]) + "\n")
        with support.without_figures():
            shapes, _ = self.drawn("spoilt")
        self.assertEqual((len(shapes), precious.read_text()), (6, "years of work"))

    def test_an_error_in_a_process_names_the_shape(self):
        def draw(work, original=shape_files.draw):
            if work[0].shape.name == "2_0":
                raise ZeroDivisionError("no light")
            return original(work)
        for processes in (1, 2):
            with self.subTest(processes), unittest.mock.patch("salbench.report.shape_files.draw", draw):
                status, errors = support.make(self.out, self.folder / f"error-{processes}", "--processes", processes)
                self.assertEqual(status, 70)
                self.assertIn("drawing 2_0: ZeroDivisionError: no light", errors)

    def test_a_process_that_is_killed_ends_the_call_with_a_sentence(self):
        with unittest.mock.patch("salbench.report.shape_files.draw", lambda work: os.kill(os.getpid(), 9)):
            status, errors = support.make(self.out, self.folder / "killed", "--processes", 2)
        self.assertEqual(status, 3)
        self.assertIn("was ended from outside", errors)

    def test_what_the_system_lacks_is_no_defect(self):
        for number, (error, said) in enumerate(((MemoryError(), "no memory to draw 2_0: close other programs"),
                                                (OSError(errno.EMFILE, "Too many open files", "font"), "drawing 2_0: font: Too many open files; raise"))):
            def draw(work, original=shape_files.draw):
                if work[0].shape.name == "2_0":
                    raise error
                return original(work)
            for processes in (1, 2):
                with self.subTest(said, processes=processes), unittest.mock.patch("salbench.report.shape_files.draw", draw):
                    status, errors = support.make(self.out, self.folder / f"lacking-{number}-{processes}", "--processes", processes)
                    self.assertEqual((status, errors.count("\n")), (3, 1), errors)
                    self.assertIn(said, errors)
