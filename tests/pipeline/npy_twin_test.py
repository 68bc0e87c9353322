# SPDX-License-Identifier: GPL-3.0-or-later
"""Files .npy beside NumPy: what it reads, a command's map and a description's values are read as, or are refused with a reason."""

import io
import os
import struct
import subprocess
import tempfile
import unittest
import warnings
from pathlib import Path

import numpy as np
from salbench.datasets._arrays import parse_npy
from salbench.datasets.records import InputError

PROGRAM = os.environ["SALBENCH_PROGRAM"]
N = 8
CUBE = ("OFF\n8 12 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n1 0 1\n1 1 1\n0 1 1\n3 0 2 1\n3 0 3 2\n3 4 5 6\n3 4 6 7\n3 0 1 5\n3 0 5 4\n3 1 2 6\n3 1 6 5\n"
        "3 2 3 7\n3 2 7 6\n3 3 0 4\n3 3 4 7\n")
VALUES = np.array([1, 0, 3, 100, 7, 2, 11, 5])
READ, TYPE, SHAPE, BIG = None, "its type is ", "its shape is ", "it holds "


def saved(values, version=None):
    file = io.BytesIO()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of later versions
        np.lib.format.write_array(file, values, version)
    return file.getvalue()


def headed(header, values=VALUES.astype("<f8"), version=1):
    return b"\x93NUMPY" + struct.pack("<BB" + ("H" if version == 1 else "I"), version, 0, len(header)) + header.encode("latin-1") + values.tobytes()


def typed(descr, dtype):
    return headed(f"{{'descr': {descr}, 'fortran_order': False, 'shape': ({N},), }}\n", VALUES.astype(dtype))


def shaped(shape, **how):
    return headed(f"{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}, }}\n", **how)


FIELDS = np.dtype([("a", "<f4"), ("b", "<i4")])
BEYOND = VALUES.astype("<i8") + (1 << 53)
FILES = [  # bytes, and the beginning of why they are refused
    *((saved(VALUES.astype(order + kind)), READ) for order in "<>" for kind in ("f2", "f4", "f8", "i1", "i2", "i4", "i8", "u1", "u2", "u4", "u8")),
    *((saved(VALUES.astype("f4"), version), READ) for version in ((1, 0), (2, 0), (3, 0))),
    *((saved(np.asarray(VALUES[shape], "f8", order=order)), READ) for shape in ((None,), (slice(None), None)) for order in "CF"),
    (saved(-VALUES.astype("i2")), READ), (saved(VALUES * 1e-7), READ), (saved((VALUES * 1e-7).astype("f2")), READ), (saved(VALUES.astype("f4") / 3), READ),
    # as Python 2 wrote them, or by hand
    (shaped(f"({N}L,)"), READ), (shaped(f"({N}L, 1L)"), READ), (shaped(f"({N},)", version=2), READ), (shaped(f"(1, 1, {N}, 1)"), READ),
    (headed(f"{{'descr':'<f8','fortran_order':False,'shape':({N},)}}"), READ), (headed(f'{{"descr": "<f8", "fortran_order": False, "shape": ({N},)}}'), READ),
    (headed(f"{{u'descr': u'<f8', u'fortran_order': True, u'shape': ({N}L,), }}   \n"), READ),
    (headed(f"{{'shape': ({N},), 'fortran_order': False, 'descr': '<f8'}}"), READ),
    (headed(f"{{ 'shape' :({N} , ),\t'fortran_order' :False ,'descr' : '<f8' }}"), READ),
    *((typed(f"'{name}'", kind), READ) for name, kind in (("f8", "f8"), ("=f8", "f8"), ("|f8", "f8"), ("f4", "f4"), ("=f2", "f2"), ("|u1", "u1"),
                                                          ("u1", "u1"), (">u1", "u1"), ("i4", "i4"), ("=i8", "i8"), ("float64", "f8"), ("float32", "f4"),
                                                          ("float16", "f2"), ("int64", "i8"), ("int32", "i4"), ("uint16", "u2"), ("int8", "i1"))),
    # no numbers, or not as many as points
    *((saved(VALUES.astype(kind)), TYPE) for kind in ("bool", "c8", "c16", "S4", "U4", "M8[s]", "m8[s]", "V8", np.longdouble)),
    (saved(np.zeros(N, FIELDS)), TYPE), (saved(np.zeros(N, np.dtype([("é", "f8")])), (3, 0)), TYPE), (typed("('<f8', (1,))", "f8"), TYPE),
    (saved(BEYOND), BIG), (saved(-BEYOND), BIG), (saved(BEYOND.astype("u8") << 8), BIG), (saved(np.zeros((N, 2))), SHAPE), (saved(np.float64(1)), SHAPE),
    (saved(np.zeros((0, 3))), SHAPE), (shaped("(True, 8)"), ""), (shaped("(8)"), ""), (shaped("[8]"), ""), (shaped("(-8,)"), ""), (shaped("(8.0,)"), ""),
    (shaped("(8,)") + b"x", SHAPE), (shaped("(8,)")[:-1], SHAPE), (shaped("(9,)"), SHAPE), (shaped("(8,), 'more': 1"), ""), (shaped("(8,"), ""),
    (headed("{}"), ""), (headed(""), ""), (shaped("(8,)").replace(b"\x01\x00", b"\x04\x00", 1), "its version is 4.0"),
    (b"\x93NUMPY\x01\x00", ""), (saved(VALUES)[:90], ""),
]
REFUSED = "not a .npy file that can be read: "


def by_numpy(data):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of what Python 2 wrote
        return np.load(io.BytesIO(data), allow_pickle=False)


class Files(unittest.TestCase):
    def agrees(self, number, found):
        """`found`: the values, or the message."""
        data, why = FILES[number]
        if why is not READ:
            self.assertIsInstance(found, str)
            self.assertIn(REFUSED + why, found)
            self.assertNotIn("\n", found)
        else:
            np.testing.assert_array_equal(found, by_numpy(data).astype(np.float64).ravel(), err_msg=repr(data[:99]))

    def test_by_the_package(self):
        for number, (data, _) in enumerate(FILES):
            with self.subTest(number=number, header=data[:120]):
                try:
                    found = parse_npy(data, "a.npy")
                except InputError as error:
                    found = str(error)
                self.agrees(number, found)

    def test_as_maps_of_a_command(self):
        with tempfile.TemporaryDirectory() as folder:
            root = Path(folder)
            for name in ("data", "maps"):
                (root / name).mkdir()
            for number, (data, _) in enumerate(FILES):
                (root / f"data/{number}.off").write_text(CUBE)
                (root / f"maps/{number}.npy").write_bytes(data)
            config = root / "config.yaml"
            config.write_text(f"dataset: {{layout: folder, scans: false}}\nmodels: {{MINE: {{command: 'test {{mesh}} && cp {root}/maps/{{item}}.npy {{out}}'}}}}\n")
            done = subprocess.run([PROGRAM, "export", config, "--data", root / "data", "--cache", root / "cache", "--to", root / "out", "--format", "maps",
                                   "--quiet"], capture_output=True, text=True)
            self.assertEqual(done.returncode, 1, done.stderr)
            for number, (data, _) in enumerate(FILES):
                with self.subTest(number=number, header=data[:120]):
                    map_ = root / f"out/MINE/{number}.val"
                    said = next((line for line in done.stderr.splitlines() if f"mesh {number} " in line or f" {number}: " in line), "")
                    self.agrees(number, np.loadtxt(map_) if map_.exists() else said)
