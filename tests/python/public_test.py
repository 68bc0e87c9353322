# SPDX-License-Identifier: GPL-3.0-or-later
"""First contact of users: one spelling of each thing, early checks of arguments, tables by their names."""

import ast
import pathlib
import pickle
import subprocess
import sys
import tempfile
import tomllib
import unittest

import numpy as np
import pandas
import toy

import salbench
import salbench.conclusions.glossary
from salbench import conclusions, models, stats
from salbench._core import models_about
from salbench.models.fingerprint import fingerprint
from salbench.shapes.shape import _ESTIMATED
from tests.support.shapes import FACES, POINTS

NAN, INFINITY = float("nan"), float("inf")
CONFIG = {"dataset": {"layout": "folder", "participants": "simulated"}, "scan": {"step_degrees": 2}}
SCORES = pandas.DataFrame({"item": list("abcdefg") * 2, "model": ["A"] * 7 + ["B"] * 7, "auc": np.linspace(.5, .9, 14)})


class Shapes(unittest.TestCase):
    """(what is given, what the message names)"""

    WRONG = [
        ({"points": POINTS[:, :2]}, r"points: must have shape \(4, 3\), not \(4, 2\)"), ({"points": None}, "points"), ({"points": 1}, "points"),
        ({"points": POINTS * NAN}, "points: must be finite"), ({"points": np.full((4, 3), INFINITY)}, "points: must be finite"),
        ({"points": [["a", "b", "c"]]}, "points: has values of type"), ({"points": POINTS * 1j}, "points: has values of type"),
        ({"points": [[0, 0, 0], [0, 0]]}, "points: "),
        ({"faces": [[0, 1, 4]]}, r"faces: must have numbers of points, 0 to 3"), ({"faces": [[0, 1, -1]]}, "faces: must have numbers"),
        ({"faces": [[0, 1]]}, r"faces: must have shape \(any, 3\)"), ({"faces": [[0, 1, 2.0]]}, r"faces: has values of type float64: .*astype\(int\)"),
        ({"faces": [0, 1, 2]}, "faces: must have shape"), ({"normals": POINTS[:3]}, "normals: must have shape"),
        ({"normals": POINTS * NAN}, "normals: must be finite"), ({"fpfh": np.zeros((4, 32))}, r"fpfh: must have shape \(4, 33\)"),
        ({"ground_truth": [1, 2, 3]}, r"ground_truth: must have shape \(4,\), not \(3,\)"), ({"ground_truth": [1, 2, 3, INFINITY]}, "must be finite"),
        ({"participants": [[4]]}, "participants: must have numbers"), ({"participants": [[0.5]]}, "participants: has values"),
        ({"participants": [[[1]]]}, "participants: must have shape"), ({"viewers": [[1, 2]]}, "viewers: must have shape"),
    ]

    def test_what_does_not_fit_is_named(self):
        for given, message in self.WRONG:
            with self.subTest(given), self.assertRaisesRegex(ValueError, message):
                salbench.Shape("a", **{"points": POINTS, **given})

    def test_what_fits_is_read_only_and_of_the_types_that_are_said(self):
        points = POINTS.tolist()
        shape = salbench.Shape("a", points, FACES.tolist(), ground_truth=[1, NAN, 0, 2], participants=[[0, 1], []], viewers=[[0, 0, 1, 1]])
        self.assertEqual((shape.points.dtype, shape.faces.dtype, shape.ground_truth.dtype), (np.float64, np.int32, np.float64))
        self.assertEqual([each.dtype for each in shape.participants], [np.int32] * 2)
        for array in (shape.points, shape.faces, shape.ground_truth, *shape.participants, *shape.viewers):
            self.assertFalse(array.flags.writeable)
        own = POINTS.copy()
        self.assertIs(salbench.Shape("a", own).points.base, own)
        self.assertTrue(own.flags.writeable, "the array of the caller stays as it is")


class Scores(unittest.TestCase):
    def test_of_a_shape_are_those_of_its_parts(self):
        rng = np.random.default_rng(1)
        shape = salbench.Shape("a", POINTS, FACES, ground_truth=rng.random(4), participants=[np.array([1, 2]), np.array([1])])
        given = {"ground_truth": shape.ground_truth, "picks": shape.participants, "points": shape.points, "faces": shape.faces,
                 "areas": salbench.vertex_areas(POINTS, FACES)}
        prediction = rng.random(4)
        self.assertEqual(repr(salbench.score(prediction, shape, metrics="all")), repr(salbench.score(prediction, **given, metrics="all")))
        self.assertEqual(salbench.metrics.cc(prediction, shape), salbench.metrics.cc(prediction, shape.ground_truth))
        with_picks = salbench.score(prediction, shape, picks=[3], metrics=["nss", "cc"])
        self.assertEqual(with_picks, salbench.score(prediction, shape.ground_truth, [3], metrics=["nss", "cc"]))
        with self.assertRaisesRegex(ValueError, "^a has neither ground truth nor marks"):
            salbench.score(prediction, salbench.Shape("a", POINTS))


class Datasets(unittest.TestCase):
    def setUp(self):
        self.folder = toy.meshes(self.enterContext(tempfile.TemporaryDirectory()) + "/meshes", 4, 12, 5)
        self.dataset = salbench.Dataset("folder", self.folder)

    def test_normals_are_estimated_when_they_are_asked_for(self):
        shape = self.dataset[0]
        before = fingerprint(shape)
        salbench.models.cb(shape)
        self.assertNotIn(shape, _ESTIMATED, "a model that reads none")
        copied = pickle.loads(pickle.dumps(shape))
        np.testing.assert_array_equal(shape.normals, salbench.estimate_normals(shape.points, shape.faces))
        np.testing.assert_array_equal(copied.normals, shape.normals)
        self.assertIs(shape.normals, shape.normals)
        self.assertEqual(fingerprint(shape), before, "what depends on it is the same")


class Runs(toy.InAFolder):
    def setUp(self):
        super().setUp()
        self.meshes = toy.meshes(self.folder / "meshes", 2, 12, 5)

    def run_with(self, **keywords):
        return salbench.run(**{"config": CONFIG, "data": self.meshes, "models": {"CB": {}}, "cache": self.folder / "cache", "progress": False,
                               "out": self.folder / "out"} | keywords)

    def test_arguments_that_are_something_else_are_named(self):
        for keywords, message in [
            ({"items": []}, "^items is empty"), ({"items": ""}, "^items is empty"), ({"items": 9}, "^items must be a text .* not 9"),
            ({"items": [b"1"]}, r"^items must be .* not \[b'1'\]"), ({"items": [["1"]]}, r"^items must be .* not \[\['1'\]\]"),
            ({"items": ["1-2"]}, "the data set has no item '1-2'"), ({"items": ["x"] * 999}, "^.items='x, x, x, x, x and 994 more': the data set has no item 'x'"),
            ({"models": {"LS": []}}, "models.LS must be a mapping"), ({"models": {"LS": False}}, "models.LS must be a mapping"),
        ]:
            with self.subTest(str(keywords)[:80]), self.assertRaisesRegex((ValueError, KeyError), message):
                self.run_with(**keywords)

    def test_arguments_of_other_types_are_named_as_well(self):
        results, cache, learned = self.run_with(), salbench.Cache(self.folder / "cache"), {"data": self.meshes, "config": CONFIG, "progress": False}

        def fit(shapes):
            return len

        for number, (call, message) in enumerate([
            (lambda: self.run_with(data=3), "^data must be a text or a path, not 3"), (lambda: self.run_with(cache=b"x"), "^cache must be a text or a path, not b'x'"),
            (lambda: self.run_with(out=3), "^out must be a text or a path, not 3"), (lambda: self.run_with(config=3), "^config must be a file, a name or a dict, not 3"),
            (lambda: self.run_with(models={1: len}), "^models: the name 1 must be a text"), (lambda: salbench.Model(3), "^predict must be a function of a shape, not 3"),
            (lambda: self.run_with(config=CONFIG | {"seed": object()}), "^config: a object is neither"), (lambda: self.run_with(config={(1,): 2}), "^config: keys must be"),
            (lambda: salbench.cross_validate(fit, **learned | {"config": 3}), "^config must be a file"), (lambda: salbench.cross_validate(3, **learned), "^participants are sim"),
            (lambda: salbench.cross_validate({}, **learned), "^fit names no model"), (lambda: salbench.cross_validate(fit, None, CONFIG | {"dataset": {}}), "^root must be"),
            (lambda: salbench.cross_validate("shrec07", **learned | {"config": CONFIG | {"dataset": {}}}), "^fit must be a function of a list of shapes, not .shrec07"),
            (lambda: results.maps(3), "there is no model with maps '3'; there are CB"), (lambda: results.maps("CB")[1], "of an item called 1: names are texts, such as '1'"),
            (lambda: cache[1], "there is no item 1: names are texts, such as '1'"), (lambda: salbench.Cache(3), "^path must be a text or a path, not 3"),
            (lambda: salbench.Results(3), "^folder must be a text or a path, not 3"), (lambda: salbench.Dataset("folder", 3), "^root must be a text or a path, not 3"),
            (lambda: salbench.Dataset(3, self.meshes), "^layout must be a text or a path, not 3"), (lambda: salbench.datasets.write(self.folder / "set", [1]), "^shape 'shape 0': "),
            (lambda: salbench.score([0, 1], [0, 1], metrics=3), "^metrics must be a name, or a sequence of names"), (lambda: stats.conclude(SCORES, metrics=3), "^metrics must be names"),
            (lambda: stats.conclude(SCORES, metrics=[]), "^metrics names no column"),
        ]):
            with self.subTest(number), self.assertRaisesRegex((ValueError, KeyError), message):
                call()
        with self.assertRaises(NotADirectoryError):
            self.run_with(data=self.folder / "out/results.csv")

    def test_numbers_and_paths_of_a_configuration_may_be_those_of_numpy_and_pathlib(self):
        config = CONFIG | {"seed": np.int64(3), "data": pathlib.Path(self.meshes), "metrics": {"names": np.array(["nss"])}}
        self.assertEqual([column for column in self.run_with(config=config, data=None).scores if column in ("nss", "auc")], ["nss"])
        results = self.run_with(models={"MINE": salbench.Model(lambda shape: shape.points[:, 0], version=1, trained_on=[1])})
        self.assertEqual(results.score(results.maps("MINE")["1"], 1), results.score(results.maps("MINE")["1"], "1"))

    def test_a_configuration_is_called_as_the_program_calls_it(self):
        for config in ("shrec07", "shrec07.yaml"):
            self.assertEqual(self.run_with(config=config, models={"RS": None}).maps("RS").keys(), self.run_with(config=config).maps("CB").keys())
        for config, message in (("shrec08", "^shrec08: .* there is no such configuration; did you mean 'shrec07'"), ("x/y.yaml", "^x/y.yaml: .* no such conf"),
                                (pathlib.Path("protocols/3dvb"), "did you mean 'protocols/3dva'")):
            for call in (self.run_with, lambda **keywords: salbench.cross_validate(None, self.meshes, **keywords)):
                with self.subTest(config), self.assertRaisesRegex(FileNotFoundError, message):
                    call(config=config)

    def test_maps_have_one_form_and_every_table_is_there(self):
        results, cache = self.run_with(), salbench.Cache(self.folder / "cache")
        of_run, of_cache = results.maps("CB"), cache.maps("CB")
        self.assertEqual(set(of_run), set(of_cache))
        for item in of_run:
            np.testing.assert_array_equal(of_run[item], of_cache[item])
        for maps in (cache.maps, results.maps):
            with self.assertRaisesRegex(KeyError, "CX"):
                maps("CX")
        for table in conclusions.TABLES:
            frame = getattr(results, {"ranking_agreement": "agreement"}.get(table.name, table.name))
            self.assertEqual({name: str(kind).replace("object", "str") for name, kind in frame.dtypes.items()},
                             {column.name: column.type for column in table.columns if column.name in frame}, table.name)
        self.assertEqual(len(results.smoothing), 0)

    def test_the_same_arguments_of_run_and_cross_validate(self):
        learnable = toy.learnable(self.folder / "learnable")
        shared = {"config": {"dataset": {"scans": False}, "metrics": {"names": ["cc"]}}, "data": learnable, "models": {"CB": {}},
                  "cache": self.folder / "c", "out": self.folder / "o", "reference": None, "threads": None, "progress": False}
        salbench.run(**shared)
        salbench.cross_validate(lambda shapes: lambda shape: shape.points[:, 2], **shared, folds=2)


class Names(unittest.TestCase):
    def test_conclusions_have_every_table_and_show_themselves(self):
        found = stats.conclude(SCORES)
        for table in conclusions.TABLES:
            frame = getattr(found, {"ranking_agreement": "agreement"}.get(table.name, table.name))
            self.assertEqual(set(frame), {column.name for column in table.columns if column.name != "split"}, table.name)
        self.assertEqual(repr(found), "Conclusions: 2 models by auc; one observation per mesh")
        self.assertIn("<table", found._repr_html_())

    def test_an_option_with_the_name_of_an_argument_has_one_of_its_own(self):
        points = np.random.default_rng(1).normal(size=(60, 3))
        for name in ("ms", "lvj", "lce"):
            function = getattr(models, name)
            np.testing.assert_array_equal(function(points, target_faces={"ms": 3000}.get(name, 60000)), function(points))
            with self.assertRaisesRegex(TypeError, "has no argument .faces_."):
                function(points, faces_=1000)

    def test_tables_of_the_program_are_frames(self):
        for module, column in ((salbench.metrics, "unit"), (salbench.models, "reads")):
            rows = module.table()
            frame = rows.frame()
            self.assertEqual(list(frame.index), [row.name for row in rows])
            self.assertEqual(frame[column].tolist(), [getattr(row, column) for row in rows])
            self.assertIn("<table", rows._repr_html_())

    def test_every_model_is_described_once_for_functions_and_pages(self):
        for row in models.table():
            about = models_about[row.name]
            self.assertTrue(getattr(models, row.name.lower()).__doc__.startswith(about.summary), row.name)
            self.assertEqual(bool(about.source and not about.key), False, row.name)
            self.assertIn(about.name, conclusions.glossary.titles([row.name], [])[row.name])

    def test_what_is_public_is_shown(self):
        self.assertLessEqual({"conclusions", "datasets", "stats", *salbench.__all__}, set(dir(salbench)))
        for module in (salbench.datasets, salbench.metrics, salbench.models, stats):
            self.assertEqual(set(dir(module)), set(module.__all__))

    def test_threads_of_functions_may_be_all_cores(self):
        np.testing.assert_array_equal(salbench.estimate_normals(POINTS, FACES, threads=None), salbench.estimate_normals(POINTS, FACES))
        self.assertTrue(stats.conclude(SCORES, threads=None).ranking.equals(stats.conclude(SCORES).ranking))


class Tensor:
    """Behaves like PyTorch's tensors: one with gradient is no array until it is detached."""

    def __init__(self, values, is_detached=False):
        self.values, self.is_detached = np.asarray(values, dtype=np.float32), is_detached

    def __array__(self, *_, **__):
        raise RuntimeError("Can't call numpy() on Tensor that requires grad")

    def detach(self):
        return Tensor(self.values, True)

    def cpu(self):
        return self

    def numpy(self):
        return self.values if self.is_detached else self.__array__()


class Tensors(unittest.TestCase):
    def test_one_that_needs_grad_is_its_values(self):
        self.assertEqual(salbench.metrics.cc(Tensor([1, 2, 3]), [1, 2, 4]), salbench.metrics.cc([1, 2, 3], [1, 2, 4]))


class Extras(unittest.TestCase):
    OPTIONAL = {"yaml": "pyyaml", "PIL": "pillow", "markupsafe": "jinja2"}

    def test_the_report_has_all_that_it_imports(self):
        project = tomllib.loads((toy.ROOT / "pyproject.toml").read_text())["project"]
        declared = {name.split(">")[0] for name in project["dependencies"] + project["optional-dependencies"]["report"]}
        imported = set()
        for path in (path for part in ("report", "pages", "conclusions") for path in (toy.ROOT / "python/salbench" / part).rglob("*.py")):
            for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
                names = [alias.name for alias in node.names] if isinstance(node, ast.Import) else [node.module or ""] if isinstance(node, ast.ImportFrom) else []
                imported |= {name.split(".")[0] for name in names}
        needed = {self.OPTIONAL.get(name, name) for name in imported - sys.stdlib_module_names - {"salbench"}}
        self.assertEqual(needed - declared, set())

    def test_what_tables_need_is_said(self):
        script = "import sys; sys.modules['pandas'] = None\nimport salbench.runs.tables\nsalbench.runs.tables.read('x.csv')"
        ended = subprocess.run([sys.executable, "-B", "-c", script], capture_output=True, text=True)
        self.assertRegex(ended.stderr, r"ModuleNotFoundError: .*pandas.*; pip install 'salbench\[run\]' brings what tables need")
