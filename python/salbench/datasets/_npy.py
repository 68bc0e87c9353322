# SPDX-License-Identifier: GPL-3.0-or-later
"""Numbers of NumPy's .npy: no objects, no pickles, and a header that is matched and not evaluated."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import NoReturn

import numpy as np

from salbench.datasets._text import in_quotes
from salbench.datasets.records import Floats, InputError

NPY = b"\x93NUMPY"

_SHAPE = re.compile(rb"'shape': \(([^)]*)\)?")


def one_per_point(shape: Sequence[int]) -> bool:
    return sum(extent != 1 for extent in shape) <= 1


def parse_npy(data: bytes, name: str) -> Floats:
    """float32 or float64, little-endian; n, n x 1 or 1 x n."""

    def refuse(what: str) -> NoReturn:
        raise InputError(f"{name}: not a .npy file that can be read: {what}")

    if len(data) < 12:
        refuse("it is cut short")
    begin = 12 if data[6] >= 2 else 10
    length = int.from_bytes(data[8:begin], "little")
    if len(data) - begin < length:
        refuse("it is cut short")
    header, body = data[begin:begin + length], data[begin + length:]
    kind = header.partition(b"'descr':")[2].lstrip(b" ")
    if not kind.startswith((b"'<f8'", b"'<f4'")):
        told = in_quotes(kind.partition(b", 'fortran_order")[0])
        refuse(f"its type is {told}, neither float32 nor float64, little-endian")
    found = _SHAPE.search(header)
    text = found[1].decode("latin-1") if found else ""
    if not re.fullmatch(r"[0-9]{1,18}(, *[0-9]{1,18})*,? *", text):
        refuse("its header names no shape")
    shape = [int(extent) for extent in re.findall("[0-9]+", text)]
    if not one_per_point(shape):
        refuse(f"its shape is ({text}), expected one value per point")
    dtype = np.dtype(kind[1:4].decode())
    if len(body) != max(shape) * dtype.itemsize:
        refuse(f"its shape is ({text}), and it holds {len(body)} bytes of values")
    return np.frombuffer(body, dtype).astype(np.float64)
