# SPDX-License-Identifier: GPL-3.0-or-later
"""Numbers of NumPy's .npy, and what of numbers is said of other files as well."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from salbench._errors import quoted
from salbench._npy import header_of
from salbench.datasets.records import Floats, InputError

NPY = b"\x93NUMPY"
EXACT = 1 << 53  # beyond it doubles have gaps


def one_per_point(shape: Sequence[int]) -> bool:
    return sum(extent != 1 for extent in shape) <= 1


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
        shape, dtype, begin = header_of(data)
        if dtype.kind not in "fiu" or dtype.itemsize > 8:
            raise InputError(f"its type is {quoted(str(dtype))}, expected float16, float32, float64, or whole numbers")
        if not shape or not one_per_point(shape):
            raise InputError(f"its shape is {str(shape)[:100]}, expected one value per point")
        if len(data) - begin != math.prod(shape) * dtype.itemsize:
            raise InputError(f"its shape is {str(shape)[:100]}, and it holds {len(data) - begin} bytes of values")
        return doubles_of(np.frombuffer(data, dtype, offset=begin))
    except InputError as error:
        raise InputError(f"{name}: not a .npy file that can be read: {error}") from None
