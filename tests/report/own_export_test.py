# SPDX-License-Identifier: GPL-3.0-or-later
"""The report shows a model, whatever it is: a function, one that learned, a command, maps of another program. Looked at are the pixels: a
map that is high on one half of the shape has its halves in different colours, and the ground truth beside it has not."""

import contextlib
import io
import json
import re
import shutil
import textwrap
from pathlib import Path

import h5py
import numpy
from PIL import Image

import fixture
import salbench
import support
from salbench import __main__, datasets
from salbench.report import own_export
from salbench.report.results import Shown
from tests.support import shapes

CONFIG = {"dataset": {"layout": "schelling", "scans": False}, "metrics": {"names": ["cc"]}}
ITEMS = ("1", "21")
COMMAND = """
    import sys, h5py, numpy
    with h5py.File(sys.argv[1]) as file:
        numpy.save(sys.argv[2], (file["points"][:, 1] > 0) * 1.0)
    """

SERVED = """
    import sys, h5py, numpy
    for line in open(sys.argv[1]):
        shape, out = line.rstrip("\\n").split("\\t")
        with h5py.File(shape) as file:
            numpy.save(out, (file["points"][:, 1] > 0) * 1.0)
        print(out, flush=True)
    """


def half(shape):
    """High above the middle alone, whichever way the shape is looked at."""
    return (shape.points[:, 1] > 0) * 1.0


def fit(shapes):
    return half


def data_set(folder):
    """Bumpy spheres whose ground truth is the same all over but for a small spot."""
    for part in ("Meshes", "Distributions"):
        (folder / part).mkdir(parents=True)
    for number, item in enumerate(ITEMS):
        points, faces = fixture.sphere(rings=16, bumps=0.05 + 0.01 * number)
        (folder / f"Meshes/{item}.off").write_text(shapes.off(points, faces))
        truth = numpy.full(len(points), 0.1)
        truth[number::7] = 0.2  # speckled
        (folder / f"Distributions/{item}.val").write_text(shapes.lines(truth))
    return folder


def halves(path):
    """Mean colours of the upper and lower half of what is not transparent."""
    image = numpy.asarray(Image.open(path).convert("RGBA"), dtype=float)
    rows = numpy.nonzero(image[..., 3].max(axis=1) > 128)[0]
    middle = (rows[0] + rows[-1]) // 2
    return [part[part[..., 3] > 128][:, :3].mean(axis=0) for part in (image[:middle - 5], image[middle + 5:])]


def contrast(path):
    upper, lower = halves(path)
    return float(numpy.abs(upper - lower).max())


class OwnModelTest(support.ReportTest):
    def setUp(self):
        self.own = self.folder / self._testMethodName
        self.data = data_set(self.own / "data")

    def places(self):
        return {"cache": self.own / "cache", "out": self.own / "out"}

    def program(self, *words, status=0):
        """Output of a command of the program to either stream, in this process."""
        with contextlib.redirect_stdout(io.StringIO()) as out, contextlib.redirect_stderr(io.StringIO()) as errors:
            ended = __main__.main([*map(str, words)])
        self.assertEqual(ended, status, errors.getvalue())
        return out.getvalue() + errors.getvalue()

    def run_command(self, *words, models="RS:"):
        config = self.own / "mine.yaml"
        config.write_text(f"dataset: {{layout: schelling, scans: false}}\nmetrics: [cc]\nmodels:\n  {models}\n")
        self.program("run", config, "--data", self.data, "--cache", self.own / "cache", "--out", self.own / "out", "--quiet", *words)

    def shown(self, model, out=None):
        """The pictures of a shape that its page shows: of the ground truth and of the model."""
        self.to = self.report(self.own.name, out=out or self.own / "out")
        page = support.page(self.to, "shapes/21.html")
        self.assertNotIn("No export given to the report holds this shape", page)
        found = []
        for name in ("ground%2B20%2Btruth-before|ground\\+20\\+truth-before", f"{model}-before"):
            src = re.search(rf'src="[^"]*?(pictures/21/mesh-(?:{name})-[0-9a-f]+\.webp)"', page)
            self.assertIsNotNone(src, name)
            found.append(self.to / src[1].replace("%2B", "+"))
        return found

    def assert_shown(self, model, out=None):
        truth, own = self.shown(model, out)
        self.assertGreater(contrast(own), 60)
        self.assertLess(contrast(truth), 40)

    def assert_is_a_configuration(self, model):
        """run.yaml of the run can be planned and exported, and nothing is to be done."""
        record = self.own / "out/run.yaml"
        self.assertEqual(json.loads(self.program("plan", record, "--format", "json"))["open"], 0)
        item = json.loads(self.program("plan", record, "21", f"map.{model}", "--format", "json"))
        self.assertEqual([stage["state"] for stage in item["stages"]], ["cached"])
        self.program("export", record, "--items", "21", "--to", self.own / "21.h5", "--quiet")
        with h5py.File(self.own / "21.h5") as file:
            values = file[f"21/map.{model}/saliency"][:]
            numpy.testing.assert_array_equal(values, (file["21/mesh/vertices"][:, 1] > 0) * 1.0)

    def test_whatever_a_model_is(self):
        """A function, one with a version and all that it can read, a model that learned, a command with a file beside its configuration, one that
        is started once, maps of another program."""
        mine = salbench.Model(half, version=3, reads=["normals", "faces", "fpfh", "source"], trained_on=["1"])
        ways = {
            "function": lambda: salbench.run(CONFIG, data=self.data, models={"RS": {}, "MINE": half}, progress=False, **self.places()),
            "version": lambda: salbench.run(CONFIG, data=self.data, models={"RS": {}, "MINE": mine}, progress=False, items="1,21", **self.places()),
            "learned": lambda: salbench.cross_validate(fit, self.data, CONFIG, models={"RS": {}}, folds=2, by="mesh", progress=False, **self.places()),
            "command": lambda: self.run_command(models=self.written(COMMAND, "{shape} {out.npy}")),
            "served": lambda: self.run_command(models=self.written(SERVED, "{list.h5}")),
            "maps": self.run_maps,
        }
        for name, run in ways.items():
            with self.subTest(name):
                self.own = self.folder / name
                self.data = data_set(self.own / "data")
                run()
                self.assert_is_a_configuration("MINE")
                self.assert_shown("MINE")

    def written(self, program, words):
        (self.own / "half.py").write_text(textwrap.dedent(program))
        return f"MINE: {{command: '/usr/bin/python3 half.py {words}', depends: [half.py]}}"

    def run_maps(self):
        (self.own / "maps").mkdir()
        for item in ITEMS:
            lines = (self.data / f"Meshes/{item}.off").read_text().splitlines()
            points = [line.split() for line in lines[2:2 + int(lines[1].split()[0])]]
            (self.own / f"maps/{item}.val").write_text("".join(f"{float(float(y) > 0)}\n" for _, y, _ in points))
        self.run_command("--maps", self.own / "maps", "--name", "MINE")
        again = self.own / "again.h5"
        self.program("export", self.own / "mine.yaml", "--data", self.data, "--cache", self.own / "cache", "--maps", self.own / "maps",
                     "--name", "MINE", "--to", again, "--quiet")
        with h5py.File(again) as file:
            self.assertIn("map.MINE", file["21"])

    def test_a_folder_that_was_sent_with_an_export_shows_it(self):
        salbench.run(CONFIG, data=self.data, models={"RS": {}, "MINE": half}, progress=False, **self.places())
        self.program("export", self.own / "out/run.yaml", "--for-report", "--to", self.own / "out/shapes.h5", "--quiet")
        sent = Path(shutil.move(self.own / "out", self.own / "sent"))
        for folder in ("cache", "data"):
            shutil.rmtree(self.own / folder)
        self.assert_shown("MINE", sent)

    def test_matched_maps_are_found_whatever_they_were_matched_to(self):
        for reference in ("items", numpy.linspace(1 / 3, 2, 100)):
            salbench.run(CONFIG, data=self.data, models={"MINE": half}, progress=False, items=["1", "21"], reference=reference,
                         **self.places())
            self.shown("MINE")
            self.assertTrue(support.drawn(self.to, "pictures/21/mesh-MINE-after.webp").is_file(), reference)

    def test_without_the_cache_the_report_says_why_it_has_no_pictures(self):
        salbench.run(CONFIG, data=self.data, models={"MINE": half}, progress=False, **self.places())
        shutil.rmtree(self.own / "cache")
        with self.assertLogs("salbench", "WARNING") as said:
            self.to = self.report(self._testMethodName, out=self.own / "out")
        self.assertRegex("".join(said.output), f"no shapes in the report: .*{self.own / 'cache'}")
        self.assertIn(f"the cache that run.yaml names is not there: {self.own / 'cache'}", support.page(self.to, "shapes/21.html"))

    def test_a_data_set_made_in_python_is_told_to_become_a_file(self):
        points, faces = fixture.sphere(rings=16)
        read = lambda item: salbench.Shape(points=points, faces=faces, ground_truth=numpy.abs(points[:, 1]))
        data = datasets.Dataset([datasets.Item(name) for name in ITEMS], read, name="spheres")
        results = salbench.run({"dataset": {"scans": False}, "metrics": {"names": ["cc"]}}, data=data, models={"MINE": half}, progress=False, **self.places())
        with self.assertRaisesRegex(ValueError, "spheres was made in Python"):
            results.figure(self.own / "figure", ["1"], progress=False)

    def test_a_map_that_is_not_in_the_cache_fails_alone_with_a_line_that_says_what_to_do(self):
        salbench.run(CONFIG, data=self.data, models={"RS": {}, "MINE": half}, progress=False, **self.places())
        shutil.rmtree(self.own / "cache")
        said = self.program("export", self.own / "out/run.yaml", "--to", self.own / "all.h5", "--quiet", status=1)
        self.assertIn("MINE is a function of Python: its map of 21 is not in the cache; run it again from Python, or leave it out with "
                      "--models", said)
        with h5py.File(self.own / "all.h5") as file:
            self.assertIn("map.RS", file["21"])
            self.assertNotIn("map.MINE", file["21"])

    def test_the_report_computes_no_map(self):
        self.run_command(models=self.written(COMMAND, "{shape} {out.npy}"))
        shutil.rmtree(self.own / "cache")
        (self.own / "cache").mkdir()
        (self.own / "half.py").write_text(f"open({str(self.own / 'was run')!r}, 'w')\n")
        self.to = self.report(self._testMethodName, out=self.own / "out")
        self.assertFalse((self.own / "was run").exists())
        self.assertNotIn("mesh-MINE", support.page(self.to, "shapes/21.html"))


class ChosenTest(support.ReportTest):
    def test_of_many_shapes_those_that_are_talked_about(self):
        items = [(str(number), fixture.CLASSES[number % 4]) for number in range(1, 101)]
        table = fixture.with_metrics(fixture.results_table(items, views=2), ["auc"])
        fixture.write_results(self.folder / "many", items, results=table, extra=fixture.metric_lines(["auc"]))
        results = Shown(self.folder / "many")
        found = own_export.chosen(results, ["77", "absent"])
        self.assertEqual((len(found), len(set(found)), found[0]), (own_export.MOST, own_export.MOST, "77"))
        means = table.groupby(["model", "item"])["auc"].mean()
        for model in fixture.MODELS:
            self.assertLessEqual({means[model].idxmin(), means[model].idxmax()}, set(found), model)
        few = fixture.eight_meshes()
        fixture.write_results(self.folder / "few", few)
        self.assertEqual(own_export.chosen(Shown(self.folder / "few"), []), [item for item, _ in few])
