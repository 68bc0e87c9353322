# SPDX-License-Identifier: GPL-3.0-or-later
"""Numbers in binary files: NumPy's .npy, and MATLAB's files of version 5 (-v6, -v7).

SciPy's compiled reader of the latter trusts sizes in the file, and a few of 10 000 damaged files end the process: items that have one are read
by worker.py.
"""

from __future__ import annotations

import io
import math
import warnings
from collections.abc import Sequence
from typing import Any

import numpy as np

from salbench._errors import quoted
from salbench._npy import is_one_per_point, read_npy
from salbench.datasets.records import Floats, InputError

MAT = b"MATLAB "
MAX_BYTES = 1 << 30  # of a variable, unpacked
MAX_NAMED = 10
EXACT = 1 << 53  # beyond it doubles have gaps
_NPY_TYPES = [order + kind for order in "<>" for kind in ("f2", "f4", "f8", "i2", "i4", "i8", "u2", "u4", "u8")] + ["|i1", "|u1"]
_NUMBERS = ("double", "single", "logical", *(f"{sign}int{bits}" for sign in ("", "u") for bits in (8, 16, 32, 64)))  # as SciPy names classes


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


def parse_mat(data: bytes, name: str, variable: str, cell: Sequence[str] = (), row_or_column: bool = False) -> Floats:
    """The numbers of a real numeric variable, column by column; or of one cell of a cell array, `cell` being its row and column from 1."""
    where = f"{name}: not a MAT file that can be read: "
    if len(data) < 128:
        raise InputError(where + "it is cut short")
    version = data[124:128]
    if version in (b"\0\2IM", b"\2\0MI"):
        raise InputError(where + "version 7.3 is HDF5; save it with -v7")
    if version not in (b"\0\1IM", b"\1\0MI"):
        raise InputError(where + "its version is unknown; save it with -v7")
    if not variable:
        raise InputError(f"{name}: a MAT file, and the description names no `variable:` in it")
    import scipy.io

    def read(kind: Any, **how: Any) -> Any:
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                return kind(io.BytesIO(data), **how)
        except MemoryError:
            raise
        except Exception:  # whatever the library makes of damaged bytes
            raise InputError(where + "it is damaged, copy it again") from None

    there = {found: (shape, kind) for found, shape, kind in read(scipy.io.whosmat)}
    if variable not in there:
        raise InputError(f"{name}: no variable {quoted(variable)}; the file has {', '.join(map(quoted, [*there][:MAX_NAMED])) or 'none'}")
    shape, kind = there[variable]
    try:
        if kind not in (*_NUMBERS, "cell"):
            raise InputError("it holds no numbers")
        if math.prod(shape) > MAX_BYTES // 8:
            raise InputError(f"it has more than {MAX_BYTES} bytes")
        found = read(scipy.io.loadmat, variable_names=[variable], chars_as_strings=False).get(variable)
        return _numbers(_cell(found, cell) if cell else found, row_or_column)
    except InputError as error:
        raise error if str(error).startswith(where) else InputError(f"{name}: variable {quoted(variable)}: {error}") from None


def _cell(found: Any, cell: Sequence[str]) -> Any:
    if found.dtype != object:
        raise InputError("it is not a cell array: leave out `cell:`")
    row, column = map(int, cell)
    rows, columns = found.shape[:2]
    if found.ndim != 2 or not (1 <= row <= rows and 1 <= column <= columns):
        raise InputError(f"it has {rows} x {columns} cells, expected cell {row}, {column}")
    return found[row - 1, column - 1]


def _numbers(found: Any, row_or_column: bool) -> Floats:
    if not isinstance(found, np.ndarray) or found.dtype.kind not in "fiucbO":
        raise InputError("it holds no numbers")
    if found.dtype == object:
        raise InputError("it is a cell array: name one with `cell: [row, column]`")
    if row_or_column and not is_one_per_point(found.shape):
        raise InputError(f"its shape is ({', '.join(map(str, found.shape))}), expected a row or a column")
    if found.size and found.dtype.kind == "c":
        raise InputError("it holds no real numbers")
    return doubles_of(found.ravel(order="F"))
