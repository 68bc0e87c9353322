# SPDX-License-Identifier: GPL-3.0-or-later
"""The header of NumPy's .npy, read by NumPy itself, which takes at most 10 000 bytes: no objects, no pickles."""

import io
import tokenize
import warnings
from typing import Any

import numpy as np

from salbench._errors import InputError


def header_of(data: bytes) -> "tuple[tuple[int, ...], np.dtype[Any], int]":
    """Shape, type, and where the values begin. Throws InputError, without the name of the file."""
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
