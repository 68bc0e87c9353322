# SPDX-License-Identifier: GPL-3.0-or-later
"""Numbers of MATLAB's files of version 5 (-v6, -v7): numeric variables, and cells that hold such.

Read here, not by SciPy: its compiled reader (1.10) trusts sizes in the file, and a few of 10 000 damaged files end the process, which may
be a user's. A file is a sequence of elements: type, bytes, content. A matrix is an element of elements: flags, extents, name, numbers; a
cell array has matrices in place of numbers. What is not asked for is skipped by its size, so nothing recurses.
"""

from __future__ import annotations

import math
import zlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from salbench.datasets._npy import doubles_of, one_per_point
from salbench.datasets._text import in_quotes, quoted
from salbench.datasets.records import Floats, InputError

MAT = b"MATLAB "
MAX_BYTES = 1 << 30  # of a variable, unpacked
HEAD_BYTES = 1 << 12  # that tell a matrix' name
MAX_NAMED = 10
MATRIX, COMPRESSED = 14, 15
CELL, NUMBERS, COMPLEX = 1, range(6, 16), 0x08  # classes, and a flag
DTYPES = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 9: "f8", 12: "i8", 13: "u8"}


class _Damaged(Exception):
    pass


@dataclass(frozen=True)
class _Matrix:
    kind: int
    flags: int
    extents: tuple[int, ...]
    name: bytes
    content: bytes  # elements: the numbers, or the cells
    order: str  # of bytes: "<" or ">"

    @property
    def size(self) -> int:
        return math.prod(self.extents)


def _elements(data: bytes, order: str) -> Iterator[tuple[int, bytes, int]]:
    """Type and content of each, and where the next begins. Short ones have both in eight bytes."""
    at = 0
    endian = "little" if order == "<" else "big"
    while at < len(data):
        if len(data) - at < 8:
            raise _Damaged
        kind, size = (int.from_bytes(data[at + k:at + k + 4], endian) for k in (0, 4))  # type: ignore[arg-type]
        if kind >> 16:
            kind, size, begin, end = kind & 0xffff, kind >> 16, at + 4, at + 8
            if size > 4:
                raise _Damaged
        else:
            begin = at + 8
            end = begin + size if kind == COMPRESSED else begin + (size + 7) // 8 * 8
        if begin + size > len(data):
            raise _Damaged
        yield kind, data[begin:begin + size], end
        at = end


def _matrix(content: bytes, order: str) -> _Matrix:
    """A matrix, of which the content may be cut short behind the name."""
    if not content:
        return _Matrix(6, 0, (0, 0), b"", b"", order)  # as an empty cell is written
    elements = _elements(content, order)
    try:
        (_, flags, _), (_, extents, _), (_, name, used) = next(elements), next(elements), next(elements)
    except StopIteration:
        raise _Damaged from None
    if len(flags) != 8 or len(extents) % 4 or not 8 <= len(extents) <= 128:
        raise _Damaged
    word = int(np.frombuffer(flags, order + "u4")[0])
    sizes = tuple(int(size) for size in np.frombuffer(extents, order + "i4"))
    if min(sizes) < 0:
        raise _Damaged
    return _Matrix(word & 0xff, word >> 8 & 0xff, sizes, name, content[used:], order)


def _unpacked(content: bytes, most: int) -> bytes:
    try:
        return zlib.decompressobj().decompress(content, most)
    except zlib.error:
        raise _Damaged from None


def _variables(data: bytes, order: str) -> Iterator[tuple[bytes, int, bytes]]:
    """Name of each variable, with its element."""
    for kind, content, _ in _elements(data[128:], order):
        head = content
        if kind == COMPRESSED:
            unpacked = _unpacked(content, HEAD_BYTES)
            inner = int.from_bytes(unpacked[:4], "little" if order == "<" else "big")
            if len(unpacked) < 8 or inner != MATRIX:
                raise _Damaged
            head = unpacked[8:]
        elif kind != MATRIX:
            continue
        yield _name(head, order), kind, content


def _name(head: bytes, order: str) -> bytes:
    """Of a matrix, whose end may be missing."""
    names = _elements(head, order)
    try:
        next(names), next(names)
        return next(names)[1]
    except StopIteration:
        raise _Damaged from None


def _find(data: bytes, order: str, variable: bytes) -> tuple[_Matrix | None, list[bytes]]:
    """The variable of this name, or the names that there are."""
    names = []
    for name, kind, content in _variables(data, order):
        if name == variable:
            if kind == COMPRESSED:
                content = _unpacked(content, MAX_BYTES + 1)[8:]
                if len(content) > MAX_BYTES - 8:
                    raise InputError(f"it has more than {MAX_BYTES} bytes")
            return _matrix(content, order), []
        names.append(name)
    return None, names


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
    order = "<" if version.endswith(b"IM") else ">"
    try:
        found, names = _find(data, order, variable.encode())
        if found is None:
            raise InputError(f"{name}: no variable {quoted(variable)}; the file has {', '.join(map(in_quotes, names[:MAX_NAMED])) or 'none'}")
        try:
            return _numbers(_cell(found, cell) if cell else found, row_or_column)
        except InputError as error:
            raise InputError(f"{name}: variable {quoted(variable)}: {error}") from None
    except _Damaged:
        raise InputError(where + "it is damaged, copy it again") from None


def _cell(matrix: _Matrix, cell: Sequence[str]) -> _Matrix:
    if matrix.kind != CELL:
        raise InputError("it is not a cell array: leave out `cell:`")
    row, column = map(int, cell)
    rows, columns = matrix.extents[:2]
    if len(matrix.extents) != 2 or not (1 <= row <= rows and 1 <= column <= columns):
        raise InputError(f"it has {rows} x {columns} cells, expected cell {row}, {column}")
    wanted = row - 1 + (column - 1) * rows
    for place, (kind, content, _) in enumerate(_elements(matrix.content, matrix.order)):
        if place == wanted and kind == MATRIX:
            return _matrix(content, matrix.order)
    raise _Damaged


def _numbers(matrix: _Matrix, row_or_column: bool) -> Floats:
    if matrix.kind == CELL:
        raise InputError("it is a cell array: name one with `cell: [row, column]`")
    if matrix.kind not in NUMBERS:
        raise InputError("it holds no numbers")
    if row_or_column and not one_per_point(matrix.extents):
        raise InputError(f"its shape is ({', '.join(map(str, matrix.extents))}), expected a row or a column")
    if matrix.size == 0:
        return np.empty(0)
    if matrix.flags & COMPLEX:
        raise InputError("it holds no real numbers")
    kind, content, _ = next(_elements(matrix.content, matrix.order), (0, b"", 0))
    dtype = np.dtype(matrix.order + DTYPES[kind]) if kind in DTYPES else None
    if dtype is None or len(content) != matrix.size * dtype.itemsize:
        raise _Damaged
    return doubles_of(np.frombuffer(content, dtype))
