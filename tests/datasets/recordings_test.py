# SPDX-License-Identifier: GPL-3.0-or-later
"""Recordings of gaze: tables of each kind become what people looked at, when, and from where."""

import gzip
import json
import struct

import numpy as np
import pandas as pd

import salbench
from salbench.datasets import Recording, eyenavgs, gather, saliency3d, table
from support import WithArchive, obj, sphere
from tests.support import tracker_files

SPHERE = sphere(20, 22)
HITS = {"time": "t", "point": ("x", "y", "z"), "duration": "d"}
PLACES = {"time": "t", "point": "xyz"}
RAYS = {"time": "t", "valid": "ok", "origin": ("ox", "oy", "oz"), "direction": ("dx", "dy", "dz"), "length": 0.001}
PIXELS = {"time": "at", "pixel": ("gaze.0", "gaze.1"), "frame": "frame"}
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
    def gathered(self, columns, people, item="", cameras="cameras.json"):
        """Gathers files, given with the person of each. If the person is "", selects rows of an item by columns `shape` and `who`."""
        more = {"cameras": self.root / cameras} if "pixel" in columns else {}
        sources = [(person, self.root / name) for name, person in people.items()]
        if not sources[0][0]:
            rows = table(sources[0][1])
            sources = rows[rows["shape"] == item].groupby("who")
        return gather(sources, Recording.of, **columns, **more)

    def recording(self, *files, **others):
        found = self.gathered(*files, **others)
        self.assertEqual(found.remarks, [])
        return found

    def told(self, found):
        return [line.replace(f"{self.root}/", "") for line in (*found.problems, *map(str, found.faults))]

    def refused(self, columns, text, **how):
        """The message for a file of person A, when no other has rows."""
        self.write({"A": text})
        return self.error_of(lambda: self.gathered(columns, {"A": "A"}, **how)).replace("ROOT/", "").replace("; nothing is known of the gaze on this shape", "")


class Kinds(WithRecordings):
    def test_hits_of_a_file_per_person_are_in_natural_order(self):
        points = np.array([[0, 0, 1], [0, 1, 0], [1, 0, 0.5]])
        self.write({f"P{k}.csv": csv([(100 * k + 7 * i, 5 + i, *point) for i, point in enumerate(points)], "t,d,x,y,z") for k in (10, 2)})
        found = self.recording(HITS, {"P10.csv": "P10", "P2.csv": "P2"})
        self.assertEqual((found.people, found.origins, found.directions), (("P2", "P10"), None, None))
        self.equal(found.person, [0, 0, 0, 1, 1, 1])
        self.equal(found.time, [200, 207, 214, 1000, 1007, 1014])
        self.equal(found.durations, [5, 6, 7] * 2)
        self.equal(found.points, np.vstack([points, points]))
        self.assertTrue(found.valid.all())

    def test_times_and_durations_have_a_unit(self):
        self.write({"P1.csv": csv([(4000, 2000, 0, 0, 1), (10000, 500, 0, 1, 0)], "t,d,x,y,z")})
        for unit, in_ms in (("ns", 1e-6), ("ticks", 1e-4), ("us", .001), ("ms", 1), ("s", 1000)):
            found = self.recording(HITS | {"unit": unit}, {"P1.csv": "P1"})
            np.testing.assert_allclose((found.time, found.durations), np.array([(4000, 10000), (2000, 500)]) * in_ms, rtol=1e-15)

    def test_rays_of_all_items_and_people_are_in_one_file(self):
        eyes, directions = samples(40)
        rows = [("egg" if i % 3 else "ball", "Zoë" if i % 2 else "Al", 25 * i, "true" if i % 5 else "false", *(1000 * eyes[i]), *directions[i])
                for i in range(40)]
        chosen = [i for odd in (0, 1) for i in range(40) if i % 3 and i % 2 == odd]
        valid = np.array(chosen) % 5 > 0
        for separator in (",", "\t", ";", " "):
            self.write({"gaze.csv": "# by us\n" + csv(rows, RAY_NAMES.strip().replace(",", separator), separator)})
            found = self.recording(RAYS, {"gaze.csv": ""}, "egg")
            self.assertEqual(found.people, ("Al", "Zoë"))
            self.equal(found.time, 25.0 * np.array(chosen))
            self.equal(found.person, [i % 2 for i in chosen])
            self.equal(found.valid, valid)
            np.testing.assert_allclose(found.origins[valid], eyes[chosen][valid], rtol=1e-15)
            np.testing.assert_allclose(found.directions[valid], directions[chosen][valid], rtol=1e-15)
            self.assertTrue(np.isnan(found.directions[~valid]).all())

    def test_directions_may_be_angles(self):
        self.write({"gaze.csv": csv([("ball", "A", 0, "1", 0, 0, 3, 90, 0), ("ball", "A", 1, "1", 0, 0, 3, 45, -90)], "shape,who,t,ok,ox,oy,oz,az,el")})
        layout = RAYS | {"direction": ("az", "el"), "length": 2.0}
        found = self.recording(layout, {"gaze.csv": ""}, "ball")
        np.testing.assert_allclose(found.directions, [[0, 1, 0], [0, 0, -1]], atol=1e-15)
        self.equal(found.origins, [[0, 0, 6], [0, 0, 6]])
        found = self.recording(layout | {"angles": "radians"}, {"gaze.csv": ""}, "ball")
        np.testing.assert_allclose(found.directions[0], [np.cos(90), np.sin(90), 0], atol=1e-15)

    def test_fixations_without_times_follow_one_another(self):
        self.write({"A": "10,1,0,0\n20,1,0,0\n5,1,0,0\n"})
        self.equal(self.recording({"duration": 1, "point": (2, 3, 4)}, {"A": "P"}).time, [0, 10, 30])

    def test_a_person_may_have_several_tables_in_order_of_time(self):
        self.write({"A": "t,x,y,z\n0,1,0,0\n9,1,0,0\n", "B": "t,x,y,z\n18,1,0,0\n", "C": "t,x,y,z\n18,1,0,0\n"})
        found = self.gathered(PLACES, {"A": "P", "B": "P", "C": "P"})
        self.equal(found.time, [0, 9, 18])
        self.assertIn("C: begins before", *self.told(found))
        tables = [("P", table(self.root / name)) for name in "AC"]
        self.assertIn("A: begins before", *self.told(gather(tables + tables[:1], Recording.of, **PLACES)))

    def test_quaternions_turn_the_forward_axis_and_axes_name_the_frame(self):
        half = np.sqrt(0.5)
        self.write({"A": csv([(0, 1, 2, 3, 0, half, 0, half), (8, 1, 2, 3, 0, 0, 0, 1), (16, 1, 2, 3, 0, 0, 0, 0)], "t,px,py,pz,qx,qy,qz,qw")})
        columns = {"time": "t", "origin": ("px", "py", "pz"), "direction": ("qx", "qy", "qz", "qw"), "missing": 0}
        for how, turned, ahead, eye in (({}, [1, 0, 0], [0, 0, 1], [1, 2, 3]), ({"forward": "-z"}, [-1, 0, 0], [0, 0, -1], [1, 2, 3]),
                                        ({"axes": "-x y z"}, [-1, 0, 0], [0, 0, 1], [-1, 2, 3]), ({"axes": "x -z y"}, [1, 0, 0], [0, -1, 0], [1, -3, 2])):
            found = self.recording(columns | how, {"A": "P"})
            np.testing.assert_allclose(found.directions[:2], [turned, ahead], atol=1e-15)
            self.equal(found.origins[:2], [eye, eye])
            self.equal(found.valid, [True, True, False])

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
        self.write({"P1": json_lines({"at": 100 * k + 40, "gaze": [640, 360], "frame": k} for k in range(6)),
                    "cameras.json": json.dumps({"frames_per_second": 10, "frames": frames})})
        later, now, by_time = (self.gathered(layout, {"P1": "P1"}) for layout in (PIXELS | {"delay_ms": 200}, PIXELS, PIXELS | {"frame": ""}))
        self.equal(later.valid, [False, False, True, True, True, False])
        self.equal(later.directions[2:5], now.directions[:3])
        self.equal(by_time.directions[:5], now.directions[:5])
        self.equal(by_time.valid, [True, True, True, True, True, False])  # the film is over
        self.assertEqual(self.told(later), ["P1:1: 3 rows of P1 lost: there is no camera of its frame"])
        self.write({"cameras.json": json.dumps([frame | {"time": 0.1 * k} for k, frame in enumerate(frames)])})
        self.assertIn("cameras.json: frames step by 0.1 ms", self.error_of(self.gathered, PIXELS | {"frame": ""}, {"P1": "P1"}))
        self.equal(self.gathered(PIXELS, {"P1": "P1"}).directions[:5], now.directions[:5])  # frames by number
        for us, told in ((1, 0), (1000, 1)):
            self.write({"cameras.json": json.dumps([frame | {"time": 100 * us * k} for k, frame in enumerate(frames)])})
            self.assertEqual(len([line for line in self.told(self.gathered(PIXELS | {"frame": ""}, {"P1": "P1"})) if "in ms" in line]), told)
        self.write({"cameras.json": json.dumps(frames)})
        self.assertIn("cameras.json: a frame has no time, which delay_ms needs: add `time`, or `frames_per_second` beside `frames`",
                      self.error_of(self.gathered, PIXELS | {"delay_ms": 200}, {"P1": "P1"}))


class Tables(WithRecordings):
    def test_numbers_are_the_doubles_that_python_reads(self):
        rng = np.random.default_rng(5)
        values = [value for value in struct.unpack("2000d", rng.bytes(16000)) if 0 < value < 1e300]
        words = [repr(value) for value in values] + [f"{value:.25e}" for value in rng.random(500)] + ["9007199254740993", "1e-320", "5."]
        self.write({"A": "".join(f"{k},{word},0,1\n" for k, word in enumerate(words))})
        self.equal(self.recording({"time": 1, "point": (2, 3, 4)}, {"A": "A"}).points[:, 0], [*map(float, words)])

    def test_line_ends_blank_lines_and_marks_change_nothing(self):
        eyes, directions = samples(60)
        rows = [RAY_NAMES.strip(), *(",".join(map(str, ("ball", f"P{i % 3}", i, "" if i % 11 == 0 else 1, *(1000 * eyes[i]), *directions[i]))) for i in range(60))]
        self.write({"gaze.csv": "\n".join(rows)})
        whole = self.recording(RAYS, {"gaze.csv": ""}, "ball")
        for text in ("\r\n".join([*rows, ""]), "\r".join([*rows, "", ""]), "sep=,\r\n" + "\n".join(rows), "\ufeff# ours\n\n" + "\n \n#\n".join(rows) + "\n", ", ".join("\n".join(rows).split(","))):
            self.write({"gaze.csv": text})
            found = self.recording(RAYS, {"gaze.csv": ""}, "ball")
            for name in ("people", "person", "time", "valid", "origins", "directions"):
                self.equal(getattr(found, name), getattr(whole, name))

    def test_columns_have_names_above_the_rows_or_numbers(self):
        rows, layout = "0,9,1,0,0\n9,9,1,0,0\n", {"time": 1, "point": (3, 4, 5)}
        for text, by_name in [("#t,d,x,y,z\n" + rows, True), ("#t,d,x,y,z\n# 1,2,3,4,5\n#by us\n" + rows, True), ("t,d,x,y,z\n" + rows + "# a,b,c,e,f\n", True),
                              ("# 1,2,3,4,5\n" + rows, False), (rows + "#t,d,x,y,z\n", False)]:
            self.write({"A": text})
            self.equal(self.recording(layout, {"A": "A"}).time, [0, 9])
            if by_name:
                self.equal(self.recording(HITS, {"A": "A"}).time, [0, 9])
            else:
                self.assertIn('A: no column "x": there are "1", "2"', self.refused(HITS, text))

    def test_names_of_people_are_words(self):
        people = ["007", "NA", "1e3", "\u00c5sa", "Zo\u00e0", "\u5f20 \u4f1f", "O, K"]
        self.write({"gaze.csv": "shape,who,t,d,x,y,z\n" + "".join(f'a,"{name}",{k},1,1,0,0\n' for k, name in enumerate(people))})
        self.assertEqual(sorted(self.recording(HITS, {"gaze.csv": ""}, "a").people), sorted(people))

    def test_json_lines_are_columns_by_the_paths_of_keys_and_may_be_packed(self):
        self.write({"A": gzip.compress(b'{"t": 1.5, "data": {"at": [0, 1]}, "on": true}\n{"t": 2, "data": {}}\nno\n')})
        self.assertEqual(table(self.root / "A").to_dict("list"), {"t": [1.5, 2, ""], "data.at.0": [0, "", ""], "data.at.1": [1, "", ""], "on": [True, "", ""]})
        self.write({"A": gzip.compress(b"1,2\n")[:-4]})
        self.assertIn("A: cannot be unpacked", self.error_of(table, self.root / "A"))

    def test_a_data_frame_of_ones_own_becomes_rows_of_a_person(self):
        frame = pd.DataFrame({"t": [0, 5, 5, 9], "x": [1, 2, 3, None], "y": 0, "z": 1}, index=[7, 8, 9, 10])
        found = Recording.of(frame, "A", **PLACES)
        self.assertEqual(found.people, ("A",))
        self.equal(found.time, [0, 5, 9])
        self.equal(found.points[:2], [[1, 0, 1], [2, 0, 1]])
        self.assertEqual(found.remarks, ["row:10: 1 row of A lost: a coordinate is missing, NaN or infinite", "row:9: 1 row of A left out: the time is that of another row"])

    def test_names_may_be_whole_numbers_of_one_column(self):
        frame = pd.DataFrame({"who": [10, 10, 2], "take": 1, "t": [0, 5, 0], "x": 1, "y": 0, "z": 1})
        self.assertEqual(gather(frame.groupby("who"), Recording.of, **PLACES).people, ("2", "10"))
        self.assertIn("group by one column", self.error_of(lambda: gather(frame.groupby(["who", "take"]), Recording.of, **PLACES)))

    def test_columns_that_make_no_recording_are_refused(self):
        for wrong, expected in [({}, "one kind"), ({"point": "xyz", "pixel": "xy"}, "one kind"), ({"direction": "xyz"}, "direction with origin"),
                                ({"point": "xy"}, "point must be 3 columns, not 2"), ({"point": "xyz", "unit": "min"}, "s, ms, us, ns"),
                                ({"pixel": "xy"}, "need cameras"), ({"point": "xyz", "axes": "x y y"}, "-x y z"), ({"point": "xyz", "time": ""}, "time or duration")]:
            with self.assertRaisesRegex(ValueError, expected):
                Recording.of(pd.DataFrame(), "A", **{"time": "t"} | wrong)


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
        self.assertEqual(self.told(shape.recording), [f"{folder}/hand/zl:1: 1 row of zl left out: the duration is no number above 0"])
        self.equal(shape.recording.points, SPHERE[0][:6])
        self.equal(shape.recording.time, [0, 200, 401, 603, 0, 200])
        self.equal(shape.points, SPHERE[0])

    def test_eyenavgs_has_a_file_per_person(self):
        """trackers_test.py has its columns."""
        cloud = "ply\nformat ascii 1.0\nelement vertex 12\nproperty float x\nproperty float y\nproperty float z\nend_header\n"
        cloud += "".join(f"{k % 4} {k // 4} {k % 3}\n" for k in range(12))
        for folder in ("truck", "dataset/truck"):
            self.setUp()
            self.write({"scenes/truck.ply": cloud} | {f"{folder}/user{k}_truck.csv": tracker_files.eyenavgs() for k in (2, 10)})
            (item,) = eyenavgs.items(str(self.root)).items
            self.assertEqual((item.name, item.kind, item.info), ("truck", "cloud", ["user2", "user10"]))
            recording = eyenavgs.read(item).recording
            self.assertEqual(recording.people, ("user2", "user10"))
            np.testing.assert_allclose(recording.directions[:8], tracker_files.DIRECTIONS[:8], atol=1e-5)
