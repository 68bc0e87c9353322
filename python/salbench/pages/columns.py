# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables defined by columns, each with a head and a function from rows to cells."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any

from salbench.pages.blocks import Cell, Table, cell, count, interval, p_value


@dataclass(frozen=True)
class Column:
    head: str  # unique in the table
    show: Callable[[Any], Cell]  # cell of a row
    numeric: bool = True
    better: str = ""  # "higher" or "lower", shown in the head
    # cell in the last row, if any column has a drawing
    foot: Cell = field(default_factory=lambda: Cell(""))


def text(head: str, of: str | Callable[[Any], Any]) -> Column:
    """Column of text. of: a field of the rows, or a function of a row."""
    return Column(head, lambda row: Cell(str(row[of] if isinstance(of, str) else of(row))), numeric=False)


def number(head: str, name: str, digits: int = 3) -> Column:
    return Column(head, lambda row: cell(row[name], digits))


def counted(head: str, name: str) -> Column:
    return Column(head, lambda row: count(row[name]))


def between(head: str, low: str, high: str, digits: int = 3) -> Column:
    return Column(head, lambda row: interval(row[low], row[high], digits))


def probability(head: str, name: str) -> Column:
    return Column(head, lambda row: p_value(row[name]))


def sheet(
    identifier: str,
    caption: str,
    columns: Sequence[Column],
    rows: Iterable[Any],
    menus: Sequence[str] = (),
    opened: int = 0,
    files: Sequence[tuple[str, str]] = (),
) -> Table:
    """Table of rows by columns. menus: heads of the columns that get one; the first `opened` of them start at
    the value of the first row and hide the others. files: (label, path) of the same table in other
    formats."""
    cells = [[column.show(row) for column in columns] for row in rows]
    heads = [column.head for column in columns]
    places = [heads.index(head) for head in menus]
    return Table(
        identifier,
        caption,
        heads,
        cells,
        [column.numeric for column in columns],
        places,
        list(files),
        [column.better for column in columns] if any(column.better for column in columns) else [],
        {place: cells[0][place].text for place in places[:opened]} if cells else {},
        foot=[column.foot for column in columns] if any(column.foot.drawn for column in columns) else [],
    )
