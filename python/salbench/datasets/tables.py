# SPDX-License-Identifier: GPL-3.0-or-later
"""Readers of text tables. `numbers` uses NumPy; if that fails, a second pass finds line and column. `table`
reads words, for gaze."""

from __future__ import annotations

import contextlib
import csv
import gzip
import json
import os
import re
import zlib
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from salbench.system.errors import InputError, in_quotes
from salbench.system.files import AnyPath, read_file

if TYPE_CHECKING:
    import pandas as pd

    from salbench.datasets.arrays import Bools, Floats

BYTE_ORDER_MARK = b"\xef\xbb\xbf"
MAX_NAMED = 20  # columns listed in a message
_DECIMAL_COMMA = re.compile(rb"[-+]?[0-9]*,[0-9]+(?:[eE].*)?", re.DOTALL)
_BEGINS_AS_NUMBER = re.compile(rb"[-+.]*[0-9]")  # 0,5 and 1.#INF are no column names

_OTHER_FILES = {
    b"\x93NUMPY": "a .npy file of NumPy",
    b"PK\x03\x04": "a zip archive, as .npz and .xlsx are",
    b"\x89HDF\r\n": "an HDF5 file",
    b"MATLAB 5.0": "a .mat file of MATLAB",
    b"ply\n": "a PLY file",
    b"ply\r": "a PLY file",
}  # by their first bytes; the program has the same

Lines = Sequence[bytes]


def numbers(path: AnyPath, columns: int | Sequence[str] | None = None) -> Floats:
    """Reads the numbers of a text, one row per line, as an (n, k) array.

    They are separated by commas, semicolons, tabs or blanks. Lines that begin with '#' are comments; a first
    line of names is a header.

    columns: number per line, or the names to read, in this order; None: as many as in the first line. NaN and
    infinities count as numbers: `require` refuses them.
    """
    return parse(read_lines(path), path, columns)


def require(path: AnyPath, good: Bools, what: str) -> None:
    """Throws InputError that names the line of the first bad row of a table."""
    wrong = np.flatnonzero(~np.asarray(good).reshape(len(good), -1).all(axis=1))
    if len(wrong):
        raise InputError(f"{path}:{rows_of(read_lines(path))[1][int(wrong[0])]}: {what}")


def read_lines(path: AnyPath) -> list[bytes]:
    """Splits at LF, CR LF and CR. Throws InputError for some files that are no text."""
    data = read_file(path)
    for start, kind in _OTHER_FILES.items():
        if data.startswith(start):
            raise InputError(f"{path}: is {kind}, expected text")
    return data.removeprefix(BYTE_ORDER_MARK).splitlines()


def rows_of(lines: Lines) -> tuple[list[bytes], list[int]]:
    """Names of the columns, if a line has them, and 1-based lines of the rows, without blank lines and
    comments."""
    filled = [number for number, line in enumerate(lines, 1) if (text := line.strip()) and text[:1] != b"#"]
    first = _cells(lines[filled[0] - 1]) if filled else []
    if any(cell and not is_number(cell) and not _BEGINS_AS_NUMBER.match(cell) for cell in first):
        return first, filled[1:]
    comments = (
        _cells(line.strip()[1:], _separator_of(lines[filled[0] - 1]))
        for line in reversed(lines[: filled[0] - 1] if filled else [])
    )
    # header as NumPy writes it
    return (
        next(
            (cells for cells in comments if len(cells) == len(first) and not all(map(is_number, cells))), []
        ),
        filled,
    )


def parse(lines: Lines, path: AnyPath, columns: int | Sequence[str] | None = None) -> Floats:
    """As `numbers`, for lines that are already read."""
    header, numbered = rows_of(lines)
    if not numbered:
        raise InputError(f"{path}: the file has no values")
    rows = [lines[line - 1] for line in numbered]
    separator = _separator_of(rows[0])
    width = len(header or _cells(rows[0], separator))
    if isinstance(columns, int) and width != columns:
        named = (
            f": name it, as in numbers(path, [{in_quotes(header[-1])}])[:, 0]"
            if header and columns == 1
            else ""
        )
        raise InputError(
            f"{path}:{numbered[0]}: the line has {width} columns, expected {columns}"
            f"{named or _advice(rows[0])}"
        )
    wanted = (
        [*range(width)]
        if columns is None or isinstance(columns, int)
        else _places(columns, header, f"{path}:{numbered[0]}")
    )
    # NumPy ignores surplus columns
    counted = not header and not (separator and any(row.rstrip(b" ").endswith(separator) for row in rows))
    how: dict[str, Any] = {} if counted else {"usecols": wanted}
    if any(b'"' in row for row in rows):
        how["quotechar"] = '"'
    try:
        if not counted and any(len(_cells(row, separator)) != width for row in rows):
            raise ValueError
        table = np.loadtxt(rows, comments=None, ndmin=2, delimiter=separator.decode() or None, **how)
    except ValueError as error:
        raise _second_look(rows, numbered, path, separator, width, wanted, header) or InputError(
            f"{path}: {' '.join(str(error).split())}"
        ) from None
    return table


def _second_look(
    rows: Lines,
    numbered: Sequence[int],
    path: AnyPath,
    separator: bytes,
    width: int,
    wanted: Sequence[int],
    header: Lines,
) -> InputError | None:
    for line, row in zip(numbered, rows):
        cells = _cells(row, separator)
        if len(cells) != width:
            return InputError(
                f"{path}:{line}: the line has {len(cells)} columns, the first one {width}{_advice(row)}"
            )
        for place in wanted:
            if not is_number(cells[place]):
                comma = (
                    ": write its decimal comma as a point" if _DECIMAL_COMMA.fullmatch(cells[place]) else ""
                )
                name = in_quotes(header[place]) if header else place + 1
                return InputError(
                    f"{path}:{line}: {in_quotes(cells[place])} in column {name} is not a number{comma}"
                )
    return None


def _advice(row: bytes) -> str:
    return (
        ": close each quote on its line"
        if b'"' in row
        else ": write decimal commas, if these are some, as points"
        if b"," in row
        else ""
    )


def _separator_of(row: bytes) -> bytes:
    """Separator outside quotes: semicolon, tab or comma; b"" for blanks."""
    outside = re.sub(rb'"[^"]*"', b"", row)
    return next((separator for separator in (b";", b"\t", b",") if separator in outside), b"")


def is_number(word: bytes) -> bool:
    try:
        return b"_" not in word and float(word) is not None
    except ValueError:
        return False


def _cells(row: bytes, separator: bytes | None = None) -> list[bytes]:
    """Cells without their quotes; a separator may end the row. separator None: detected."""
    between = _separator_of(row) if separator is None else separator
    text = (row.strip(b" ").removesuffix(between) if between else b" ".join(row.split())).decode("latin-1")
    cells: list[str] = [text]
    with contextlib.suppress(csv.Error):
        cells = next(
            csv.reader([text], delimiter=between.decode() or " ", skipinitialspace=True, strict=True), []
        )
    return [cell.encode("latin-1").strip() for cell in cells]


def _places(columns: Sequence[str], header: Lines, where: str) -> list[int]:
    for column in (wanted := [column.encode("utf-8", "surrogateescape") for column in columns]):
        if column not in header:
            there = (
                f"there are {', '.join(map(in_quotes, header[:MAX_NAMED]))}"
                if header
                else "the first line has numbers, not names of columns"
            )
            raise InputError(f"{where}: there is no column {in_quotes(column)}; {there}")
    return [header.index(column) for column in wanted]


def table(path: AnyPath) -> pd.DataFrame:
    """Reads a table of words, unconverted. The index holds the lines of the rows, and its name is the path.

    The text is CSV, with commas, semicolons, tabs or blanks, or JSON lines, optionally compressed by gzip.
    Lines that are blank or begin with '#' are skipped. The first line names the columns unless it is all
    numbers: then they are 1, 2 and so on. In JSON lines, key paths name the columns ("data.gaze2d.0").
    Missing cells are "".
    """
    import pandas as pd

    data = read_file(path)
    try:
        lines = (
            (gzip.decompress(data) if data[:2] == b"\x1f\x8b" else data)
            .removeprefix(BYTE_ORDER_MARK)
            .splitlines()
        )
    except (OSError, EOFError, zlib.error) as error:
        raise InputError(f"{path}: cannot be unpacked: {error}") from None
    if any(b"\0" in line for line in lines[:20]):
        raise InputError(f"{path}: is no text of UTF-8: save it as such")
    if lines and lines[0].startswith(b"sep="):  # for Excel
        lines[0] = b"#"
    filled = [number for number, line in enumerate(lines, 1) if line.strip() and line[:1] != b"#"]
    is_json = bool(filled) and lines[filled[0] - 1].lstrip()[:1] == b"{"
    header, numbered = ([], filled) if is_json else rows_of(lines)
    if not numbered:
        raise InputError(f"{path}: has no rows")
    index = pd.Index(numbered, name=os.fspath(path))
    if is_json:
        return pd.DataFrame([_flat(lines[number - 1]) for number in numbered], index, dtype=object).fillna("")
    rows = _words(path, lines, header, numbered, _separator_of(lines[filled[0] - 1]))
    return pd.DataFrame(rows, index, [_text(name) for name in header] or range(1, len(rows[0]) + 1), object)


def _text(word: bytes) -> str:
    return word.decode("utf-8", "surrogateescape")


def _flat(line: bytes) -> dict[str, Any]:
    """Values of a JSON object by key path; empty if the line is no object."""
    found: dict[str, Any] = {}

    def add(value: Any, path: str) -> None:
        if not isinstance(value, (dict, list)):
            found[path] = value
        for key, part in (
            value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
        ):
            add(part, f"{path}.{key}" if path else str(key))

    with contextlib.suppress(ValueError, RecursionError):
        add(json.loads(line), "")
    return found


def _words(
    path: AnyPath, lines: Lines, header: Lines, numbered: Sequence[int], separator: bytes
) -> list[list[str]]:
    """Cells of rows, padded to the length of the header or of the longest row."""
    between = _text(separator) or " "
    texts = (
        _text(lines[number - 1] if separator else b" ".join(lines[number - 1].split())) for number in numbered
    )
    try:
        rows = [*csv.reader(texts, delimiter=between, skipinitialspace=True, strict=True)]
        if len(rows) != len(numbered):
            raise csv.Error
    except csv.Error:
        wrong = next((number for number in numbered if lines[number - 1].count(b'"') % 2), numbered[0])
        raise InputError(
            f"{path}:{wrong}: a quote that nothing closes on its line, or text behind one: correct it"
        ) from None
    width = len(header) or max(map(len, rows))
    for place, number in enumerate(numbered):
        if b" " in lines[number - 1]:
            rows[place] = [cell.strip() for cell in rows[place]]
        if len(row := rows[place]) != width:
            if any(row[width:]):
                advice = "write decimal commas, if these are some, as points"
                if separator != b",":  # as of R's write.table with names of rows
                    advice = "name each column; from R, write it with row.names=FALSE"
                raise InputError(f"{path}:{number}: has more words than the header: {advice}")
            rows[place] = (row + [""] * width)[:width]
    return rows
