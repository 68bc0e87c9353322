# SPDX-License-Identifier: GPL-3.0-or-later
"""Numbers in binary files: NumPy's .npy and MATLAB's files of version 5. Neither is trusted: no objects, no pickles, one line per error."""

from __future__ import annotations

import io
import re
from collections.abc import Sequence
from typing import Any, NoReturn

import numpy as np

from salbench.datasets._text import in_quotes, quoted
from salbench.datasets.records import Floats, InputError

NPY, MAT = b"\x93NUMPY", b"MATLAB "
EXACT = 1 << 53  # beyond it doubles have gaps
MAX_NAMED = 10

_SHAPE = re.compile(rb"'shape': \(([^)]*)\)?")


def _one_per_point(shape: Sequence[int]) -> bool:
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
    if not _one_per_point(shape):
        refuse(f"its shape is ({text}), expected one value per point")
    dtype = np.dtype(kind[1:4].decode())
    if len(body) != max(shape) * dtype.itemsize:
        refuse(f"its shape is ({text}), and it holds {len(body)} bytes of values")
    return np.frombuffer(body, dtype).astype(np.float64)


def _load(data: bytes, variable: str) -> Any:
    from scipy.io import loadmat

    return loadmat(io.BytesIO(data), variable_names=[variable], chars_as_strings=False).get(variable)


def _names(data: bytes) -> str:
    from scipy.io import whosmat

    names = [quoted(str(name)) for name, _, _ in whosmat(io.BytesIO(data))][:MAX_NAMED]
    return ", ".join(names) or "none"


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
    try:
        found = _load(data, variable)
        names = _names(data) if found is None else ""
    except ImportError as error:
        raise InputError(f"{name}: a MAT file needs SciPy: {error}") from None
    except MemoryError:
        raise InputError(f"{name}: no memory for variable {quoted(variable)}") from None
    except Exception as error:  # SciPy trusts what it reads: damaged bytes raise whatever the place is that meets them
        raise InputError(f"{where}it is damaged ({type(error).__name__})") from None
    if found is None:
        raise InputError(f"{name}: no variable {quoted(variable)}; the file has {names}")
    try:
        chosen = _cell(found, cell) if cell else found
        return _numbers(chosen, row_or_column)
    except InputError as error:
        raise InputError(f"{name}: variable {quoted(variable)}: {error}") from None


def _cell(array: Any, cell: Sequence[str]) -> Any:
    if not isinstance(array, np.ndarray) or array.dtype != object:
        raise InputError("it is not a cell array: leave out `cell:`")
    row, column = map(int, cell)
    if array.ndim != 2 or not (1 <= row <= array.shape[0] and 1 <= column <= array.shape[1]):
        columns = array.shape[1] if array.ndim > 1 else 1
        raise InputError(f"it has {array.shape[0]} x {columns} cells, expected cell {row}, {column}")
    return array[row - 1, column - 1]


def _numbers(array: Any, row_or_column: bool) -> Floats:
    if not isinstance(array, np.ndarray):
        raise InputError("it holds no numbers")  # sparse
    if array.dtype == object:
        raise InputError("it is a cell array: name one with `cell: [row, column]`")
    if row_or_column and not _one_per_point(array.shape):
        raise InputError(f"its shape is ({', '.join(map(str, array.shape))}), expected a row or a column")
    if array.size == 0:
        return np.empty(0)
    if array.dtype.kind == "c":
        raise InputError("it holds no real numbers")
    if array.dtype.kind not in "fiub" or array.dtype.hasobject:
        raise InputError("it holds no numbers")
    if array.dtype.kind in "iu" and array.dtype.itemsize == 8:
        extreme = max(int(array.max()), int(array.min()), key=abs)
        if abs(extreme) > EXACT:
            raise InputError(f"it holds {extreme}: whole numbers beyond 2^53 cannot be used, scale them")
    return np.asarray(array.ravel(order="F"), np.float64)
