# SPDX-License-Identifier: GPL-3.0-or-later
"""CSV files (RFC 4180) of anybody's, read strictly: a message names the file, the line and what was expected there."""

import os
import sys
from collections.abc import Container, Sequence
from itertools import islice
from typing import Any, NoReturn

import pandas

from salbench._csv import Row, missing, read_rows
from salbench._errors import InputError as InputError

_OF_NUMBERS = b"+-.0123456789eEinfatyINFATY"  # what "1e-3", "nan" and "infinity" are spelled with
_AT_ONCE = 4096  # rows that are texts


def read_csv(path: str | os.PathLike[str], numeric: Container[str] = ()) -> pandas.DataFrame:
    """Columns of texts, or of numbers with NaN for empty cells; the index has the line on which each row begins. `attrs` has the `name` of the
    file, and as `remarks` the lines that begin with '#' above the names of the columns. numeric: columns of numbers.

    Throws InputError as read_rows does, and for a cell of a column of numbers that is none; OSError for a file that cannot be read.
    """
    name = os.fspath(path)
    with open(path, encoding="utf-8-sig", errors="surrogateescape", newline="") as file:
        remarks, columns, rows = read_rows(file, name)
        parts = [_typed(name, columns, some, numeric) for some in iter(lambda: list(islice(rows, _AT_ONCE)), [])]
    table = pandas.concat(parts) if parts else _typed(name, columns, [], numeric)
    table.attrs.update(name=name, remarks=remarks)
    return table


def fail(table: pandas.DataFrame, row: int, what: str) -> NoReturn:
    """row: its place."""
    raise InputError(f"{table.attrs['name']}:{table.index[row]}: {what}")


def require(table: pandas.DataFrame, *names: str) -> None:
    for name in names:
        if name not in table:
            raise missing(table.attrs["name"], name, table.columns)


def _typed(name: str, columns: Sequence[str], rows: Sequence[Row], numeric: Container[str]) -> pandas.DataFrame:
    lines = pandas.Index([line for line, _ in rows], dtype="int64")
    cells: dict[str, Any] = dict(zip(columns, zip(*(fields for _, fields in rows)) if rows else [()] * len(columns)))
    try:
        typed = {column: _numbers(of) if column in numeric else pandas.Series(map(sys.intern, of), lines, object) for column, of in cells.items()}
    except ValueError:
        line, wrong = next((line, cell) for line, fields in rows for column, cell in zip(columns, fields) if column in numeric and not _is_number(cell))
        raise InputError(f"{name}:{line}: '{wrong}' is not a number") from None
    return pandas.DataFrame(typed, lines)


def _numbers(cells: Sequence[str]) -> list[float]:
    """Throws ValueError also for what float() takes and other readers of numbers do not: "1_000", " 1", digits of other scripts."""
    if "".join(cells).encode(errors="surrogateescape").translate(None, _OF_NUMBERS):
        raise ValueError
    return [float(cell or "nan") for cell in cells]


def _is_number(cell: str) -> bool:
    try:
        _numbers([cell])
    except ValueError:
        return False
    return True
