# SPDX-License-Identifier: GPL-3.0-or-later
"""CSV files (RFC 4180) of anybody's, read strictly: a message names the file, the line and what was expected there."""

import os
import sys
from array import array
from collections.abc import Container, Sequence
from typing import NoReturn

import numpy as np
import pandas

from salbench._csv import REMARKS, missing, parted, read_rows
from salbench._errors import InputError as InputError

_OF_NUMBERS = b"+-.0123456789eEinfatyINFATY"  # what "1e-3", "nan" and "infinity" are spelled with


def read_csv(path: str | os.PathLike[str], numeric: Container[str] = ()) -> pandas.DataFrame:
    """Columns of texts, or of numbers with NaN for empty cells; the index has the line on which each row begins. `attrs` has the `name` of the
    file, and the `remarks` of its column of that name, which is none of the frame's, and of lines above the names of the columns that begin
    with '#'. numeric: columns of numbers.

    Throws InputError as read_rows does, and for a cell of a column of numbers that is none; OSError for a file that cannot be read.
    """
    name = os.fspath(path)
    with open(path, encoding="utf-8-sig", errors="surrogateescape", newline="") as file:
        remarks, columns, rows = read_rows(file, name)
        places = [place for place, column in enumerate(columns) if column in numeric]
        texts: dict[int, list[str]] = {place: [] for place in range(len(columns)) if place not in places}
        lines, numbers = list[int](), array("d")  # row by row: many small arrays take more memory when they are put together
        for line, fields in rows:
            lines.append(line)
            try:
                numbers.extend(_numbers([fields[place] for place in places]))
            except ValueError:
                wrong = next(fields[place] for place in places if not _is_number(fields[place]))
                raise InputError(f"{name}:{line}: '{wrong}' is not a number") from None
            for place, cells in texts.items():
                cells.append(sys.intern(fields[place]))
    values = np.array(numbers).reshape(len(lines), len(places))
    table = pandas.concat([pandas.DataFrame({columns[place]: pandas.Series(cells, lines, object) for place, cells in texts.items()}, lines),
                           pandas.DataFrame(values, lines, [columns[place] for place in places])], axis=1)[columns]
    if REMARKS in table and REMARKS not in numeric:
        remarks = list(dict.fromkeys([*remarks, *parted(table.pop(REMARKS))]))
    table.attrs.update(name=name, remarks=remarks)
    return table


def fail(table: pandas.DataFrame, row: int, what: str) -> NoReturn:
    """row: its place."""
    raise InputError(f"{table.attrs['name']}:{table.index[row]}: {what}")


def require(table: pandas.DataFrame, *names: str) -> None:
    for name in names:
        if name not in table:
            raise missing(table.attrs["name"], name, table.columns)


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
