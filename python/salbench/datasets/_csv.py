# SPDX-License-Identifier: GPL-3.0-or-later
"""Small CSV files (RFC 4180) of an archive: splits and cameras. Read strictly, and without NumPy."""

from __future__ import annotations

import csv
import io
from dataclasses import dataclass, field
from typing import NoReturn

from salbench.datasets._files import read_file
from salbench.datasets._text import BYTE_ORDER_MARK, fits, in_quotes, number_in, quoted
from salbench.datasets.records import InputError

MAX_BYTES = 64 << 20
_WRONG = {"unexpected end of data": "a quote opens a field that nothing closes",
          "',' expected after '\"'": "there is text after the quote that closes a field"}  # what the module csv says, in our words


@dataclass
class Table:
    name: str  # the file, for messages
    columns: list[str]
    rows: list[list[str]] = field(default_factory=list)
    lines: list[int] = field(default_factory=list)  # on which each row begins

    def column(self, name: str) -> list[str]:
        if name not in self.columns:
            raise InputError(f"{self.name}: there is no column {quoted(name)}; there are {', '.join(map(quoted, self.columns))}")
        place = self.columns.index(name)
        return [row[place] for row in self.rows]

    def numbers(self, name: str) -> list[float]:
        """NaN for an empty cell."""
        numbers = []
        for line, text in zip(self.lines, self.column(name)):
            word = text.encode("utf-8", "surrogateescape")
            number = float("nan") if not word else None if word.startswith(b"+") else number_in(word)
            if number is None or not (word == b"" or fits(word, number)):
                raise InputError(f"{self.name}:{line}: {in_quotes(word)} is not a number")
            numbers.append(number)
        return numbers


def _fail(name: str, line: int, what: str) -> NoReturn:
    raise InputError(f"{name}:{line}: {what}")


def read_csv(path: str) -> Table:
    """The first line names the columns, after any lines that begin with '#'."""
    text = read_file(path, MAX_BYTES).removeprefix(BYTE_ORDER_MARK).decode("utf-8", "surrogateescape")
    lines = io.StringIO(text, newline="")
    above = 0  # lines before the header
    while True:
        start = lines.tell()
        line = lines.readline()
        if not line or (line.strip("\r\n") and not line.startswith("#")):
            lines.seek(start)
            break
        above += 1
    reader = csv.reader(lines, strict=True)
    table: Table | None = None
    while True:
        at = above + reader.line_num + 1
        try:
            row = next(reader, None)
        except csv.Error as error:
            _fail(path, at, _WRONG.get(str(error), str(error)))
        if row is None:
            break
        if not row:
            continue
        if table is None:
            table = Table(path, row)
            twins = sorted(name for name in row if row.count(name) > 1)
            if twins:
                _fail(path, at, f"two columns are named {quoted(twins[0])}")
        elif len(row) != len(table.columns):
            _fail(path, at, f"the line has {len(row)} fields, the header {len(table.columns)}")
        else:
            table.rows.append(row)
            table.lines.append(at)
    if table is None:
        raise InputError(f"{path}: the file is empty, where a line of column names is expected")
    return table
