# SPDX-License-Identifier: GPL-3.0-or-later
"""`salbench inspect`: facts of every item, files that belong to none, and what is wrong, whoever reads the files."""

import json
import os
from types import SimpleNamespace

import numpy as np

from own_sets import PLAIN, VIEWS, doing
from salbench import datasets
from salbench.datasets import inspecting
from salbench.system.errors import InputError
from support import FACES, POINTS, WithArchive, lines, off, sphere
from tests.support import forked


RECORDED = """from salbench.datasets import Item, Recording, gather, match, mesh

def items(root):
    of = {one.item: [] for one in match(root, "m/{item}.off")}
    for one in match(root, "g/{item}_{person}.csv", of):
        of[one.item].append(one)
    return [Item(name, [f"{root}/m/{name}.off", *(one.path for one in some)], truth=False, recorded=2, info=[one.viewer for one in some])
            for name, some in of.items()]

def read(item):
    shape = mesh(item.files[0])
    shape.recording = gather(zip(item.info, item.files[1:]), Recording.of, time="t", origin=("ex", "ey", "ez"), direction=("dx", "dy", "dz"))
    return shape
"""


class Inspect(WithArchive):
    def layout(self, layout):
        """A name, or the text of a file of Python."""
        if "\n" not in layout:
            return layout
        mine = self.root.parent / "mine.py"
        mine.write_text(layout)
        return str(mine)

    def found(self, layout):
        return inspecting.inspected(self.layout(layout), str(self.root))

    def unused(self, found):
        return [os.path.relpath(path, self.root) for path in found["unused"]]

    def test_the_programs_own_layout(self):
        points, _ = sphere(4, 5)
        self.write({"Meshes/21.off": off(), "Meshes/22.off": off(), "Meshes/23.ply": cloud_ply(points), "Distributions/21.val": lines([1, 2, 3, 5]),
                    "RawData/21_0.pid": lines([0, 1]), "RawData/21_1.pid": lines([3]), "RawData/22_0.pid": lines([2])})
        keys = ("name", "kind", "points", "faces", "has_truth", "participants", "picks", "seen")
        first, second, third = self.found("schelling")["items"]
        self.assertEqual([tuple(item[key] for key in keys) for item in (first, second, third)],
                         [("21", "mesh", 4, 4, True, 2, 3, 4), ("22", "mesh", 4, 4, True, 1, 1, 4), ("23", "cloud", len(points), 0, False, 0, 0, 0)])
        self.assertEqual((first["low"], first["high"], first["diagonal"]), (1, 5, 3**0.5))
        self.assertTrue(np.isnan(second["low"]), "picks alone have no range")

    def test_views_masks_splits_and_unused_files(self):
        self.write({"m/a.off": off(), "v/a_1.txt": lines([1, 2, 3, 4]), "seen/a_1.txt": lines([0, 1, 1, 1]), "v/a_2.txt": lines([1, 2, 3, 4]),
                    "seen/a_2.txt": lines([1, 1, 0, 0]), "splits.csv": "item,split\na,test\n", "readme.txt": "", "m/.hidden": "", "v/a_3.md": ""})
        found = self.found(VIEWS)
        self.assertEqual([(item["name"], item["view"], item["split"], item["seen"]) for item in found["items"]], [("a_1", "1", "test", 3), ("a_2", "2", "test", 2)])
        self.assertEqual((self.unused(found), found["shapes"], found["problems"]), (["readme.txt", "v/a_3.md"], 1, []))

    def test_of_a_set_in_the_hdf5_form_its_index_is_used(self):
        datasets.write(self.root, [SimpleNamespace(id="a", points=POINTS, faces=FACES)])
        self.write({"notes.txt": ""})
        self.assertEqual(self.unused(self.found("hdf5")), ["notes.txt"])

    def test_one_item_that_fails_harms_no_other(self):
        self.write({"m/a.off": off(), "m/b.off": "OFF\n1 2\n", "m/c.off": off(), "v/a.txt": lines([1, 2]), "v/b.txt": "1\n", "v/c.txt": lines([1, 2, 3, 4]),
                    "m/d.off": off(), "v/d.txt": lines([1, 2, 3, 4])})
        a, b, c, d = (item["problem"].replace(str(self.root), "ROOT") for item in self.found(doing(d="os.abort()"))["items"])
        self.assertTrue(a.startswith("ROOT/v/a.txt: ") and b.startswith("ROOT/m/b.off:"), (a, b))
        self.assertEqual(c, "")
        self.assertRegex(d, "^ROOT/m/d.off: .*crashed")

    def test_an_item_that_says_another_thing_than_its_shape_is_named(self):
        self.write({"m/a.off": off()})
        own = doing(a="return mesh(item.files[0])").replace(', f"{root}/v/{one.item}.txt"', "")
        (item,) = self.found(own)["items"]
        self.assertIn("truth=False", item["problem"])
        self.assertEqual(self.found(own.replace('.path])', '.path], truth=False)'))["problems"], [])

    def test_remarks_and_sizes_that_are_odd(self):
        self.write({f"{name}.off": off(POINTS * size) for name, size in (("a", 1), ("b", 2), ("c", 1000))})
        self.write({"d.off": off(np.vstack([POINTS, [[1, 1, 0]]])).replace("5 4 0", "5 5 0") + "4 0 1 4 2\n"})
        found = self.found("folder")
        self.assertEqual([item["remark"] for item in found["items"]], ["", "", "", "1 polygons split into triangles, 0 of them concave"])
        (problem,) = found["problems"]
        self.assertRegex(problem, "^c: .*1732.*667.*2.598")

    def test_ground_truths_that_are_odd(self):
        self.write({f"m/{name}.off": off() for name in "abc"} | {"v/a.txt": lines([1, 0, 3, 4]), "v/b.txt": lines([-1, 2, -1, 4]), "v/c.txt": lines([0] * 4)})
        found = self.found(PLAIN.replace("return shape", "shape.ground_truth = shape.ground_truth.astype(int)\n    return shape"))
        self.assertEqual([(item["low"], item["high"]) for item in found["items"]], [(0, 4), (-1, 4), (0, 0)], "whole numbers, too")
        negative, constant = found["problems"]
        self.assertRegex(negative, "^b: .*unseen=-1.*1 of 3")
        self.assertRegex(constant, "^c: .*1 of 3")
        self.assertEqual([item["problem"] for item in found["items"]], [""] * 3, "a run scores them")

    def test_a_version_of_the_file_that_is_none(self):
        self.write({"m/a.off": off(), "v/a.txt": lines([1, 2, 3, 4])})
        with self.assertRaisesRegex(InputError, "mine.py: version .*'1.0'"):
            self.found(PLAIN + "VERSION = '1.0'\n")

    def test_picks_of_densities_count(self):
        self.write({"m/a.off": off(), "v/a.txt": lines([1, 2, 3, 4])})
        (item,) = self.found(PLAIN.replace("return shape", "shape.participants = [top(shape.ground_truth, 25)]\n    return shape").replace("values\n", "top, values\n"))["items"]
        self.assertEqual((item["picks"], item["participants"]), (1, 1))

    def test_text_document_and_status(self):
        self.write({"m/a.off": off(), "m/b.off": off(), "v/a.txt": lines([1, 2, 3, 4]), "v/b.txt": lines([1]), "x": ""})
        line = ["inspect", self.layout(PLAIN), "--data", self.root]
        done = forked.salbench(*line)
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertEqual(done.stdout.split("\n\n")[0], "layout   mine\nitems    2 of 2 shapes\nsplits   none\nviews    none")
        self.assertIn("\n1 unused file:\n", done.stdout)
        self.assertIn("\n1 problem:\n  b: ", done.stdout)
        document = json.loads(forked.salbench(*line, "--format", "json").stdout)
        self.assertEqual((document["command"], document["layout"], document["n_problems"], document["items"][0]["low"], document["against_shapes"]),
                         ("inspect", "mine", 1, "1", 0))

    def test_recordings_that_are_nowhere_or_not_there_end_with_1_and_causes_are_a_line_each(self):
        points, faces = sphere(12, 14)
        points = points + [2.0, 0.0, 0.0]
        files = {f"m/{name}.off": off(points, faces) for name in ("a", "b", "c")}
        for name in "abc":
            for person in ("P1", "P07"):
                eye = -2 if name == "b" else 9 if person == "P07" else 2  # b: of a left-handed frame
                rows = [(8 * k, eye, 0, 5, 0, 0, -1) if k % 10 and name != "c" else (8 * k, *[""] * 6) for k in range(40)]
                files[f"g/{name}_{person}.csv"] = "t,ex,ey,ez,dx,dy,dz\n" + "".join(",".join(map(str, row)) + "\n" for row in rows)
        self.write(files)
        mine, to = self.layout(RECORDED), self.root.parent / "h5"
        done = forked.salbench("inspect", mine, "--data", self.root, "--format", "json")
        found = json.loads(done.stdout)
        self.assertEqual(done.returncode, 1, done.stderr)
        a, b, c = (item["problem"].replace(f"{self.root}/", "") for item in found["items"])
        self.assertRegex(a, "no fixation on the shape.*P07")
        self.assertIn("no fixation on the shape", b)
        self.assertEqual(c, "g/c_P1.csv:2: 80 rows of 2 people lost: a coordinate is missing, NaN or infinite; nothing is known of the gaze on this shape")
        lines = [line.replace(f"{self.root}/", "") for line in found["problems"]]
        self.assertIn("b: mirrored by axes='-x y z', 2 of 2 fixations hit, and 0 as they are: the frame is another one than the shape's", lines)
        self.assertEqual([line for line in lines if "lost:" in line][1:], ["g/a_P1.csv:2: 16 rows of 2 people lost: a coordinate is missing, NaN or infinite"])
        done = forked.salbench("import", mine, "--data", self.root, "--to", to, "--quiet")
        self.assertEqual((done.returncode, done.stderr.count("error: "), done.stderr.count("warning: ")), (1, 1, 1), done.stderr)


def cloud_ply(points):
    head = f"ply\nformat ascii 1.0\nelement vertex {len(points)}\nproperty float x\nproperty float y\nproperty float z\nend_header\n"
    return head + "".join(f"{x} {y} {z}\n" for x, y, z in points)
