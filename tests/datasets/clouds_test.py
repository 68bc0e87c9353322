# SPDX-License-Identifier: GPL-3.0-or-later
"""Point clouds in .pcd and .xyz files."""

import struct

import numpy as np

from salbench import Dataset
from salbench.datasets.clouds import read_pcd, read_xyz
from salbench.datasets.reading import cloud
from support import NAN, WithArchive, sphere

POINTS, NORMALS = sphere()[0] * 3.7 + 0.1, sphere()[0]
FIELDS = ("rgb F 4 1", "z F 8 1", "normal_x F 4 1", "y F 8 1", "_ U 1 3", "normal_y F 4 1", "x F 8 1", "normal_z F 8 1", "ring I 2 2")  # out of order, others between
PLAIN = ("x F 8 1", "y F 8 1", "z F 8 1")


def header(form, n, fields=PLAIN, width=None, height=1, viewpoint="0 0 0 1 0 0 0"):
    names, kinds, sizes, counts = zip(*(field.split() for field in fields))
    return (f"# .PCD v0.7\nVERSION 0.7\nFIELDS {' '.join(names)}\nSIZE {' '.join(sizes)}\nTYPE {' '.join(kinds)}\nCOUNT {' '.join(counts)}\n"
            f"WIDTH {width or n}\nHEIGHT {height}\nVIEWPOINT {viewpoint}\nPOINTS {n}\nDATA {form}\n")


def columns(points, normals):
    """By field, as bytes of each point."""
    values = {"x": points[:, 0], "y": points[:, 1], "z": points[:, 2], "normal_x": normals[:, 0], "normal_y": normals[:, 1], "normal_z": normals[:, 2],
              "rgb": np.full(len(points), NAN), "_": np.full((len(points), 3), 7), "ring": np.tile([-3, 4], (len(points), 1))}
    kinds = {"F": "f", "I": "i", "U": "u"}
    for name, kind, size, count in map(str.split, FIELDS):
        yield np.asarray(values[name]).reshape(len(points), int(count)).astype(f"<{kinds[kind]}{size}")


def lzf(data):
    """As bytes of their own, with a run of the last one where there are some: what a decoder has to know."""
    packed, at = b"", 0
    while at < len(data):
        run = 1
        while run < 264 and data[at:at + 1] == data[at + run:at + run + 1]:
            run += 1
        packed += b"\0" + data[at:at + 1]
        at += 1
        if run > 3:
            length = run - 1 - 2
            packed += bytes([min(length, 7) << 5, *([length - 7] if length >= 7 else []), 0])
            at += run - 1
    return packed


def files(points=POINTS, normals=NORMALS):
    table = [*columns(points, normals)]
    rows = b"".join(b"".join(column[k].tobytes() for column in table) for k in range(len(points)))
    whole = b"".join(column.tobytes() for column in table)
    packed = lzf(whole)
    text = "".join(" ".join(str(value) for column in table for value in column[k].tolist()) + "\n" for k in range(len(points)))
    n = len(points)
    return {"ascii": (header("ascii", n, FIELDS) + text).encode(), "binary": header("binary", n, FIELDS).encode() + rows,
            "binary_compressed": header("binary_compressed", n, FIELDS).encode() + struct.pack("<II", len(packed), len(whole)) + packed}


class Pcd(WithArchive):
    def expect(self, wrong, content):
        self.assertRegex(self.error_of(cloud, self.write({"a.pcd": content})), f"^ROOT/a.pcd.*{wrong}")

    def test_every_encoding_holds_the_same_cloud(self):
        for name, content in files().items():
            for end in (b"", b"\n" if name == "ascii" else b"\0" * 40):
                found = cloud(self.write({"a.PCD": content + end}))
                self.equal(found.points, POINTS)
                np.testing.assert_allclose(found.normals, NORMALS, atol=1e-7)
                self.assertEqual((found.viewpoint, found.left_out), (None, None), name)

    def test_numbers_of_every_type(self):
        corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [100, 7, 3]])
        for kind, size in [("I", 1), ("U", 1), ("I", 2), ("U", 2), ("I", 4), ("U", 4), ("I", 8), ("U", 8), ("F", 4), ("F", 8)]:
            values = corners.astype(f"<{kind.lower()}{size}")
            found = read_pcd(self.write({"a.pcd": header("binary", 5, [f"{axis} {kind} {size} 1" for axis in "xyz"]).encode() + values.tobytes()}))
            self.equal(found[0], corners)

    def test_points_without_a_position_are_left_out(self):
        gap = np.insert(POINTS, 2, NAN, axis=0)
        for content in files(gap, np.insert(NORMALS, 2, NAN, axis=0)).values():
            found = cloud(self.write({"a.pcd": content}))
            self.equal(found.points, POINTS)
            self.assertEqual(found.left_out.tolist(), [2])

    def test_a_viewpoint_that_is_not_the_origin_or_that_of_an_organised_cloud(self):
        n, text = len(POINTS), "".join(f"{x!r} {y!r} {z!r}\n" for x, y, z in POINTS.tolist())
        for width, height, written, expected in [(n, 1, "0 0 0 1 0 0 0", None), (n, 1, "0 0.5 -1 1 0 0 0", [0, 0.5, -1]), (n // 2, 2, "0 0 0 1 0 0 0", [0, 0, 0])]:
            found = cloud(self.write({"a.pcd": header("ascii", n, PLAIN, width, height, written) + text})).viewpoint
            self.assertEqual(None if found is None else found.tolist(), expected)
        for eye in ([0, 0, 9], [0, 0, -9]):  # the data set's normals, too
            self.write({"a.pcd": header("ascii", n, PLAIN, viewpoint="{} {} {} 1 0 0 0".format(*eye)) + text})
            shape = Dataset("folder", self.root)["a"]
            self.assertGreaterEqual(((np.array(eye) - shape.points) * shape.normals).sum(axis=1).min(), 0)
        old = "COLUMNS x y z\nSIZE 4 4 4\nTYPE F F F\nPOINTS 4\nDATA ascii\n1 2 3\n2 2 3 1 3\n3 1 2 4\n"  # records go over ends of lines
        self.equal(read_pcd(self.write({"a.pcd": old}))[0], [[1, 2, 3], [2, 2, 3], [1, 3, 3], [1, 2, 4]])

    def test_a_header_that_is_wrong(self):
        good, body = header("ascii", 4), "0 0 0\n1 0 0\n0 1 0\n0 0 1\n"
        self.equal(read_pcd(self.write({"a.pcd": good + body}))[0], [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
        for line, other, wrong in [("VERSION 0.7", "ply", '"ply" is not a keyword'), ("FIELDS x y z", "FIELDS x y w", 'no field "z" of one number per point'),
                                   ("FIELDS x y z\n", "", "0 fields and the types of 3"),
                                   ("SIZE 8 8 8", "SIZE 8 3 8", "header cannot be used"), ("SIZE 8 8 8", "SIZE 8 8", "header cannot be used"),
                                   ("TYPE F F F", "TYPE F D F", "header cannot be used"), ("COUNT 1 1 1", "COUNT 1 -1 1", "header cannot be used"),
                                   ("COUNT 1 1 1", "COUNT 1 2 1", 'no field "y" of one number'), ("WIDTH 4", "WIDTH -4", "announces 4 points, -4 x 1"),
                                   ("WIDTH 4", "WIDTH 5", "announces 4 points, 5 x 1"), ("VIEWPOINT 0 0", "VIEWPOINT 0 nan", "VIEWPOINT is not a finite place"),
                                   ("POINTS 4", "POINTS " + "9" * 20, "announces 9"), ("DATA ascii", "DATA text", '"text" is not a PCD format')]:
            self.expect(wrong, (good + body).replace(line, other))
        self.expect("the file ends within the header", "VERSION 0.7\nFIELDS x y z\n")
        self.expect("announces 0 points", header("ascii", 0))

    def test_a_body_that_does_not_fit_its_header(self):
        good, n = header("ascii", 4), len(POINTS)
        self.expect("11 numbers follow the header, which announces 4 points of 3", good + "0 0 0\n1 0 0\n0 1 0\n0 0\n")
        self.expect("13 numbers follow the header", good + "0 0 0\n1 0 0\n0 1 0\n0 0 1 1\n")
        self.expect(':14: "x" is not a number', good + "0 0 0\n1 0 0\n0 x 0\n0 0 1\n")
        binary, packed = files()["binary"], files()["binary_compressed"]
        self.expect(f"the file ends after {n - 1} of {n} points", binary[:-1])
        self.expect("there are 1 bytes after the last point", binary + b"x")
        self.expect("the file ends after 0 of 2147483647 points", header("binary", 2147483647))
        begin = len(header("binary_compressed", n, FIELDS))
        for cut in (begin, begin + 5, begin + 9, len(packed) - 1):
            self.expect("compressed bytes", packed[:cut])
        self.expect("there are 1 bytes after the last point", packed + b"x")
        self.expect("compressed bytes are damaged", packed[:begin + 8] + b"\xff" + packed[begin + 9:])
        self.expect("compressed bytes are damaged", packed[:begin] + struct.pack("<II", len(packed) - begin - 18, int.from_bytes(packed[begin + 4:begin + 8], "little"))
                    + packed[begin + 8:-10])  # what h5py's filter does not see
        self.expect("compressed bytes are to hold", header("binary_compressed", 89478485).encode() + struct.pack("<II", 4, 89478485 * 24) + b"abcd")


class Xyz(WithArchive):
    def expect(self, wrong, content):
        self.assertIn(f"ROOT/a.xyz{wrong}", self.error_of(cloud, self.write({"a.xyz": content})))

    def test_points_and_normals_to_the_bit(self):
        text = "".join(" ".join(map(repr, row)) + "\n" for row in POINTS.tolist())
        found = cloud(self.write({"a.xyz": text}))
        self.equal(found.points, POINTS)
        self.assertEqual((found.normals, found.viewpoint), (None, None))
        both = "".join(" ".join(map(repr, row)) + "\n" for row in np.hstack([POINTS, NORMALS.round(2)]).tolist())
        np.testing.assert_allclose(cloud(self.write({"a.xyz": both})).normals, NORMALS, atol=0.01)

    def test_comments_blank_lines_a_count_and_gaps(self):
        found, normals, _ = read_xyz(self.write({"a.xyz": "# scanner 3\r\n4\r\n\r\n1 2 3 # first\r\n\t4 5 6\r\nnan nan nan\r\n7 8 inf\r\n"}))
        self.equal(found, [[1, 2, 3], [4, 5, 6], [NAN] * 3, [7, 8, np.inf]])
        self.assertIsNone(normals)

    def test_the_line_that_is_wrong_is_named(self):
        for text, wrong in [("1 2 3\n1 2\n", ":2: the line has 2 columns, the first one 3"), ("1 2 3 4\n", ":1: a point needs 3 values"),
                            ("1 2 3 0 0 1 9\n", ":1: a point needs"), ("1 2 3\n1 2 3 0 0 1\n", ":2: the line has 6 columns, the first one 3"),
                            ("# c\n1 2 3 0 0 1\n1 2 3 255 128 0\n", ":3: the last three of six values are 255 128 0, which is not a unit normal: are these "
                             "colours"), ("1 2 3 0 0 0\n", ":1: the last three of six values are 0 0 0"),
                            ("1 2 3\nC 2 3\n", ':2: "C" in column 1 is not a number'), ("1.#INF 2 3\n", ':1: "1.#INF" in column 1 is not'),
                            ("3\n1 2 3\n1 2 3\n", ": 2 points, but the first line announces 3"), ("1\n1 2 3\n1 2 3\n", ": 2 points, but the first line announces 1"),
                            ("# nothing\n\n", ": the file has no values")]:
            self.expect(wrong, text)
