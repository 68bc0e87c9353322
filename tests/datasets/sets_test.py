# SPDX-License-Identifier: GPL-3.0-or-later
"""Data sets of one's own: functions that `salbench.run` is given, and files of Python. What fails an item, what is computed again, and what is no
data set. The functions of the public sets are asked in archives_test.py."""

import json
import os
import pickle
import sys
import threading
from unittest import mock

import numpy as np

import salbench
from salbench.datasets import Dataset, Item, Shape, importing, match, mesh, sets
from salbench.datasets.records import InputError
from salbench.system import workers
from salbench.system.errors import StorageError
from own_sets import PLAIN, doing
from support import FACES, WithArchive, lines, off, sphere
from tests.support import forked

CONFIG = {"dataset": {"scans": False}, "metrics": {"names": ["cc"], "matching": "none"}}
BALL, BALL_FACES = sphere(6, 7)
TRUTH = BALL[:, 2].copy()


def ball(item):
    return Shape(BALL, BALL_FACES, ground_truth=TRUTH)


class OfOnesOwn(WithArchive):
    def setUp(self):
        super().setUp()
        self.mine = self.root.parent / "mine.py"

    def made(self, data, config=CONFIG, cache="cache", **more):
        """A run of a data set, or of a file over the folder."""
        if not isinstance(data, Dataset):
            config, data = config | {"dataset": config["dataset"] | {"layout": str(data)}}, self.root
        folder = self.root.parent
        return salbench.run(config, data=data, models={"CB": {}}, cache=folder / cache, out=folder / "out", progress=False, **more)

    def failures(self, data, **more):
        """Why an item failed, by name; all other items of the set have scores."""
        results = self.made(data, **more)
        failed = {failure.item: failure.cause.replace(str(self.root.parent), "") for failure in results.failures}
        listed = {item.name for item in (data if isinstance(data, Dataset) else sets.find(str(data))).items(str(self.root)).items}
        self.assertEqual({*results.scores["item"]}, listed - {*failed})
        self.assertFalse([cause for cause in failed.values() if "\n" in cause or "defect" in cause])
        return failed


class Functions(OfOnesOwn):
    def test_items_need_no_files_and_no_folder(self):
        shapes = {"ball": (Shape(BALL.tolist(), BALL_FACES.tolist(), ground_truth=[*TRUTH]), "mesh"), "dots": (Shape(BALL, ground_truth=TRUTH), "cloud")}
        own = Dataset([Item(name, kind=kind, category="round", split="test") for name, (_, kind) in shapes.items()], lambda item: shapes[item.name][0])
        results = self.made(own, split="test")
        self.assertEqual((sorted(results.scores["item"]), {*results.scores["class"]}, results.failures), (["ball", "dots"], {"round"}, []))
        dataset = salbench.Dataset(own)
        self.assertEqual((dataset.ids, dataset.layout, dataset.splits, dataset["dots"].faces), (("ball", "dots"), "own", ("test",), None))
        self.equal(dataset["ball"].ground_truth, TRUTH)

    def test_what_read_does_fails_its_item_alone(self):
        def raised(error):
            raise error

        n, two = len(BALL), [np.array([1]), np.array([2])]
        rows = [("BAD: read.. raised ValueError: two lines .*sets_test.py, line ", lambda: raised(ValueError("two\nlines")), {}),
                ("BAD: read.. raised KeyError: ", lambda: {}["x"], {}), ("BAD: read.. raised SystemExit: 3", lambda: sys.exit(3), {}),
                ("cow.off:3: no", lambda: raised(InputError("cow.off:3: no")), {}), ("BAD: no memory", lambda: np.zeros(1 << 50), {}),
                ("BAD: .*None.*Shape", lambda: None, {}), ("BAD: .*dict|BAD: .*Shape", dict, {}),
                ("BAD: .*point cloud.*mesh", lambda: Shape(BALL, ground_truth=TRUTH), {}), ("BAD: .*mesh.*point cloud", lambda: ball(None), {"kind": "cloud"}),
                ("BAD: .*no ground truth", lambda: Shape(BALL, BALL_FACES), {}),
                ("BAD: read.. raised AttributeError: .*'truth'", lambda: setattr(ball(None), "truth", TRUTH), {}),
                ("BAD: .*2 picks.* 3", lambda: Shape(BALL, BALL_FACES, ground_truth=TRUTH, participants=two), {"participants": 3}),
                ("BAD: .*2 values of viewers.* 3", lambda: Shape(BALL, BALL_FACES, ground_truth=TRUTH, viewers=np.ones((2, n))), {"viewers": 3}),
                ("BAD: .*shape/points.*: row 0 .*not a finite number", lambda: Shape(BALL * np.nan, BALL_FACES), {}),
                ("BAD: points ", lambda: Shape("abc", BALL_FACES), {}), ("BAD: ground_truth .*2.* 37 points", lambda: Shape(BALL, BALL_FACES, ground_truth=[1, 2]), {}),
                ("BAD: .*shape/faces.*: 65 is out of range", lambda: Shape(BALL, BALL_FACES + 64), {}),
                ("BAD: faces ", lambda: Shape(BALL, BALL_FACES + .5), {}), ("BAD: participants ", lambda: Shape(BALL, BALL_FACES, ground_truth=TRUTH, participants=["a"]), {}),
                ("nobody knows", lambda: None, {"problem": "nobody knows"})]
        of_name = {f"bad {k}": read for k, (_, read, _) in enumerate(rows)} | {"good": lambda: ball(None)}
        own = Dataset([Item("good"), *(Item(f"bad {k}", **of_item) for k, (_, _, of_item) in enumerate(rows))], lambda item: of_name[item.name]())
        failed = self.failures(own, keep_going=True)
        self.assertEqual({*failed}, {*of_name} - {"good"})
        for k, (named, _, _) in enumerate(rows):
            self.assertRegex(failed[f"bad {k}"].replace(f"bad {k}", "BAD"), f"^{named}")

    def test_what_says_less_than_it_has_is_taken_at_its_word(self):
        rich = Dataset([Item("a", truth=False), Item("b")], lambda item: Shape(BALL, BALL_FACES, ground_truth=TRUTH, participants=[np.array([1]), np.array([2])]))
        self.assertEqual([*self.made(rich).scores["item"]], ["b"])

    def test_a_read_that_changes_is_called_again_and_the_rest_only_if_the_shape_differs(self):
        calls = []

        def computed(read, **more):
            """Number of calls of read, and of computed maps."""
            calls.clear()
            maps = self.made(Dataset([Item("a"), Item("b")], read, **more)).models["CB"]
            self.assertEqual(maps["read"], 0 if maps["computed"] else 2, "what the run itself computed is not read")
            return len(calls), maps["computed"]

        def scaled(factor, more=""):
            def read(item):
                calls.append(item.name + more)
                return Shape(factor * BALL, BALL_FACES, ground_truth=TRUTH)
            return read

        one = [Shape(BALL, BALL_FACES, ground_truth=TRUTH)]
        self.assertEqual(computed(scaled(1)), (2, 1), "equal shapes have one map")
        self.assertEqual(computed(scaled(1)), (0, 0))
        self.assertEqual(computed(scaled(1, "x")), (2, 0), "the shape is as it was")
        self.assertEqual(computed(scaled(2)), (2, 1))
        self.assertEqual(computed(scaled(2), version=1), (2, 0))
        self.assertEqual(computed(scaled(3), version=1), (0, 0), "version= is a promise")
        self.assertEqual(computed(scaled(3), version=2), (2, 1))
        self.assertEqual(computed(scaled(3), version=2, name="other"), (2, 0))
        self.assertEqual(computed(lambda item: calls.append(1) or one[0]), (2, 0))
        one[0] = Shape(4 * BALL, BALL_FACES, ground_truth=TRUTH)
        self.assertEqual(computed(lambda item: calls.append(1) or one[0]), (2, 1), "the values that it uses count")

    def test_values_that_read_uses_count_in_each_run(self):
        """Without comparable values, every run reads."""
        calls, lock = [], threading.Lock()

        def locked(item):
            with lock:
                calls.append(item.name)
                return ball(item)

        with self.assertLogs("salbench", "WARNING") as log:
            for _ in range(2):
                self.made(Dataset([Item("a")], locked))
        self.assertEqual(calls, ["a", "a"])
        self.assertIn("version=", log.output[0])

    def test_without_read_the_files_are_read_by_salbench(self):
        self.write({"a.off": off(), "a.val": lines([1, 2, 3, 4]), "a_0.pid": "3\n"})
        own = Dataset([Item("a", [self.root / "a.off"], saliency=self.root / "a.val", picks=[self.root / "a_0.pid"])])
        shape = salbench.Dataset(own)["a"]
        self.equal(shape.faces, FACES)
        self.equal(shape.ground_truth, [1, 2, 3, 4])
        self.assertEqual([picks.tolist() for picks in shape.participants], [[3]])
        self.assertEqual(self.failures(own), {})

    def test_plans_and_folds_take_it_as_runs_do(self):
        own = Dataset([Item("a", category="x"), Item("b", category="y"), Item("c", truth=False)],
                      lambda item: Shape(BALL * (1 + ord(item.name[0]) % 3), BALL_FACES, ground_truth=TRUTH))
        folder, learned = self.root.parent, []
        self.assertIn("3 import: ", str(salbench.plan(CONFIG, data=own, models={"CB": {}}, cache=folder / "cache")))

        def fit(shapes):
            learned.append([shape.id for shape in shapes])
            return lambda shape: shape.points[:, 2]

        folds = salbench.cross_validate(fit, own, CONFIG, folds=2, by="mesh", models={}, cache=folder / "cache", out=folder / "out", progress=False)
        self.assertEqual((sorted(learned), sorted({*folds.scores["item"]})), ([["a"], ["b"]], ["a", "b"]))

    def test_items_may_be_a_function_of_a_folder(self):
        self.write({"a.off": off(), "b.off": off()})
        found = Dataset(lambda root: (Item(one.item, [one.path], truth=False) for one in match(root, "{item}.off")),
                        lambda item: mesh(item.files[0]), root=self.root)
        self.assertEqual(salbench.Dataset(found).ids, ("a", "b"))
        (self.root / "below").mkdir()
        self.write({"below/c.off": off()})
        self.assertEqual(salbench.Dataset(found, self.root / "below").ids, ("c",))
        results = salbench.run({"dataset": {"participants": "simulated", "scans": False}}, data=found, models={"CB": {}}, cache=self.root.parent / "cache",
                               out=self.root.parent / "out", progress=False)
        self.assertEqual([*results.scores["item"]], ["a", "b"])

    def test_a_folder_that_is_not_there_is_named(self):
        with self.assertRaisesRegex(InputError, "^/no/such: there is no such folder$"):
            Dataset(lambda root: [], lambda item: None, name="own").items("/no/such")

    def test_what_is_no_data_set(self):
        for items, said in (([], "items\\(\\) found none"), ([Item("a"), Item("a")], '"a"'), ([Item("a/b")], '"a/b"'), ([Item("..")], r'"\.\."'), ([Item("")], '""'),
                            ([Item(3)], "3"), (["a"], "'a'"), ([Item("a", category=None)], "category"), (lambda root: 3 / 0, "ZeroDivisionError"),
                            (3, "own: items"), (lambda root: None, "own: items")):
            own = Dataset(items, ball)
            for work in (lambda: self.made(own), lambda: salbench.Dataset(own)):  # noqa: B023
                with self.subTest(said), self.assertRaisesRegex(ValueError, said) as caught:
                    work()
                self.assertNotIn("\n", str(caught.exception))
        for wrong in ({"read": 3}, {"read": ball, "version": 0}, {"read": ball, "version": 2**31}, {"read": ball, "version": "1.0"}):
            with self.assertRaises(ValueError):
                Dataset([Item("a")], **wrong)


class Files(OfOnesOwn):
    def setUp(self):
        super().setUp()
        for number, name in enumerate(("cat", "cow", "dog"), 1):
            self.write({f"m/{name}.off": off(number * BALL, BALL_FACES), f"v/{name}.txt": lines(TRUTH + number)})
        self.mine.write_text(PLAIN)
        self.to = self.root.parent / "to"

    def change(self, before, after):
        text = self.mine.read_text()
        self.assertIn(before, text)
        self.mine.write_text(text.replace(before, after))

    def imported(self):
        """Why an item failed, by name; all others are in the set."""
        done = importing.import_set(str(self.mine), str(self.root), str(self.to))
        failed = {shape.name: shape.problem.replace(str(self.root.parent), "") for shape in done.shapes if shape.problem}
        self.assertEqual({*salbench.Dataset("hdf5", self.to).ids}, {shape.name for shape in done.shapes} - {*failed})
        return failed

    def test_is_a_layout_of_runs_of_dataset_and_of_commands(self):
        self.assertEqual(self.failures(self.mine), {})
        dataset = salbench.Dataset(self.mine, self.root)
        self.assertEqual((dataset.layout, dataset.ids), ("mine", ("cat", "cow", "dog")))
        copy = pickle.loads(pickle.dumps(dataset[:2]))
        self.assertEqual((copy.ids, [name in copy for name in ("cat", "dog", "elk")]), (("cat", "cow"), [True, False, False]))
        self.equal(copy["cow"].ground_truth, TRUTH + 2)
        for command, *more in (("inspect",), ("import", "--to", self.to, "--quiet")):
            done = forked.salbench(command, self.mine, "--data", self.root, *more, "--format", "json")
            self.assertEqual((done.returncode, done.stderr), (0, ""))
            self.assertEqual(json.loads(done.stdout)["layout"], "mine")
        self.equal(salbench.Dataset("hdf5", self.to)["dog"].ground_truth, TRUTH + 3)

    def test_what_is_no_data_set_names_the_file_and_its_line(self):
        items = "def items(root):\n    return "
        for text, named in ((items + "[\n", "mine.py:2: "), ("import nothing_of_this_name\n", "mine.py: .*No module named .*line 1"),
                            ("x = 1\n1 / 0\n", "mine.py: .*line 2"), ("import sys\nsys.exit(3)\n", "mine.py: .*SystemExit.*line 2"),
                            ("items = 3\n", r"mine.py: .*items\(root\)"), ("x" * (1 << 20) + "\n", "mine.py: .*bytes"), (items + "[]\n", "items\\(\\) found none"),
                            ("a\0b", "mine.py"), (items + "3 / 0\n", "mine.*ZeroDivisionError.*line 2"), (items + "None\n", "mine.*items")):
            self.mine.write_text(text)
            for work in (lambda: self.made(self.mine), lambda: salbench.Dataset(self.mine, self.root), self.imported):
                with self.subTest(text[:40]), self.assertRaisesRegex(ValueError, named) as caught:
                    work()
                self.assertNotRegex(str(caught.exception), "\n|defect")

    def test_a_module_beside_it_is_found(self):
        (self.root.parent / "helpers_of_mine.py").write_text("FACTOR = 2\n")
        self.change("import os\n", "from helpers_of_mine import FACTOR\n")
        self.change("return shape", "shape.points = FACTOR * shape.points\n    return shape")
        self.equal(salbench.Dataset(self.mine, self.root)["cow"].points, 4 * BALL)
        self.assertEqual(self.failures(self.mine), {})
        self.assertNotIn(str(self.root.parent), sys.path)
        (self.root.parent / "helpers_of_mine_2.py").write_text("x = 1\n(\n")
        self.change("helpers_of_mine", "helpers_of_mine_2")
        self.assertRaisesRegex(ValueError, "helpers_of_mine_2.py:2: ", salbench.Dataset, self.mine, self.root)

    def test_its_data_classes_are_like_any(self):
        self.change('"""Cattle."""', "from __future__ import annotations\nfrom dataclasses import dataclass")
        self.change("VERSION = 1", "@dataclass\nclass Cow:\n    name: str\nVERSION = 1")
        self.assertEqual(self.failures(self.mine), {})

    def test_an_edited_file_is_another_set_in_the_same_session(self):
        self.change("VERSION = 1\n", "")
        self.made(self.mine)
        listed_by = sets.find(str(self.mine))
        (item, *_) = listed_by.items(str(self.root)).items
        self.assertEqual(len(sets.read_of(str(self.mine), item, listed_by.key).points), len(BALL))
        self.change("return shape", "shape.points = shape.points * 1.25\n    return shape")
        self.equal(salbench.Dataset(self.mine, self.root)["cat"].points, 1.25 * BALL)
        self.assertEqual(self.made(self.mine).models["CB"]["computed"], 3)
        with self.assertRaisesRegex(StorageError, "mine.py: was changed"):  # in the middle of a run: nothing is stored of the wrong text
            sets.read_of(str(self.mine), item, listed_by.key)

    def test_what_an_item_does_to_its_process_fails_it_by_name(self):
        """In runs and in `import`."""
        own = "read.. of .*/mine.py"
        does = {"crash": ("os.kill(os.getpid(), 11)", f"{own} crashed .signal 11.* on this item; correct it, or leave the item out$"),
                "end": ("os._exit(3)", f"{own} crashed .status 3"), "hang": ("while True: pass", f"{own} took more than"),
                "error": ("{}['x']", "KeyError.*mine.py, line "), "number": ("return 3", "3.*Shape"), "exit": ("raise SystemExit(3)", "SystemExit")}
        for name in does:
            self.write({f"m/{name}.off": off(), f"v/{name}.txt": lines([1, 2, 3, 4])})
        self.mine.write_text(doing(**{name: work for name, (work, _) in does.items()}))
        quick = workers._START.replace("serve(*", "sys.modules['salbench.system.limits'].SECONDS = 1; serve(*")
        with mock.patch.object(workers, "_START", quick):
            for failed in (self.failures(self.mine), self.imported()):
                self.assertEqual({*failed}, {*does})
                for name, (_, said) in does.items():
                    self.assertRegex(failed[name], f"^/data/m/{name}.off: .*{said}")

    def test_a_read_that_sleeps_for_ever_fails_its_item(self):
        for name in ("cat", "dog"):
            (self.root / f"m/{name}.off").unlink()
        self.mine.write_text(doing(cow="import time; time.sleep(1e6)"))
        with mock.patch.object(workers, "_WAITS", 0.01):
            self.assertRegex(self.failures(self.mine)["cow"], "^/data/m/cow.off: read.. of .*/mine.py took more than 60 s, and 1 s per MB on this item; ")

    def test_a_file_of_8_gib_fails_its_item(self):
        os.truncate(self.root / "m/cow.off", 8 << 30)  # sparse
        for failed in (self.failures(self.mine), self.imported()):
            self.assertEqual([*failed], ["cow"])
            self.assertRegex(failed["cow"], "^/data/m/cow.off: 8589934592 bytes: at most ")
