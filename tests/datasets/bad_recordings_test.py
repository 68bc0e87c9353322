# SPDX-License-Identifier: GPL-3.0-or-later
"""Recordings of gaze in which rows, names, files or cameras cannot be used. Each is counted by cause and person; everything else goes on."""

import json
import unittest
from dataclasses import replace

import numpy as np

from recordings_test import HITS, PIXELS, RAY_NAMES, RAYS, WithRecordings, camera, json_lines, turning_camera
from salbench.datasets.gaze import Gaze, Gathered, named
from salbench.datasets.records import InputError, Shape


class Rows(WithRecordings):
    def read(self, columns, text, item="", **files):
        """Of one file, whose person is A unless a column names people."""
        self.write({"gaze": text} | files)
        return self.gathered(columns, {"gaze": "" if columns.person else "A"}, item)

    def test_each_cause_names_person_and_line(self):
        good = ["ball", "A", "{t}", "1", "4000", "0", "0", "-1", "0", "0"]
        lost, out = "is lost", "is left out"
        for place, value, expected in [
                (2, "", f"{out}: the time is no finite number"), (2, "inf", f"{out}: the time is no finite number"),
                (2, "x", f"{out}: the time is no finite number"),
                (2, "-1", f"{out}: the time runs back"), (2, "1", f"{out}: the time is that of a row before"),
                (4, "nan", f"{lost}: a coordinate is missing, NaN or infinite"), (8, "", f"{lost}: a coordinate is missing, NaN or infinite"),
                (4, "1e999", f"{lost}: a coordinate is missing, NaN or infinite"),
                (6, "oops", f"{lost}: a word that is no number"), (7, "0", f"{lost}: the direction has no length"),
                (7, "-1.002", f"{lost}: the direction is not of length 1; for directions of any length give normalise_directions=True"),
                (1, "", f"{out}: no person is named, or with characters that tables cannot have"),
                (9, None, f"{out}: fewer columns than are named"),
                (9, "0,7", f"{out}: more columns than the header has: write decimal commas, if these are some, as points")]:
            rows = [[cell.format(t=i) for cell in good] for i in range(5)]
            rows[2][place:place + 1] = [] if value is None else [value]
            found = self.read(RAYS, RAY_NAMES + "".join(",".join(row) + "\n" for row in rows), "ball")
            with self.subTest(place=place, value=value):
                of_whom = "1 rows of nobody" if place == 1 else "5 rows of A"
                self.assertEqual(self.told(found), [f"gaze:4: 1 of {of_whom} {expected} (the first is here)"])
                self.assertEqual((len(found.recording.time), int(found.recording.valid.sum())), (5 - (out in expected), 4))

    def test_directions_of_any_length_are_taken_when_that_is_said(self):
        text = RAY_NAMES + "ball,A,0,1,4,0,0,-1.5,0,0\nball,A,1,1,4,0,0,0,1e-200,0\n"
        self.equal(self.read(replace(RAYS, normalise_directions=True), text, "ball").recording.directions, [[-1, 0, 0], [0, 1, 0]])

    def test_a_row_that_is_lost_and_has_no_time_is_left_out(self):
        self.assertEqual(self.told(self.read(HITS, "t,d,x,y,z\n0,1,x,0,0\nsoon,1,x,0,0\n")), [
            "gaze:2: 1 of 2 rows of A is lost: a word that is no number (the first is here)",
            "gaze:3: 1 of 2 rows of A is left out: the time is no finite number (the first is here)"])

    def test_what_the_tracker_lost_is_no_fault_of_the_file(self):
        text = RAY_NAMES + "ball,A,0,0,,,,,,\nball,A,1,1,4,0,0,-1,0,0\nball,A,2,,4,0,0,-1,0,0\n"
        found = self.read(RAYS, text, "ball")
        self.assertEqual(self.told(found), [])
        self.equal(found.recording.valid, [False, True, False])
        found = self.read(replace(RAYS, valid_is=0.0), text, "ball")  # as of trackers whose codes count failures
        self.assertEqual(self.told(found), ["gaze:2: 1 of 3 rows of A is lost: a coordinate is missing, NaN or infinite (the first is here)"])
        self.equal(found.recording.valid, [False, False, False])

    def test_a_flag_that_is_no_number_is_a_fault_of_the_file(self):
        words = ["yes", "no", "1", "", "yes", "false", "yes"]
        lines = [f"ball,A,{min(t, 5)},{word},4,0,0,-1,0,{'x' if t == 4 else 0}\n" for t, word in enumerate(words)]
        found = self.read(RAYS, RAY_NAMES + "".join(lines), "ball")
        self.assertEqual(sorted(self.told(found)), [
            'gaze:2: 3 of 7 rows of A are lost: `valid` is a word such as "yes", expected a number, true or false (the first is here)',
            "gaze:8: 1 of 7 rows of A is left out: the time is that of a row before (the first is here)"])
        self.equal(found.recording.valid, [False, False, True, False, False, False])

    def test_people_whom_no_table_can_name_are_left_out(self):
        rows = [{"who": who, "t": t, "x": 1, "y": 0, "z": 0} for t, who in enumerate(["A", "\ud800", "B\n", "C\x07C"])]
        found = self.read(Gaze(person="who", time="t", point="xyz"), json_lines(rows))
        self.assertEqual([line.partition(": no person")[0] for line in self.told(found)],
                         [f'gaze:{line}: 1 of 1 rows of "{name}" is left out' for line, name in ((2, "?"), (4, "C?C"))])
        self.assertEqual(found.recording.people, ("A", "B"))
        self.write({"gaze": "t,x,y,z\n0,1,0,0\n"})
        found = self.gathered(Gaze(time="t", point="xyz"), {"gaze": "B\x07"})
        self.assertEqual((found.recording, self.told(found)[0].partition(" is left")[0]), (None, 'gaze:2: 1 of 1 rows of "B?"'))

    def test_fixations_without_a_duration_are_left_out(self):
        text = "t,d,x,y,z\n0,10,1,0,0\n20,0,1,0,0\n30,-1,1,0,0\n40,,1,0,0\n50,5,1,0,0\n"
        for columns, times in ((HITS, [0, 50]), (replace(HITS, time=""), [0, 10])):
            found = self.read(columns, text)
            self.assertEqual(self.told(found), ["gaze:3: 3 of 5 rows of A are left out: the duration is no number above 0 (the first is here)"])
            self.equal(found.recording.time, times)

    def test_causes_are_counted_over_all_files_of_a_person(self):
        self.write({"one": "t,d,x,y,z\n0,1,,0,0\n1,1,1,0,0\n", "two": "t,d,x,y,z\n1,1,1,0,0\n2,1,,0,0\n3,1,,0,0\n"})
        self.assertEqual(self.told(self.gathered(HITS, {"one": "A", "two": "A"})), [
            "one:2: 3 of 5 rows of A are lost: a coordinate is missing, NaN or infinite (the first is here)",
            "two:2: 1 of 5 rows of A is left out: the time is that of a row before (the first is here)"])

    def test_json_lines(self):
        lines = ['{"at": 0, "gaze": [640, 360], "frame": 0}', "{", '{"at": 2, "gaze": [640], "frame": 0}', '{"at": 3, "gaze": [640, null], "frame": 0}',
                 '{"at": 4, "gaze": [640, "here"], "frame": 0}', '{"at": 5, "gaze": [640, 360], "frame": 7}', '{"at": 6, "gaze": [[1], 360], "frame": 0}']
        found = self.read(PIXELS, "\n".join(lines) + "\n", **{"cameras.json": json.dumps([camera(turning_camera(0), frame=0)])})
        self.assertEqual(self.told(found), ["gaze:2: 2 of 7 rows of A are left out: no object of JSON with these keys (the first is here)",
                                            "gaze:5: 2 of 7 rows of A are lost: a word that is no number (the first is here)",
                                            "gaze:4: 1 of 7 rows of A is lost: a coordinate is missing, NaN or infinite (the first is here)",
                                            "gaze:6: 1 of 7 rows of A is lost: there is no camera of its frame (the first is here)"])
        self.equal(np.flatnonzero(found.recording.valid), [0])


class Files(WithRecordings):
    def test_a_file_that_cannot_be_read_fails_its_people(self):
        header = "t,d,x,y,z\n"
        expected = {"B": ("", "B: has no rows"), "C": ("t,d,x,y\n0,1,1,0\n", 'C:1: no column "z": the first line has "t", "d", "x", "y"'),
                    "D": (b"\xff\xfet\0", "D: is no text of UTF-8: save it as such"), "E": (header, "E: has no rows"), "F": ("# t\n\n", "F: has no rows"),
                    "G": (header + '0,1,1,0,0\n"1,1,1,0,0\n', "G:3: a quote that nothing closes on its line, or text behind one: correct it"),
                    "H": ('{"t": 0, "look": 1}\n', 'H:1: no object of JSON with the keys "t", "d", "x", "y", "z"')}
        self.write({"A": header + "0,1,1,0,0\n"} | {name: text for name, (text, _) in expected.items()})
        found = self.gathered(HITS, {name: name for name in ("A", *expected, "I")})
        self.assertEqual(self.told(found), [f"{message}; {name} cannot be in the recording" for name, (_, message) in expected.items()]
                         + ["I: cannot be read: No such file or directory; I cannot be in the recording"])
        self.assertEqual(found.recording.people, ("A",))

    def test_a_shape_of_which_nothing_is_known_is_an_error(self):
        shape = Shape(np.zeros((3, 3)))
        for found, expected in ((Gathered(remarks=["r"]), "r"), (Gathered(remarks=["r"], problems=["p"]), "p"), (Gathered(), "no row of gaze")):
            with self.assertRaisesRegex(InputError, expected):
                found.added_to(shape)
        shape.truth = np.zeros(3)
        self.assertEqual(Gathered(problems=["p"]).added_to(shape).problems, ["p"])

    def test_rows_without_a_name_belong_to_no_item(self):
        self.write({"gaze": RAY_NAMES + "ball,A,0,1,4,0,0,-1,0,0\n,A,1,1,4,0,0,-1,0,0\ncow,,1,1,4,0,0,-1,0,0\ncow,B,2,1,4,0,0,-1,0,0\n"})
        self.assertEqual(named(self.root / "gaze", RAYS), {"ball": ["A"], "cow": ["B"]})


class Cameras(WithRecordings):
    def seen(self, columns, cameras, rows):
        self.write({"A": json_lines(rows), "cameras.json": cameras if isinstance(cameras, str) else json.dumps(cameras)})
        found = self.gathered(columns, {"A": "A"})
        return self.told(found), np.flatnonzero(found.recording.valid).tolist(), found.recording

    def test_each_fault_is_named(self):
        good = camera(turning_camera(0), frame=0)
        matrix = turning_camera(1)
        mirrored, scaled, sheared = (matrix @ np.diag(by) for by in ([1, 1, -1, 1], [2, 2, 2, 1], [1, 1, 1.01, 1]))
        wide = float(2 * np.degrees(np.arctan(640 / 900)))
        for wrong, expected in [
                ({"world_to_camera": mirrored.tolist()}, "world_to_camera is no rotation: it mirrors"),
                ({"world_to_camera": scaled.tolist()}, "world_to_camera is no rotation: it scales by 2"),
                ({"object_to_world": sheared.tolist()}, "object_to_world is no rotation: it scales by 1 to 1.01"),
                ({"world_to_camera": matrix.T.tolist()}, "world_to_camera: the last row is not 0 0 0 1: is it transposed?"),
                ({"world_to_camera": [1, 2]}, "world_to_camera is no matrix of 4 x 4 numbers"),
                ({"world_to_camera": None}, "world_to_camera is missing"),
                ({"world_to_camera": [[float("nan")] * 4] * 4}, "world_to_camera has a number that is not finite"),
                ({"fx": None}, "fx is missing, expected a finite number"), ({"fy": -1}, "fy is -1, expected a number above 0"),
                ({"fx": 1600}, "fx / fy is 1.77778, which is width / height: one field of view was taken for both axes"),
                ({"fx": 506.25}, "fx / fy is 0.5625, which is height / width: one field of view was taken for both axes"),
                ({"fov_degrees": wide, "fov_axis": "vertical"}, f"a vertical field of view of {wide:.15g} degrees makes fx 506.25, but it is 900: the angle "
                                                                "is that of the other axis"),
                ({"fov_degrees": 20, "fov_axis": "vertical"}, "a vertical field of view of 20 degrees makes fx 2041.66, but it is 900"),
                ({"fov_degrees": 20}, "fov_axis is missing, expected horizontal or vertical"),
                ({"fov_degrees": 180, "fov_axis": "vertical"}, "fov_degrees is 180, expected an angle below 180"),
                ({"time": "soon"}, 'time is "soon", expected a finite number')]:
            told, valid, _ = self.seen(PIXELS, [good, good | {"frame": 1} | wrong, good | {"frame": 2}, good | {"frame": 3} | wrong],
                                       [{"at": 10 * k, "gaze": [600, 300], "frame": k} for k in range(4)])
            with self.subTest(expected):
                self.assertEqual((told, valid), ([f"A:2: 2 of 4 rows of A are lost: cameras.json: frame 1: {expected} (the first is here)"], [0, 2]))

    def test_a_field_of_view_stands_for_focal_lengths(self):
        good = camera(turning_camera(0))
        for axis, side in (("horizontal", 640), ("vertical", 360)):
            view = {key: value for key, value in good.items() if key not in ("fx", "fy", "cx", "cy")}
            view |= {"fov_degrees": 2 * np.degrees(np.arctan(side / 900)), "fov_axis": axis}
            told, _, recording = self.seen(PIXELS, [view, good], [{"at": k, "gaze": [600, 300], "frame": k} for k in range(2)])
            self.assertEqual(told, [])
            np.testing.assert_allclose(recording.directions[0], recording.directions[1], atol=1e-12)

    def test_forms_of_files(self):
        good = camera(turning_camera(0))
        lost = "A:1: 1 of 1 rows of A is lost: the file of its cameras cannot be read (the first is here)"
        for text, expected in [(json.dumps(good), None), (json.dumps(good | {"frame": 3}) + "\n" + json.dumps(good | {"frame": 2}), None),
                               (json.dumps({"frames": [{}] * 4} | good, indent=1), None), ("{", "no JSON of cameras: Expecting property name enclosed in double quotes"),
                               ("[1]", "expected cameras: a list of objects, or an object with `frames`"),
                               (json.dumps([good | {"frame": 3}] * 2), "frame 3 has two cameras: keep one of them")]:
            told, valid, _ = self.seen(PIXELS, text, [{"at": 0, "gaze": [600, 300], "frame": 3}])
            self.assertEqual(valid, [] if expected else [0])
            self.assertEqual(told[1:], [lost] if expected else [])
            self.assertTrue(not expected or told[0].startswith(f"cameras.json: {expected}") and told[0].endswith("; gaze in its frames is lost"), told)
        self.write({"A": json_lines([{"at": 0, "gaze": [600, 300], "frame": 3}])})
        self.assertEqual(self.told(self.gathered(PIXELS, {"A": "A"}, B="cameras.json"))[1:], [lost.replace("the file of its cameras cannot be read",
                                                                                                         "there is no file of its cameras")])

    def test_one_camera_without_a_frame_is_that_of_every_frame_but_not_below_frames(self):
        good = camera(turning_camera(0))
        for cameras, seen in [(good, [0, 1]), ([good], [0, 1]), ({"frames": [good]}, [0]), (good | {"frames": [{}]}, [0]), (good | {"frame": 3}, [1]),
                              ([good | {"frame": 3}], [1]), ({"frames": [good | {"frame": 3}]}, [1])]:
            self.assertEqual(self.seen(PIXELS, cameras, [{"at": frame, "gaze": [600, 300], "frame": frame} for frame in (0, 3)])[1], seen)

    def test_a_broken_camera_does_not_stand_in_for_the_time_of_another(self):
        good = [camera(turning_camera(k), frame=k, time=10 * k) for k in range(4)]
        broken, timeless = {"fx": -1}, {"time": None}
        for changes, valid, expected in [
                ({1: broken}, [0, 2, 3], "fx is -1, expected a number above 0"), ({1: broken, 2: timeless}, [], "a frame has no time, which rows without a"),
                ({1: broken | timeless}, [2, 3], "fx is -1"), ({0: {"time": "soon"}}, [1, 2, 3], 'time is "soon"'),
                (dict.fromkeys(range(4), broken | timeless), [], "fx is -1")]:
            cameras = [{key: value for key, value in (one | changes.get(k, {})).items() if value is not None} for k, one in enumerate(good)]
            told, seen, _ = self.seen(replace(PIXELS, frame=""), cameras, [{"at": 10 * k + 5, "gaze": [600, 300]} for k in range(4)])
            with self.subTest(changes):
                self.assertEqual((seen, len(told)), (valid, 1), told)
                self.assertIn(expected, told[0])


if __name__ == "__main__":
    unittest.main()
