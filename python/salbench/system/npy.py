# SPDX-License-Identifier: GPL-3.0-or-later
"""NumPy's .npy with one number per point, read by NumPy itself: no objects, no pickles. Its header is looked at before memory is taken."""

import io
import math
import tokenize
import warnings
from collections.abc import Sequence
from typing import Any

import numpy as np

from salbench.system.errors import InputError, quoted

MAGIC = b"\x93NUMPY"
_MOST_DIMENSIONS = 32  # of an array


def is_one_per_point(shape: Sequence[int]) -> bool:
    return sum(extent != 1 for extent in shape) <= 1


def read_npy(data: bytes, types: Sequence[str], expected: str) -> "np.ndarray[Any, np.dtype[Any]]":
    """The values: n, n x 1 or 1 x n. types: as NumPy writes them, and in words. Throws InputError, without the name of the file."""
    shape, dtype, begin = _header_of(data)
    if dtype.str not in types:
        raise InputError(f"its type is {quoted(str(dtype))}, {expected}")
    if not 1 <= len(shape) <= _MOST_DIMENSIONS or not is_one_per_point(shape):
        raise InputError(f"its shape is {str(shape)[:100]}, expected one value per point")
    if len(data) - begin != math.prod(shape) * dtype.itemsize:
        raise InputError(f"its shape is {str(shape)[:100]}, and it holds {len(data) - begin} bytes of values")
    return np.frombuffer(data, dtype, offset=begin)


def _header_of(data: bytes) -> "tuple[tuple[int, ...], np.dtype[Any], int]":
    """Shape, type, and where the values begin. NumPy takes a header of at most 10 000 bytes."""
    file = io.BytesIO(data)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of headers that Python 2 wrote
            version = np.lib.format.read_magic(file)  # type: ignore[no-untyped-call]
            if version not in ((1, 0), (2, 0), (3, 0)):
                raise InputError(f"its version is {version[0]}.{version[1]}, expected 1.0 to 3.0")
            read = np.lib.format.read_array_header_1_0 if version == (1, 0) else np.lib.format.read_array_header_2_0
            shape, _, dtype = read(file)  # type: ignore[no-untyped-call]
    except InputError:
        raise
    except (ValueError, TypeError, SyntaxError, tokenize.TokenError, RecursionError, MemoryError) as error:
        told = " ".join(str(error.args[0] if error.args else "").split())[:100]
        raise InputError(f"its header is damaged{f' ({told})' if told else ''}") from None
    if any(type(extent) is not int or extent < 0 for extent in shape):
        raise InputError(f"its shape is {str(shape)[:100]}, expected one value per point")
    return shape, dtype, file.tell()
