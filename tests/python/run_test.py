# SPDX-License-Identifier: GPL-3.0-or-later
"""The benchmark with models that are functions: tables, reruns, failures, Ctrl-C."""

import collections.abc
import contextlib
import copy
import datetime
import functools
import inspect
import io
import os
import pathlib
import pickle
import shutil
import signal
import subprocess
import sys
import tempfile
import textwrap
import threading
import unittest
import unittest.mock

import numpy as np
import yaml

import salbench
import toy
from salbench import datasets
from salbench.datasets.reading import from_faces
from salbench.models.function import described
from salbench.runs.results import _IN_PROCESS
from tests.support.cache_files import damage
from tests.support.shapes import sphere

HEIGHT = "def predict(shape):\n    return shape.points[:, {axis}] * 2.0\n"
MESHES = {"dataset": {"layout": "folder", "participants": "simulated", "scans": False}}
CONFIG = {"dataset": {"layout": "folder", "participants": "simulated"}, "scan": {"step_degrees": 2}}


def function(text, folder, name="predict"):
    """A function whose source text is in a file, as inspect wants it."""
    import importlib.util

    path = pathlib.Path(folder) / f"module_{abs(hash(text))}.py"
    path.write_text(textwrap.dedent(text))
    spec = importlib.util.spec_from_file_location(path.stem, path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return getattr(module, name)


class Folders(toy.InAFolder):
    config = CONFIG

    @classmethod
    def setUpClass(cls):
        cls.made = toy.meshes(cls.enterClassContext(tempfile.TemporaryDirectory()) + "/meshes", 2)

    def setUp(self):
        super().setUp()
        self.meshes = shutil.copytree(self.made, self.folder / "meshes")

    def run_with(self, models, **keywords):
        keywords = {"config": self.config, "data": self.meshes, "cache": self.folder / "cache", "out": self.folder / "out", "progress": False} | keywords
        return salbench.run(models=models, **keywords)


class Net:
    """Heights: a "network" # of one layer.

    And more."""

    def __call__(self, shape):
        return shape.points[:, 0]


class Bare(Net):
    def __call__(self, shape):
        return shape.points[:, 1]


class Runs(Folders):
    def test_a_function_and_the_same_command_have_the_same_tables(self):
        script = self.folder / "height.py"
        script.write_text(textwrap.dedent("""\
            import sys, h5py, numpy
            with h5py.File(sys.argv[1]) as file:
                numpy.save(sys.argv[2], file["points"][:, 2] * 2.0)
            """))
        config = self.folder / "command.yaml"
        config.write_text("dataset: {layout: folder, participants: simulated, scans: false}\n"
                          f"models: {{LS: {{}}, MINE: {{command: '/usr/bin/python3 {script} {{shape}} {{out.npy}}', depends: [{script}]}}}}\n")
        toy.run(config, "--data", self.meshes, "--cache", self.folder / "c", "--out", self.folder / "o")
        results = self.run_with({"LS": {}, "MINE": function(HEIGHT.format(axis=2), self.folder)}, config=MESHES)
        self.assertEqual(results.failures, [])
        self.assertEqual(set(results.ranking.model), {"LS", "MINE"})  # which concludes
        for name in ("results", "summary", "ranking", "significance"):
            self.assertEqual((self.folder / "out" / f"{name}.csv").read_bytes(),
                             (self.folder / "o" / f"{name}.csv").read_bytes())
        rows = (self.folder / "out" / "results.csv").read_text().splitlines()
        self.assertEqual([float(row.rsplit(",", 2)[1]) for row in rows[1:]], results.scores.iloc[:, -1].tolist())
        self.assertEqual(len(rows), 1 + 2 * 2)

    def test_results_are_pickled_with_all_that_is_in_their_folder(self):
        os.chdir(self.folder)
        self.addCleanup(os.chdir, pathlib.Path(__file__).parent)
        results = self.run_with({"LS": {}}, out="out")
        scores, ranking = results.scores, results.ranking
        for copied in (pickle.loads(pickle.dumps(results)), copy.deepcopy(results), pickle.loads(pickle.dumps(salbench.Results("out")))):
            os.chdir("/")
            self.assertTrue(copied.ranking.equals(ranking))
            self.assertTrue(copied.scores.equals(scores))
            self.assertEqual(copied.failures, results.failures)
            for work in (lambda: copied.maps("LS"), lambda: copied.score([1], "1")):
                with self.assertRaisesRegex(ValueError, "is of results that run\\(\\) returned"):
                    work()
            os.chdir(self.folder)
        self.assertEqual(pickle.loads(pickle.dumps(results)).computed, results.computed)
        self.assertEqual(copy.copy(results).maps("LS").keys(), results.maps("LS").keys())
        self.assertEqual(list(pickle.loads(pickle.dumps(results.reference))), list(results.reference))

    def test_a_function_whose_state_changes_when_it_is_called_is_named(self):
        seen, same = [], [0.0]
        models = {"MINE": lambda shape: seen.append(shape.id) or shape.points[:, 2], "SAME": lambda shape: shape.points[:, 2] + same[0]}
        with self.assertLogs("salbench", "WARNING") as logged:
            self.run_with(models, config=MESHES)
        self.assertEqual([line.split(":")[2] for line in logged.output if "calling it changed" in line], ["MINE"])

    def test_results_whose_folder_holds_a_later_run_refuse_its_tables(self):
        results, of_folder = self.run_with({"LS": {}}), salbench.Results(self.folder / "out")
        self.run_with({"LS": {}})  # with the same scores
        scores, ranking = results.scores, of_folder.ranking
        for name in ("folds", "training"):
            with self.assertRaisesRegex(ValueError, f"no table {name}"):
                getattr(results, name)
        later = self.run_with({"RS": {}})
        self.assertIs(results.scores, scores)
        self.assertIs(of_folder.ranking, ranking)
        for work in (lambda: results.ranking, lambda: of_folder.scores, lambda: results.costs, lambda: of_folder.record,
                     lambda: results.report(self.folder / "report", progress=False)):
            with self.assertRaisesRegex(ValueError, "holds a later run by now.*out="):
                work()
        self.assertEqual(set(later.summary.model), {"RS"})
        (self.folder / "out/run.yaml").write_text("# a run is under way, or was ended before its end\n")  # as a killed one leaves it
        with self.assertRaisesRegex(ValueError, "has not ended"):
            salbench.Results(self.folder / "out").scores

    def test_an_exception_fails_its_shape_and_has_the_whole_traceback_of_the_function(self):
        text = """
            def helper(shape):
                return {}[shape.id]
            def predict(shape):
                try:
                    return helper(shape) if shape.id.endswith("_3") else shape.points[:, 0]
                except KeyError as error:
                    raise ValueError("no\\0eyes") from error
            """
        results = self.run_with({"MINE": function(text, self.folder)})
        failures = [row for row in results.failures if row.stage == "map.MINE"]
        self.assertEqual(([row.item for row in failures], len(results.scores)), (["1_3", "2_3"], 24), "the others are scored")
        first, *trace = failures[0].cause.splitlines()
        self.assertRegex(first, r"^MINE\(\) raised ValueError: no\\(0|x00)eyes \(.*module_\d+\.py, line 8\)$")
        self.assertNotIn("\0", failures[0].cause)
        trace = "\n".join(trace)
        for line in ("line 3, in helper", "KeyError: '1_3'", "direct cause", "line 8, in predict"):
            self.assertIn(line, trace)
        self.assertRegex(trace, r"ValueError: no.{1,4}eyes$")
        record = (self.folder / "out" / "run.yaml").read_text()
        self.assertIn("raised ValueError: no", record)
        self.assertNotIn("Traceback", record)

    def test_what_is_no_map_fails_its_shape(self):
        for returned, cause in [
            ("None", r"the map must have"), ("shape.points", r"the map must have shape \(n,\), not \(n, 3\)"),
            ("shape.points[1:, 0]", r"the map must have shape"), ("shape.points[:, 0] * float('nan')", "finite"),
            ("['a'] * len(shape)", "real numbers"),
        ]:
            with self.subTest(returned):
                results = self.run_with({"MINE": function(f"def predict(shape):\n    return {returned}\n", self.folder)}, config=MESHES)
                for found in [failure.cause for failure in results.failures if failure.stage == "map.MINE"]:
                    self.assertRegex(found, cause)
                self.assertEqual({failure.item for failure in results.failures}, {"1", "2"})

    def test_axes_of_length_one_are_left_out(self):
        """A network returns (n, 1), or a batch of one shape."""
        models = {"MAP": lambda shape: shape.points[:, 0], "COLUMN": lambda shape: shape.points[:, :1], "BATCH": lambda shape: shape.points[None, :, :1]}
        results = self.run_with(models, config=MESHES)
        for name in models:
            np.testing.assert_array_equal(results.maps(name)["1"], results.maps("MAP")["1"])

    def test_a_shape_has_what_is_asked_for(self):
        """And the function runs in the thread that called."""
        seen, caller = {}, threading.get_ident()

        def predict(shape):
            assert threading.get_ident() == caller
            seen[shape.id] = shape
            return np.zeros(len(shape))

        self.run_with({"MINE": salbench.Model(predict, reads=["fpfh"])}, items="1")
        shape = next(iter(seen.values()))
        self.assertEqual(shape.fpfh.shape, (len(shape), 33))
        self.assertIsNone(shape.normals)
        self.assertIsNone(shape.faces)
        self.assertIsNone(shape.ground_truth)
        self.assertFalse(shape.points.flags.writeable)
        self.run_with({"TWO": predict}, items="1")
        self.assertEqual(seen[shape.id].normals.shape, shape.points.shape)
        self.assertIsNone(seen[shape.id].source)
        results = self.run_with({"TWO": salbench.Model(predict, trained_on=[shape.id.split("_")[0]])}, items="1")
        self.assertIn(" | TWO was trained on shapes that it is scored on here", (results.folder / "results.csv").read_text())
        self.assertIn("TWO was trained on shapes that it is scored on here", results.scores.attrs["remarks"][1])
        self.run_with({"THREE": salbench.Model(predict, reads=["source"])}, items="1")
        self.assertEqual(pathlib.Path(seen[shape.id].source).suffix, ".off")
        with self.assertRaisesRegex(KeyError, "reads 'colour'"):
            self.run_with({"MINE": salbench.Model(predict, reads=["colour"])})

    def test_maps_are_a_mapping_of_what_was_returned(self):
        kept = {}

        def predict(shape):
            if shape.id == "1_3":
                raise ValueError
            kept[shape.id] = shape.points[:, 0]
            return kept[shape.id]

        results = self.run_with({"MINE": predict, "LS": {}})
        maps = results.maps("MINE")
        self.assertIsInstance(maps, collections.abc.Mapping)
        scans = [f"{item}_{view}" for item in "12" for view in range(12)]
        self.assertEqual(list(maps), ["1", *(name for name in scans[:12] if name != "1_3"), "2", *scans[12:]])
        self.assertEqual((len(maps), "1_3" in maps, "2" in maps, 3 in maps, maps.get("1_3")), (25, False, True, False, None))
        for item, values in maps.items():
            np.testing.assert_array_equal(values, kept[item])
        for wrong, said in ((lambda: maps["1_33"], "called '1_33'; did you mean '1_"), (lambda: maps["nobody"], "nobody"),
                            (lambda: results.maps("mine"), "'mine'; did you mean 'MINE'"),
                            (lambda: results.maps("XX"), "no model with maps 'XX'; there are LS, MINE")):
            with self.assertRaisesRegex(KeyError, said):
                wrong()

    def test_of_two_shapes_with_one_name_none_is_taken_for_the_other(self):
        (self.meshes / "1_3.off").write_bytes((self.meshes / "2.off").read_bytes())
        results = self.run_with({"MINE": Box(1)})
        for asked in (lambda: results.maps("MINE")["1_3"], lambda: results.score(np.zeros(9), "1_3"),
                      lambda: results.write_submission(self.folder / "mine", "MINE")):
            with self.assertRaisesRegex(ValueError, "two shapes of the run are called '1_3': rename one"):
                asked()
        self.assertIn("2_3", results.maps("MINE"))

    def test_a_submission_has_maps_of_one_run(self):
        self.run_with({"MINE": Box(1)}, config=MESHES).write_submission(self.folder / "mine", "MINE")
        fewer = self.run_with({"MINE": Box(2)}, config=MESHES, items="1")
        with self.assertRaisesRegex(ValueError, "mine: holds 2.val, and the run has no such map: name an empty folder"):
            fewer.write_submission(self.folder / "mine", "MINE")
        (self.folder / "mine/2.val").unlink()
        fewer.write_submission(self.folder / "mine", "MINE")

    def test_scores_of_maps_are_those_of_the_tables(self):
        config = CONFIG | {"metrics": {"names": "all"}}
        models = {"MINE": function(HEIGHT.format(axis=0), self.folder), "TWO": function(HEIGHT.format(axis=1), self.folder), "CS": {}}
        results = self.run_with(models, config=config)
        self.assertEqual(len(results.scores), 3 * 26)
        for row in results.scores.to_dict("records"):
            item = f"{row['item']}_{row['view']}" if row["view"] else row["item"]
            scores = results.score(results.maps(row["model"])[item], item)
            for metric, score in scores.items():
                self.assertEqual(repr(score), repr(row[metric]), (item, row["model"], metric))
        of_another = results.score(-results.maps("TWO")["1"], "1")
        self.assertEqual(of_another, results.score(-results.maps("TWO")["1"], "1", model="CS"))
        own = results.score(-results.maps("TWO")["1"], "1", model="TWO")
        self.assertEqual(of_another["auc"], own["auc"], "the draws are common to all models")
        for error, what, call in [
            (KeyError, "did you mean '1_1", lambda: results.score([0], "1_111")),
            (KeyError, "'Mine'; did you mean 'MINE'", lambda: results.score([0], "1", model="Mine")),
            (ValueError, r"prediction must have shape \(\d+,\), not \(1,\)", lambda: results.score([0], "1")),
            (ValueError, "prediction: value 0 .* is nan", lambda: results.score(results.maps("CS")["1"] * np.nan, "1")),
            (ValueError, "results that run\\(\\) returned", lambda: salbench.Results(self.folder / "out").score([0], "1")),
        ]:
            with self.subTest(what), self.assertRaisesRegex(error, what):
                call()

    def test_functions_and_maps_may_answer_per_face(self):
        def read(item):
            shape = datasets.mesh(item.files[0])
            shape.face_truth = np.arange(len(shape.faces)) % 5.0
            shape.ground_truth = from_faces(shape, shape.face_truth)
            return shape

        own = datasets.Dataset([datasets.Item(item, [self.meshes / f"{item}.off"]) for item in ("1", "2")], read)
        config = {"dataset": {"scans": False, "score_on": "faces"}, "metrics": {"names": ["cc"], "matching": "none"}}
        per_face = function("def predict(shape):\n    return [k % 5 for k in range(len(shape.faces))]\n", self.folder)
        results = salbench.run(config, data=own, models={"MINE": per_face, "RS": {}}, cache=self.folder / "cache",
                               out=self.folder / "out", progress=False)
        self.assertEqual(results.failures, [])
        for item in ("1", "2"):
            row = results.scores[(results.scores.item.astype(str) == item)].set_index("model")
            self.assertAlmostEqual(row.cc["MINE"], 1, delta=1e-12)
            map_ = results.maps("RS")[item]
            self.assertEqual(results.score(map_, item), {"cc": row.cc["RS"]})
            self.assertAlmostEqual(results.score(results.maps("MINE")[item], item)["cc"], 1, delta=1e-12)
            with self.assertRaisesRegex(ValueError, "5 values for [0-9]+ points and [0-9]+ faces"):
                results.score(np.ones(5), item)
        short = salbench.run(config, data=own, models={"MINE": function("def predict(shape):\n    return [1.0, 2.0]\n", self.folder)},
                             cache=self.folder / "cache", out=self.folder / "out", progress=False)
        self.assertRegex(short.failures[0].cause, r"MINE\(\): the map: 2 values, but the shape has [0-9]+ points and [0-9]+ faces")

    def test_the_reference_is_the_histogram_that_maps_were_matched_to(self):
        results = self.run_with({"LS": {}})
        for read in (results, salbench.Results(self.folder / "out")):
            self.assertEqual(list(read.reference), ["meshes", "scans"])
            self.assertEqual(read.reference["scans"].shape, (100,))
            np.testing.assert_array_equal(salbench.match_histogram(results.maps("LS")["1"], read.reference["meshes"]),
                                          salbench.Cache(self.folder / "cache")["1"].matched["LS"])
        with self.assertRaisesRegex(ValueError, "choose one, such as results.reference\\['meshes'\\]"):
            salbench.score([0, 1], reference=results.reference)
        with self.assertRaisesRegex(KeyError, "did you mean 'scans'"):
            results.reference["scan"]
        part = self.run_with({"LS": {}}, items="1", reference=results.reference["meshes"])
        np.testing.assert_array_equal(np.asarray(part.reference), results.reference["meshes"])
        np.testing.assert_array_equal(salbench.match_histogram(part.maps("LS")["1"], part.reference),
                                      salbench.match_histogram(part.maps("LS")["1"], results.reference["meshes"]))
        with self.assertRaisesRegex(ValueError, "reference must have shape"):
            self.run_with({"LS": {}}, reference=[1, 2])

    def test_a_function_that_runs_the_program_over_the_cache_of_its_own_run_is_told_so(self):
        """Each would wait for the other. A program that it starts is another matter: nothing tells that one."""
        def predict(shape):
            self.run_with({"LS": {}}, config=MESHES, cache=inner, out=self.folder / "inner")
            return shape.points[:, 0]

        for inner, told in ((self.folder / "cache", True), (self.folder / "another", False)):
            results = self.run_with({"MINE": salbench.Model(predict, cache=False, version=1)}, config=MESHES)
            self.assertEqual(["give it a separate cache" in failure.cause for failure in results.failures], [True, True] if told else [])

    def test_names_that_are_no_utf8_go_through_functions_and_results(self):
        os.rename(self.meshes / "1.off", os.fsencode(self.meshes) + b"/caf\xe9.off")

        def predict(shape):
            if shape.id == "2":
                raise ValueError("two")
            return shape.points[:, 0]

        results = self.run_with({"MINE": salbench.Model(predict, version=1), "LS": {}})
        name = os.fsdecode(b"caf\xe9")
        self.assertEqual([failure.item for failure in results.failures], ["2"])
        self.assertIn(name, set(results.scores.item))
        self.assertEqual(results.score(results.maps("MINE")[name], name)["nss"], results.score(results.maps("MINE")[name], name, model="MINE")["nss"])
        with self.assertRaisesRegex(KeyError, "no item in the run"):
            results.score([0], name + "x")

    def test_a_process_that_a_function_forks_ends_where_it_would_go_on_with_the_run(self):
        program = self.folder / "forking.py"
        program.write_text(textwrap.dedent(f"""\
            import os, sys
            import salbench

            def predict(shape):
                child = os.fork()
                if child == 0 and sys.argv[1] == "exits":
                    sys.exit(3)
                if child == 0 and sys.argv[1] == "raises":
                    raise ValueError("in the child")
                if child != 0:
                    _, status = os.waitpid(child, 0)
                    print("child", os.waitstatus_to_exitcode(status), flush=True)
                return shape.points[:, 0]

            results = salbench.run({MESHES!r}, data={str(self.meshes)!r}, models={{"MINE": salbench.Model(predict, version=1, cache=False)}},
                                   items="1", cache={str(self.folder / "cache")!r}, out={str(self.folder / "out")!r}, progress=False)
            print("done", len(results.failures), flush=True)
            """))
        for kind, status in (("returns", 0), ("exits", 3), ("raises", 1)):
            with self.subTest(kind):
                ended = subprocess.run([sys.executable, "-W", "ignore", program, kind], capture_output=True, text=True, timeout=300)
                self.assertEqual(ended.returncode, 0, ended.stderr)
                lines = ended.stdout.splitlines()
                self.assertEqual(lines[-1], "done 0")
                self.assertEqual(set(lines[:-1]), {f"child {status}"})
                self.assertEqual("let it end with os._exit()" in ended.stderr, kind != "exits")

    def test_a_model_says_what_it_is(self):
        def cut(shape):
            return shape.points[:, 2]

        cut.__doc__ = "Broken \ud800 text" + " long" * 100
        for given, said in ((Net(), 'Heights: a "network" # of one layer.'), (Bare(), ""), (lambda shape: shape, ""), (cut, "Broken ? text" + " long" * 57 + " l"),
                            (functools.partial(Net.__call__, Net()), ""), (Net().__call__, "")):
            self.assertEqual(described(given), said)
        self.run_with({"MINE": Net(), "BARE": Bare()}, config=MESHES)
        models = yaml.safe_load((self.folder / "out/run.yaml").read_text())["configuration"]["models"]
        self.assertEqual([models[name].get("description") for name in ("MINE", "BARE")], ['Heights: a "network" # of one layer.', None])
        self.assertEqual(salbench.run(self.folder / "out/run.yaml", data=self.meshes, out=self.folder / "again", progress=False).models["MINE"]["computed"], 0)

    def test_items_with_ground_truth_and_splits_are_run_alone(self):
        points, faces = sphere(5, 6)
        own = datasets.Dataset([datasets.Item(name, split=split, truth=name != "1") for name, split in zip("1234", ("train", "train", "test", "test"))],
                               lambda item: datasets.Shape(int(item.name) * points, faces, ground_truth=points[:, 2] if item.name != "1" else None))
        config, seen = {"dataset": {"scans": False, "split": "test"}}, []

        def predict(shape):
            seen.append(shape.id)
            return shape.points[:, 0]

        for keywords, items in [({"split": "train"}, "12"), ({"split": "train", "items": "scored"}, "2"), ({}, "34"), ({"split": ""}, "1234"),
                                ({"split": "", "items": "scored"}, "234")]:
            with self.subTest(keywords):
                seen.clear()
                self.run_with({"MINE": salbench.Model(predict, cache=False)}, config=config, data=own, **keywords)
                self.assertEqual("".join(sorted(seen)), items)
        for keywords, what in (({"split": "trian"}, "did you mean 'train'"), ({"items": "5-box"}, "no item '5-box'")):
            with self.subTest(what), self.assertRaisesRegex(KeyError, what):
                self.run_with({"LS": {}}, config=config, data=own, **keywords)

    def test_a_warning_recommends_arguments_of_run(self):
        with self.assertLogs("salbench", "WARNING") as logged:
            self.run_with({"LS": {}}, items="1")
        text = "\n".join(logged.output)
        self.assertIn("reference='items' matches to the mean over these alone", text)
        self.assertNotIn("--", text)
        self.assertIn("reference", inspect.signature(salbench.run).parameters)
        with self.assertRaisesRegex(OSError, "choose another with `out`"):
            (self.folder / "file").write_text("")
            self.run_with({"LS": {}}, out=self.folder / "file" / "out")

    def test_a_notebook_shows_results(self):
        results = self.run_with({"LS": {}, "A": function(HEIGHT.format(axis=0), self.folder)})
        page = results._repr_html_()
        self.assertIn("artefacts computed", page)
        self.assertIn("<td>LS</td>", page)
        for path in (self.folder / "out").glob("*.csv"):
            path.unlink()
        self.assertNotIn("<table", salbench.Results(self.folder / "out")._repr_html_())

    def test_a_map_that_was_damaged_since_is_computed_again(self):
        results = self.run_with({"MINE": function(HEIGHT.format(axis=0), self.folder)})
        name = results.scores.item[0]
        before = results.maps("MINE")[name].copy()
        for item in results.scores.item[results.scores.model == "MINE"]:
            damage(self.folder / "cache", "map.MINE", item)
        with self.assertLogs("salbench", "WARNING"):
            np.testing.assert_array_equal(results.maps("MINE")[name], before)

    def test_what_cannot_be_run_is_refused_by_its_name(self):
        def of(model, version=1):
            return {"models": {"MINE": salbench.Model(model, version=version)}}

        for named, *calls in [
            ("models.ls", {"models": {"ls": {}}}), ("foci_share", {"models": {"LS": {"foci": 1}}}), ("a/b", {"models": {"a/b": len}}),
            ("^models .*{'LS': {}}", {"models": ["LS"]}, {"models": "LS"}, {"models": {"LS"}}, {"models": []}),
            ("^models .*'CS'", {"models": ("LS", "CS")}), ("^models .*{'len': function}", {"models": len}, {"models": [len]}),
            ("^models", {"models": 3}, {"models": salbench.Model(len)}),
            *((f"'{name}'", {"models": {name: len}}) for name in ("hs", "Rs", "CONSTANT", "gs", "avg", "lS", "Remarks")),
            *((f"^{name}\\b", {name: ""}) for name in ("config", "data", "cache", "out", "reference")),
            ("MINE: version.* 2147483647.*2147483648", of(np.copy, 2**31)), ("MINE: version.*-1", of(np.copy, -1)),
            ("MINE: version", of(np.copy, [1, 2]), of(len, 1.5)), ("seed.*-1", {"config": CONFIG | {"seed": -1}}),
            ("splits", {"config": CONFIG | {"metrics": {"splits": [3, 4]}}}), ("^config.*shrec07", {"config": ["shrec07"]}),
            ("splits.*-2147483648 to 2147483647", {"config": CONFIG | {"metrics": {"splits": 10**30}}}),
            ("version.*2147483647", {"models": {"MINE": {"command": "cp {mesh} {out}", "version": 2**40}}}),
        ]:
            for keywords in calls:
                with self.subTest(keywords), self.assertRaisesRegex(ValueError, named):
                    self.run_with(**{"models": {"LS": {}}} | keywords)
        for error, named, call in [
            (ValueError, "^items", lambda: salbench.Dataset("folder", self.meshes, items=5)), (ValueError, "^folder", lambda: salbench.Results("")),
            (FileNotFoundError, "shrec7", lambda: salbench.run("shrec7", data=self.meshes)),
            (FileNotFoundError, "nowhere", lambda: salbench.run(CONFIG, data="nowhere")), (ValueError, "data='DIR'", lambda: salbench.run(CONFIG)),
            (ValueError, "its folder", lambda: salbench.run(CONFIG, data=salbench.Dataset("folder", self.meshes))),
            (ValueError, "^depends", lambda: salbench.Model(len, depends="weights.bin")),
            (ValueError, "^depends", lambda: salbench.Model(len, depends=pathlib.Path("weights.bin"))),
        ]:
            with self.subTest(named), self.assertRaisesRegex(error, named):
                call()

    def test_ctrl_c_ends_the_run_in_order_and_the_next_call_goes_on(self):
        program = self.folder / "slow.py"
        program.write_text(textwrap.dedent(f"""\
            import sys, time
            import salbench

            shapes, HELD = [], int(sys.argv[1])
            def predict(shape):
                print(shape.id, flush=True)
                shapes.append(shape.id)
                while len(shapes) == HELD:  # until Ctrl-C
                    time.sleep(0.01)
                return shape.points[:, 0]

            try:
                results = salbench.run({CONFIG!r}, data={str(self.meshes)!r}, models={{"MINE": salbench.Model(predict, version=1)}},
                                       cache={str(self.folder / "cache")!r}, out={str(self.folder / "out")!r}, progress=False)
            except KeyboardInterrupt:
                print("interrupted", flush=True)
                sys.exit(9)
            print("computed", results.computed)
            """))
        held = subprocess.Popen([sys.executable, program, "3"], stdout=subprocess.PIPE, text=True)
        for _ in range(3):
            held.stdout.readline()
        held.send_signal(signal.SIGINT)
        rest = held.communicate()[0]
        self.assertEqual((held.returncode, rest), (9, "interrupted\n"))
        self.assertTrue((self.folder / "out" / "run.yaml").is_file())
        again = subprocess.run([sys.executable, program, "0"], capture_output=True, text=True, check=True)
        shapes = [line for line in again.stdout.splitlines() if not line.startswith("computed")]
        self.assertEqual(len(shapes), 26 - 2)

    def test_after_an_interrupt_the_same_process_runs_commands_again(self):
        def interrupted(shape):
            raise KeyboardInterrupt

        command = {"command": "cp {mesh} kept; /usr/bin/awk '/element vertex/ {n = $3} END {for (i = 0; i < n; ++i) print i}' kept > {out}"}
        with self.assertRaises(KeyboardInterrupt):
            self.run_with({"MINE": salbench.Model(interrupted, version=1), "COUNTED": command})
        results = self.run_with({"MINE": salbench.Model(lambda shape: shape.points[:, 0], version=1), "COUNTED": command})
        self.assertEqual(results.failures, [])
        np.testing.assert_array_equal(results.maps("COUNTED")["1"], np.arange(len(results.maps("COUNTED")["1"])))

    def test_a_process_that_was_forked_after_a_run_and_computing_computes(self):
        def work():
            points, faces = sphere(40, 60)
            return np.concatenate([salbench.models.vis(points, faces, threads=2), salbench.simulate_scans(points, faces, step_degrees=2)[0].points[:, 0],
                                   salbench.models.ls(points), [salbench.score(points[:, 0], points[:, 1], [1], metrics="cc")["cc"]]])

        self.run_with({"LS": {}})
        expected = work()
        child = os.fork()
        if child == 0:
            try:
                os._exit(0 if np.array_equal(work(), expected) else 1)
            finally:
                os._exit(2)
        self.assertEqual(os.waitpid(child, 0)[1], 0)

    def test_a_run_in_a_thread_that_the_interpreter_does_not_wait_for_ends_in_order(self):
        script = f"""
            import threading, time
            import salbench
            called = threading.Event()
            def predict(shape):
                called.set()
                while threading.main_thread().is_alive():
                    time.sleep(.001)
                return salbench.models.cb(shape)
            keywords = {{"data": {str(self.meshes)!r}, "cache": {str(self.folder / "cache")!r}, "out": {str(self.folder / "out")!r}, "progress": False}}
            threading.Thread(target=salbench.run, args=[{CONFIG!r}], kwargs={{**keywords, "models": {{"MINE": salbench.Model(predict, version=1)}}}}, daemon=True).start()
            called.wait()
            """
        for _ in range(2):
            ended = subprocess.run([sys.executable, "-B", "-c", textwrap.dedent(script)], capture_output=True, text=True)
            self.assertEqual((ended.returncode, ended.stderr), (0, ""))
        self.assertEqual(len(salbench.Cache(self.folder / "cache").maps("MINE")), 2, "one of each call")

    def test_a_run_in_a_function_for_the_end_of_the_interpreter_goes_on(self):
        script = f"""
            import atexit
            keywords = {{"data": {str(self.meshes)!r}, "cache": {str(self.folder / "cache")!r}, "out": {str(self.folder / "out")!r}, "progress": False}}
            atexit.register(lambda: print(salbench.run({CONFIG!r}, models={{"CB": None}}, **keywords).computed))  # called after that of the package
            import salbench.models
            """
        ended = subprocess.run([sys.executable, "-B", "-c", textwrap.dedent(script)], capture_output=True, text=True)
        self.assertEqual((ended.returncode, ended.stderr), (0, ""))
        self.assertGreater(int(ended.stdout), 0)


class Box:
    """An object with weights; called, it is a model."""

    def __init__(self, weight):
        self.weight = weight

    def __call__(self, shape):
        return self.weight * shape.points[:, 2]


def by_closure(weight):
    return lambda shape: weight * shape.points[:, 2]


class Plans(Folders):
    def plan_with(self, models, **keywords):
        return salbench.plan(CONFIG, data=self.meshes, models=models, cache=self.folder / "cache", out=self.folder / "out", **keywords)

    def test_nothing_is_called_or_written(self):
        def never(shape):
            raise AssertionError

        planned = self.plan_with({"MINE": never, "PS": {}})
        self.assertEqual(planned.to_compute["map.MINE"], 26)
        self.assertEqual(planned["schema"], 2)
        self.assertEqual(planned.frame().set_index("stage").loc["map.PS", "waiting"], 26)
        self.assertIn("26 map.MINE: waits for", repr(planned))
        self.assertFalse((self.folder / "cache").exists() or (self.folder / "out").exists())

    def test_a_plan_takes_the_arguments_of_a_run(self):
        self.assertEqual(inspect.signature(salbench.plan).parameters, inspect.signature(salbench.run).parameters)
        self.assertEqual(self.plan_with({"PS": {}}, threads=1, progress=False, keep_going=True), self.plan_with({"PS": {}}))

    def test_what_is_there_is_not_planned(self):
        height = function(HEIGHT.format(axis=2), self.folder)
        self.run_with({"MINE": height})
        self.assertEqual(self.plan_with({"MINE": height}).to_compute, {})
        self.assertEqual(self.plan_with({"MINE": height, "V": {"model": "LS", "grid": {"foci_sigma": [1]}}}).to_compute["map.V-1"], 26)


class SameFailures(Folders):
    def test_a_function_that_fails_alike_on_the_first_shapes_is_not_tried_on_the_others(self):
        def each_another(shape, count=iter(range(26))):
            raise ValueError("bad" * next(count))

        tables = {
            "one message": (lambda shape: 1 / 0, False, 5),
            "each another": (each_another, False, 26),
            "asked to go on": (lambda shape: 1 / 0, True, 26),
        }
        for number, (name, (model, keep_going, failed)) in enumerate(tables.items()):
            with self.subTest(name):
                results = self.run_with({f"MINE{number}": model}, keep_going=keep_going)
                self.assertEqual(len([each for each in results.failures if each.stage == f"map.MINE{number}"]), failed)

    def test_it_is_said_once_and_what_is_there_stays(self):
        def fails(shape):
            raise ValueError(f"no weights of version 1.1 for {shape.id}")  # where 1 is the name of a shape, too

        with self.assertLogs("salbench", "ERROR") as logged:
            self.run_with({"MINE": fails, "PS": {}})
        said = [line for line in logged.output if "no weights" in line]
        self.assertEqual(len(said), 1, said)
        self.assertIn("failed alike on its first 5 items (1, 2, 1_0, 2_0, 1_1), and is not tried on the other 21; keep_going=True tries all", said[0])
        self.assertEqual(self.run_with({"PS": {}}).computed, 0)


    def test_it_holds_for_shapes_of_a_function_on_several_threads(self):
        mesh = salbench.Dataset("automatic", self.meshes)["1"]
        data = salbench.datasets.Dataset(
            [salbench.datasets.Item(f"s{k}") for k in range(8)],
            lambda item: salbench.datasets.Shape(int(item.name[1]) + mesh.points, mesh.faces, ground_truth=mesh.points[:, 0] ** 2), name="mine")
        results = self.run_with({"MINE": lambda shape: 1 / 0}, data=data, config={"dataset": {"scans": False}}, threads=2)
        self.assertEqual(len(results.failures), 5)


CHANGED = "options, inputs, seed or version changed"


class Versions(Folders):
    config = MESHES

    def test_functions_with_a_version_are_told_apart_by_name(self):
        for name, axis in (("A", 0), ("B", 2)):
            results = self.run_with({name: salbench.Model(lambda shape: shape.points[:, axis], version=1)})  # noqa: B023: called at once
            self.assertEqual(results.models[name]["computed"], 2)


class StaleMaps(Folders):
    """Two models of one name: the second has maps of its own if it differs, and those of the first if it does not. What differs:
    fingerprint_test.py."""

    config = MESHES

    def test_a_changed_function_computes_its_maps_again(self):
        changes = {
            "another closure": (lambda: by_closure(1), lambda: by_closure(-1)),
            "a file": (lambda: self.by_file(b"1"), lambda: self.by_file(b"2")),
        }
        for number, (name, (before, after)) in enumerate(changes.items()):
            with self.subTest(name):
                model = f"MINE{number}"
                first = self.run_with({model: before()})
                maps = {item: first.maps(model)[item] for item in ("1", "2")}
                self.assertEqual((first.models[model]["computed"], self.run_with({model: before()}).models[model]["computed"]), (2, 0))
                changed = after()
                planned = salbench.plan(MESHES, data=self.meshes, models={model: changed}, cache=self.folder / "cache", out=self.folder / "out")
                self.assertEqual((planned.why[f"map.{model}"], planned.to_compute[f"map.{model}"]), ({CHANGED: 2}, 2))
                second = self.run_with({model: changed})
                self.assertEqual(second.models[model]["computed"], 2)
                self.assertEqual(any((maps[item] != second.maps(model)[item]).any() for item in maps), name != "a file")
                record = yaml.safe_load((self.folder / "out/run.yaml").read_text())
                self.assertEqual(record["stages"][f"map.{model}"]["why"], {CHANGED: 2})

    def by_file(self, content):
        (self.folder / "weights").write_bytes(content)
        return salbench.Model(lambda shape: shape.points[:, 2], version=1, depends=[self.folder / "weights"])

    def test_what_cannot_be_walked_is_computed_anew_with_a_line(self):
        box = Box(1.0)
        box.lock = threading.Lock()
        for _ in range(2):
            with self.assertLogs("salbench", "WARNING") as said:
                results = self.run_with({"MINE": box})
            self.assertEqual(results.models["MINE"]["computed"], 2)
            self.assertEqual(len(said.output), 1)
            self.assertRegex(said.output[0], r"MINE: its maps are computed anew in each call.*: lock: a lock .*has no content")
            np.testing.assert_array_equal(results.maps("MINE")["1"], salbench.Dataset("folder", self.meshes)["1"].points[:, 2])
        with self.assertNoLogs("salbench", "WARNING"):
            self.run_with({"MINE": salbench.Model(box, version=1)})
            self.assertEqual(self.run_with({"MINE": salbench.Model(box, version=1)}).models["MINE"]["read"], 2)

    def test_a_version_counts_alone_beside_depends(self):
        def run(weight, **what):
            return self.run_with({"MINE": salbench.Model(Box(weight), **what)}).models["MINE"]["computed"]

        self.assertEqual([run(1, version=1), run(2, version=1), run(2, version=0), run(3, version=1, depends=[{"a": np.ones(3)}]),
                          run(4, version=1, depends=[{"a": np.ones(3)}]), run(4, version=1, depends=[{"a": np.zeros(3)}])],
                         [2, 0, 2, 2, 0, 2])
        model = salbench.Model(Box(1), version=1, depends=(value for value in [1]))
        self.assertEqual([self.run_with({"MINE": model}).models["MINE"]["computed"] for _ in range(2)], [2, 0])

    def test_a_model_without_a_cache_is_computed_in_each_call_and_no_other_is(self):
        @salbench.model(cache=False)
        def mine(shape):
            return shape.points[:, 0]

        for read in (0, 2):
            results = self.run_with({"MINE": mine, "KEPT": lambda shape: shape.points[:, 1]})
            self.assertEqual(results.models["MINE"], {"computed": 2, "read": 0, "from": None})
            self.assertEqual(results.models["KEPT"]["read"], read)
            self.assertEqual(results.maps("MINE")["2"].ndim, 1)

    def test_results_say_how_many_maps_are_new_and_from_when_the_others_are(self):
        before = datetime.datetime.now() - datetime.timedelta(seconds=2)
        first = self.run_with({"LS": {}, "MINE": Box(1)})
        self.assertEqual(list(first.models), ["LS", "MINE"])
        with contextlib.redirect_stderr(io.StringIO()) as said:
            second = self.run_with({"LS": {}, "MINE": Box(2)}, progress=True)
        maps = second.models["LS"]
        self.assertEqual((maps["computed"], maps["read"]), (0, 2))
        self.assertTrue(before <= maps["from"][0] <= maps["from"][1] <= datetime.datetime.now())
        lines = said.getvalue().splitlines()
        self.assertIn(f"results in {self.folder / 'out'}, cache in {self.folder / 'cache'}", lines[-2])
        self.assertIn("results.ranking", lines[-1])
        self.assertTrue([line for line in lines if line.startswith("On ")])
        lines = lines[-4:-2]
        self.assertRegex(lines[0], r"^LS: 0 maps computed now, 2 read \(from \d{4}-\d\d-\d\d \d\d:\d\d( to .*)?\)$")
        self.assertEqual(lines[1], "MINE: 2 maps computed now, 0 read")
        self.assertIn(lines[0], repr(second))
        self.assertEqual(salbench.Results(self.folder / "out").models, {})

    def test_a_report_is_written_by_the_package_that_the_caller_has(self):
        quick = "\nfrom tests.support.without_figures import without_figures\nwith without_figures(): sys.exit"
        quick = _IN_PROCESS.replace("sys.exit", quick)
        self.enterContext(unittest.mock.patch("salbench.runs.results._IN_PROCESS", quick))
        results = self.run_with({"LS": {}, "RS": {}, "MINE": Net()}, config=MESHES)
        page = results.report(self.folder / "report", models=["LS", "MINE"], metrics="nss", examples="2", viewer=False)
        self.assertEqual(page, self.folder / "report/index.html")
        text = page.read_text()
        self.assertFalse("<title>Unfinished" in text or "AUC" in text)
        self.assertIn("Heights: a &#34;network&#34; # of one layer", text)
        with self.assertRaisesRegex(ValueError, f"^{self.folder / 'none.h5'}: [^\\n]+$"):
            results.report(self.folder / "report", exports=str(self.folder / "none.h5"))

    def test_items_are_names_or_a_text_and_not_nothing(self):
        (self.meshes / "a, b.off").write_bytes((self.meshes / "1.off").read_bytes())
        for items, found in (["a, b"], {"a, b"}), (["a, b", "1"], {"a, b", "1"}), ([1, 2], {"1", "2"}), ("1-2", {"1", "2"}), ("1,2", {"1", "2"}):
            self.assertEqual({*self.run_with({"MINE": Box(1)}, config=MESHES, items=items).scores.item}, found)
        with self.assertRaisesRegex(KeyError, "no item 'a'"):
            self.run_with({"MINE": Box(1)}, items="a, b")
