# SPDX-License-Identifier: GPL-3.0-or-later
"""A report made again draws what changed and nothing else, and has the bytes of one made anew by any number of processes."""

import os
import re
import shutil
import unittest
import unittest.mock

import h5py
import numpy

import fixture
import support
from folder_test import files_of
from salbench.report import drawing, shape_files, style
from salbench.report.folder import LIST

ITEMS, MODELS = fixture.eight_meshes()[:3], ("LS", "CS")
DIGEST = re.compile(r"-[0-9a-f]{16}(?=\.)")


def without_digests(paths):
    return sorted(DIGEST.sub("", path) for path in paths)


class DrawnAgain(support.ReportTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.out = cls.folder / "out"
        table = fixture.with_metrics(fixture.results_table(ITEMS, MODELS, datasets=("meshes",)), ["auc"])
        fixture.write_results(cls.out, ITEMS, MODELS, results=table, extra=fixture.metric_lines(["auc"]))
        fixture.write_export(cls.out / "shapes.h5", ITEMS[:2], MODELS, views=1, size=48)
        cls.anew = files_of(cls.made("anew", 2))

    @classmethod
    def made(cls, name, processes=1, out=None):
        status, errors = support.make(out or cls.out, cls.folder / name, "--metrics", "auc", "--processes", processes)
        assert status == 0, errors
        return cls.folder / name

    def drawn(self, name, out=None):
        """Makes a report again in one process: the names of its files that are written but for pages and tables, without their digests, and how
        many figures are drawn."""
        figures, before = [], files_of(self.folder / name)

        def save(figure, original=style.save):
            figures.append(figure)
            return original(figure)
        with unittest.mock.patch("salbench.report.style.save", save):
            self.made(name, out=out)
        return without_digests(path for path in files_of(self.folder / name) if path not in before), len(figures)

    def copied(self, name):
        shutil.copytree(self.folder / "anew", self.folder / name)
        return self.folder / name

    def expect_anew(self, name):
        files = files_of(self.folder / name)
        self.assertEqual(sorted(files), sorted(self.anew))
        self.assertEqual([path for path in files if files[path] != self.anew[path]], [])

    def test_nothing_is_drawn_twice(self):
        self.copied("again")
        with unittest.mock.patch.object(shape_files, "draw", side_effect=AssertionError):
            self.assertEqual(self.drawn("again"), ([], 0))
        self.expect_anew("again")

    def test_what_is_not_there_is_drawn(self):
        to = self.copied("ended")
        with unittest.mock.patch("salbench.report.front.sentences", side_effect=KeyboardInterrupt):
            self.assertEqual(support.make(self.out, to, "--metrics", "auc")[0], 130)
        missing = ["figures/human-curves.pdf", "pictures/1/mesh-LS-after.webp", "shapes/2_0.js"]
        for name in missing:
            support.drawn(to, name).unlink()
        self.assertEqual(self.drawn("ended"), (missing, 1))
        self.expect_anew("ended")

    def test_a_changed_map_and_a_changed_row_are_drawn_alone(self):
        to, out = self.copied("changed"), self.folder / "changed-out"
        shutil.copytree(self.out, out)
        with h5py.File(out / "shapes.h5", "r+") as file:
            file["1/map.LS/saliency"][0] += 0.25
        curve = (out / "human_curve.csv").read_text().splitlines(keepends=True)
        (out / "human_curve.csv").write_text("".join(curve[:1] + curve[2:]))
        written, _ = self.drawn("changed", out)
        self.assertEqual([name for name in written if not name.startswith("figures/")],
                         ["pictures/1/mesh-LS-before.webp", "pictures/1/mesh-LS-difference.webp", "shapes/1.js"])
        self.assertIn("figures/human-curves.svg", written)
        showing = ("human-curves", "examples-meshes", "matching", "difficult-meshes")
        self.assertEqual([name for name in written if name.startswith("figures/") and not name.startswith(tuple(f"figures/{one}" for one in showing))], [])
        files = files_of(to)
        self.assertEqual(without_digests(files), without_digests(self.anew), "what shows the map as it was is gone")
        self.assertEqual(sorted(files[LIST].decode().splitlines()), sorted(files.keys() - {LIST}))

    def test_pictures_of_a_model_that_is_gone_are_removed(self):
        to, out = self.copied("fewer"), self.folder / "fewer-out"
        shutil.copytree(self.out, out)
        with h5py.File(out / "shapes.h5", "r+") as file:
            for shape in file.values():
                for kind in ("map", "matched"):
                    del shape[f"{kind}.CS"]
        written, _ = self.drawn("fewer", out)
        self.assertEqual([name for name in written if name.startswith("pictures/")], [])
        self.assertEqual([path for path in files_of(to) if path.startswith("pictures/") and "-CS-" in path], [])
        self.assertTrue([path for path in self.anew if path.startswith("pictures/") and "-CS-" in path])

    def test_what_another_version_drew_is_drawn_again_and_one_process_draws_the_same_as_two(self):
        self.copied("older")
        with unittest.mock.patch.object(drawing, "code", lambda: "another"), unittest.mock.patch.object(shape_files, "code", lambda: "another"):
            written, _ = self.drawn("older")
        self.assertEqual(written, without_digests(path for path in self.anew if DIGEST.search(path)))
        drawn = {DIGEST.sub("", path): content for path, content in files_of(self.folder / "older").items() if path.startswith(("figures/", "pictures/"))}
        self.assertEqual([path for path, content in self.anew.items() if drawn.get(DIGEST.sub("", path), content) != content], [])
        self.assertTrue(drawn)

    def test_the_digest_that_an_export_has_of_an_artefact_is_believed(self):
        with h5py.File(self.folder / "digests.h5", "w") as file:
            for name, of_first in (("a", "00"), ("b", "00"), ("c", "01")):
                file[f"{name}/map.LS/saliency"] = numpy.arange(3.0) + ord(name)
                file[f"{name}/map.LS"].attrs["content"] = of_first
            found = [shape_files.content(file[name], "map.LS") for name in "abc"]
        self.assertEqual(found, [["00"], ["00"], ["01"]])

    def test_a_process_that_is_killed_ends_the_call_with_a_sentence(self):
        with unittest.mock.patch("salbench.report.shape_files.draw", lambda *_: os.kill(os.getpid(), 9)):
            status, errors = support.make(self.out, self.folder / "killed", "--processes", 2)
        self.assertEqual(status, 3)
        self.assertIn("was ended from outside", errors)
