# SPDX-License-Identifier: GPL-3.0-or-later
"""A miniature of each tracker's files is the same gaze, whatever its units, its codes for lost samples and its frame."""

import inspect
import json
import re
import unittest.mock

import numpy as np
import pandas as pd

from salbench.datasets import Recording, gather, table, trackers
from support import WithArchive
from tests.support import tracker_files
from tests.support.tracker_files import CAMERA, DIRECTIONS, EYE, LOST, MS, N, SIZE

HOW = {"tobii_pro_lab": {}, "tobii_glasses": {}, "pupil_core": {"size": SIZE}, "pupil_neon": {}, "eyelink": {"eye": "R"}, "gazepoint": {"size": SIZE}}
RAYS = "unity", "eyenavgs"


class Trackers(WithArchive):
    def read(self, name, content=None, rows=None, **how):
        path = self.write({"cameras.json": json.dumps(CAMERA), "gaze": content or getattr(tracker_files, name)()})
        cameras = {} if name in RAYS else {"cameras": self.root / "cameras.json"}
        return gather([("A", path if rows is None else rows)], getattr(trackers, name), **HOW.get(name, {}) | cameras | how)

    def test_each_is_the_gaze_that_was_written(self):
        self.assertEqual({*HOW, *RAYS}, {name for name, value in vars(trackers).items() if getattr(value, "__module__", "") == trackers.__name__ and name[0] != "_"})
        for name in (*HOW, *RAYS):
            with self.subTest(name):
                found = self.read(name)
                self.assertEqual((found.people, found.faults), (("A",), []))
                self.equal(np.flatnonzero(~found.valid), LOST)
                np.testing.assert_allclose(found.time - found.time[0], MS, atol=.01)
                valid = found.valid
                np.testing.assert_allclose(found.origins[valid], np.tile(EYE, (N - len(LOST), 1)), atol=1e-7)
                np.testing.assert_allclose(found.directions[valid], DIRECTIONS[valid], atol=1e-5)

    def test_every_argument_that_a_reader_does_not_set_reaches_the_recording(self):
        arguments = [of for of in inspect.signature(Recording.of).parameters.values() if of.kind is of.KEYWORD_ONLY]
        for name in (*HOW, *RAYS):
            with unittest.mock.patch.object(Recording, "of", wraps=Recording.of) as made:
                self.read(name)
                own = made.call_args.kwargs
                for of in arguments:
                    if of.name not in own:
                        with self.subTest(name, argument=of.name):
                            self.read(name, **{of.name: of.default})
                            self.assertIs(made.call_args.kwargs[of.name], of.default)

    def test_pupil_core_takes_cameras_by_number(self):
        moved = CAMERA | {"frame": 2, "object_to_world": [[1, 0, 0, 1], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]}
        path = self.write({"two.json": json.dumps([CAMERA | {"frame": 0}, moved]), "gaze": tracker_files.pupil_core()})
        found = trackers.pupil_core(path, "A", size=SIZE, frame="world_index", cameras=self.root / "two.json")
        self.equal(found.origins[[0, 8], 0], [EYE[0], EYE[0] - 1])
        self.assertFalse(found.valid[4:8].any())  # of frame 1, which has no camera

    def test_missing_values_of_pandas_and_r_are_empty_cells(self):
        for name, how in (("tobii_pro_lab", {"sep": "\t", "decimal": ","}), ("pupil_neon", {})):
            whole = self.read(name)
            frame = pd.read_csv(self.root / "gaze", **how)
            for found in (self.read(name, rows=frame), *(self.read(name, frame.to_csv(index=False, na_rep=word)) for word in ("NA", "nan"))):
                self.assertEqual((found.valid.tolist(), found.faults), (whole.valid.tolist(), []))

    def test_rows_of_a_file_of_several_people_and_shapes_are_selected_as_pandas_does(self):
        path = self.write({"cameras.json": json.dumps(CAMERA), "all.tsv": tracker_files.tobii_pro_lab(["A", "B"], ["cat", "owl"])})
        rows = table(path)
        rows = rows[rows["Presented Stimulus name"] == "owl"]
        found = gather(rows.groupby("Participant name"), trackers.tobii_pro_lab, cameras=self.root / "cameras.json")
        self.assertEqual((found.people, len(found.time), found.time[0]), (("A", "B"), 2 * N, 1000))
        whole = self.read("eyelink", tracker_files.eyelink(["cat", "owl 2"]), trial="owl 2")
        self.assertEqual((len(whole.time), whole.time[0]), (N, 25000))

    def test_old_tobii_files_name_no_unit(self):
        old = tracker_files.tobii_pro_lab().replace(" [ms]", "").replace(" [DACS px]", "")
        self.equal(self.read("tobii_pro_lab", old, unit="ms").time, self.read("tobii_pro_lab").time)
        self.assertIn("times step by 0.008333 ms, expected 0.3 to 200: unit='ms' fits", self.error_of(self.read, "tobii_pro_lab", old))

    def test_fixations_of_the_tracker(self):
        found = self.read("eyelink", fixations=True)
        self.equal((found.time, found.durations), [[20000, 20130], [80, 190]])
        self.equal(self.read("gazepoint", fixations=True).time, [0, 130])
        floats = pd.read_csv(self.root / "gaze").astype({"FPOGV": float})
        self.equal(self.read("gazepoint", rows=floats, fixations=True).time, [0, 130])

    def test_both_eyes_of_eyelink_are_refused_unless_one_is_taken(self):
        self.assertIn("has the eyes L and R: eye='L' takes one", self.error_of(lambda: self.read("eyelink", eye="")))
        left, right = (self.read("eyelink", eye=eye).directions[0] for eye in "LR")
        self.assertAlmostEqual((right / right[2] - left / left[2])[0], 100 / 1800)
        alone = tracker_files.eyelink().replace("\tLEFT", "")
        self.assertIn("has the eyes R: eye='R' takes one", self.error_of(lambda: self.read("eyelink", alone, eye="L")))
        self.assertIn("has no samples of the trial \"dog\"", self.error_of(lambda: self.read("eyelink", trial="dog")))

    def test_decimal_commas_in_vectors_of_unity_are_refused(self):
        commas = re.sub(r"(\d)\.(\d)", r"\1,\2", tracker_files.unity())
        self.assertRegex(self.error_of(self.read, "unity", commas), r'gaze:2: "\(.*" in column "CombinedGazePosition"')

    def test_a_shape_that_stands_in_unitys_world_turned_and_scaled(self):
        """The matrix moves, turns by a right angle around y and doubles."""
        matrix = np.array([[0, 0, 2, 5], [0, 2, 0, 6], [-2, 0, 0, 7], [0, 0, 0, 1.0]])
        points = np.array([[0.1, 0.2, 0.3], [-0.3, 0.1, 0.2], [0.0, 0.0, 0.4]])  # in the file of the shape, whose x Unity mirrors
        world = (points * [-1, 1, 1]) @ matrix[:3, :3].T + matrix[:3, 3]
        names = [f"{name}.{axis}" for name in ("origin", "gaze") for axis in "xyz"]
        rows = [[8 * k, *[1, 2, -3], *(place - [1, 2, -3])] for k, place in enumerate(world)]
        path = self.write({"u.csv": tracker_files.text(",".join(["t", *names]), rows)})
        found = trackers.unity(path, "A", time="t", unit="ms", valid="", rotation="", origin="origin", direction="gaze", object_to_world=matrix)
        away = points - found.origins
        np.testing.assert_allclose(found.directions, away / np.linalg.norm(away, axis=1, keepdims=True), atol=1e-12)
