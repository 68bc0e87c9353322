# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads untrusted .npy files with one number per point."""

import io
import warnings
from collections.abc import Sequence
from typing import Any

import numpy as np

from salbench.system.errors import InputError, quoted

MAGIC = b"\x93NUMPY"
_EXACT = 1 << 53  # beyond this, doubles have gaps


def read_npy(data: bytes, types: Sequence[str], expected: str) -> "np.ndarray[Any, np.dtype[Any]]":
    """Reads the values: n, n x 1 or 1 x n. types: as NumPy writes them; expected: in words. Throws
    InputError, without the file name."""
    file = io.BytesIO(data)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # about headers written by Python 2
            values = np.load(file, allow_pickle=False)
    except (
        Exception
    ) as error:  # a header is Python, and fails in as many ways; it may request too much memory
        raise InputError(" ".join(str(error).split())[:100] or type(error).__name__) from None
    if not isinstance(values, np.ndarray):
        raise InputError("it is an archive")
    if values.dtype.str not in types:
        raise InputError(f"its type is {quoted(str(values.dtype))}, {expected}")
    if values.ndim == 0 or sum(extent != 1 for extent in values.shape) > 1:
        raise InputError(f"its shape is {values.shape}, expected one value per point")
    if behind := len(file.read()):
        raise InputError(f"its shape is {values.shape}, and {behind} bytes are left behind its values")
    return values


def doubles_of(values: "np.ndarray[Any, np.dtype[Any]]") -> "np.ndarray[Any, np.dtype[np.float64]]":
    """Converts numbers of any type, each equal to a double. Throws InputError, without the file name."""
    if (
        values.dtype.kind in "iu"
        and values.dtype.itemsize == 8
        and ((values > _EXACT) | (values < -_EXACT)).any()
    ):
        raise InputError("it holds whole numbers beyond 2^53: scale them")
    return values.astype(np.float64)
