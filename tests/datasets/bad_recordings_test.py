# SPDX-License-Identifier: GPL-3.0-or-later
"""Recordings of gaze in which rows, names, files or cameras cannot be used. Each is counted by cause and person; everything else goes on."""

import json

import numpy as np

from recordings_test import HITS, PIXELS, PLACES, RAY_NAMES, RAYS, WithRecordings, camera, csv, json_lines, turning_camera
from salbench.datasets.samples import Fault, summed

MISSING = "a coordinate is missing, NaN or infinite"


class Rows(WithRecordings):
    def read(self, columns, text, item="", **files):
        """Reads one file, whose person is A unless an item is named."""
        self.write({"gaze": text} | files)
        return self.gathered(columns, {"gaze": "" if item else "A"}, item)

    def test_each_cause_names_person_and_line(self):
        good = ["ball", "A", "{t}", "1", "4000", "0", "0", "-1", "0", "0"]
        word = "lost: a word that is no number"
        for place, value, expected in [
                (2, "", "left out: the time is no finite number"), (2, "inf", "left out: the time is no finite number"),
                (2, "x", "left out: the time is no finite number"), (2, "-1", "left out: the time is out of order"),
                (2, "1e9", "left out: the time is out of order"), (2, "1", "left out: the time is that of another row"),
                (4, "nan", f"lost: {MISSING}"), (8, "", f"lost: {MISSING}"), (4, "1e999", f"lost: {MISSING}"), (9, None, f"lost: {MISSING}"),
                (6, "oops", word), (7, "0", "lost: the direction has no length"),
                (7, "-1.002", "lost: the direction is not of length 1; for directions of any length give normalise_directions=True")]:
            rows = [[cell.format(t=i) for cell in good] for i in range(5)]
            rows[2][place:place + 1] = [] if value is None else [value]
            found = self.read(RAYS, RAY_NAMES + "".join(",".join(row) + "\n" for row in rows), "ball")
            with self.subTest(place=place, value=value):
                self.assertEqual(self.told(found), [f"gaze:4: 1 row of A {expected}"])
                self.assertEqual((len(found.time), int(found.valid.sum())), (4 + expected.startswith("lost"), 4))

    def test_gaze_that_is_not_there_is_a_lost_sample_however_it_is_written(self):
        """A blink of 250 ms at 120 Hz is 30 lost samples; without them, what lies on both sides would be one fixation."""
        time, lost = np.arange(240) / 120, [*range(108, 138)]
        values = [("0", "0", "1")] * 240
        tables = {name: "t,x,y,z\n" + "".join(",".join([repr(float(t)), *(cells if k in lost else value)]) + "\n" for k, (t, value) in enumerate(zip(time, values)))
                  for name, cells in {"blank": ("", "", ""), "NaN": ("nan",) * 3, "short": (), "two": ("0", "1"), "code": ("-1",) * 3, "zeros": ("0",) * 3}.items()}
        for name, at in {"{}": {}, "null": {"at": None}, "nulls": {"at": [None] * 3}, "a key less": {"at": {"x": 0}}}.items():
            tables[name] = json_lines({"t": t, "data": at if k in lost else {"at": [0, 0, 1]}} for k, t in enumerate(time))
        for name, text in tables.items():
            with self.subTest(name):
                places = [f"data.at.{k}" for k in range(3)] if text[0] == "{" else "xyz"
                found = self.read({"time": "t", "unit": "s", "point": places, "missing": (-1, 0)}, text)
                self.equal(np.flatnonzero(~found.valid), lost)
                np.testing.assert_allclose(found.time, 1000 * time)

    def test_one_wrong_time_costs_its_own_row(self):
        time = np.arange(240.0) * 8
        for places, wrong, expected in (([5], 1e9, 1), ([239], 1e9, 1), ([5], -1e9, 1), ([5, 6, 7], 1e9, 3), ([100], time[98], 1), ([0], 1e9, 1)):
            given = time.copy()
            given[places] = wrong
            found = self.read(PLACES, csv([(t, 0, 0, 1) for t in given], "t,x,y,z"))
            with self.subTest(places=places, wrong=wrong):
                self.equal(found.time, np.delete(time, places))
                self.assertEqual(sum(fault.rows for fault in found.faults), expected)
        found = self.read(PLACES, csv([(t + 600000 * (t > 900), 0, 0, 1) for t in time], "t,x,y,z"))
        self.assertEqual((len(found.time), self.told(found)), (240, ["gaze:115: 1 row of A kept: the time jumps by 600 s, longer than all the rest lasts"]))

    def test_of_a_clock_that_begins_again_the_later_times_need_a_sum(self):
        for begin, cause in ((0, "that of another row"), (4, "out of order")):
            found = self.read(PLACES, csv([(t, 0, 0, 1) for t in (*range(0, 800, 8), *range(begin, 800 + begin, 8))], "t,x,y,z"))
            self.assertRegex(self.told(found)[0], f"left out: the time is {cause}.* add to the times of the later one")

    def test_a_unit_that_makes_no_rate_of_a_tracker_is_a_problem_of_its_file(self):
        self.write({f"P{k}": csv([(scale * i, 0, 0, 1) for i in range(4)], "t,x,y,z") for k, scale in enumerate((8.333, .008333, 8333, 8333333, 4e4, 1e-2))})
        found = self.gathered(PLACES, {f"P{k}": f"P{k}" for k in range(6)})
        self.assertEqual(found.people, ("P0",))
        expected = ["0.008333 ms, expected 0.3 to 200: unit='s' fits (120 Hz)",
                    "8333 ms, expected 0.3 to 200: unit='us' fits (120 Hz), unit='ticks' fits (1200 Hz)",
                    "8.333e+06 ms, expected 0.3 to 200: unit='ns' fits (120 Hz)",
                    "4e+04 ms, expected 0.3 to 200: unit='us' fits (25 Hz), unit='ticks' fits (250 Hz)",
                    "0.01 ms, expected 0.3 to 200: unit='s' fits (100 Hz)"]
        self.assertEqual(self.told(found), [f"P{k}: times step by {text}; P{k} cannot be in the recording" for k, text in enumerate(expected, 1)])
        self.assertEqual(self.read(HITS, csv([(4000 * i, 2000, 0, 0, 1) for i in range(4)], "t,d,x,y,z")).problems, [], "fixations are longer")

    def test_fixations_of_two_eyes_are_refused(self):
        rows = [(0, 100, 0, 0, 1), (4, 98, 0, 0, 1), (150, 100, 0, 0, 1), (250, 50, 0, 0, 1)]
        self.assertEqual(self.refused(HITS, csv(rows, "t,d,x,y,z")),
                         "A:3: the fixation begins while another lasts: of two eyes, take the rows of one; A cannot be in the recording")
        self.equal(self.read(HITS, csv(rows[::2] + rows[3:], "t,d,x,y,z")).time, [0, 150, 250])

    def test_directions_of_any_length_are_taken_when_that_is_said(self):
        text = RAY_NAMES + "ball,A,0,1,4,0,0,-1.5,0,0\nball,A,1,1,4,0,0,0,1e-200,0\n"
        self.equal(self.read(RAYS | {"normalise_directions": True}, text, "ball").directions, [[-1, 0, 0], [0, 1, 0]])

    def test_a_row_that_is_lost_and_has_no_time_is_left_out(self):
        self.assertEqual(self.told(self.read(HITS, "t,d,x,y,z\n0,1,x,0,0\nsoon,1,x,0,0\n1,1,0,0,0\n")), [
            "gaze:2: 1 row of A lost: a word that is no number", "gaze:3: 1 row of A left out: the time is no finite number"])

    def test_what_the_tracker_lost_is_no_fault_of_the_file(self):
        text = RAY_NAMES + "ball,A,0,0,,,,,,\nball,A,1,1,4,0,0,-1,0,0\nball,A,2,,4,0,0,-1,0,0\n"
        found = self.read(RAYS, text, "ball")
        self.assertEqual(self.told(found), [])
        self.equal(found.valid, [False, True, False])

    def test_words_codes_and_confidences_say_what_is_valid(self):
        for cells, how, expected in ((["Valid", "Invalid", "VALID", "", "false", "true"], {}, [0, 2, 5]), (["0", "1", "0", "4"], {"valid_is": 0}, [0, 2]),
                                     (["ok", "no", "fine"], {"valid_is": ("ok", "fine")}, [0, 2]), ([".5", "0.7", "1", "nan", "0.6"], {"valid_from": 0.6}, [1, 2, 4])):
            found = self.read(RAYS | how, RAY_NAMES + "".join(f"ball,A,{t},{cell},4,0,0,-1,0,0\n" for t, cell in enumerate(cells)), "ball")
            self.assertEqual((np.flatnonzero(found.valid).tolist(), self.told(found)), (expected, []))

    def test_a_flag_that_is_no_number_is_a_fault_of_the_file(self):
        words = ["yes", "no", "1", "", "yes", "false", "yes"]
        lines = [f"ball,A,{min(t, 5)},{word},4,0,0,-1,0,{'x' if t == 4 else 0}\n" for t, word in enumerate(words)]
        found = self.read(RAYS, RAY_NAMES + "".join(lines), "ball")
        self.assertEqual(sorted(self.told(found)), [
            'gaze:2: 3 rows of A lost: `valid` is a word such as "yes", expected a number, true or false: valid_is says which words stand for valid samples',
            "gaze:8: 1 row of A left out: the time is that of another row"])
        self.equal(found.valid, [False, False, True, False, False, False])

    def test_words_that_no_row_has_are_a_fault_of_the_file(self):
        for cells, valid_is, there in ((["VALID", "", "INVALID"], "Valid", '2 rows of A lost: .* "VALID", "INVALID"'), (["1.0", "0.0"], "1", '"1.0", "0.0"')):
            rows = "".join(f"ball,A,{t},{cell},4,0,0,-1,0,0\n" for t, cell in enumerate(cells))
            self.assertRegex(self.refused(RAYS | {"valid_is": valid_is}, RAY_NAMES + rows), there)

    def test_people_whom_no_table_can_name_are_left_out(self):
        rows = "".join(f"ball,{who},{t},1,4,0,0,-1,0,0\n" for t, who in enumerate(["A", "", "C\x07C"]))
        found = self.read(RAYS, RAY_NAMES + rows, "ball")
        self.assertEqual(self.told(found), [f'gaze: "{shown}" is no name of a person that tables can have; {name or "nobody"} cannot be in the recording'
                                            for shown, name in (("", ""), ("C?C", "C\x07C"))])
        self.assertEqual(found.people, ("A",))

    def test_fixations_without_a_duration_are_left_out(self):
        text = "t,d,x,y,z\n0,10,1,0,0\n20,0,1,0,0\n30,-1,1,0,0\n40,,1,0,0\n50,5,1,0,0\n"
        for columns, times in ((HITS, [0, 50]), (HITS | {"time": ""}, [0, 10])):
            found = self.read(columns, text)
            self.assertEqual(self.told(found), ["gaze:3: 3 rows of A left out: the duration is no number above 0"])
            self.equal(found.time, times)

    def test_causes_of_a_study_are_a_line_each(self):
        faults = [Fault(MISSING, f"P{k % 3}", 1 + k, "lost", f"{k}.csv:2") for k in range(4)] + [Fault("the time is out of order", "P1", 1, "left out", "a:9")]
        self.assertEqual(summed(faults), [f"0.csv:2: 10 rows of 3 people lost: {MISSING}", "a:9: 1 row of P1 left out: the time is out of order"])

    def test_json_lines(self):
        lines = ['{"at": 0, "gaze": [640, 360], "frame": 0}', "{", '{"at": 2, "gaze": [640], "frame": 0}', '{"at": 3, "gaze": [640, null], "frame": 0}',
                 '{"at": 4, "gaze": [640, "here"], "frame": 0}', '{"at": 5, "gaze": [640, 360], "frame": 7}', '{"at": 6, "gaze": [[1], 360], "frame": 0}']
        found = self.read(PIXELS, "\n".join(lines) + "\n", **{"cameras.json": json.dumps([camera(turning_camera(0), frame=0)])})
        self.assertEqual(self.told(found), ["gaze:5: 1 row of A lost: a word that is no number", f"gaze:3: 3 rows of A lost: {MISSING}",
                                            "gaze:2: 1 row of A left out: the time is no finite number", "gaze:6: 1 row of A lost: there is no camera of its frame"])
        self.equal(np.flatnonzero(found.valid), [0])


class Files(WithRecordings):
    def test_a_file_that_cannot_be_read_fails_its_people(self):
        header = "t,d,x,y,z\n"
        expected = {"B": ("", "B: has no rows"), "C": ("t,d,x,y\n0,1,1,0\n", 'C: no column "z": there are "t", "d", "x", "y"'),
                    "D": (b"\xff\xfet\0", "D: is no text of UTF-8: save it as such"), "E": (header, "E: has no rows"), "F": ("# t\n\n", "F: has no rows"),
                    "G": (header + '0,1,1,0,0\n"1,1,1,0,0\n', "G:3: a quote that nothing closes on its line, or text behind one: correct it"),
                    "H": ('{"t": 0, "look": 1}\n', 'H: no column "x": there are "t", "look"'),
                    "J": (header + "0,1,1,0,0\n1,1,0,5,0,0,1\n", "J:3: has more words than the header: write decimal commas, if these are some, as points"),
                    "N": ("t d x y z\n1 0 1 1 0 0\n", "N:2: has more words than the header: name each column; from R, write it with row.names=FALSE"),
                    "K": ("t,d,x,y,z,x\n0,1,1,0,0,1\n", 'K: "x" is the name of the columns 3 and 6: take one by its number')}
        self.write({"A": header + "0,1,1,0,0\n"} | {name: text for name, (text, _) in expected.items()})
        found = self.gathered(HITS, {name: name for name in ("A", *expected, "L")})
        self.assertEqual(self.told(found), [f"{message}; {name} cannot be in the recording" for name, (_, message) in expected.items()]
                         + ["L: cannot be read: No such file or directory; L cannot be in the recording"])
        self.assertEqual(found.people, ("A",))

    def test_a_shape_without_a_row_that_can_be_used_is_an_error(self):
        for text, expected in (("t,d,x,y,z\n0,1,,,\n", f"A:2: 1 row of A lost: {MISSING}"), ("t,d,x,y,z\n", "A: has no rows; A cannot be in the recording")):
            self.assertEqual(self.refused(HITS, text), expected)
        self.assertEqual(self.refused(HITS | {"missing": 0}, "t,d,x,y,z\n0,1,0,0,0\n"), "no row has gaze")


class Cameras(WithRecordings):
    def seen(self, columns, cameras, rows):
        self.write({"A": json_lines(rows), "cameras.json": cameras if isinstance(cameras, str) else json.dumps(cameras)})
        found = self.gathered(columns, {"A": "A"})
        return self.told(found), np.flatnonzero(found.valid).tolist(), found

    def test_pixels_that_are_fractions_are_named(self):
        self.write({"cameras.json": json.dumps(camera(turning_camera(0)))})
        for pixels, corner in (((0.4, 0.6), "0 0"), ((0.4, 719.4), "0 720"), ((1279.6, 0.6), "1280 0")):
            text = json_lines({"at": 8 * k, "gaze": pixels} for k in range(3))
            self.assertIn(f"A: all pixels are within 2 of the corner {corner} of the picture", self.refused(PIXELS | {"frame": ""}, text))

    def test_each_fault_is_named(self):
        good = camera(turning_camera(0), frame=0)
        matrix = turning_camera(1)
        mirrored, scaled, sheared = (matrix @ np.diag(by) for by in ([1, 1, -1, 1], [2, 2, 2, 1], [1, 1, 1.01, 1]))
        wide = float(2 * np.degrees(np.arctan(640 / 900)))
        for wrong, expected in [
                ({"world_to_camera": mirrored.tolist()}, "world_to_camera is no rotation: it mirrors x or y; x points right, y down and z forward"),
                ({"world_to_camera": (np.diag([1, 1, -1, 1]) @ matrix).tolist()}, "world_to_camera is no rotation: it mirrors z; x points right, y down and z forward"),
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
                self.assertEqual((told, valid), ([f"A:2: 2 rows of A lost: cameras.json: frame 1: {expected}"], [0, 2]))

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
        rows = [{"at": 0, "gaze": [600, 300], "frame": 3}]
        for text in (json.dumps(good), json.dumps(good | {"frame": 3}) + "\n" + json.dumps(good | {"frame": 2}), json.dumps({"frames": [{}] * 4} | good, indent=1)):
            self.assertEqual(self.seen(PIXELS, text, rows)[:2], ([], [0]))
        for text, expected in [("{", "no JSON of cameras: Expecting property name enclosed in double quotes"),
                               ("[1]", "expected cameras: a list of objects, or an object with `frames`"),
                               (json.dumps([good | {"frame": 3}] * 2), "frame 3 has two cameras: keep one of them")]:
            self.write({"cameras.json": text})
            self.assertIn(f"A: cameras.json: {expected}", self.refused(PIXELS, json_lines(rows)))
        self.assertIn("none.json: cannot be read", self.refused(PIXELS, json_lines(rows), cameras="none.json"))

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
            self.write({"A": json_lines({"at": 10 * k + 5, "gaze": [600, 300]} for k in range(4)), "cameras.json": json.dumps(cameras)})
            with self.subTest(changes):
                if not valid:
                    self.assertIn(expected, self.error_of(self.gathered, PIXELS | {"frame": ""}, {"A": "A"}))
                    continue
                found = self.gathered(PIXELS | {"frame": ""}, {"A": "A"})
                self.assertEqual((np.flatnonzero(found.valid).tolist(), len(found.faults)), (valid, 1))
                self.assertIn(expected, found.faults[0].cause)
