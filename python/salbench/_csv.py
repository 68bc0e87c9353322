# SPDX-License-Identifier: GPL-3.0-or-later
"""CSV files (RFC 4180) of anybody, read strictly and without NumPy: what is wrong is told with the line."""

import csv
import os
from collections.abc import Iterable, Iterator
from itertools import chain
from typing import Any

from salbench._errors import InputError, quoted

Row = tuple[int, list[str]]  # the line on which it begins, and its fields
REMARKS = "remarks"  # the last column of a table that has some: all of them, in each row
_BETWEEN = " | "

# What the module csv says, in our words.
WRONG = {"unexpected end of data": "a quote opens a field that nothing closes",
          "',' expected after '\"'": "there is text after the quote that closes a field"}


def read_rows(file: Iterable[str], name: str) -> tuple[list[str], list[str], Iterator[Row]]:
    """Of the lines of a file, with their ends: the remarks, lines that begin with '#' above the first other one, whatever commas and quotes
    are in them; the names of the columns; the rows.

    Throws InputError for a line with another number of fields, a quote that does not close, a column named twice, and no columns.
    """
    remarks, above, first = _remarks(file)
    rows = _rows(csv.reader(chain([first], file), strict=True), name, above)
    header = next(rows, None)
    if header is None:
        raise InputError(f"{name}: the file is empty, where a line of column names is expected")
    line, columns = header
    for column in columns:
        if columns.count(column) > 1:
            raise InputError(f"{name}:{line}: two columns are named {quoted(column)}")
    return remarks, columns, _of_width(rows, len(columns), name)


def joined(remarks: Iterable[str]) -> str:
    """Of a cell: bars within a remark are doubled."""
    return _BETWEEN.join(remark.replace("|", "||") for remark in remarks)


def parted(cells: Iterable[str]) -> Iterator[str]:
    """The remarks of cells that `joined` made, each once, in the order of their first appearance."""
    remarks = (remark.replace("||", "|") for cell in dict.fromkeys(cells) for remark in cell.split(_BETWEEN))
    return iter(dict.fromkeys(filter(None, remarks)))


def bare(path: str | os.PathLike[str]) -> list[list[str]]:
    """A table of the program without its remarks: the names of the columns, and the rows."""
    with open(path, encoding="utf-8", errors="surrogateescape", newline="") as file:
        _, columns, rows = read_rows(file, os.fspath(path))
        kept = [place for place, column in enumerate(columns) if column != REMARKS]
        return [[fields[place] for place in kept] for fields in (columns, *(fields for _, fields in rows))]


def missing(name: str, column: str, columns: Iterable[str]) -> InputError:
    return InputError(f"{name}: there is no column {quoted(column)}; there are {', '.join(map(quoted, columns))}")


def _remarks(file: Iterable[str]) -> tuple[list[str], int, str]:
    """The lines that begin with '#', without it; how many lines these and blank ones take, and the line below them."""
    remarks = []
    for before, line in enumerate(file):
        if line.startswith("#"):
            remarks.append(line.rstrip("\r\n").lstrip("# \t"))
        elif line.rstrip("\r\n"):
            return remarks, before, line
    return remarks, 0, ""


def _rows(reader: Any, name: str, above: int) -> Iterator[Row]:
    """Lines without a field are left out."""
    while True:
        line = above + reader.line_num + 1
        try:
            fields = next(reader, None)
        except csv.Error as error:
            raise InputError(f"{name}:{line}: {WRONG.get(str(error), str(error))}") from None
        if fields is None:
            return
        if fields:
            yield line, fields


def _of_width(rows: Iterator[Row], width: int, name: str) -> Iterator[Row]:
    for line, fields in rows:
        if len(fields) != width:
            raise InputError(f"{name}:{line}: the line has {len(fields)} fields, the header {width}")
        yield line, fields
