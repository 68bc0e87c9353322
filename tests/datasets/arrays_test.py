# SPDX-License-Identifier: GPL-3.0-or-later
"""A number per line or per element: texts, and NumPy's .npy."""

import io

import numpy as np

from salbench.datasets.reading import read_values, values
from salbench.datasets.records import InputError
from support import NAN, WithArchive, npy

TYPES = [order + kind for order in "<>" for kind in ("f2", "f4", "f8", "i1", "i2", "i4", "i8", "u1", "u2", "u4", "u8")]


class Values(WithArchive):
    def test_one_value_per_point_of_any_type_and_shape(self):
        one = np.arange(3.0)
        for array in (one[:, None], one[None], np.asfortranarray(one[:, None]), np.arange(1.0), np.arange(0.0), *map(one.astype, TYPES)):
            self.equal(read_values(self.write({"a.npy": npy(array)})), np.asarray(array, float).ravel())
        file = io.BytesIO()
        np.lib.format.write_array(file, one, (2, 0))
        by_python_2 = npy(one).replace(b"(3,), }  ", b"(3L,), } ")
        for content in (file.getvalue(), by_python_2, "0\n1\n2\n", "values\n0\r\n1\r\n2", "0,\n1,\n2,\n"):
            self.equal(read_values(self.write({"a.txt": content})), one)

    def test_any_other_array_is_refused(self):
        good, begin = npy(np.arange(3.0)), "^ROOT/a.npy: not a .npy file that can be read: "
        for data, wrong in [(npy(np.array([{}, 1], object)), 'Object arrays cannot be loaded'),
                            *((npy(np.ones(3, kind)), "its type is ") for kind in ("c8", "S4", "U4", "M8[s]", "V8", np.longdouble)),
                            (npy(np.zeros((2, 3))), r"its shape is \(2, 3\), expected one value per point"), (npy(np.array([1 << 53, -1 - (1 << 53)])), "it holds whole "),
                            (npy(np.array([1 << 63], "u8")), "it holds whole numbers beyond 2.53: scale them"), (good[:11], "EOF: reading array header"),
                            (good[:-1], r"EOF: reading array data, expected 24 bytes got 23"), (good.replace(b"(3,)", b"(x,)"), "malformed node"),
                            (good.replace(b"(3,)", b"()  "), r"its shape is \(\), expected one value per point"), (good.replace(b"(3,), }   ", b"(999999,)}"), "EOF: .* got 24"),
                            (npy(np.ones(3, bool)), 'its type is "bool", expected float16, float32, float64, or whole numbers'),
                            (good + b"x", r"its shape is \(3,\), and 1 bytes are left behind its values")]:
            self.assertRegex(self.error_of(read_values, self.write({"a.npy": data})), begin + wrong)

    def test_as_many_as_there_are_elements_and_finite(self):
        for content, unseen, expected in [("1\n-1\n3\n", -1, [1, NAN, 3]), ("1\nNaN\n3\n", NAN, [1, NAN, 3]), (npy([1.0, -1, 3]), -1, [1, NAN, 3]),
                                          (npy([1.0, NAN, 3]), NAN, [1, NAN, 3]), ("1\n-1\n3\n", None, [1, -1, 3])]:
            self.equal(values(self.write({"a": content}), 3, unseen), expected)
        for content in ("1\n2\ninf\n", npy([1, 2, np.inf]), "1\n2\nnan\n"):
            self.assertIn("ROOT/a: value 2 (0-based) is ", self.error_of(values, self.write({"a": content}), 3, -1.0))
        for content in ("1\n2\n", npy([1, 2])):
            self.assertEqual(self.error_of(values, self.write({"a": content}), 3), "ROOT/a: the file has 2 values, but 3 are expected")
        with self.assertRaisesRegex(InputError, "/absent: cannot be read: No such file"):
            values(self.root / "absent", 3)
