# SPDX-License-Identifier: GPL-3.0-or-later
"""`salbench inspect`: facts of every item, files that belong to none, and what is wrong, of archives and of the program's own layouts."""

import json
import subprocess
import sys
from types import SimpleNamespace

import numpy as np

from salbench import datasets
from salbench.datasets import inspecting
from support import FACES, POINTS, WithArchive, lines, off, sphere


class Inspect(WithArchive):
    def found(self, layout):
        return inspecting.inspected(layout if layout in ("folder", "hdf5", "schelling") else self._layout(layout), str(self.root))

    def facts(self, layout, *keys):
        return [tuple(item[key] for key in keys) for item in self.found(layout)["items"]]

    def test_the_programs_own_layout(self):
        points, _ = sphere(4, 5)
        self.write({"Meshes/21.off": off(), "Meshes/22.off": off(), "Meshes/23.ply": cloud_ply(points), "Distributions/21.val": lines([1, 2, 3, 5]),
                    "RawData/21_0.pid": lines([0, 1]), "RawData/21_1.pid": lines([3]), "RawData/22_0.pid": lines([2])})
        keys = ("name", "kind", "points", "faces", "has_truth", "participants", "picks", "seen")
        self.assertEqual(self.facts("schelling", *keys), [("21", "mesh", 4, 4, True, 2, 3, 4), ("22", "mesh", 4, 4, True, 1, 1, 4),
                                                          ("23", "cloud", len(points), 0, False, 0, 0, 0)])
        first, second, _ = self.found("schelling")["items"]
        self.assertEqual((first["low"], first["high"], first["diagonal"]), (1, 5, 3**0.5))
        self.assertTrue(np.isnan(second["low"]), "picks alone have no range")

    def test_views_masks_splits_and_unused_files(self):
        described = ("places:\n  - meshes: 'm/*'\n    truth: {saliency: 'v/{item}_{view}.txt', mask: 'seen/{item}_{view}.txt'}\n    views: scored\n"
                     "splits: {file: splits.csv}\n")
        self.write({"m/a.off": off(), "v/a_1.txt": lines([1, 2, 3, 4]), "seen/a_1.txt": lines([0, 1, 1, 1]), "v/a_2.txt": lines([1, 2, 3, 4]),
                    "seen/a_2.txt": lines([1, 1, 0, 0]), "splits.csv": "item,split\na,test\n", "readme.txt": "", "m/.hidden": "", "v/a_3.md": ""})
        found = self.found(described)
        self.assertEqual([(item["name"], item["view"], item["split"], item["seen"]) for item in found["items"]],
                         [("a_1", "1", "test", 3), ("a_2", "2", "test", 2)])
        self.assertEqual([path.replace(str(self.root), "ROOT") for path in found["unused"]], ["ROOT/readme.txt", "ROOT/v/a_3.md"])
        self.assertEqual((found["shapes"], found["problems"]), (1, []))

    def test_of_a_set_in_the_one_form_its_index_is_used(self):
        datasets.write(self.root, [SimpleNamespace(id="a", points=POINTS, faces=FACES)])
        self.write({"notes.txt": ""})
        self.assertEqual([path.replace(str(self.root), "ROOT") for path in self.found("hdf5")["unused"]], ["ROOT/notes.txt"])

    def test_one_item_that_fails_harms_no_other(self):
        described = "places: [{meshes: 'm/*', truth: {saliency: 'v/{item}.txt'}}]\n"
        self.write({"m/a.off": off(), "m/b.off": "OFF\n1 2\n", "m/c.off": off(), "v/a.txt": lines([1, 2]), "v/b.txt": "1\n", "v/c.txt": lines([1, 2, 3, 4])})
        problems = [problem.replace(str(self.root), "ROOT") for (problem,) in self.facts(described, "problem")]
        self.assertTrue(problems[0].startswith("ROOT/v/a.txt:2: ") and problems[1].startswith("ROOT/m/b.off:"), problems)
        self.assertEqual(problems[2], "")

    def test_remarks_and_sizes_that_are_odd(self):
        self.write({f"{name}.off": off(POINTS * size) for name, size in (("a", 1), ("b", 2), ("c", 1000))})
        self.write({"d.off": off(np.vstack([POINTS, [[1, 1, 0]]])).replace("5 4 0", "5 5 0") + "4 0 1 4 2\n"})
        found = self.found("folder")
        self.assertEqual([item["remark"] for item in found["items"]], ["", "", "", "1 polygons split into triangles, 0 of them concave"])
        (problem,) = found["problems"]
        self.assertIn("c: its diagonal, 1732, is 667 times the median of the data set, 2.598: if it is in another unit, scale it", problem)

    def test_scale_and_positives(self):
        described = "places: [{meshes: 'm/*', truth: {saliency: 'v/{item}.txt'}}]\nvalues: {positives: top 25%}\nunits: mm\n"
        self.write({"m/a.off": off(POINTS * 1000), "v/a.txt": lines([1, 2, 3, 4])})
        found = self.found(described)
        self.assertEqual((found["positives"], found["scale"], found["items"][0]["picks"]), ("top 25%", 0.001, 1))
        self.assertAlmostEqual(found["items"][0]["diagonal"], 3**0.5)

    def test_text_document_and_status(self):
        described = "places: [{meshes: 'm/*', truth: {saliency: 'v/{item}.txt'}}]\n"
        self.write({"m/a.off": off(), "m/b.off": off(), "v/a.txt": lines([1, 2, 3, 4]), "v/b.txt": lines([1]), "x": ""})
        line = [sys.executable, "-P", "-m", "salbench", "inspect", self._layout(described), "--data", str(self.root)]
        done = subprocess.run(line, capture_output=True, text=True)
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertEqual(done.stdout.split("\n\n")[0], "layout   own\nitems    2 of 2 shapes\nsplits   none\nviews    none")
        self.assertIn("\n1 unused files:\n", done.stdout)
        self.assertIn("\n1 problems:\n  b: ", done.stdout)
        document = json.loads(subprocess.run([*line, "--format", "json"], capture_output=True, text=True).stdout)
        self.assertEqual((document["command"], document["n_problems"], document["scale"], document["items"][0]["low"]), ("inspect", 1, "1", "1"))

    def test_a_folder_that_cannot_be_listed_is_no_defect(self):
        for layout in ("hdf5", "schelling", "automatic", "sal3d"):
            with self.subTest(layout):
                line = [sys.executable, "-P", "-m", "salbench", "inspect", layout, "--data", str(self.root / "none")]
                done = subprocess.run(line, capture_output=True, text=True)
                self.assertEqual((done.returncode, done.stdout), (2, ""), done.stderr)
                self.assertRegex(done.stderr, r"\Aerror: .*none.*\n\Z")


def cloud_ply(points):
    head = f"ply\nformat ascii 1.0\nelement vertex {len(points)}\nproperty float x\nproperty float y\nproperty float z\nend_header\n"
    return head + "".join(f"{x} {y} {z}\n" for x, y, z in points)
