# SPDX-License-Identifier: GPL-3.0-or-later
"""Items that cannot be used, point clouds, and data sets that Python lists and reads, from their files to scores and exports."""

import h5py
import numpy as np
from support import MESHES, POINTS, Workspace

OWN = """from salbench.datasets import Item, Listing, mesh, top, values
from salbench.datasets.splits import from_names

def items(root):
    found = [Item(name, [f"{root}/Meshes/{name}.off", f"{root}/Distributions/{name}.val"]) for name in "12"]
    return from_names(Listing(found), {"test": ["1", "2", "eel"]}, __file__)

def read(item):
    shape = mesh(item.files[0])
    shape.ground_truth = values(item.files[1], len(shape.points))
    shape.participants = [top(shape.ground_truth, 20)]
    return shape
"""


class BadItems(Workspace):
    def test_one_is_named_in_one_line_and_the_others_are_scored(self):
        for name, text, said in (("Meshes/2.off", "OFF\n4 1 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 1 4\n", "2.off:7: .*4"),
                                 ("Distributions/2.val", "0.5\n1\n", f"2.val:?.*2 values.*{POINTS} vertices"),
                                 ("RawData/2_1.pid", f"3\n{POINTS}\n", f"2_1.pid:2: .*{POINTS}"), ("Meshes/2.off", None, "2.off: cannot be read")):
            file = self.data / name
            sound = file.read_text()
            file.unlink()
            if text is None:
                file.symlink_to("no such file")
            else:
                file.write_text(text)
            with self.subTest(name, said=said):
                done = self.salbench("run", status=1)
                errors = [line for line in done.stderr.splitlines() if line.startswith("error: ")]
                self.assertEqual(len(errors), 1, errors)
                self.assertRegex(errors[0], f"^error: 2: .*{said}")
                self.assertIn("\n1 failed, each named above: ", done.stderr)
                self.assertEqual([row["item"] for row in self.rows()], ["1", "1"])
            file.unlink()
            file.write_text(sound)
            self.salbench("run")  # mended, it is taken up again
            self.assertEqual(len(self.rows(item="2")), 2)
        for item in "12":
            (self.data / f"Meshes/{item}.off").write_text("OFF\n")
        self.assertEqual(len(self.fails()), 2)
        self.assertEqual(self.rows(), [], "nothing usable at all is no crash")


class Clouds(Workspace):
    """The mesh "1", and the cloud "2" of the other one's points, of which one has no position."""

    def setUp(self):
        super().setUp()
        mesh = self.data / "Meshes/2.off"
        points = mesh.read_text().splitlines()[2:POINTS + 2]
        mesh.unlink()
        (self.data / "Meshes/2.xyz").write_text("\n".join([*points[:4], "nan nan nan", *points[5:]]) + "\n")
        for file in self.data.glob("RawData/2_*.pid"):
            file.write_text(f"0\n{POINTS - 1}\n")
        count = "n=$(grep -a -m1 'element vertex' {mesh} | cut -d' ' -f3); seq $n > {out}"
        self.configure(f'dataset: {{scans: false}}\nmodels: {{PS: , MS: , RS: , LINES: {{command: "{count}"}}}}\npicture: {{size: 40}}\n')

    def test_they_go_through_every_subcommand(self):
        left = str(POINTS - 1)
        said = self.salbench("run").stderr
        self.assertIn(f"2: 1 of {POINTS} points dropped: they have no position", said)
        rows = self.rows(dataset="clouds")
        self.assertEqual([(row["item"], row["view"], row["model"], row["n_points"]) for row in rows],
                         [("2", "", name, left) for name in ("PS", "MS", "RS", "LINES")])
        self.assertTrue(self.rows("summary", dataset="clouds", metric="auc"))
        self.assertTrue((self.out / "mean_histograms_clouds.csv").exists())
        self.assertEqual({key: self.record()["data_set"][key] for key in ("meshes", "clouds")}, {"meshes": 1, "clouds": 1})
        self.assertRegex(self.salbench("plan").stdout, "(?s)data set: 1 meshe?s?, 1 point clouds?, 4 models.*\n0 jobs to do")
        self.assertIn("cloud_normals", self.salbench("plan", "2").stdout)
        self.salbench("verify", "--deep", "--sample", "100")
        self.salbench("export", "--to", self.folder / "all.h5")
        with h5py.File(self.folder / "all.h5") as file:
            self.assertEqual((file["2/cloud/points"].shape, list(file["2/cloud/dropped"])), ((POINTS - 1, 3), [4]))
            self.assertLessEqual({"cloud_normals", "surface", "picture"}, set(file["2"]))
            self.assertNotIn("cloud", file["1"])
        self.salbench("export", "--to", self.folder / "shapes", "--format", "ply")
        self.assertIn(b"element vertex " + left.encode(), (self.folder / "shapes/2.ply").read_bytes())
        self.salbench("run", "--items", "1")
        self.assertFalse((self.out / "mean_histograms_clouds.csv").exists(), "nothing is left of clouds where there are none")
        self.assertEqual(self.rows(dataset="clouds"), [])

    def test_given_maps_have_a_value_per_point_that_is_left_or_of_the_file(self):
        self.salbench("export", "--format", "maps", "--models", "PS", "--to", self.folder / "maps")
        file = self.folder / "maps/PS/2.val"
        left = file.read_text().splitlines()
        scores = []
        for values in (left, [*left[:4], "77", *left[4:]]):
            file.write_text("\n".join(values) + "\n")
            self.salbench("run", "--maps", self.folder / "maps/PS", "--name", "OWN")
            scores.append(self.rows(dataset="clouds", model="OWN"))
        self.assertEqual(*scores)
        file.write_text("1\n2\n")
        said = self.salbench("run", "--maps", self.folder / "maps/PS", "--name", "OWN", status=1).stderr
        self.assertIn(f"2 values, but the shape has {POINTS - 1} points", said)

    def test_few_and_repeated_points_are_no_trouble_to_any_model(self):
        self.configure("dataset: {scans: false, participants: simulated}\n")
        corners = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n"
        points = (self.data / "Meshes/2.xyz").read_text()
        for name, text in (("nine", "".join(" ".join(map(str, point)) + "\n" for point in np.random.default_rng(3).random((9, 3)))),
                           ("line", "".join(f"{i} 0 0\n" for i in range(40))), ("twice", points + points), ("places", corners * 3)):
            (self.data / f"Meshes/{name}.xyz").write_text(text)
        self.salbench("run", "--items", "nine,line,twice,places")
        self.assertEqual(len(self.rows(dataset="clouds")), 4 * 5)


def with_trouble(at, trouble):
    """In the processes of a call: what is done when Python opens, or lists, what ends like this."""
    code = f"""import os, signal, sys
def look(event, words):
    if event in ('open', 'os.scandir') and str(words[0]).endswith({at!r}):
        {trouble}
sys.addaudithook(look)
"""

    def before():
        from salbench.system import workers

        workers._START = code + workers._START
        exec(code, {})
    return before


class OwnDataSets(Workspace):
    def setUp(self):
        super().setUp()
        self.own = self.write("own.py", OWN)
        self.configure(MESHES.replace("scans: false", f"scans: false, layout: '{self.own}', split: test"))

    def test_a_problem_of_the_set_is_a_failure_and_a_warning_where_no_split_is_asked_for(self):
        unknown = f"{self.own}: the split 'test' names 'eel', which is no item of the data set: "
        said = self.salbench("run", status=1).stderr
        self.assertIn(f"error: data set: {unknown}", said)
        self.assertIn("\n1 failed, each named above: 1 data set\n", said)
        self.assertEqual(len(self.rows()), 4)
        self.assertIn(unknown, str(self.record()["failed"]))
        self.assertIn(f"warning: {unknown}", self.salbench("run", "--split", "").stderr)
        (self.data / "Distributions/2.val").write_text("1\n2\n")
        said = self.salbench("run", status=1).stderr
        self.assertIn("\n2 failed, each named above: 1 data set, 1 import\n", said)
        self.assertEqual(len(self.rows()), 2)

    def test_what_is_in_the_cache_is_not_read_again(self):
        crash = with_trouble(".off", "os.kill(os.getpid(), signal.SIGSEGV)")
        for verb, words in (("plan", ()), ("run", ())):
            done = self.salbench(verb, *words, "--split", "", status=verb == "run", before=crash)
            self.assertEqual(done.stderr.count(" crashed (signal 11"), 2 * (verb == "run"), "each item fails alone")
        self.salbench("run", "--split", "")
        results = self.results()
        for verb, words in (("run", ()), ("plan", ()), ("plan", ("1", "import")), ("gc", ())):
            self.salbench(verb, *words, "--split", "", before=crash)
        self.assertEqual((self.computed(), self.results()), (0, results))
        self.salbench("verify", "--deep", "--split", "")
        self.salbench("export", "--split", "", "--to", self.folder / "all.h5")

    def test_a_collection_whose_list_failed_removes_nothing(self):
        self.salbench("run", "--split", "")
        before = self.artefacts()
        for text, said in (("def items(root):\n    raise RuntimeError('no list')\n", "no list"), ("def items(root):\n    return []\n", "")):
            self.own.write_text(text)
            self.assertIn(said, self.salbench("gc", status=2).stderr)
        self.assertEqual(self.artefacts(), before)
