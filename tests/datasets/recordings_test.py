# SPDX-License-Identifier: GPL-3.0-or-later
"""Recordings of gaze: what a description says of their files is read, one of each kind."""

import json
import unittest
from unittest import mock

import numpy as np

import salbench
from salbench.datasets import _gaze_rows, importing, inspecting, sets
from support import WithArchive, off, sphere

SPHERE = sphere(20, 22)
MESHES = {"shapes/ball.off": off(*SPHERE), "shapes/egg.off": off(SPHERE[0] * [1, 1, 1.4], SPHERE[1])}
PLACES = "places: [{meshes: 'shapes/*'}]\n"
HITS = PLACES + """recording:
  files: gaze/{item}_{person}.csv
  columns: {time: t, point: [x, y, z], duration: d}
"""
RAYS = PLACES + """units: m
recording:
  files: gaze.csv
  columns: {item: shape, person: who, time: t, valid: ok, origin: [ox, oy, oz], direction: [dx, dy, dz]}
  time: s
  length: mm
"""
PIXELS = PLACES + """recording:
  files: gaze/{item}/{person}.jsonl
  columns: {time: at, pixel: [gaze.0, gaze.1], frame: frame}
  cameras: cameras/{item}.json
"""


def table(rows, header="", separator=","):
    """Lines of CSV."""
    text = [separator.join(value if isinstance(value, str) else repr(float(value)) for value in row) + "\n" for row in rows]
    return header + "\n" * bool(header) + "".join(text)


def samples(n, seed=0):
    """Eyes and unit directions to places on a sphere of radius 0.9."""
    rng = np.random.default_rng(seed)
    places, eyes = (radius * v / np.linalg.norm(v, axis=1, keepdims=True) for radius, v in zip((0.9, 4), rng.normal(size=(2, n, 3))))
    return eyes, (places - eyes) / np.linalg.norm(places - eyes, axis=1, keepdims=True)


def turning_camera(angle, distance=5.0):
    """World to camera: x right, y down, z forward, from a place on a circle around the z axis, towards the origin."""
    forward = -np.array([np.cos(angle), np.sin(angle), 0])
    down = np.array([0, 0, -1.0])
    turn = np.stack([np.cross(down, forward), down, forward])
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = turn, turn @ (distance * forward)
    return matrix


def camera(matrix, **others):
    return {"fx": 900, "fy": 900, "cx": 640, "cy": 360, "width": 1280, "height": 720, "world_to_camera": np.asarray(matrix).tolist()} | others


class Kinds(WithArchive):
    def recording(self, layout, item="ball"):
        return self.read(layout, item).recording

    def remarks(self, layout, item="ball"):
        form = self.read(layout, item)
        return [line.replace(f"{self.root}/", "") for line in (*form.problems, *form.remarks)]

    def test_hits_have_a_file_per_item_and_person(self):
        points = np.array([[0, 0, 1], [0, 1, 0], [1, 0, 0.5]])
        self.write(MESHES | {f"gaze/ball_P{k}.csv": table([(100 * k + 7 * i, 50 + i, *point) for i, point in enumerate(points)], "t,d,x,y,z")
                             for k in (10, 2)})
        (ball, egg) = self.list(HITS).items
        self.assertEqual((ball.name, ball.recorded, egg.recorded, ball.truth, ball.native), ("ball", 2, 0, False, False))
        found = self.recording(HITS)
        self.assertEqual(found.people, ("P2", "P10"))
        self.equal(found.person, [0, 0, 0, 1, 1, 1])
        self.equal(found.time, [200, 207, 214, 1000, 1007, 1014])
        self.equal(found.durations, [50, 51, 52] * 2)
        self.equal(found.points, np.vstack([points, points]))
        self.assertTrue(found.valid.all())
        self.assertIsNone(found.origins)

    def test_rays_of_all_items_and_people_are_in_one_file(self):
        eyes, directions = samples(40)
        rows = [("egg" if i % 3 else "ball", "Zoë" if i % 2 else "Al", 0.25 * i, "true" if i % 5 else "false", *(1000 * eyes[i]), *directions[i])
                for i in range(40)]
        for separator in (",", "\t", ";"):
            self.write(MESHES | {"gaze.csv": "# by us\n" + table(rows, separator.join("shape who t ok ox oy oz dx dy dz".split()), separator)})
            self.assertEqual([item.recorded for item in self.list(RAYS).items], [2, 2])
            found, chosen = self.recording(RAYS, "egg"), [i for odd in (0, 1) for i in range(40) if i % 3 and i % 2 == odd]
            self.assertEqual(found.people, ("Al", "Zoë"))
            self.equal(found.time, 250.0 * np.array(chosen))
            self.equal(found.person, [i % 2 for i in chosen])
            valid = np.array(chosen) % 5 > 0
            self.equal(found.valid, valid)
            np.testing.assert_allclose(found.origins[valid], eyes[chosen][valid], rtol=1e-15)
            np.testing.assert_allclose(found.directions[valid], directions[chosen][valid], rtol=1e-15)
            self.assertTrue(np.isnan(found.directions[~valid]).all())
            self.assertEqual(self.remarks(RAYS, "egg"), [])

    def test_names_of_files_may_tell_one_of_both(self):
        rows = [("ball", "A", 0), ("egg", "A", 1), ("ball", "B", 5), ("ball", "A", 2)]
        columns = "{item: shape, person: who, time: t, point: [x, y, z]}"
        found = []
        for files, without, header in (("gaze.tsv", "", "shape who t x y z"), ("gaze/{person}.tsv", ", person: who", "shape t x y z"),
                                       ("gaze/{item}.tsv", "item: shape, ", "who t x y z")):
            self.write(MESHES)
            names = header.split()
            for name in {files.format(item=item, person=person) for item, person, _ in rows}:
                cells = [dict(zip(("shape", "who", "t", "x", "y", "z"), (*row, 1, 0, 0))) for row in rows if files.format(item=row[0], person=row[1]) == name]
                self.write({name: "".join("\t".join(line) + "\n" for line in [names, *([str(row[key]) for key in names] for row in cells)])})
            layout = PLACES + f"recording: {{files: '{files}', columns: {columns.replace(without, '')}}}\n"
            self.assertEqual([item.recorded for item in self.list(layout).items], [2, 1])
            ball, egg = (self.recording(layout, item) for item in ("ball", "egg"))
            found.append((ball.people, ball.person.tolist(), ball.time.tolist(), egg.people, egg.time.tolist()))
        self.assertEqual(found, [(("A", "B"), [0, 0, 1], [0, 2, 5], ("A",), [1])] * 3)

    def test_names_may_have_bytes_that_are_blanks_in_other_encodings(self):
        people = ("Meier", "\u00c5sa", "Zo\u00e0", "\u8001\u5f20", "\u5f20\u4f1f", "\u5f20\u654f")
        for names in (("shape", "t", "x", "y", "z", "who"), ("shape", "who", "t", "x", "y", "z"), ("who", "shape", "t", "x", "y", "z")):
            rows = [dict(zip(("shape", "t", "x", "y", "z", "who"), ("ball", t, 1, 0, 0, person))) for t, person in enumerate(people)]
            self.write(MESHES | {"gaze.txt": "".join(" ".join(line) + "\n" for line in [names, *([str(row[key]) for key in names] for row in rows)])})
            layout = PLACES + "recording: {files: gaze.txt, columns: {item: shape, person: who, time: t, point: [x, y, z]}}\n"
            self.assertEqual(sorted(self.recording(layout).people), sorted(people))

    def test_directions_may_be_angles(self):
        layout = RAYS.replace("[dx, dy, dz]", "[az, el]").replace("length: mm", "length: 2")
        self.write(MESHES | {"gaze.csv": table([("ball", "A", 0, "1", 0, 0, 3, 90, 0), ("ball", "A", 1, "1", 0, 0, 3, 45, -90)],
                                               "shape,who,t,ok,ox,oy,oz,az,el")})
        found = self.recording(layout)
        np.testing.assert_allclose(found.directions, [[0, 1, 0], [0, 0, -1]], atol=1e-15)
        self.equal(found.origins, [[0, 0, 6], [0, 0, 6]])
        np.testing.assert_allclose(self.recording(layout + "  angles: radians\n").directions[0], [np.cos(90), np.sin(90), 0], atol=1e-15)

    def test_a_camera_that_turns_once_around_gives_back_the_points(self):
        """Pixels are projections of points of the surface; the shape itself is turned and moved in the world."""
        points, frames, rows, expected = SPHERE[0], [], [], []
        of_object = turning_camera(0.3, 0.2)
        for k, angle in enumerate(np.linspace(0, 2 * np.pi, 60, endpoint=False)):
            matrix = turning_camera(angle)
            in_camera = (points @ of_object[:3, :3].T + of_object[:3, 3]) @ matrix[:3, :3].T + matrix[:3, 3]
            faces_it = np.einsum("ij,ij->i", in_camera, (points @ of_object[:3, :3].T) @ matrix[:3, :3].T) < -0.5
            i = int(np.flatnonzero(faces_it)[(7 * k) % faces_it.sum()])
            expected.append(points[i])
            x, y, z = in_camera[i]
            rows.append({"at": 10 * k, "gaze": [640 + 900 * x / z, 360 + 900 * y / z], "frame": 3 * k})
            frames.append(camera(matrix, frame=3 * k, object_to_world=of_object.tolist()))
        self.write(MESHES | {"gaze/ball/P1.jsonl": "".join(json.dumps(row) + "\n" for row in rows), "cameras/ball.json": json.dumps(frames)})
        found = self.recording(PIXELS)
        self.assertEqual((found.people, int(found.valid.sum())), (("P1",), 60))
        hits = salbench.cast_rays(*SPHERE, found.origins, found.directions * 1.0, snap=0.01)
        self.assertTrue((hits.face >= 0).all())
        back = np.einsum("kc,kcd->kd", hits.weights, points[SPHERE[1][hits.face]])
        self.assertLess(np.abs(back - expected).max(), 1e-6)

    def test_a_delay_takes_the_frame_that_was_shown_before(self):
        frames = [camera(turning_camera(k), frame=k) for k in range(5)]
        rows = [{"at": 100 * k + 40, "gaze": [640, 360], "frame": k} for k in range(5)]
        lines = "".join(json.dumps(row) + "\n" for row in rows)
        self.write(MESHES | {"gaze/ball/P1.jsonl": lines, "cameras/ball.json": json.dumps({"frames_per_second": 10, "frames": frames})})
        later, now = (self.recording(PIXELS + f"  delay_ms: {delay}\n") for delay in (200, 0))
        self.equal(later.valid, [False, False, True, True, True])
        self.equal(later.directions[2:], now.directions[:3])
        self.assertEqual(self.remarks(PIXELS + "  delay_ms: 200\n"),
                         ["gaze/ball/P1.jsonl:1: 2 of 5 rows of P1 are lost: there is no camera of its frame (the first is here)"])
        by_time = self.recording(PIXELS.replace(", frame: frame", ""))
        self.equal(by_time.directions, now.directions)
        self.write({"cameras/ball.json": json.dumps(frames)})
        self.assertEqual(self.remarks(PIXELS + "  delay_ms: 200\n"),
                         ["gaze/ball/P1.jsonl:1: 5 of 5 rows of P1 are lost: ROOT/cameras/ball.json: a frame has no time, which delay_ms needs: add `time`, "
                          "or `frames_per_second` beside `frames` (the first is here)".replace("ROOT/", "")])

    def test_blocks_of_any_size_give_the_same(self):
        rng, rows = np.random.default_rng(3), []
        eyes, directions = samples(400)
        for i in range(400):
            cells = [f"{'ball' if i % 7 else 'egg'}", f"P{i % 3}", i, "" if i % 11 == 0 else 1, *(1000 * eyes[i]), *directions[i]]
            cells[4] = "NA" if i % 13 == 0 else "oops" if i % 101 == 5 else cells[4]
            rows.append(cells[:-2] if i % 97 == 3 else [*map(str, cells)])
        for ending in ("\n", "\r\n", "\r"):
            text = ending.join(["shape,who,t,ok,ox,oy,oz,dx,dy,dz", *(",".join(map(str, row)) + "\n\n" * bool(rng.integers(20) == 0) for row in rows), ""])
            self.write(MESHES | {"gaze.csv": text})
            whole, remarks = self.read(RAYS, "ball"), None
            for size in (40, 300, 5000):
                with mock.patch.object(_gaze_rows, "BLOCK", size):
                    (self.root / "gaze.csv").touch()  # another file for what is kept of it
                    form = self.read(RAYS, "ball")
                for name in ("person", "time", "valid", "origins", "directions"):
                    self.equal(getattr(form.recording, name), getattr(whole.recording, name))
                self.assertEqual((form.recording.people, form.remarks, form.digests), (whole.recording.people, whole.remarks, whole.digests))
                remarks = form.remarks
            self.assertEqual(len(remarks), 9)
        self.assertEqual(whole.recording.people, ("P0", "P1", "P2"))
        self.assertEqual(len(whole.recording.time), sum(bool(i % 7) and i % 97 != 3 for i in range(400)))


class Commands(WithArchive):
    def setUp(self):
        super().setUp()
        self.to = self.root.parent / "to"
        eyes, directions = samples(4)
        looks = [(item, person, *(1000 * eyes[k]), *directions[k]) for k, (item, person) in enumerate((item, person) for item in ("ball", "egg") for person in "AB")]
        looks.append(("egg", "C", 0, 0, 9000, 0, 0, 1))
        rows = [(item, person, 0.01 * i, "1", *ray) for i in range(20) for item, person, *ray in looks]  # a fixation of each
        self.write(MESHES | {"gaze.csv": table([*rows, ("ball", "A", "soon", "1", 4000, 0, 0, -1, 0, 0)], "shape,who,t,ok,ox,oy,oz,dx,dy,dz")})

    def imported(self, layout=RAYS):
        return importing.import_set(self._layout(layout), str(self.root), str(self.to))

    def test_what_is_imported_is_what_was_read(self):
        done = self.imported()
        self.assertEqual([(shape.name, shape.outcome, shape.problem) for shape in done.shapes], [("ball", "written", ""), ("egg", "written", "")])
        self.assertEqual([remark.replace(str(self.root), "ROOT") for remark in done.shapes[0].remarks],
                         ["ROOT/gaze.csv:102: 1 of 21 rows of A is left out: the time is no finite number (the first is here)"])
        index = (self.to / "index.csv").read_text().splitlines()
        self.assertEqual([line.split(",")[::9] for line in index], [["item", "recorded"], ["ball", "2"], ["egg", "3"]])
        listed = sets.listed("hdf5", str(self.to))[1]
        for item in listed.items:
            again, recording = sets.read("hdf5", str(self.to), item).recording, self.read(RAYS, item.name).recording
            self.assertEqual(again.people, recording.people)
            for name in ("person", "time", "valid", "origins", "directions", "points", "durations"):
                self.equal(getattr(again, name), getattr(recording, name))
        self.assertEqual([shape.outcome for shape in self.imported().shapes], ["unchanged"] * 2)

    def test_a_file_that_cannot_be_read_is_a_problem_of_its_shape(self):
        self.write({"gaze/ball_A.csv": "t,d,x,y,z\n0,1,1,0,0\n", "gaze/ball_B.csv": "", "gaze/egg_A.csv": "", "gaze/egg_B.csv": "x\n"})
        ball, egg = self.imported(HITS).shapes
        self.assertEqual((ball.outcome, egg.outcome, len(egg.remarks)), ("written", "failed", 0))
        self.assertEqual([shape.problem.replace(str(self.root), "ROOT") for shape in (ball, egg)],
                         [f"ROOT/gaze/{name}.csv: has no rows; {name[-1]} cannot be in the recording" for name in ("ball_B", "egg_A")])
        self.assertEqual((self.to / "index.csv").read_text().splitlines()[1:], ["ball,,,,mesh,no,0,0,own,1"])

    def test_inspect_counts_by_person_and_names_who_looked_nowhere(self):
        self.imported()
        for layout, root in ((self._layout(RAYS), self.root), ("hdf5", self.to)):
            found = inspecting.inspected(layout, str(root))
            people = {(item["name"], *(person[key] for key in ("name", "samples", "lost"))) for item in found["items"] for person in item["people"]}
            self.assertEqual(people, {("ball", "A", 20, 0), ("ball", "B", 20, 0), ("egg", "A", 20, 0), ("egg", "B", 20, 0), ("egg", "C", 20, 0)})
            for item in found["items"]:
                for person in item["people"]:
                    on_shape = int(person["name"] != "C")
                    self.assertEqual(person, person | {"fixations": 1, "hits": on_shape, "snapped": 0, "missed": 1 - on_shape})
            missed = [problem for problem in found["problems"] if problem.startswith("egg: 1 of 3 people have no fixation on the shape (first: C, 0 of 1): check the unit")]
            self.assertEqual(len(missed), 1, found["problems"])

    def test_inspect_asks_for_the_unit(self):
        found = inspecting.inspected(self._layout(RAYS.replace("length: mm", "length: 1")), str(self.root))
        (asked,) = [problem for problem in found["problems"] if "no fixation" in problem and problem.startswith("ball")]
        self.assertRegex(asked, r"^ball: 2 of 2 people have no fixation on the shape \(first: A, 0 of [0-9]+\): check the unit of length")


class Descriptions(WithArchive):
    def test_file_line_key_and_what_was_expected(self):
        self.write(MESHES)
        for old, new, expected in [
                ("  files: gaze.csv\n", "", "4: recording.files is missing; expected a pattern such as gaze/{item}_{person}.csv"),
                ("gaze.csv", "'gaze/{item}.csv'", "5: recording.columns.item is there beside {item} in `files`: expected one of them"),
                ("who", "''", "5: recording.columns.person is missing, and so is {person} in `files`: expected one of them"),
                ("gaze.csv", "'gaze/{view}.csv'", "4: recording.files 'gaze/{view}.csv' cannot have {view} here"),
                ("direction", "directions", "5: recording.columns.directions is not a known key; did you mean 'direction'?"),
                (", direction: [dx, dy, dz]", "", "5: recording.columns names no gaze: expected one of point, direction, pixel"),
                ("ok,", "ok, point: [a, b, c],", "5: recording.columns names point and direction: expected one of point, direction, pixel"),
                ("[ox, oy, oz]", "[ox, oy]", "5: recording.columns.origin must be 3 columns, of x, y and z, not 2"),
                ("[dx, dy, dz]", "[dx]", "5: recording.columns.direction must be 3 columns, of x, y and z, or 2, of azimuth and elevation, not 1"),
                ("origin: [ox, oy, oz], ", "", "5: recording.columns.direction is there without `origin`, the place of the eye"),
                ("time: t, ", "", "5: recording.columns.time is missing; without it, each row needs a `duration`"),
                ("ok,", "ok, frame: f,", "5: recording.columns.frame is there without `pixel`"),
                ("length: mm", "cameras: c.json", "7: recording.cameras is there without `pixel`"),
                ("length: mm", "valid_is: yes", "7: recording.valid_is is 'yes', not a finite number"),
                ("time: s", "time: min", "6: recording.time is 'min', expected one of ms, s, us"),
                ("length: mm", "length: -1", "7: recording.length is '-1', expected one of m, dm, cm, mm, um, in, ft, or a number above 0"),
                ("units: m\n", "", "6: recording.length is 'mm', but the unit of the shapes is not known: add `units`, or give a number that lengths are "
                                   "multiplied by"),
                ("'shapes/*'", "'shapes/*', views: scored, truth: {saliency: '{item}_{view}'}",
                 "3: recording is there beside `views: scored`: it is of shapes, whose files are named here"),
                ("gaze.csv", "look.csv", "4: 'look.csv' fits no recording of gaze; expected are such as ROOT/look.csv")]:
            self.assertIn(old, RAYS)
            message = self.error_of(lambda: self.list(RAYS.replace(old, new)))  # noqa: B023: called at once
            self.assertEqual(message.replace("is 'min', not one of", "is 'min', expected one of"), f"own.yaml:{expected}")


if __name__ == "__main__":
    unittest.main()
