# SPDX-License-Identifier: GPL-3.0-or-later
"""Small CSV files of an archive: splits."""

from __future__ import annotations

import io
from dataclasses import dataclass, field

from salbench._csv import missing, read_rows
from salbench.datasets._files import read_file
from salbench.datasets._text import BYTE_ORDER_MARK

MAX_BYTES = 64 << 20


@dataclass
class Table:
    name: str  # the file, for messages
    columns: list[str]
    rows: list[list[str]] = field(default_factory=list)
    lines: list[int] = field(default_factory=list)  # on which each row begins

    def column(self, name: str) -> list[str]:
        if name not in self.columns:
            raise missing(self.name, name, self.columns)
        place = self.columns.index(name)
        return [row[place] for row in self.rows]


def read_csv(path: str) -> Table:
    """The first line names the columns, after any lines that begin with '#'."""
    text = read_file(path, MAX_BYTES).removeprefix(BYTE_ORDER_MARK).decode("utf-8", "surrogateescape")
    _, columns, rows = read_rows(io.StringIO(text, newline=""), path)
    table = Table(path, columns)
    for line, fields in rows:
        table.rows.append(fields)
        table.lines.append(line)
    return table
