# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables of numbers: CSV, or words between blanks. NumPy reads them; where it refuses one, a second look at the file finds line and column."""

from __future__ import annotations

import contextlib
import csv
import re
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from salbench.system.errors import InputError, in_quotes
from salbench.system.files import AnyPath, read_file

if TYPE_CHECKING:
    from salbench.datasets.records import Bools, Floats

BYTE_ORDER_MARK = b"\xef\xbb\xbf"
MAX_NAMED = 20  # columns in a message
_DECIMAL_COMMA = re.compile(rb"[-+]?[0-9]*,[0-9]+(?:[eE].*)?", re.DOTALL)
_BEGINS_AS_NUMBER = re.compile(rb"[-+.]*[0-9]")  # 0,5 and 1.#INF are no names of columns

Lines = Sequence[bytes]


def numbers(path: AnyPath, columns: int | Sequence[str] | None = None) -> Floats:
    """The numbers of a text, a row per line, as an (n, k) array.

    Commas, semicolons, tabs or blanks stand between them. Lines that begin with '#' are comments; a first line of names is a header.

    columns: how many each line has; or the names of those that are wanted, in this order; None: as many as the first line has. NaN and infinities
    are numbers: `require` refuses them.
    """
    return parse(read_lines(path), path, columns)


def require(path: AnyPath, good: Bools, what: str) -> None:
    """Throws InputError that names the line of the first row of a table that is not good."""
    wrong = np.flatnonzero(~np.asarray(good).reshape(len(good), -1).all(axis=1))
    if len(wrong):
        raise InputError(f"{path}:{rows_of(read_lines(path))[1][int(wrong[0])]}: {what}")


def read_lines(path: AnyPath) -> list[bytes]:
    """LF, CR LF and CR each end a line, wherever they stand."""
    return read_file(path).removeprefix(BYTE_ORDER_MARK).splitlines()


def rows_of(lines: Lines) -> tuple[list[bytes], list[int]]:
    """The names of the columns, if a line has them, and the lines of the rows, from 1: those that are neither blank nor comments."""
    filled = [number for number, line in enumerate(lines, 1) if (text := line.strip()) and text[:1] != b"#"]
    first = _cells(lines[filled[0] - 1]) if filled else []
    if any(cell and not _is_number(cell) and not _BEGINS_AS_NUMBER.match(cell) for cell in first):
        return first, filled[1:]
    comments = (_cells(line.strip()[1:], _separator_of(lines[filled[0] - 1])) for line in reversed(lines[:filled[0] - 1] if filled else []))
    return next((cells for cells in comments if len(cells) == len(first)), []), filled  # as NumPy writes names


def parse(lines: Lines, path: AnyPath, columns: int | Sequence[str] | None = None) -> Floats:
    """As `numbers`, of lines that are read already."""
    header, numbered = rows_of(lines)
    if not numbered:
        raise InputError(f"{path}: the file has no values")
    rows = [lines[line - 1] for line in numbered]
    separator = _separator_of(rows[0])
    width = len(header or _cells(rows[0], separator))
    if isinstance(columns, int) and width != columns:
        raise InputError(f"{path}:{numbered[0]}: the line has {width} columns, expected {columns}{_advice(rows[0])}")
    wanted = [*range(width)] if columns is None or isinstance(columns, int) else _places(columns, header, f"{path}:{numbered[0]}")
    counted = not header and not (separator and any(row.rstrip(b" ").endswith(separator) for row in rows))  # by NumPy, which counts none that is not wanted
    how: dict[str, Any] = {} if counted else {"usecols": wanted}
    if any(b'"' in row for row in rows):
        how["quotechar"] = '"'
    try:
        if not counted and any(len(_cells(row, separator)) != width for row in rows):
            raise ValueError
        table = np.loadtxt(rows, comments=None, ndmin=2, delimiter=separator.decode() or None, **how)
    except ValueError as error:
        raise _second_look(rows, numbered, path, separator, width, wanted, header) or InputError(f"{path}: {' '.join(str(error).split())}") from None
    return table


def _second_look(rows: Lines, numbered: Sequence[int], path: AnyPath, separator: bytes, width: int, wanted: Sequence[int],
                 header: Lines) -> InputError | None:
    for line, row in zip(numbered, rows):
        cells = _cells(row, separator)
        if len(cells) != width:
            return InputError(f"{path}:{line}: the line has {len(cells)} columns, the first one {width}{_advice(row)}")
        for place in wanted:
            if not _is_number(cells[place]):
                comma = ": write its decimal comma as a point" if _DECIMAL_COMMA.fullmatch(cells[place]) else ""
                name = in_quotes(header[place]) if header else place + 1
                return InputError(f"{path}:{line}: {in_quotes(cells[place])} in column {name} is not a number{comma}")
    return None


def _advice(row: bytes) -> str:
    return ": close each quote on its line" if b'"' in row else ": write decimal commas, if these are some, as points" if b"," in row else ""


def _separator_of(row: bytes) -> bytes:
    """Semicolons, tabs or commas, whichever the row has outside quotes; b"" for blanks."""
    outside = re.sub(rb'"[^"]*"', b"", row)
    return next((separator for separator in (b";", b"\t", b",") if separator in outside), b"")


def _is_number(word: bytes) -> bool:
    try:
        return b"_" not in word and float(word) is not None
    except ValueError:
        return False


def _cells(row: bytes, separator: bytes | None = None) -> list[bytes]:
    """Without their quotes; a separator may end the row. None: the row's own."""
    between = _separator_of(row) if separator is None else separator
    text = (row.strip(b" ").removesuffix(between) if between else b" ".join(row.split())).decode("latin-1")
    cells: list[str] = [text]
    with contextlib.suppress(csv.Error):
        cells = next(csv.reader([text], delimiter=between.decode() or " ", skipinitialspace=True, strict=True), [])
    return [cell.encode("latin-1").strip() for cell in cells]


def _places(columns: Sequence[str], header: Lines, where: str) -> list[int]:
    for column in (wanted := [column.encode("utf-8", "surrogateescape") for column in columns]):
        if column not in header:
            there = f"there are {', '.join(map(in_quotes, header[:MAX_NAMED]))}" if header else "the first line has numbers, not names of columns"
            raise InputError(f"{where}: there is no column {in_quotes(column)}; {there}")
    return [header.index(column) for column in wanted]
