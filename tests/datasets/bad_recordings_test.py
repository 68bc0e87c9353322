# SPDX-License-Identifier: GPL-3.0-or-later
"""Recordings of gaze in which rows, names, files or cameras cannot be used."""

import json
import unittest
from unittest import mock

import numpy as np

from recordings_test import HITS, MESHES, PIXELS, PLACES, RAYS, camera, turning_camera
from salbench.datasets import _gaze_rows
from support import WithArchive


class BadInput(WithArchive):
    """Each is counted by cause and person, with file and line of the first; everything else goes on."""

    def remarks_of(self, layout, item="ball"):
        form = self.read(layout, item)
        return [line.replace(f"{self.root}/", "") for line in (*form.problems, *form.remarks)], form.recording

    def test_rows(self):
        good = ["ball", "A", "{t}", "1", "4000", "0", "0", "-1", "0", "0"]
        lost, out = "is lost", "is left out"
        for place, value, expected in [
                (2, "", f"{out}: the time is no finite number"), (2, "inf", f"{out}: the time is no finite number"),
                (2, "x", f"{out}: the time is no finite number"),
                (2, "-1", f"{out}: the time runs back"), (2, "1", f"{out}: the time is that of a row before"),
                (4, "nan", f"{lost}: a coordinate is missing, NaN or infinite"), (8, "", f"{lost}: a coordinate is missing, NaN or infinite"),
                (4, "1e999", f"{lost}: a coordinate is missing, NaN or infinite"),
                (6, "1_0", f"{lost}: a word that is no number"), (7, "0", f"{lost}: the direction has no length"),
                (7, "-1.002", f"{lost}: the direction is not of length 1; for directions of any length add `normalise_directions: true`"),
                (1, "", f"of nobody {out}: no person is named, or with characters that tables cannot have, or in more than 256 bytes"),
                (9, None, f"{out}: fewer columns than are named"),
                (9, "0,7", f"{out}: more columns than the header has: write decimal commas, if these are some, as points")]:
            rows = [[cell.format(t=i) for cell in good] for i in range(5)]
            rows[2][place] = value
            if value is None:
                del rows[2][place]
            self.write(MESHES | {"gaze.csv": "shape,who,t,ok,ox,oy,oz,dx,dy,dz\n" + "".join(",".join(row) + "\n" for row in rows)})
            found, recording = self.remarks_of(RAYS)
            with self.subTest(place=place, value=value):
                rows = "1 rows of nobody" if "nobody" in expected else "5 rows of A"
                self.assertEqual(found, [f"gaze.csv:4: 1 of {rows} {expected.removeprefix('of nobody ')} (the first is here)"])
                self.assertEqual((len(recording.time), int(recording.valid.sum())), (5 - (out in expected), 4))
        text = (self.root / "gaze.csv").read_text()
        (self.root / "gaze.csv").write_text(text.replace("-1,", "-1.002,").replace('"', ""))
        form = self.read(RAYS + "  normalise_directions: true\n")
        self.equal(form.recording.directions, [[-1, 0, 0]] * 4)
        self.assertEqual(len(form.remarks), 1)

    def test_what_the_tracker_lost_is_no_fault_of_the_file(self):
        self.write(MESHES | {"gaze.csv": "shape,who,t,ok,ox,oy,oz,dx,dy,dz\nball,A,0,0,,,,,,\nball,A,1,1,4,0,0,-1,0,0\nball,A,2,,4,0,0,-1,0,0\n"})
        found, recording = self.remarks_of(RAYS)
        self.assertEqual(found, [])
        self.equal(recording.valid, [False, True, False])
        found, recording = self.remarks_of(RAYS + "  valid_is: 0\n")  # as of trackers whose codes count failures
        self.assertEqual(found, ["gaze.csv:2: 1 of 3 rows of A is lost: a coordinate is missing, NaN or infinite (the first is here)"])
        self.equal(recording.valid, [False, False, False])

    def test_a_flag_that_is_no_number_is_a_fault_of_the_file(self):
        words = ["yes", "no", "1", "", "yes", "false", "yes"]
        lines = [f"ball,A,{min(t, 5)},{word},4,0,0,-1,0,{'x' if t == 4 else 0}\n" for t, word in enumerate(words)]
        self.write(MESHES | {"gaze.csv": "shape,who,t,ok,ox,oy,oz,dx,dy,dz\n" + "".join(lines)})
        found, recording = self.remarks_of(RAYS)
        self.assertEqual(found, ["gaze.csv:8: 1 of 7 rows of A is left out: the time is that of a row before (the first is here)",
                                 'gaze.csv:2: 2 of 7 rows of A are lost: `valid` is "yes", expected a number, true or false (the first is here)',
                                 'gaze.csv:3: 1 of 7 rows of A is lost: `valid` is "no", expected a number, true or false (the first is here)'])
        self.equal(recording.valid, [False, False, True, False, False, False])
        rows = [{"at": t, "gaze": [640, 360], "frame": 0, "ok": word} for t, word in enumerate([True, "yes", [1], None, "\ud800", *map(str, "abcdefghijk")])]
        self.write({"gaze/ball/A.jsonl": "".join(json.dumps(row) + "\n" for row in rows), "cameras/ball.json": json.dumps(camera(turning_camera(0)))})
        found, recording = self.remarks_of(PIXELS.replace("time: at", "time: at, valid: ok"))
        self.assertEqual([line.partition("lost: `valid` is ")[2].partition(",")[0] for line in found],
                         ['"yes"', '"[1]"', '"?"', *(f'"{letter}"' for letter in "abcdefg"), "another word"])
        self.assertTrue(found[-1].startswith("gaze/ball/A.jsonl:13: 4 of 16 rows of A are lost: "), found[-1])
        self.equal(np.flatnonzero(recording.valid), [0])

    def test_names_that_no_table_can_have(self):
        """Those who share the first 256 bytes of a long name are not one person."""
        header, long = "shape,who,t,ok,ox,oy,oz,dx,dy,dz\n", "P" * 256
        for names in ((long, long + "1", long + "2"), (long, f'"{long}1"', f'"{long}2"')):
            self.write(MESHES | {"gaze.csv": header + "".join(f"ball,{name},{t},1,4,0,0,-1,0,0\n" for t, name in enumerate(names))})
            found, recording = self.remarks_of(RAYS)
            self.assertEqual(found, [f'gaze.csv:3: 2 of 2 rows of "{"P" * 32}..." are left out: no person is named, or with characters that tables cannot '
                                     "have, or in more than 256 bytes (the first is here)"])
            self.assertEqual((recording.people, len(recording.time)), ((long,), 1))
        self.write({"gaze.csv": header + f"ball,A,0,1,4,0,0,-1,0,0\n{long}1,A,1,1,4,0,0,-1,0,0\n"})
        self.assertEqual([note.replace(f"{self.root}/", "") for note in self.list(RAYS).notes],
                         [f'gaze.csv:3: "{"P" * 32}..." (1 rows, the first is here) is no item of the data set: correct the name, or add its mesh'])
        rows = [{"at": t, "gaze": [640, 360], "frame": 0, "who": who} for t, who in enumerate(["A", "\ud800", "\udc80", "B\udfff"])]
        layout = PIXELS.replace("/{person}", "").replace("time: at", "person: who, time: at")
        self.write({"gaze/ball.jsonl": "".join(json.dumps(row) + "\n" for row in rows), "cameras/ball.json": json.dumps(camera(turning_camera(0)))})
        found, recording = self.remarks_of(layout)
        self.assertEqual([line.partition(": no person")[0] for line in found],
                         [f'gaze/ball.jsonl:{line}: 1 of 1 rows of "{name}" is left out' for line, name in ((2, "???"), (3, "?"), (4, "B???"))])
        self.assertEqual(recording.people, ("A",))
        self.write({"gaze/ball.jsonl": json.dumps({"\ud800": 1}) + "\n"})
        self.assertIn('ball.jsonl:1: no key "who": there are "???"; its people cannot be', self.error_of(lambda: self.read(layout)))
        self.write({"gaze/ball.jsonl": "".join(json.dumps(row | {"shape": row["who"]}) + "\n" for row in rows)})
        notes = self.list(layout.replace("{item}.jsonl", "ball.jsonl").replace("person: who", "person: who, item: shape")).notes
        self.assertEqual([note.partition("jsonl:")[2].partition(" (")[0] for note in notes], ['1: "A"', '2: "???"', '3: "?"', '4: "B???"'])

    def test_only_names_above_the_rows_are_a_header(self):
        rows = "0,1,1,0,0\n9,1,1,0,0\n"
        for text, is_header in [("#t,d,x,y,z\n" + rows, True), ("#t,d,x,y,z\n# 1,2,3,4,5\n#by us\n" + rows, True), ("# 1,2,3,4,5\n" + rows, False),
                                (rows + "#t,d,x,y,z\n", False), ("#t,d,x,y,z\n" + rows + "#a,b,c,e,f\n", True),
                                ("t,d,x,y,z\n" + rows + "# a,b,c,e,f\n", True)]:
            self.write(MESHES | {"gaze/ball_A.csv": text})
            for size in (1 << 22, 8):
                with mock.patch.object(_gaze_rows, "BLOCK", size), self.subTest(text=text, size=size):
                    if is_header:
                        self.equal(self.read(HITS).recording.time, [0, 9])
                    else:
                        self.assertIn('no column "t": the first line has "0", "1"', self.error_of(lambda: self.read(HITS)))

    def test_quotes_and_names(self):
        self.write(MESHES | {"gaze/ball_A.csv": 't,d,x,y,z\n"0",10,1,0,0\n"20,0,1,0,0\n30,"4,4",1,0,0\n50,5,1,0,"0\n60,5,1,0,0\n',
                             "gaze/ball_B\x07.csv": "t,d,x,y,z\n0,10,1,0,0\n"})
        found, recording = self.remarks_of(HITS)
        self.assertEqual(found, ["gaze/ball_B\x07.csv: names a person, and has a control character, which tables cannot have: rename it",
                                 "gaze/ball_A.csv:3: 2 of 5 rows of A are left out: a quote that nothing closes, or text behind one (the first is here)",
                                 "gaze/ball_A.csv:4: 1 of 5 rows of A is left out: the duration is no number above 0 (the first is here)"])
        self.equal(recording.time, [0, 60])

    def test_fixations_without_a_duration_are_left_out(self):
        self.write(MESHES | {"gaze/ball_A.csv": "t,d,x,y,z\n0,10,1,0,0\n20,0,1,0,0\n30,-1,1,0,0\n40,,1,0,0\n50,5,1,0,0\n"})
        found, recording = self.remarks_of(HITS)
        self.assertEqual(found, ["gaze/ball_A.csv:3: 3 of 5 rows of A are left out: the duration is no number above 0 (the first is here)"])
        self.equal(recording.time, [0, 50])
        found, recording = self.remarks_of(HITS.replace("time: t, ", ""))
        self.equal(recording.time, [0, 10])  # each begins when the one before it ends

    def test_unknown_items_and_files_of_nothing_are_noted(self):
        self.write(MESHES | {"gaze.csv": "shape,who,t,ok,ox,oy,oz,dx,dy,dz\nball,A,0,1,4,0,0,-1,0,0\ncow,A,1,1,4,0,0,-1,0,0\ncow,B,2,1,4,0,0,-1,0,0\n"})
        listing = self.list(RAYS)
        self.assertEqual([(item.name, item.recorded) for item in listing.items], [("ball", 1), ("egg", 0)])
        self.assertEqual(dict.fromkeys(note.replace(f"{self.root}/", "") for note in listing.notes),
                         {'gaze.csv:3: "cow" (2 rows, the first is here) is no item of the data set: correct the name, or add its mesh': None})
        self.write({"gaze/cow_A.csv": "", "gaze/egg_A.csv": "t,d,x,y,z\n0,1,1,0,0\n", "gaze/readme.csv": ""})
        self.assertEqual([note.replace(f"{self.root}/", "") for note in self.list(HITS).notes],
                         ["gaze/readme.csv: is not named NAME_PERSON.csv and was left out", "gaze/cow_A.csv: a recording of no item"])

    def test_a_file_that_cannot_be_read_fails_its_people(self):
        self.write(MESHES | {"gaze/ball_A.csv": "t,d,x,y,z\n0,1,1,0,0\n", "gaze/ball_B.csv": "", "gaze/ball_C.csv": "t,d,x,y\n0,1,1,0\n",
                             "gaze/ball_D.csv": b"\xff\xfet\0",
                             "gaze/ball_E.csv": "t,d,x,y,z\n", "gaze/ball_F.csv": "# t\n\n"})
        found, recording = self.remarks_of(HITS)
        self.assertEqual(found, ["gaze/ball_B.csv: has no rows; B cannot be in the recording",
                                 'gaze/ball_C.csv:1: no column "z": the first line has "t", "d", "x", "y"; C cannot be in the recording',
                                 "gaze/ball_D.csv: is no text of UTF-8: save it as such; D cannot be in the recording",
                                 "gaze/ball_E.csv: has no rows; E cannot be in the recording", "gaze/ball_F.csv: has no rows; F cannot be in the recording"])
        self.assertEqual(recording.people, ("A",))
        (self.root / "gaze/ball_A.csv").write_text("t,d,x,y,z\nx,1,1,0,0\n")
        self.assertEqual(self.error_of(lambda: self.read(HITS)), "ROOT/gaze/ball_B.csv: has no rows; B cannot be in the recording")

        self.write({"gaze.csv": "shape,who,t,ok,ox,oy,oz,dx,dy,dz\n", "gaze.tsv/ball": "who,t,x,y,z\n"})
        self.assertEqual([note.replace(f"{self.root}/", "") for note in self.list(RAYS).notes], ["gaze.csv: has no rows; its rows are in no recording"])
        layout = PLACES + "recording: {files: 'gaze.tsv/{item}', columns: {person: who, time: t, point: [x, y, z]}}\n"
        self.assertEqual(self.error_of(lambda: self.read(layout)), "ROOT/gaze.tsv/ball: has no rows; its people cannot be in the recording")

    def test_json_lines(self):
        lines = ['{"at": 0, "gaze": [640, 360], "frame": 0}', "{", '{"at": 2, "gaze": [640], "frame": 0}', '{"at": 3, "gaze": [640, null], "frame": 0}',
                 '{"at": 4, "gaze": [640, "here"], "frame": 0}', '{"at": 5, "gaze": [640, 360], "frame": 7}', "[" * 100_000]
        self.write(MESHES | {"gaze/ball/A.jsonl": "\n".join(lines) + "\n", "cameras/ball.json": json.dumps([camera(turning_camera(0), frame=0)])})
        self.assertEqual([line.removeprefix("gaze/ball/A.jsonl:") for line in self.remarks_of(PIXELS)[0]],
                         ["2: 3 of 7 rows of A are left out: no object of JSON with these keys (the first is here)",
                          "5: 1 of 7 rows of A is lost: a word that is no number (the first is here)",
                          "4: 1 of 7 rows of A is lost: a coordinate is missing, NaN or infinite (the first is here)",
                          "6: 1 of 7 rows of A is lost: there is no camera of its frame (the first is here)"])
        self.write({"gaze/ball/A.jsonl": '{"at": 0, "look": 1, "frame": 0}\n'})
        self.assertEqual(self.error_of(lambda: self.read(PIXELS)), 'ROOT/gaze/ball/A.jsonl:1: no key "gaze.0": there are "at", "look", "frame"; A cannot be '
                                                                   "in the recording")

    def test_cameras(self):
        good = camera(turning_camera(0), frame=0)
        matrix = turning_camera(1)
        mirrored, scaled, sheared = (matrix @ np.diag(of) for of in ([1, 1, -1, 1], [2, 2, 2, 1], [1, 1, 1.01, 1]))
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
                ({"fx": 10**400}, 'fx is "inf", expected a finite number'), ({"time": 10**400}, 'time is "inf", expected a finite number'),
                ({"world_to_camera": [[10**400] * 4] * 4}, "world_to_camera has a number that is not finite"),
                ({"fx": 1600}, "fx / fy is 1.77778, which is width / height: one field of view was taken for both axes"),
                ({"fx": 506.25}, "fx / fy is 0.5625, which is height / width: one field of view was taken for both axes"),
                ({"fov_degrees": wide, "fov_axis": "vertical"}, f"a vertical field of view of {wide!r} degrees makes fx 506.25, but it is 900: the angle "
                                                                "is that of the horizontal axis"),
                ({"fov_degrees": 20, "fov_axis": "vertical"}, "a vertical field of view of 20 degrees makes fx 2041.66, but it is 900"),
                ({"fov_degrees": 20}, "fov_axis is missing, expected horizontal or vertical"),
                ({"fov_degrees": 180, "fov_axis": "vertical"}, "fov_degrees is 180, expected an angle below 180"),
                ({"time": "soon"}, 'time is "soon", expected a finite number')]:
            cameras = json.dumps([good, good | {"frame": 1} | wrong, good | {"frame": 2}], indent=0)
            line = 1 + cameras[:cameras.index('"frame": 1') if '"frame": 1' in cameras else 0].count("\n")
            rows = "".join(json.dumps({"at": 10 * k, "gaze": [600, 300], "frame": k}) + "\n" for k in range(3))
            self.write(MESHES | {"gaze/ball/A.jsonl": rows, "cameras/ball.json": cameras})
            found, recording = self.remarks_of(PIXELS)
            with self.subTest(expected):
                at = found[0].partition("cameras/ball.json:")[2].partition(":")[0]
                self.assertEqual(found, [f"gaze/ball/A.jsonl:2: 1 of 3 rows of A is lost: {self.root}/cameras/ball.json:{at}: {expected} (the first is here)"
                                         .replace(f"{self.root}/", "")])
                self.assertTrue(1 < int(at) < line)
                self.equal(recording.valid, [True, False, True])
        axes = {"horizontal": wide, "vertical": 2 * np.degrees(np.arctan(360 / 900))}
        for axis, degrees in axes.items():
            view = {key: value for key, value in good.items() if key not in ("fx", "fy", "cx", "cy")} | {"fov_degrees": degrees, "fov_axis": axis}
            self.write({"cameras/ball.json": json.dumps([view, view | {"frame": 1}, good | {"frame": 2}])})
            found, recording = self.remarks_of(PIXELS)
            np.testing.assert_allclose(recording.directions, recording.directions[[2, 2, 2]], atol=1e-12)

    def test_files_of_cameras(self):
        rows = json.dumps({"at": 0, "gaze": [600, 300], "frame": 3}) + "\n"
        good = camera(turning_camera(0))
        for text, expected in [(json.dumps(good), None), (json.dumps(good | {"frame": 3}) + "\n" + json.dumps(good | {"frame": 2}), None),
                               (json.dumps({"frames": [{}] * 4} | good), None),
                               ("{", "1: no JSON: Expecting property name enclosed in double quotes; gaze in its frames is lost"),
                               ("[" * 100_000, " no JSON of cameras: too deep, or numbers too long; gaze in its frames is lost"),
                               ("[1]", " expected cameras: a list of objects, or an object with `frames`; gaze in its frames is lost"),
                               (json.dumps([good | {"frame": 3}] * 2), "1: the frame 3 has a camera already: keep one of them; gaze in its frames is lost")]:
            self.write(MESHES | {"gaze/ball/A.jsonl": rows, "cameras/ball.json": text})
            found, recording = self.remarks_of(PIXELS)
            self.equal(recording.valid, [expected is None])
            lost = "gaze/ball/A.jsonl:1: 1 of 1 rows of A is lost: {} (the first is here)"
            self.assertEqual(found, [f"cameras/ball.json:{expected}", lost.format("the file of its cameras cannot be read")] if expected else [])
        (self.root / "cameras/ball.json").unlink()
        self.assertEqual([note.replace(str(self.root), "ROOT").replace(str(self.own), "own.yaml") for note in self.list(PIXELS).notes],
                         ["ROOT/cameras/ball.json: is missing, the cameras of all gaze on ball (own.yaml:5)"])
        self.assertEqual(self.remarks_of(PIXELS)[0], [lost.format("there is no file of its cameras")])

    def test_one_camera_without_a_frame_is_that_of_every_frame_but_not_below_frames(self):
        good = camera(turning_camera(0))
        for cameras, seen in [(good, [0, 3]), ([good], [0, 3]), ({"frames": [good]}, [0]), (good | {"frames": [{}]}, [0]), (good | {"frame": 3}, [3]),
                              ([good | {"frame": 3}], [3]), ({"frames": [good | {"frame": 3}]}, [3])]:
            rows = "".join(json.dumps({"at": frame, "gaze": [600, 300], "frame": frame}) + "\n" for frame in (0, 3))
            self.write(MESHES | {"gaze/ball/A.jsonl": rows, "cameras/ball.json": json.dumps(cameras)})
            recording = self.remarks_of(PIXELS)[1]
            self.equal(recording.time[recording.valid], seen)

    def test_a_broken_camera_does_not_stand_in_for_the_time_of_another(self):
        layout = PIXELS.replace(", frame: frame", "")
        rows = "".join(json.dumps({"at": 10 * k + 5, "gaze": [600, 300]}) + "\n" for k in range(4))
        good = [camera(turning_camera(k), frame=k, time=10 * k) for k in range(4)]
        broken, timeless = {"fx": -1}, {"time": None}
        for changes, valid, expected in [
                ({1: broken}, [0, 2, 3], "fx is -1, expected a number above 0"), ({1: broken, 2: timeless}, [], "a frame has no time, which rows without a"),
                ({1: broken | timeless}, [2, 3], "fx is -1"), ({0: {"time": "soon"}}, [1, 2, 3], 'time is "soon"'),
                (dict.fromkeys(range(4), broken | timeless), [], "fx is -1")]:
            cameras = [{key: value for key, value in (one | changes.get(k, {})).items() if value is not None} for k, one in enumerate(good)]
            self.write(MESHES | {"gaze/ball/A.jsonl": rows, "cameras/ball.json": json.dumps(cameras)})
            found, recording = self.remarks_of(layout)
            with self.subTest(changes):
                self.assertEqual((np.flatnonzero(recording.valid).tolist(), len(found)), (valid, 1), found)
                self.assertIn(expected, found[0])


if __name__ == "__main__":
    unittest.main()
