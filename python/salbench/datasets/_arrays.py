# SPDX-License-Identifier: GPL-3.0-or-later
"""Numbers in binary files: NumPy's .npy."""

from __future__ import annotations

from typing import Any

import numpy as np

from salbench._npy import read_npy
from salbench.datasets.records import Floats, InputError

EXACT = 1 << 53  # beyond it doubles have gaps
_NPY_TYPES = [order + kind for order in "<>" for kind in ("f2", "f4", "f8", "i2", "i4", "i8", "u2", "u4", "u8")] + ["|i1", "|u1"]


def doubles_of(values: np.ndarray[Any, np.dtype[Any]]) -> Floats:
    """Numbers of any type, each equal to a double. Throws InputError, without the name of the file."""
    if values.dtype.kind in "iu" and values.dtype.itemsize == 8:
        beyond = (values > EXACT) | ((values < -EXACT) if values.dtype.kind == "i" else False)
        if beyond.any():
            raise InputError(f"it holds {values[beyond][0]}: whole numbers beyond 2^53 cannot be used, scale them")
    return values.astype(np.float64)


def parse_npy(data: bytes, name: str) -> Floats:
    """Floating-point or whole numbers of at most 64 bits; n, n x 1 or 1 x n."""
    try:
        return doubles_of(read_npy(data, _NPY_TYPES, "expected float16, float32, float64, or whole numbers").ravel())
    except InputError as error:
        raise InputError(f"{name}: not a .npy file that can be read: {error}") from None
