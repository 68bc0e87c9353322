# SPDX-License-Identifier: GPL-3.0-or-later
"""Numbers in binary files: .npy."""

import io
import unittest

import numpy as np

from salbench.datasets._arrays import parse_npy
from salbench.datasets.records import InputError
from support import npy


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
