# SPDX-License-Identifier: GPL-3.0-or-later
"""Recordings of gaze: tables of each kind become what people looked at, when, and from where."""

import json
import struct
import unittest
from dataclasses import replace
from unittest import mock

import numpy as np
import pandas as pd

import salbench
from salbench.datasets import eyenavgs, gaze, saliency3d
from salbench.datasets.gaze import Gaze, named, read_gaze, rows_of, table
from support import WithArchive, obj, off, sphere

SPHERE = sphere(20, 22)
HITS = Gaze(time="t", point=("x", "y", "z"), duration="d")
RAYS = Gaze(item="shape", person="who", time="t", valid="ok", origin=("ox", "oy", "oz"), direction=("dx", "dy", "dz"), unit="s", length=0.001)
PIXELS = Gaze(time="at", pixel=("gaze.0", "gaze.1"), frame="frame")
RAY_NAMES = "shape,who,t,ok,ox,oy,oz,dx,dy,dz\n"


def csv(rows, header="", separator=","):
    text = [separator.join(value if isinstance(value, str) else repr(float(value)) for value in row) + "\n" for row in rows]
    return header + "\n" * bool(header) + "".join(text)


def json_lines(rows):
    return "".join(json.dumps(row) + "\n" for row in rows)


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


class WithRecordings(WithArchive):
    def gathered(self, columns, people, item="", **cameras):
        """Of files by name: the person of each."""
        return read_gaze([(self.root / name, person) for name, person in people.items()], columns, item,
                         {person: self.root / name for person, name in cameras.items()} | ({"": self.root / "cameras.json"} if columns.pixel and not cameras else {}))

    def recording(self, *files, **others):
        found = self.gathered(*files, **others)
        self.assertEqual((found.remarks, found.problems), ([], []))
        return found.recording

    def told(self, found):
        return [line.replace(f"{self.root}/", "") for line in (*found.problems, *found.remarks)]


class Kinds(WithRecordings):
    def test_hits_of_a_file_per_person_are_in_natural_order(self):
        points = np.array([[0, 0, 1], [0, 1, 0], [1, 0, 0.5]])
        self.write({f"P{k}.csv": csv([(100 * k + 7 * i, 50 + i, *point) for i, point in enumerate(points)], "t,d,x,y,z") for k in (10, 2)})
        found = self.recording(HITS, {"P10.csv": "P10", "P2.csv": "P2"})
        self.assertEqual((found.people, found.origins, found.directions), (("P2", "P10"), None, None))
        self.equal(found.person, [0, 0, 0, 1, 1, 1])
        self.equal(found.time, [200, 207, 214, 1000, 1007, 1014])
        self.equal(found.durations, [50, 51, 52] * 2)
        self.equal(found.points, np.vstack([points, points]))
        self.assertTrue(found.valid.all())

    def test_times_and_durations_have_a_unit(self):
        self.write({"P1.csv": csv([(4000, 2000, 0, 0, 1), (10000, 500, 0, 1, 0)], "t,d,x,y,z")})
        for unit, in_ms in (("us", .001), ("ms", 1), ("s", 1000)):
            found = self.recording(replace(HITS, unit=unit), {"P1.csv": "P1"})
            np.testing.assert_allclose((found.time, found.durations), np.array([(4000, 10000), (2000, 500)]) * in_ms, rtol=1e-15)

    def test_rays_of_all_items_and_people_are_in_one_file(self):
        eyes, directions = samples(40)
        rows = [("egg" if i % 3 else "ball", "Zoë" if i % 2 else "Al", 0.25 * i, "true" if i % 5 else "false", *(1000 * eyes[i]), *directions[i])
                for i in range(40)]
        chosen = [i for odd in (0, 1) for i in range(40) if i % 3 and i % 2 == odd]
        valid = np.array(chosen) % 5 > 0
        for separator in (",", "\t", ";", " "):
            self.write({"gaze.csv": "# by us\n" + csv(rows, RAY_NAMES.strip().replace(",", separator), separator)})
            self.assertEqual(named(self.root / "gaze.csv", RAYS), {"ball": ["Al", "Zoë"], "egg": ["Zoë", "Al"]})
            found = self.recording(RAYS, {"gaze.csv": ""}, "egg")
            self.assertEqual(found.people, ("Al", "Zoë"))
            self.equal(found.time, 250.0 * np.array(chosen))
            self.equal(found.person, [i % 2 for i in chosen])
            self.equal(found.valid, valid)
            np.testing.assert_allclose(found.origins[valid], eyes[chosen][valid], rtol=1e-15)
            np.testing.assert_allclose(found.directions[valid], directions[chosen][valid], rtol=1e-15)
            self.assertTrue(np.isnan(found.directions[~valid]).all())

    def test_names_of_files_may_tell_what_no_column_does(self):
        rows = [("ball", "A", 0), ("egg", "A", 1), ("ball", "B", 5), ("ball", "A", 2)]
        for columns in (("item", "person"), ("item",), ("person",), ()):
            files = {}
            for row in [dict(zip(("item", "person", "t"), row)) for row in rows]:
                name = "_".join(["gaze", *(row[key] for key in ("item", "person") if key not in columns)])
                files.setdefault(name, (row["person"] if "person" not in columns else "", []))[1].append([*(row[key] for key in columns), str(row["t"]), "1", "0", "0"])
            self.write({name: csv(cells, "\t".join([*columns, *"txyz"]), "\t") for name, (_, cells) in files.items()})
            layout = Gaze(**{key: key for key in columns}, time="t", point="xyz")
            found = {item: self.recording(layout, {name: person for name, (person, _) in files.items() if "item" in columns or item in name}, item)
                     for item in ("ball", "egg")}
            self.assertEqual((found["ball"].people, found["ball"].person.tolist(), found["ball"].time.tolist()), (("A", "B"), [0, 0, 1], [0, 2, 5]))
            self.assertEqual((found["egg"].people, found["egg"].time.tolist()), (("A",), [1]))

    def test_directions_may_be_angles(self):
        self.write({"gaze.csv": csv([("ball", "A", 0, "1", 0, 0, 3, 90, 0), ("ball", "A", 1, "1", 0, 0, 3, 45, -90)], "shape,who,t,ok,ox,oy,oz,az,el")})
        layout = replace(RAYS, direction=("az", "el"), length=2.0)
        found = self.recording(layout, {"gaze.csv": ""}, "ball")
        np.testing.assert_allclose(found.directions, [[0, 1, 0], [0, 0, -1]], atol=1e-15)
        self.equal(found.origins, [[0, 0, 6], [0, 0, 6]])
        found = self.recording(replace(layout, angles="radians"), {"gaze.csv": ""}, "ball")
        np.testing.assert_allclose(found.directions[0], [np.cos(90), np.sin(90), 0], atol=1e-15)

    def test_fixations_without_times_follow_one_another(self):
        self.write({"A": "10,1,0,0\n20,1,0,0\n5,1,0,0\n", "B": "1,1,0,0\n"})
        found = self.recording(Gaze(duration=1, point=(2, 3, 4)), {"A": "P", "B": "P"})
        self.equal(found.time, [0, 10, 30, 35])

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
        self.write({"P1": json_lines(rows), "cameras.json": json.dumps(frames)})
        found = self.recording(PIXELS, {"P1": "P1"})
        self.assertEqual((found.people, int(found.valid.sum())), (("P1",), 60))
        hits = salbench.cast_rays(*SPHERE, found.origins, found.directions * 1.0, snap=0.01)
        self.assertTrue((hits.face >= 0).all())
        back = np.einsum("kc,kcd->kd", hits.weights, points[SPHERE[1][hits.face]])
        self.assertLess(np.abs(back - expected).max(), 1e-6)

    def test_a_delay_takes_the_frame_that_was_shown_before(self):
        frames = [camera(turning_camera(k), frame=k) for k in range(5)]
        self.write({"P1": json_lines({"at": 100 * k + 40, "gaze": [640, 360], "frame": k} for k in range(5)),
                    "cameras.json": json.dumps({"frames_per_second": 10, "frames": frames})})
        later, now, by_time = (self.gathered(layout, {"P1": "P1"}) for layout in (replace(PIXELS, delay_ms=200), PIXELS, replace(PIXELS, frame="")))
        self.equal(later.recording.valid, [False, False, True, True, True])
        self.equal(later.recording.directions[2:], now.recording.directions[:3])
        self.equal(by_time.recording.directions, now.recording.directions)
        self.assertEqual(self.told(later), ["P1:1: 2 of 5 rows of P1 are lost: there is no camera of its frame (the first is here)"])
        self.write({"cameras.json": json.dumps(frames)})
        self.assertEqual(self.told(self.gathered(replace(PIXELS, delay_ms=200), {"P1": "P1"})), [
            f"P1:1: 5 of 5 rows of P1 are lost: {self.root}/cameras.json: a frame has no time, which delay_ms needs: add `time`, or `frames_per_second` "
            "beside `frames` (the first is here)".replace(f"{self.root}/", "")])

    def test_people_may_have_cameras_of_their_own(self):
        self.write({name: json.dumps(camera(turning_camera(k))) for k, name in enumerate(("all.json", "mine.json"))})
        self.write(dict.fromkeys("ABC", json_lines([{"at": 0, "gaze": [640, 360], "frame": 0}])))
        found = read_gaze([(self.root / name, name) for name in "ABC"], PIXELS, cameras={"": self.root / "all.json", "B": self.root / "mine.json"}).recording
        np.testing.assert_allclose(found.origins, [[5, 0, 0], [5 * np.cos(1), 5 * np.sin(1), 0], [5, 0, 0]], atol=1e-12)


class Tables(WithRecordings):
    def test_numbers_are_the_doubles_that_python_reads(self):
        rng = np.random.default_rng(5)
        bits = struct.unpack("2000d", rng.bytes(16000))
        words = [repr(value) for value in bits if np.isfinite(value)] + [f"{value:.25e}" for value in rng.normal(size=500)] + ["9007199254740993", "1e-320", "5."]
        self.write({"a": "".join(f"{word},x\n" for word in words)})
        self.assertEqual(table(str(self.root / "a"), [1])[1].tolist(), [*map(float, words)])

    def test_line_ends_blank_lines_and_marks_change_nothing(self):
        eyes, directions = samples(60)
        rows = [RAY_NAMES.strip(), *(",".join(map(str, ("ball", f"P{i % 3}", i, "" if i % 11 == 0 else 1, *(1000 * eyes[i]), *directions[i]))) for i in range(60))]
        self.write({"gaze.csv": "\n".join(rows)})
        whole = self.recording(RAYS, {"gaze.csv": ""}, "ball")
        for text in ("\r\n".join([*rows, ""]), "\r".join([*rows, "", ""]), "\ufeff# ours\n\n" + "\n \n#\n".join(rows) + "\n", ", ".join("\n".join(rows).split(","))):
            self.write({"gaze.csv": text})
            found = self.recording(RAYS, {"gaze.csv": ""}, "ball")
            for name in ("people", "person", "time", "valid", "origins", "directions"):
                self.equal(getattr(found, name), getattr(whole, name))

    def test_columns_have_names_above_the_rows_or_numbers(self):
        rows, layout = "0,9,1,0,0\n9,9,1,0,0\n", Gaze(time=1, point=(3, 4, 5))
        for text, by_name in [("#t,d,x,y,z\n" + rows, True), ("#t,d,x,y,z\n# 1,2,3,4,5\n#by us\n" + rows, True), ("t,d,x,y,z\n" + rows + "# a,b,c,e,f\n", True),
                              ("# 1,2,3,4,5\n" + rows, False), (rows + "#t,d,x,y,z\n", False)]:
            self.write({"A": text})
            self.equal(self.recording(layout, {"A": "A"}).time, [0, 9])
            if by_name:
                self.equal(self.recording(HITS, {"A": "A"}).time, [0, 9])
            else:
                self.assertIn('A:1: no column "t": the first line has "0", "9"', self.told(self.gathered(HITS, {"A": "A"}))[0].replace("A:2", "A:1"))

    def test_names_of_people_are_words(self):
        people = ["007", "NA", "1e3", "\u00c5sa", "Zo\u00e0", "\u5f20 \u4f1f", "O, K"]
        self.write({"gaze.csv": "who,t,d,x,y,z\n" + "".join(f'"{name}",{k},1,1,0,0\n' for k, name in enumerate(people))})
        self.assertEqual(sorted(self.recording(replace(HITS, person="who"), {"gaze.csv": ""}).people), sorted(people))

    def test_a_file_of_several_items_is_read_once(self):
        self.write({"gaze.csv": RAY_NAMES + "ball,A,0,1,4,0,0,-1,0,0\negg,A,1,1,4,0,0,-1,0,0\n"})
        with mock.patch.object(gaze, "read_file", side_effect=gaze.read_file) as reads:
            self.assertEqual(named(self.root / "gaze.csv", RAYS), {"ball": ["A"], "egg": ["A"]})
            self.assertEqual([self.recording(RAYS, {"gaze.csv": ""}, item).time.tolist() for item in ("ball", "egg")], [[0], [1000]])
            self.assertEqual(reads.call_count, 1)

    def test_a_data_frame_of_ones_own_becomes_rows_of_a_person(self):
        frame = pd.DataFrame({"t": [0, 5, 5, 9], "x": [1, 2, 3, None], "y": 0, "z": 1})
        recording, faults, end = rows_of(frame, Gaze(time="t", point="xyz"), "A", before=-1)
        self.assertEqual((recording.people, end), (("A",), 9))
        self.equal(recording.time, [0, 5, 9])
        self.equal(recording.points[:2], [[1, 0, 1], [2, 0, 1]])
        self.assertEqual([faults.texts[cause] for cause in faults.cause],
                         ["", "", "the time is that of a row before", "a coordinate is missing, NaN or infinite"])

    def test_columns_that_make_no_recording_are_refused(self):
        for wrong, expected in [({}, "one kind"), ({"point": "xyz", "pixel": "xy"}, "one kind"), ({"direction": "xyz"}, "direction with origin"),
                                ({"point": "xy"}, "point must be 3 columns, not 2"), ({"point": "xyz", "unit": "min"}, "ms, s, us")]:
            with self.assertRaisesRegex(ValueError, expected):
                Gaze(**{"time": "t"} | wrong)
        with self.assertRaisesRegex(ValueError, "time or duration"):
            Gaze(point="xyz")


class Archives(WithRecordings):
    def test_saliency3d_has_fixations_that_follow_one_another(self):
        def rows(points):
            return csv([(0, 0, 0, 0, 9, 9, 0, 0, 1, 2, 200 + k, *point) for k, point in enumerate(points)])

        folder = "3D_gaze_data/Code/Exp1"
        self.write({"obj/hand.obj": obj(*SPHERE), f"{folder}/hand/zl": "1,2,3\n" + rows(SPHERE[0][:4]), f"{folder}/hand/zy": rows(SPHERE[0][4:6]),
                    f"{folder}/cow/zl": rows(SPHERE[0])})
        listing = saliency3d.items(str(self.root))
        (item,) = listing.items
        self.assertEqual((item.name, item.recorded, item.info, len(listing.notes)), ("hand", 2, ["zl", "zy"], 1))
        shape = saliency3d.read(item)
        self.assertEqual(self.told(shape), [f"{folder}/hand/zl:1: 1 of 5 rows of zl is left out: fewer columns than are named (the first is here)"])
        self.equal(shape.recording.points, SPHERE[0][:6])
        self.equal(shape.recording.time, [0, 200, 401, 603, 0, 200])
        self.equal(shape.points, SPHERE[0])

    def test_eyenavgs_turns_the_forward_axis_by_the_quaternion_of_the_left_eye(self):
        rng = np.random.default_rng(1)
        turns = rng.normal(size=(6, 4))
        turns /= np.linalg.norm(turns, axis=1, keepdims=True)
        turns[5] = 0  # a tracker that lost the eye
        names = "ViewIndex FOV1 FOV2 FOV3 FOV4 PositionX PositionY PositionZ QuaternionX QuaternionY QuaternionZ QuaternionW".split()
        header = ",".join([*names, "GazeQX,GazeQY,GazeQZ,GazeQW,GazePosX,GazePosY,GazePosZ,timestep"])
        rows = [(eye, *[0.7] * 11, *(np.round(turn, 6) if eye == 0 else turns[0]), 1, 2, 3, 14 * k + 6 * eye) for k, turn in enumerate(turns) for eye in (0, 1)]
        cloud = "ply\nformat ascii 1.0\nelement vertex 12\nproperty float x\nproperty float y\nproperty float z\nend_header\n"
        cloud += "".join(f"{k % 4} {k // 4} {k % 3}\n" for k in range(12))
        for folder in ("truck", "dataset/truck"):
            self.setUp()
            self.write({"scenes/truck.ply": cloud, f"{folder}/user2_truck.csv": csv(rows, header), f"{folder}/user10_truck.csv": csv(rows[:2], header)})
            (item,) = eyenavgs.items(str(self.root)).items
            self.assertEqual((item.name, item.kind, item.info), ("truck", "cloud", ["user2", "user10"]))
            shape = eyenavgs.read(item)
            self.assertEqual([line.partition(": ")[2] for line in self.told(shape)], ["1 of 6 rows of user2 is lost: the direction has no length (the first is here)"])
            self.equal(shape.recording.time, [0, 14, 28, 42, 56, 70, 0])
            self.equal(shape.recording.origins[0], [1, 2, 3])
            for (x, y, z, w), found in zip(turns[:5], shape.recording.directions):
                i, j, k = (np.array(matrix) for matrix in ([[0, 0, 0], [0, 0, -1], [0, 1, 0]], [[0, 0, 1], [0, 0, 0], [-1, 0, 0]], [[0, -1, 0], [1, 0, 0], [0, 0, 0]]))
                cross = x * i + y * j + z * k  # Rodrigues: 1 + 2 w [v] + 2 [v]^2
                np.testing.assert_allclose(found, (np.eye(3) + 2 * w * cross + 2 * cross @ cross) @ [0, 0, -1], atol=1e-5)


if __name__ == "__main__":
    unittest.main()
