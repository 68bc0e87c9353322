# SPDX-License-Identifier: GPL-3.0-or-later
"""CSV files (RFC 4180) of anybody's, read strictly: a message names the file, the line and what was expected there."""

import os
from array import array
from collections.abc import Container, Sequence
from dataclasses import dataclass, field
from typing import NoReturn

import numpy as np

from salbench._csv import missing, read_rows
from salbench._errors import InputError as InputError
from salbench.conclusions.units import Floats

_OF_NUMBERS = b"+-.0123456789eEinfatyINFATY"  # what "1e-3", "nan" and "infinity" are spelled with


@dataclass(frozen=True)
class Table:
    """Columns of texts, or of numbers with NaN for empty cells."""

    name: str  # the file, for messages
    texts: dict[str, list[str]]
    numbers: dict[str, Floats]
    lines: Sequence[int]  # on which each row begins
    columns: list[str]  # all of them, in their order
    remarks: list[str] = field(default_factory=list)  # lines above the names of the columns, without their '#'

    def fail(self, row: int, what: str) -> NoReturn:
        raise InputError(f"{self.name}:{self.lines[row]}: {what}")

    def column(self, name: str) -> list[str]:
        """A column of texts that must be there."""
        self._require(name)
        return self.texts[name]

    def number_column(self, name: str) -> Floats:
        self._require(name)
        return self.numbers[name]

    def column_if_any(self, name: str) -> list[str]:
        """Empty cells where there is no such column."""
        return self.texts[name] if name in self.texts else [""] * len(self.lines)

    def _require(self, name: str) -> None:
        if name not in self.columns:
            raise missing(self.name, name, self.columns)


def read_csv(path: str | os.PathLike[str], numeric: Container[str] = ()) -> Table:
    """The first line names the columns, below any lines that begin with '#': these are text, whatever commas and quotes are in it. numeric: columns of numbers.

    Throws InputError as read_rows does, and for a cell of a column of numbers that is none; OSError for a file that cannot be read.
    """
    name = os.fspath(path)
    with open(path, encoding="utf-8-sig", errors="surrogateescape", newline="") as file:
        remarks, columns, rows = read_rows(file, name)
        read = _Columns(name, columns, numeric)
        for line, fields in rows:
            read.add(line, fields)
    return read.table(remarks)


class _Columns:
    """Takes up row after row: texts that repeat are kept once, numbers as such, so that a large file takes little memory."""

    def __init__(self, name: str, columns: list[str], numeric: Container[str]) -> None:
        self.lines: list[int] = []
        self._name, self._columns = name, columns
        self._texts: dict[int, list[str]] = {place: [] for place, column in enumerate(columns) if column not in numeric}
        self._numbers = [place for place in range(len(columns)) if place not in self._texts]
        self._cells = array("d")  # of the numbers, row by row
        self._known: dict[str, str] = {}

    def add(self, line: int, fields: list[str]) -> None:
        self.lines.append(line)
        for place, cells in self._texts.items():
            cells.append(self._known.setdefault(fields[place], fields[place]))
        cells = [fields[place] for place in self._numbers]
        try:
            self._cells.extend([float(cell or "nan") for cell in cells])
            are_numbers = _are_plain(cells)
        except ValueError:
            are_numbers = False
        if not are_numbers:
            wrong = next(cell for cell in cells if not _is_number(cell))
            raise InputError(f"{self._name}:{line}: '{wrong}' is not a number")

    def table(self, remarks: list[str]) -> Table:
        values = np.array(self._cells).reshape(len(self.lines), len(self._numbers))
        texts = {self._columns[place]: cells for place, cells in self._texts.items()}
        return Table(self._name, texts, {self._columns[place]: values[:, at] for at, place in enumerate(self._numbers)}, self.lines,
                     self._columns, remarks)


def _are_plain(cells: list[str]) -> bool:
    """False for what float() takes and other readers of numbers do not: "1_000", " 1", digits of other scripts. Once per row: it is fast."""
    return not "".join(cells).encode().translate(None, _OF_NUMBERS)


def _is_number(cell: str) -> bool:
    try:
        float(cell or "nan")
    except ValueError:
        return False
    return _are_plain([cell])
