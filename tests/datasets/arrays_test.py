# SPDX-License-Identifier: GPL-3.0-or-later
"""Numbers in binary files: .npy and MATLAB's files of version 5."""

import io
import struct
import unittest

import numpy as np
import scipy.io
import scipy.sparse

from salbench.datasets._arrays import parse_mat
from salbench.datasets._arrays import parse_npy
from salbench.datasets.records import InputError
from support import cells, mat, npy

BEYOND = (1 << 53) + 1


class Npy(unittest.TestCase):
    def test_one_value_per_point(self):
        for values in (np.arange(3.0), np.arange(3.0)[:, None], np.arange(3.0)[None], np.asfortranarray(np.arange(3.0)[:, None]),
                       np.arange(3, dtype="f4"), np.arange(1.0), np.arange(0.0)):
            self.assertEqual(parse_npy(npy(values), "a.npy").tolist(), values.ravel().tolist())
        file = io.BytesIO()
        np.lib.format.write_array(file, np.arange(3.0), (2, 0))
        self.assertEqual(parse_npy(file.getvalue(), "a.npy").tolist(), [0, 1, 2])

    def test_anything_else_is_refused(self):
        good, refused = npy(np.arange(3.0)), "^a.npy: not a .npy file that can be read: "
        for data, wrong in [(npy(np.array([{}, 1], object)), 'its type is "object", expected float16, float32, float64, or whole numbers'),
                            (npy(np.array([True])), 'its type is "bool"'), (npy(np.zeros((2, 3))), r"its shape is \(2, 3\), expected one value per point"),
                            (good[:-1], r"its shape is \(3,\), and it holds 23 bytes of values"), (good[:11], "its header is damaged"),
                            (good[:50], "its header is damaged"), (good.replace(b"(3,)", b"(x,)"), "its header is damaged"),
                            (good.replace(b"(3,)", b"()  "), r"its shape is \(\), expected one value per point"),
                            (good.replace(b"'shape", b'"""shape'), "its header is damaged"), (good.replace(b"descr", b"desc("), "its header is damaged"),
                            (good.replace(b"(3,), }   ", b"(999999,)}"), ".* 24 bytes")]:
            with self.assertRaisesRegex(InputError, refused + wrong):
                parse_npy(data, "a.npy")


class Mat(unittest.TestCase):
    def setUp(self):
        self.data = mat(values=[0.5, -2, 3e7], bytes=np.uint8([1, 255]), whole=np.int32([-7]), single=np.float32([0.25]), none=np.zeros((0, 0)),
                        cells=cells(2, 2, r1c1=[11], r2c1=[21, 22], r1c2=[12]), text="words", flags=np.array([True, False]))

    def numbers(self, variable, cell=(), data=None, **how):
        return parse_mat(self.data if data is None else data, "a.mat", variable, cell, **how).tolist()

    def test_numbers_of_any_type(self):
        for variable, expected in [("values", [0.5, -2, 3e7]), ("bytes", [1, 255]), ("whole", [-7]), ("single", [0.25]), ("none", []),
                                   ("flags", [1, 0])]:
            self.assertEqual(self.numbers(variable), expected)
        self.assertEqual(self.numbers("square", data=mat(square=[[1, 3], [2, 4]])), [1, 2, 3, 4])  # column by column

    def test_packed_or_not_and_of_either_order_of_bytes(self):
        file = io.BytesIO()
        scipy.io.savemat(file, {"a": [1.5, 2], "longer_name": cells(1, 2, r1c2=[3])})
        self.assertEqual((self.numbers("a", data=file.getvalue()), self.numbers("longer_name", "12", file.getvalue())), ([1.5, 2], [3]))

        def element(kind, content):
            return struct.pack(">II", kind, len(content)) + content + bytes(-len(content) % 8)

        matrix = element(6, struct.pack(">II", 6, 0)) + element(5, struct.pack(">ii", 1, 2)) + element(1, b"a") + element(9, struct.pack(">dd", 1.5, 2))
        self.assertEqual(self.numbers("a", data=b"MATLAB 5.0 MAT-file".ljust(124) + b"\1\0MI" + element(14, matrix)), [1.5, 2])

    def test_a_cell_by_row_and_column(self):
        for cell, expected in [("11", [11]), ("21", [21, 22]), ("12", [12]), ("22", [])]:
            self.assertEqual(self.numbers("cells", tuple(cell)), expected)

    def test_what_was_expected(self):
        odd = mat(beyond=np.int64([-BEYOND]), unsigned=np.uint64([1 << 63]), largest=np.int64([BEYOND - 1, 1 - BEYOND]), complex=[1j],
                  sparse=scipy.sparse.eye(2), struct={"a": 1}, square=np.eye(2))
        self.assertEqual(self.numbers("largest", data=odd), [2.0 ** 53, -2.0 ** 53])
        for data, variable, cell, wrong in [
                (None, "value", (), "no variable \"value\"; the file has \"values\", \"bytes\""),
                (None, "", (), "a MAT file, and the description names no `variable:`"),
                (None, "cells", (), "variable \"cells\": it is a cell array: name one with `cell: [row, column]`"),
                (None, "cells", "38", "variable \"cells\": it has 2 x 2 cells, expected cell 3, 8"),
                (None, "values", "11", "variable \"values\": it is not a cell array: leave out `cell:`"), (None, "text", (), "it holds no numbers"),
                (odd, "beyond", (), f"it holds -{BEYOND}: whole numbers beyond 2^53 cannot be used, scale them"),
                (odd, "unsigned", (), "it holds 9223372036854775808: whole"), (odd, "complex", (), "it holds no real numbers"),
                (odd, "sparse", (), "it holds no numbers"), (odd, "struct", (), "it holds no numbers"),
                (self.data[:124] + b"\0\2" + self.data[126:], "values", (), "version 7.3 is HDF5; save it with -v7"),
                (self.data[:124] + b"\7\7" + self.data[126:], "values", (), "its version is unknown"),
                (self.data[:99], "values", (), "it is cut short")]:
            with self.assertRaises(InputError) as caught:
                self.numbers(variable, cell, data)
            self.assertTrue(str(caught.exception).startswith("a.mat: "))
            self.assertIn(wrong, str(caught.exception))
        with self.assertRaisesRegex(InputError, r"its shape is \(2, 2\), expected a row or a column"):
            self.numbers("square", data=odd, row_or_column=True)
