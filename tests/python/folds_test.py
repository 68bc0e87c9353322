# SPDX-License-Identifier: GPL-3.0-or-later
"""Models that learn: nothing that a map was trained on is in its fold, what is known is not trained again, and tables say how it was."""

import contextlib
import io
import os
import re
import shutil
import subprocess
import sys
import tempfile
import textwrap
import unittest

import numpy as np
import pandas

import salbench
import toy
from salbench.datasets.records import Item
from salbench.runs.folds import Dealing, dealt, in_split, with_scans

CONFIG = {"dataset": {"scans": False}, "metrics": {"names": ["cc"]}}
CHANGED = "options, inputs, seed or version changed"
MEMORY = """
    import numpy

    def fit(shapes):
        with open({log!r}, "a") as file:
            print(*(shape.id for shape in shapes), file=file)
        points = numpy.concatenate([shape.points for shape in shapes])
        truth = numpy.concatenate([shape.ground_truth for shape in shapes])

        def predict(shape):
            return truth[numpy.square(shape.points[:, None] - points).sum(axis=2).argmin(axis=1)]
        return predict
    """
OTHER = MEMORY.replace("truth[", "2 * truth[")


class Height:
    """Trained model for tests of storage: a weight of the height."""

    def __init__(self, weight):
        self.weight = weight

    def __call__(self, shape):
        return shape.points[:, 2] * self.weight


def items(*rows):
    return [Item(name, shape=shape, category=category, split=split, truth=True) for name, shape, category, split in rows]


class Plans(unittest.TestCase):
    many = items(*((f"{mesh}_{view}", str(mesh), f"class {mesh % 7}", "") for mesh in range(40) for view in (300, 413)))

    def test_each_shape_is_in_one_fold_and_trains_all_others(self):
        for by in ("class", "mesh"):
            plan = dealt(self.many, 5, by, 0)
            self.assertEqual(list(plan.fold_of), [item.name for item in self.many])
            for fold, training in enumerate(plan.training):
                self.assertEqual(set(training), {name for name, own in plan.fold_of.items() if own != fold})

    def test_views_of_a_mesh_and_shapes_of_a_class_never_part(self):
        for seed in range(20):
            for by, group in (("mesh", lambda item: item.shape), ("class", lambda item: item.category)):
                plan = dealt(self.many, 5, by, seed)
                folds = {}
                for item in self.many:
                    folds.setdefault(group(item), set()).add(plan.fold_of[item.name])
                self.assertEqual({len(found) for found in folds.values()}, {1})
                sizes = np.bincount([found.pop() for found in folds.values()], minlength=5)
                self.assertLessEqual(sizes.max() - sizes.min(), 1, "groups are dealt evenly")

    def test_a_view_with_another_class_stays_with_its_mesh(self):
        plan = dealt(items(("a_1", "a", "x", ""), ("a_2", "a", "y", ""), ("b", "b", "y", ""), ("c", "c", "z", "")), 3, "class", 0)
        self.assertEqual(plan.fold_of["a_1"], plan.fold_of["a_2"])

    def test_folds_follow_from_seed_and_names_alone(self):
        plan = dealt(self.many, 5, "mesh", 0)
        self.assertEqual(dealt(self.many[::-1], 5, "mesh", 0).fold_of, dict(plan.fold_of))
        self.assertNotEqual(dealt(self.many, 5, "mesh", 1).fold_of, dict(plan.fold_of))
        few = dealt(items(*((str(mesh), "", "", "") for mesh in range(6))), 2, "mesh", 0)
        order = [4, 0, 2, 1, 5, 3]  # for n in 0 1 2 3 4 5; do echo $(printf 0/$n | sha256sum) $n; done | sort
        self.assertEqual([few.fold_of[str(mesh)] for mesh in order], [0, 1] * 3)

    def test_plans_say_how_they_are(self):
        self.assertEqual(dealt(self.many, 5, "class", 0).how, "cross-validated, 5 folds by class")
        self.assertEqual(dealt(self.many, 3, "mesh", 7).how, "cross-validated, 3 folds by mesh, seed 7")

    def test_what_cannot_be_dealt(self):
        with self.assertRaisesRegex(ValueError, "folds must be 2 to 7, the number of classes with ground truth, not 8"):
            dealt(self.many, 8, "class", 0)
        with self.assertRaisesRegex(ValueError, "2 to 40, .* not 1"):
            dealt(self.many, 1, "mesh", 0)
        with self.assertRaisesRegex(ValueError, "by must be class, mesh or split, not 'item'"):
            dealt(self.many, 5, "item", 0)
        with self.assertRaisesRegex(ValueError, "1 of 2 shapes have no class, such as b: take by='mesh'"):
            dealt(items(("a", "", "x", ""), ("b", "", "", "")), 2, "class", 0)

    def test_splits_are_trained_on_all_but_one(self):
        rows = items(("a", "a", "", "train"), ("b", "b", "", "val"), ("c", "c", "", "test"), ("d", "d", "", ""))
        plan = in_split(rows, "test")
        self.assertEqual((plan.fold_of, plan.training, plan.how), ({"c": 0}, [["a", "b"]], "trained on splits train and val"))
        for split, rest in (("dev", "score; splits with ground truth: train, val, test"), ("", "score")):
            with self.assertRaisesRegex(KeyError, f"nothing to {rest}"):
                in_split(rows, split)
        with self.assertRaisesRegex(KeyError, "nothing to train on; splits with ground truth: test"):
            in_split(rows[2:], "test")
        with self.assertRaisesRegex(ValueError, "a: has views in split test"):
            in_split(items(("a_1", "a", "", "train"), ("a_2", "a", "", "test")), "test")

    def test_scans_are_in_the_fold_of_their_mesh(self):
        plan = with_scans(dealt(items(("a", "", "", ""), ("b", "", "", "")), 2, "mesh", 0))
        views = len(salbench.simulate_scans(np.eye(3), [[0, 1, 2]], step_degrees=10))
        self.assertEqual(list(plan.fold_of), ["a", "b", *(f"{name}_{view}" for name in "ab" for view in range(views))])
        self.assertEqual({plan.fold_of[f"a_{view}"] for view in range(views)}, {plan.fold_of["a"]})
        two = Dealing("", {"a": 0, "a_3": 1}, [["a_3"], ["a"]])
        with self.assertRaisesRegex(ValueError, "a_3 is the name of a shape and of scan 3 of a"):
            with_scans(two)


class Runs(toy.InAFolder):
    @classmethod
    def setUpClass(cls):
        cls.made = toy.learnable(cls.enterClassContext(tempfile.TemporaryDirectory()))

    def setUp(self):
        super().setUp()
        self.log = self.folder / "log"
        self.data = shutil.copytree(self.made, self.folder / "data")

    def fit(self, text=MEMORY):
        names = {}
        exec(textwrap.dedent(text).format(log=str(self.log)), names)
        return names["fit"]

    def run_with(self, fit, config=CONFIG, **keywords):
        self.log.write_text("")
        keywords = {"models": {}, "by": "mesh", "cache": self.folder / "cache", "out": self.folder / "out", "progress": False} | keywords
        return salbench.cross_validate(fit, self.data, config, **keywords)

    def trained(self):
        """Numbers of the shapes that each training of the last run saw."""
        return sorted(line.split() for line in self.log.read_text().splitlines())

    def test_what_was_learnt_by_heart_scores_at_chance(self):
        """The nearest point that was seen: of the shape itself or its scans it has the answer, of all others a random number."""
        config = CONFIG | {"dataset": {"scans": True}, "scan": {"step_degrees": 1}}
        results = self.run_with(self.fit(), config)
        means = results.scores.groupby("dataset").cc.mean()
        self.assertEqual((len(results.scores), results.failures), (130, []))
        self.assertLess(means.abs().max(), 0.1)
        leaking = self.fit()(list(salbench.Dataset("schelling", self.data)))
        results = salbench.run(config, data=self.data, models={"MINE": leaking}, cache=self.folder / "cache", out=self.folder / "out", progress=False)
        means = results.scores.groupby("dataset").cc.mean()
        self.assertGreater(means["meshes"], 0.99, "a leak would be seen")
        self.assertGreater(means["scans"], 0.4)

    def test_a_rerun_trains_nothing_in_a_new_interpreter_either(self):
        first = self.run_with(self.fit())
        self.assertEqual((first.models["MINE"]["trained"], len(self.trained())), (5, 5))
        self.assertIn("MINE: 5 folds trained now, 10 maps computed now", repr(first))
        self.assertEqual(self.run_with(self.fit()).models["MINE"] | {"from": ""}, {"computed": 0, "read": 10, "from": "", "trained": 0, "failed": 0})
        module = self.folder / "mine.py"
        module.write_text(textwrap.dedent(MEMORY).format(log=str(self.log)))
        code = ("import mine, salbench; print(salbench.cross_validate(mine.fit, {!r}, {!r}, by='mesh', cache={!r}, out={!r}, progress=False)"
                ".models['MINE']['trained'])").format(*map(str, (self.data,)), CONFIG, *map(str, (self.folder / "cache", self.folder / "out")))
        said = [subprocess.run([sys.executable, "-B", "-c", code], cwd=self.folder, capture_output=True, text=True, check=True,
                               env=os.environ | {"PYTHONHASHSEED": seed}).stdout for seed in "12"]
        self.assertEqual(said, ["0\n", "0\n"])
        self.assertEqual(self.trained(), [])

    def test_folds_that_share_what_they_train_fail_instead_of_leaking(self):
        nearest = {}
        counted = []

        class Counts:
            def __init__(self, shapes):
                self.n = self.count(shapes)

            def count(self, shapes):
                counted.append(len(shapes))
                return len(shapes)

            def __call__(self, shape):
                return shape.points[:, 2] * self.n

        def shares(shapes):
            nearest["x"] = shapes[0].points[:, 0].mean() + len(nearest) + shapes[-1].points[0, 0]
            return lambda shape: shape.points[:, 2] + nearest["x"] * shape.points[:, 1]

        keep = self.folder / "kept-apart"
        with self.assertLogs("salbench", "WARNING") as logged:
            results = self.run_with({"SHARES": shares, "COUNTS": Counts}, keep=keep)
        changes = [line for line in logged.output if "fit changes" in line]
        self.assertEqual([line.split(":")[2] for line in sorted(changes)], ["COUNTS", "SHARES"])
        self.assertEqual({(failure.stage, failure.cause.splitlines()[0].partition(":")[0]) for failure in results.failures},
                         {("map.SHARES", "SHARES() raised ValueError")})
        self.assertEqual([results.models["SHARES"][of] for of in ("computed", "trained", "failed")], [10 - len(results.failures), 1, 1])
        self.assertEqual(results.models["COUNTS"]["computed"], 10, "a history that changes no map is no leak")
        self.assertEqual([len([*(keep / name).glob("*.pickle")]) for name in ("SHARES", "COUNTS")], [1, 5])
        self.assertNotIn("learning.py", results.failures[0].cause.splitlines()[0])

    def test_a_model_whose_predictions_draw_numbers_is_no_leak(self):
        def draws(shapes):
            numbers = np.random.default_rng(len(shapes))
            return lambda shape: numbers.random(len(shape.points))

        results = self.run_with({"DRAWS": draws})
        self.assertEqual((results.failures, results.models["DRAWS"]["computed"]), ([], 10))

    def test_a_plan_names_the_folds_that_would_be_trained(self):
        def planned(fit=None, **keywords):
            return self.run_with(fit or self.fit(), plan=True, **keywords)

        self.assertEqual(planned().folds, {"MINE": [0, 1, 2, 3, 4]})
        self.assertEqual((self.trained(), (self.folder / "cache").exists(), (self.folder / "out").exists()), ([], False, False))
        kept, model = self.folder / "kept", salbench.Model(lambda shapes: Height(len(shapes)), version=5)
        self.run_with(model, keep=kept, cache=self.folder / "cache-of-kept")
        self.assertEqual(planned(model, keep=kept).folds, {"MINE": []})
        self.assertEqual(planned(model).folds, {"MINE": [0, 1, 2, 3, 4]})
        self.run_with(self.fit())
        self.assertEqual((planned().folds, planned().to_compute), ({"MINE": []}, {}))
        other = self.fit(MEMORY.replace("points =", "unused = 3; points ="))
        changed = planned(other)
        self.assertEqual(changed.folds, {"MINE": [0, 1, 2, 3, 4]})
        self.assertEqual(changed.why["map.MINE"], {CHANGED: 10})
        (self.data / "Distributions/21.val").write_text((self.data / "Distributions/21.val").read_text().replace("0.", "0.1", 1))
        shapes = planned()
        self.assertEqual((len(shapes.folds["MINE"]), shapes.why["map.MINE"]), (4, {CHANGED: 8}))

    def test_a_split_of_the_configuration_takes_no_part(self):
        config = CONFIG | {"dataset": {"scans": False, "split": "train"}}
        with self.assertLogs("salbench", "WARNING") as logged:
            plan = self.run_with(self.fit(), config, plan=True)
        self.assertIn("the configuration's split train takes no part: folds by mesh are dealt out over all shapes", "\n".join(logged.output))
        self.assertEqual(plan.to_compute["map.MINE"], 10)
        self.assertIn("matched.MINE", plan.to_compute)
        unmatched = self.run_with(self.fit(), CONFIG | {"metrics": {"names": ["cc"], "matching": "none"}}, plan=True)
        self.assertNotIn("matched.MINE", unmatched.to_compute)

    def test_a_table_says_who_is_in_which_fold(self):
        results = self.run_with(self.fit())
        table = pandas.read_csv(results.folder / "folds.csv", dtype={"item": str})
        scored = table[table["role"] == "scored"]
        self.assertEqual(sorted(scored["item"]), sorted(map(str, results.scores["item"])))
        for fold, own in scored.groupby("fold"):
            training = set(table.loc[(table["fold"] == fold) & (table["role"] == "trained on"), "item"])
            self.assertEqual(training, set(scored["item"]) - set(own["item"]))

    def test_tables_of_folds_go_with_another_run_into_the_folder(self):
        tables = [self.folder / "out" / name for name in ("folds.csv", "training.csv")]
        for _ in range(2):  # the second knows the seconds of the first
            results = self.run_with(self.fit())
            self.assertEqual([*map(os.path.exists, tables), results.training.seconds.notna().all()], [True] * 3)
        salbench.run(CONFIG, data=self.data, models={"RS": {}}, cache=self.folder / "cache", out=self.folder / "out", progress=False)
        self.assertEqual([*map(os.path.exists, tables)], [False] * 2)

    def test_a_fit_that_takes_it_is_told_its_fold(self):
        told = []

        def fit(shapes, fold):
            told.append((fold, len(shapes)))
            return lambda shape: shape.points[:, 2]
        self.run_with(salbench.Model(fit, version=3))
        self.assertEqual(sorted(told), [(fold, 8) for fold in range(5)])

    def test_what_was_trained_is_kept_and_loaded(self):
        keep, trained = self.folder / "kept", []

        def fit(shapes):
            trained.append(len(shapes))
            return Height(len(shapes))
        caches = [self.folder / f"cache-of-kept-{number}" for number in range(3)]  # none has the maps of another
        first = self.run_with(salbench.Model(fit, version=4), keep=keep, cache=caches[0])
        again = self.run_with(salbench.Model(fit, version=4), keep=keep, cache=caches[1])
        self.assertEqual((first.models["MINE"]["trained"], again.models["MINE"]["trained"], len(trained)), (5, 0, 5))
        self.assertEqual(again.models["MINE"]["computed"], 10)
        self.assertTrue(first.scores.equals(again.scores))
        cached = self.run_with(salbench.Model(fit, version=4), keep=keep, cache=caches[0], out=self.folder / "other")
        self.assertEqual((cached.computed, [*cached.training.seconds]), (0, [*first.training.seconds]))
        again.write_submission(self.folder / "mine", "MINE", citation="nobody", licence="GPL")
        self.assertEqual(len([*(self.folder / "mine/folds_0").iterdir()]), 5, "of a call that trained nothing")
        file = min((keep / "MINE").iterdir())
        file.write_bytes(b"no pickle")
        spoilt = self.run_with(salbench.Model(fit, version=4), keep=keep, cache=caches[2])
        self.assertEqual(len(spoilt.failures), 2)
        self.assertIn("remove it to have the fold trained again", str(spoilt.failures))

    def test_what_cannot_be_kept_is_said_once_and_makes_its_maps(self):
        text = MEMORY.replace("return truth", "lock\n            return truth")
        text = text.replace("points =", "import threading\n        lock = threading.Lock()\n        points =")
        with self.assertLogs("salbench", "WARNING") as logged:
            results = self.run_with(self.fit(text), keep=self.folder / "nothing", cache=self.folder / "cache-of-nothing")
        said = [line for line in logged.output if "is not kept" in line]
        self.assertEqual((len(said), results.failures, len(results.scores)), (1, [], 10))
        self.assertIn("MINE: what is trained is not kept: cannot pickle '_thread.lock' object; its maps are made all the same", said[0])
        self.assertFalse((self.folder / "nothing").exists())

    def test_a_changed_shape_trains_the_folds_that_saw_it(self):
        self.run_with(self.fit())
        before = self.trained()
        path = self.data / "Distributions/21.val"
        lines = path.read_text().splitlines()
        path.write_text("\n".join(["0.5", *lines[1:]]) + "\n")
        results = self.run_with(self.fit())
        self.assertEqual(self.trained(), [names for names in before if "21" in names])
        self.assertEqual(len(self.trained()), 4)
        self.assertEqual(results.models["MINE"]["read"], 2, "maps of the fold that the shape is in")

    def test_another_fit_trains_all_and_another_model_beside_it_none(self):
        self.run_with(self.fit())
        self.run_with(self.fit(), models={"CB": {}, "HEIGHT": lambda shape: shape.points[:, 2]})
        self.assertEqual(self.trained(), [])
        results = self.run_with({"A": self.fit(), "B": self.fit(OTHER)})
        self.assertEqual([results.models[name]["trained"] for name in "AB"], [0, 5], "a name is a label: A is what MINE was")
        self.assertEqual(set(results.scores.model), {"A", "B"})
        with self.assertRaisesRegex(ValueError, "models has A, which is the name of a model that is trained"):
            self.run_with({"A": self.fit()}, models={"A": self.fit()})

    def test_versions_and_depends_are_those_of_fit(self):
        weights = self.folder / "pretrained"
        weights.write_bytes(b"1")

        def versioned(version, text=MEMORY):
            return salbench.Model(self.fit(text), version=version, depends=[weights])

        self.run_with(versioned(1))
        self.assertEqual(self.run_with(versioned(1, OTHER)).models["MINE"]["trained"], 0)
        self.assertEqual(self.run_with(versioned(2, OTHER)).models["MINE"]["trained"], 5)
        weights.write_bytes(b"2")
        self.assertEqual(self.run_with(versioned(2, OTHER)).models["MINE"]["trained"], 5)

    def test_fit_and_predict_are_handed_the_same_parts(self):
        seen = {}

        def fit(shapes):
            for shape in shapes:
                seen[shape.id] = shape

            def predict(shape):
                known = seen[shape.id]
                for part in ("points", "faces", "normals", "fpfh"):
                    np.testing.assert_array_equal(getattr(shape, part), getattr(known, part), part)
                assert shape.ground_truth is None and known.ground_truth is not None and shape.category == ""
                return shape.points[:, 0]
            return predict

        for reads in (("normals", "faces"), ("fpfh",)):
            seen.clear()
            model = salbench.Model(fit, reads=reads, cache=False)
            self.run_with(model)  # each shape is seen by other folds first, but for those of the first one
            results = self.run_with(model)
            self.assertEqual(results.failures, [])

    def test_a_fit_that_fails_is_tried_once_a_fold(self):
        text = MEMORY.replace("points =", "1 / 0; points =")
        causes = [failure.cause.splitlines()[0] for failure in self.run_with(self.fit(text), keep_going=True).failures]
        self.assertEqual((len(self.trained()), len(causes), len(set(causes))), (5, 10, 1), causes)
        self.assertIn("ZeroDivisionError", causes[0])
        with self.assertWarnsRegex(RuntimeWarning, r"1 of 2 models has no map: MINE, because ZeroDivisionError: .* \(<string>, line 7\)"):
            results = self.run_with(self.fit(text), models={"RS": {}})
        self.assertEqual((len(self.trained()), len(results.failures)), (2, 5), "the first two folds failed alike: no other is trained")
        self.assertEqual(list(results.failed), ["MINE"])
        self.assertEqual(results.trained, {})
        nothing = self.run_with(lambda shapes: None)
        self.assertIn("fit must return a function of a shape, not NoneType", nothing.failures[0].cause)

    def test_a_fold_that_fails_is_named_first_and_counts_as_failed(self):
        def fit(shapes, fold):
            if fold == 1:
                raise MemoryError("none is free")
            return Height(len(shapes))

        errors = io.StringIO()
        with self.assertWarnsRegex(RuntimeWarning, r"^1 fold has no map: fold 1 of MINE, because MemoryError: none is free \(folds_test.py, line \d+\)\.$"), \
                contextlib.redirect_stderr(errors):
            results = self.run_with(salbench.Model(fit, version=6), models={"RS": {}}, progress=True)
        said = errors.getvalue()
        self.assertEqual([results.models["MINE"][of] for of in ("trained", "failed", "computed")], [4, 1, 8])
        self.assertIn("MINE: 4 folds trained now, 1 failed, 8 maps computed now", repr(results))
        self.assertEqual((results.failed, results.training.seconds.isna().tolist()), ({}, [False, True, False, False, False]))
        self.assertLess(said.index("fold 1 of MINE, because"), said.index("On "))
        folds, begun = zip(*re.findall(r"MINE: fold (\d), training on 8 shapes \(training (\d) of at most 5\)", said))
        self.assertEqual((sorted(folds), begun), ([*"01234"], (*"12345",)))
        self.assertNotIn(" left", said)

    def test_a_map_is_checked_as_that_of_any_function(self):
        maps = {"MASKED": lambda x: np.ma.masked_greater(x, 0), "COMPLEX": lambda x: x + 1j, "TEXT": lambda x: x.astype(str),
                "LIST": lambda x: [*x], "SINGLE": lambda x: x.astype(np.float32)}
        fits = {name: salbench.Model(lambda shapes, made=made: lambda shape: made(shape.points[:, 0]), reads=()) for name, made in maps.items()}
        with self.assertWarnsRegex(RuntimeWarning, "3 of 5 models have no map"):
            results = self.run_with(fits)
        self.assertEqual({*results.failed}, {"MASKED", "COMPLEX", "TEXT"})

    def test_a_shape_that_cannot_be_read_trains_nothing_and_harms_nobody(self):
        (self.data / "Distributions/21.val").write_text("no number\n")
        with self.assertLogs("salbench", "WARNING") as logged:
            results = self.run_with(self.fit())
        self.assertIn("21: nothing is trained on it", "\n".join(logged.output))
        self.assertFalse(any("21" in names for names in self.trained()))
        self.assertEqual(len(results.scores), 9)
        table = pandas.read_csv(results.folder / "folds.csv", dtype={"item": str})
        self.assertEqual(set(table.loc[table["item"] == "21", "role"]), {"scored"})

    def test_simulated_participants_teach_nothing(self):
        with self.assertRaisesRegex(ValueError, "participants are simulated"):
            self.run_with(self.fit(), {"dataset": {"participants": "simulated"}})

    def test_tables_and_submission_say_how_it_was_trained(self):
        config = self.folder / "toy.yaml"
        config.write_text("dataset: {scans: false}\nmodels: {RS: }\n")
        results = self.run_with(self.fit(), config, folds=3, by="class", models={"RS": {}})
        how = "cross-validated, 3 folds by class"
        self.assertEqual(results.trained, {"MINE": how})
        self.assertEqual(salbench.Results(self.folder / "out").trained, {"MINE": how})
        self.assertEqual(set(results.summary.model), {"MINE", "RS"})  # which concludes
        for name in ("summary", "ranking", "significance"):
            self.assertEqual(set(pandas.read_csv(self.folder / f"out/{name}.csv")["remarks"]), {f"MINE: {how}"})
        again = self.run_with(self.fit(), config, folds=3, by="class", models={"RS": {}})
        with self.assertWarnsRegex(RuntimeWarning, "has the maps of MINE and nothing that makes them: not all folds of MINE were trained"):
            mine = again.write_submission(self.folder / "mine", "MINE", citation="nobody", licence="GPL", version="v1")
        made = (mine / "made.yaml").read_text()
        for said in ('made_by: "function"', f'learned: "{how}"', 'timed: "wall time of one call of the function', 'map_digest: "'):
            self.assertIn(said, made)
        self.assertIn(f"this data set, {how}", (mine / "card.yaml").read_text())
