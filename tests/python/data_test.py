# SPDX-License-Identifier: GPL-3.0-or-later
"""Data sets as arrays, beside what the program's artefacts hold, and in other processes. Layouts: tests/datasets."""

import gc
import json
import logging
import multiprocessing
import pickle
import subprocess
import sys
import textwrap
import threading

import h5py
import numpy as np

import salbench
import toy
from tests.support import forked, shapes, toy_data
from tests.support.shapes import lines, rows


def wedge(n=6):
    """A closed surface without symmetry: a bumpy double cone over a polygon of n corners."""
    angles = np.arange(n) * 2 * np.pi / n
    ring = np.column_stack([np.cos(angles), np.sin(angles), 0.1 * np.cos(3 * angles)]) * (1 + 0.1 * np.arange(n)[:, None] / n)
    points = np.vstack([ring, [0, 0.1, 1], [0.1, 0, -1]])
    after = (np.arange(n) + 1) % n
    top = np.column_stack([np.arange(n), after, np.full(n, n)])
    return points, np.vstack([top, np.column_stack([after, np.arange(n), np.full(n, n + 1)])]).astype(np.int32)


POINTS, FACES = wedge()


def off(points=POINTS):
    return shapes.off(points, FACES)


class Folder(toy.InAFolder):
    def setUp(self):
        super().setUp()
        self.root = self.folder / "data"
        self.root.mkdir()

    def write(self, path, text):
        path = self.root / path
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
        return path

    def assert_equal(self, values, expected):
        np.testing.assert_array_equal(values, expected)

    def assert_wedge(self, shape):
        self.assert_equal(shape.points, POINTS)
        self.assert_equal(shape.faces, FACES)


VALUES = np.arange(len(POINTS)) / 4.0


class Layouts(Folder):
    def test_schelling(self):
        self.write("Meshes/21.off", off())
        self.write("Distributions/21.val", lines(VALUES))
        for participant, picks in enumerate(["3\n1\n", "", "1\n"]):
            self.write(f"RawData/21_{participant}.pid", picks)
        for layout in ("schelling", "automatic"):
            with self.subTest(layout):
                dataset = salbench.Dataset(layout, self.root)
                self.assertEqual((dataset.layout, dataset.ids, dataset.categories), ("schelling", ("21",), ("cup",)))
                shape = dataset[0]
                self.assert_wedge(shape)
                self.assertEqual((shape.id, shape.category), ("21", "cup"))
                self.assert_equal(shape.ground_truth, VALUES)
                self.assertEqual([picks.tolist() for picks in shape.participants], [[3, 1], [], [1]])
                self.assertEqual(shape.picks.tolist(), [1, 1, 3])
                self.assertTrue(shape.mask.all())
                self.assertEqual(shape.viewers, ())
                self.assert_equal(shape.normals, salbench.estimate_normals(shape.points, shape.faces))

    def test_automatic_is_what_a_run_takes(self):
        """The same layout and items, or the same refusal; a few are planned."""
        twice, none = "have the same name: rename or remove one of them", "no .off, .obj or .ply meshes found"
        for files, layout, ids in [
                ("Meshes/a.off Meshes/b.off Distributions/a.val z.off", "schelling", "ab"), ("SchellingData/Meshes/a.off z.off", "schelling", "a"),
                ("off/a.off GS/Saliency/a.val Meshes/b.off", "gs", "a"), ("Meshes/a.off Saliency/a.val", "gs", "a"), ("off/a.off Meshes/b.off", "schelling", "b"),
                ("off/a.off Distributions/a.val z.off", "princeton", "a"), ("MeshsegBenchmark-1.0/data/off/a.off z.off", "princeton", "a"),
                ("GS/RawData/z_0.pid z.off", "folder", "z"), ("Meshes/readme.txt off/readme.txt z.off", "folder", "z"),
                ("off/a.off off/a.ply Meshes/b.off GS/Saliency/a.val", twice, ""), ("Distributions/a.val more/a.off", none, ""),
                ("Meshes/a.off Distributions/a.val Distributions/a.VAL z.off", twice, "")]:
            with self.subTest(files):
                self.setUp()
                for name in files.split():
                    self.write(name, off() if name.endswith((".off", ".ply")) else lines(VALUES) if name.lower().endswith(".val") else "")
                status, meshes, error = 0, len(ids), ""
                if ids:
                    dataset = salbench.Dataset("automatic", self.root)
                    self.assertEqual((dataset.layout, "".join(dataset.ids)), (layout, ids))
                else:
                    with self.assertRaisesRegex(ValueError, layout) as caught:
                        salbench.Dataset("automatic", self.root)
                    status, error = 2, f"error: {caught.exception}\n"
                if layout in ("gs", none):
                    (self.folder / "config.yaml").write_text("dataset: {scans: false}\nmodels: {RS: }\n")
                    plan = forked.salbench("plan", self.folder / "config.yaml", "--data", self.root, "--cache", self.folder / "cache", "--format", "json")
                    self.assertEqual((plan.returncode, plan.stderr if status else json.loads(plan.stdout)["meshes"]), (status, error or meshes))

    def test_folder_without_ground_truth(self):
        self.write("horse.off", off())
        shape = salbench.Dataset("folder", self.root)["horse"]
        self.assert_wedge(shape)
        self.assertIsNone(shape.ground_truth)
        self.assertEqual((shape.picks.size, shape.participants, shape.mask.all()), (0, (), True))


class Clouds(Folder):
    def test_points_that_were_not_seen_are_left_out(self):
        points = np.random.default_rng(5).normal(size=(400, 3))
        points[7] = np.nan
        self.write("a.xyz", rows(points))
        self.write("Distributions/a.val", lines(np.arange(400)))
        self.write("RawData/a_0.pid", "3\n9\n")
        shape = salbench.Dataset("folder", self.root)["a"]
        self.assertEqual(len(shape), 399)
        self.assertEqual(shape.picks.tolist(), [3, 8])
        self.assert_equal(shape.ground_truth, np.delete(np.arange(400), 7))


class Sequence(Folder):
    def setUp(self):
        super().setUp()
        for name in ("1", "2", "10"):
            self.write(f"{name}.off", off(POINTS * float(name)))
        self.dataset = salbench.Dataset("folder", self.root)

    def test_numbers_names_and_slices(self):
        self.assertEqual(self.dataset.ids, ("1", "2", "10"))
        self.assertEqual(len(self.dataset), 3)
        self.assertEqual([shape.id for shape in self.dataset], ["1", "2", "10"])
        self.assertEqual((self.dataset[-1].id, self.dataset[np.int64(1)].id, self.dataset["10"].id), ("10", "2", "10"))
        part = self.dataset[::-2]
        self.assertEqual((part.ids, part[0].id, len(part), "2" in part, "1" in part), (("10", "1"), "10", 2, False, True))
        with self.assertRaises(KeyError):
            part["2"]
        self.assertEqual(len(self.dataset[5:]), 0)
        ids = self.dataset.ids
        for index, expected in [([0, -1], (ids[0], ids[-1])), ([ids[2], 0], (ids[2], ids[0])), (np.array([2, 0]), (ids[2], ids[0])), ([], ()),
                                ([True, False, True], ids[::2]), (np.array([False] * 3), ()), (range(2), ids[:2])]:
            self.assertEqual(self.dataset[index].ids, expected)
        self.assertEqual(self.dataset[::-1][[0, 2]].ids, (ids[-1], ids[0]))
        self.assertEqual(self.dataset[np.array(1)].id, ids[1])
        for index, error, wrong in [([True, False], ValueError, "a mask of 2 values, but the data set has 3 items"), ([True, 0, 1], ValueError, "a mask of 3"),
                                    ([0, 3], IndexError, "index 3, but the data set has 3 items"), ([0.0], TypeError, ""), (["x"], KeyError, "x")]:
            with self.assertRaisesRegex(error, wrong):
                self.dataset[index]
        self.assert_equal(self.dataset[2].points, POINTS * 10)

    def test_chosen_items(self):
        for items, ids in (("1-3,10", ("1", "2", "10")), (["10", "1"], ("1", "10")), ([2], ("2",)), ([], ())):
            self.assertEqual(salbench.Dataset("folder", self.root, items=items).ids, ids)

    def test_those_with_ground_truth(self):
        self.write("Distributions/10.val", lines(VALUES))
        dataset = salbench.Dataset("folder", self.root, items="scored")
        self.assertEqual(dataset.ids, ("10",))
        self.assert_equal(dataset[0].ground_truth, VALUES)

    def test_a_notebook_shows_its_items(self):
        page = salbench.Dataset("folder", self.root)[1:]._repr_html_()
        self.assertIn("<td>10</td>", page)
        self.assertNotIn("<td>1</td>", page)
        for number in range(11, 30):
            self.write(f"<{number}>.off", off())
        page = salbench.Dataset("folder", self.root)._repr_html_()
        self.assertIn("&lt;11&gt;", page)
        self.assertIn("and 12 more", page)

    def test_arrays_are_views_that_cannot_be_written_to(self):
        self.write("Distributions/1.val", lines(VALUES))
        shape = salbench.Dataset("folder", self.root)[0]
        for array in (shape.points, shape.faces, shape.ground_truth):
            self.assertFalse(array.flags.writeable)
            self.assertFalse(array.flags.owndata)
            self.assertTrue(array.flags.c_contiguous)
            with self.assertRaises(ValueError):
                array[0] = 0
            with self.assertRaises(ValueError):
                array.setflags(write=True)
        points = shape.points
        del shape
        gc.collect()
        self.assert_equal(points, POINTS)

    def test_files_are_read_when_asked_for(self):
        (self.root / "2.off").write_text("OFF\n1 1 0\n")
        dataset = salbench.Dataset("folder", self.root)
        self.assertEqual(dataset[0].id, "1")
        with self.assertRaisesRegex(ValueError, r"2\.off:2: the file ends after 0 of 1 vertices"):
            dataset[1]

    def test_pickles(self):
        copy = pickle.loads(pickle.dumps(self.dataset[1:]))
        self.assertEqual(copy.ids, ("2", "10"))
        self.assert_equal(copy[-1].points, POINTS * 10)
        shape = pickle.loads(pickle.dumps(self.dataset[0]))
        self.assert_wedge(shape)

    def test_threads_read_at_once(self):
        read = []
        threads = [threading.Thread(target=lambda: read.extend(shape.points.sum() for _ in range(20) for shape in self.dataset))
                   for _ in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(len(read), 240)
        self.assertEqual(set(read), {shape.points.sum() for shape in self.dataset})


class Errors(Folder):
    def test_what_is_refused_is_named(self):
        (self.folder / "empty").mkdir()
        self.write("52.off", off())
        layout, dataset = self.write("mine.py", "def items(root\n"), salbench.Dataset("folder", self.root)

        def of(layout, root=self.root, **keywords):
            return lambda: salbench.Dataset(layout, root, **keywords)

        for error, named, *calls in [
            (FileNotFoundError, "nowhere", of("folder", self.root / "nowhere")), (NotADirectoryError, "mine.py", of("folder", layout)),
            (ValueError, "empty", of("folder", self.folder / "empty")), (KeyError, "'schelin'.*'schelling'", of("schelin")),
            (FileNotFoundError, "own.py", of(self.root / "own.py")), (ValueError, r"mine\.py:1", of(layout)),
            ((TypeError, ValueError, KeyError), "", of(3), of(None), of(b"folder\0")),
            (KeyError, "'53'.*'52'", lambda: dataset["53"], of("folder", items=["53"]), of("folder", items="53")),
            (IndexError, "1 items", *(lambda index=index: dataset[index] for index in (1, -2, 2**70, -2**70))),
            (TypeError, "", *(lambda index=index: dataset[index] for index in (1.0, None, (0,)))),
            (KeyError, "'no-box'", of("folder", items="no-box")),
            (ValueError, "ground truth", of("folder", items="scored")), (ValueError, "60-70", of("folder", items="52,60-70")),
            (ValueError, "item", of("folder", items=" , ")),
        ]:
            for call in calls:
                with self.subTest(named), self.assertRaisesRegex(error, named):
                    call()
        with self.assertRaises(FileNotFoundError) as raised:
            salbench.Dataset("folder", self.root / "nowhere")
        self.assertEqual(raised.exception.filename, str(self.root / "nowhere"))

    def test_a_bad_shape_and_bad_ground_truth_name_their_files(self):
        self.write("flat.off", off(POINTS * 0))
        self.write("short.off", off())
        self.write("Distributions/short.val", "1\n2\n")
        self.write("word.off", off())
        self.write("Distributions/word.val", "1\nx\n")
        self.write("gone.off", off())
        dataset = salbench.Dataset("folder", self.root)
        (self.root / "gone.off").unlink()
        for name, where in (("flat", r"flat\.off: all points are in one place"), ("short", r"short\.val"),
                            ("word", r"word\.val:2: \"x\""), ("gone", r"gone\.off")):
            with self.assertRaisesRegex(ValueError, where):
                dataset[name]

    def test_an_error_of_any_file_of_an_item_names_that_file_alone(self):
        self.write("3DModels-Simplif/bunny.obj", shapes.obj(POINTS, FACES))
        self.write("FixationMaps/bunny_300norm.txt", lines(VALUES))
        mask = self.write("CentricityAndVisibilityMaps/bunny_300_visibility.txt", lines(VALUES * 0))
        with self.assertRaises(ValueError) as raised:
            salbench.Dataset("3dva", self.root)[0]
        self.assertTrue(str(raised.exception).startswith(f"{mask}: hides everything"), raised.exception)


class Warnings(Folder):
    def test_go_to_the_log_and_nowhere_else(self):
        for point, said in (([9, 9, 9], r"vertex 8 \(0-based\); R is 13\.9 with them and 1\.09 without"), (POINTS.mean(0), r"vertex 8 \(0-based\)$")):
            self.write("odd.off", off(np.vstack([POINTS, [point]])))
            with self.assertLogs("salbench", logging.WARNING) as log:
                salbench.Dataset("folder", self.root)[0]
            self.assertRegex(log.records[0].getMessage(), f"^odd: 1 isolated vertices .*{said}")
        quiet = f"""
            import logging, salbench
            logging.getLogger("salbench").addHandler(logging.NullHandler())
            salbench.Dataset("folder", {str(self.root)!r})[0]
            """
        ended = subprocess.run([sys.executable, "-B", "-c", textwrap.dedent(quiet)], capture_output=True, text=True, check=True)
        self.assertEqual((ended.stdout, ended.stderr), ("", ""))

    def test_threads_and_the_end_of_the_interpreter(self):
        self.write("odd.off", off(np.vstack([POINTS, [[9, 9, 9]]])))
        script = f"""
            import logging, salbench, threading
            logging.basicConfig(filename={str(self.folder / "log")!r})
            dataset = salbench.Dataset("folder", {str(self.root)!r})
            has_read = threading.Event()
            def read():
                while True:
                    dataset[0]
                    has_read.set()
            for _ in range(4):
                threading.Thread(target=read, daemon=True).start()
            has_read.wait()
            """
        for _ in range(2):
            ended = subprocess.run([sys.executable, "-B", "-c", textwrap.dedent(script)], capture_output=True, text=True)
            self.assertEqual((ended.returncode, ended.stderr), (0, ""))
        self.assertIn("WARNING:salbench:odd: 1 isolated vertices", (self.folder / "log").read_text())

    def test_what_a_handler_raises_ends_nothing(self):
        class Broken(logging.Filter):
            def filter(self, record):
                raise RuntimeError("broken filter")

        self.write("odd.off", off(np.vstack([POINTS, [[9, 9, 9]]])))
        log, broken = logging.getLogger("salbench"), Broken()
        log.addFilter(broken)
        self.addCleanup(log.removeFilter, broken)
        raised = []
        hook, sys.unraisablehook = sys.unraisablehook, lambda given: raised.append(given.exc_type)
        self.addCleanup(setattr, sys, "unraisablehook", hook)
        self.assertEqual(len(salbench.Dataset("folder", self.root)[0]), len(POINTS) + 1)
        self.assertEqual(raised, [RuntimeError])


def scores_of(dataset, numbers):
    return [(number, salbench.score(dataset[number].points[:, 2], dataset[number].ground_truth, [1, 2],
                                    metrics=["cc", "auc_exact"])) for number in numbers]


class Processes(Folder):
    def test_workers_read_and_score_at_once(self):
        for name in range(1, 9):
            self.write(f"{name}.off", off(POINTS + np.sin(name * POINTS[:, ::-1]) / 10))
            self.write(f"Distributions/{name}.val", lines(np.cos(name * VALUES)))
        dataset = salbench.Dataset("folder", self.root)
        expected = scores_of(dataset, range(8))
        for method in ("fork", "spawn"):
            with self.subTest(method), multiprocessing.get_context(method).Pool(2) as pool:
                batches = pool.starmap(scores_of, [(dataset, [i, i + 4]) for i in range(4)] * 4)
                self.assertEqual(sorted(sum(batches[:4], []), key=lambda row: row[0]), expected)
                self.assertEqual(batches, batches[:4] * 4)


class Artefacts(Folder):
    """The arrays are those that the program computes with."""

    def compare(self, layout, shapes, config=""):
        (self.folder / "c.yaml").write_text(f"dataset: {{layout: {layout}, scans: false}}\nmodels: {{RS: {{}}}}\n{config}")
        toy.run(self.folder / "c.yaml", "--data", self.root, "--cache", self.folder / "cache", "--out", self.folder / "out")
        toy.export(self.folder / "c.yaml", "--data", self.root, "--cache", self.folder / "cache", "--to", self.folder / "all.h5")
        dataset = salbench.Dataset(layout, self.root)
        self.assertEqual(len(dataset), shapes)
        with h5py.File(self.folder / "all.h5") as file:
            for shape in dataset:
                group = file[shape.id]
                cloud = shape.faces is None
                self.assert_equal(shape.points, group["cloud/points" if cloud else "mesh/vertices"][:])
                if not cloud:
                    self.assert_equal(shape.faces, group["mesh/faces"][:])
                truth = group["cloud_ground_truth" if cloud else "ground_truth"]
                self.assert_equal(shape.ground_truth, truth["saliency"][:])
                self.assert_equal(np.concatenate([*shape.participants, np.empty(0, np.int32)]), truth["picks"][:])

    def test_meshes_and_clouds_with_picks_alone(self):
        around = np.random.default_rng(1).normal(size=(900, 3))
        around /= np.linalg.norm(around, axis=1, keepdims=True)
        self.write("cloud.xyz", rows(around))
        self.write("mesh.off", off())
        for participant in range(3):
            self.write(f"RawData/cloud_{participant}.pid", f"{participant}\n{50 * participant + 7}\n")
            self.write(f"RawData/mesh_{participant}.pid", f"{participant}\n7\n")
        self.write("Distributions/other.val", "")
        self.compare("folder", 2)

    def test_meshes_with_ground_truth(self):
        toy_data.study(self.root, (52, 125))
        self.compare("schelling", 2)
