# SPDX-License-Identifier: GPL-3.0-or-later
"""CSV files (RFC 4180), read strictly: a message names the file, the line and what was expected there.
Rows are read without any library."""

import csv
import os
import sys
from array import array
from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import chain
from typing import TYPE_CHECKING, Any, NoReturn

from salbench.system.errors import InputError, quoted

if TYPE_CHECKING:
    import pandas

Row = tuple[int, list[str]]  # the line on which it begins, and its fields
REMARKS = "remarks"  # the last column of a table that has some: all of them, in each row
_BETWEEN = " | "
_OF_NUMBERS = b"+-.0123456789eEinfatyINFATY"  # what "1e-3", "nan" and "infinity" are spelled with

# What the module csv says, in our words.
WRONG = {
    "unexpected end of data": "a quote opens a field that nothing closes",
    "',' expected after '\"'": "there is text after the quote that closes a field",
}


def read_rows(file: Iterable[str], name: str) -> tuple[list[str], list[str], Iterator[Row]]:
    """Of the lines of a file, with their ends: the remarks, lines that begin with '#' above the first other
    one, whatever commas and quotes are in them; the names of the columns; the rows.

    Throws InputError for a line with another number of fields, a quote that does not close, a column named
    twice, and no columns.
    """
    remarks, above, first = remarks_above(file)
    rows = _rows(csv.reader(chain([first], file), strict=True), name, above)
    header = next(rows, None)
    if header is None:
        raise InputError(f"{name}: the file is empty, where a line of column names is expected")
    line, columns = header
    for column in columns:
        if columns.count(column) > 1:
            raise InputError(f"{name}:{line}: two columns are named {quoted(column)}")
    return remarks, columns, _of_width(rows, len(columns), name)


def read_csv(
    path: str | os.PathLike[str],
    is_number: Callable[[str], bool] = lambda column: False,
    errors: str = "surrogateescape",
) -> "pandas.DataFrame":
    """The one reader of tables. Columns are texts as they stand, or numbers, the same doubles, with NaN for
    empty cells; the index has the line on which each row begins. `attrs` has the `name` of the file, and the
    `remarks` of its column of that name, which is none of the frame's unless it is one of numbers, and of
    lines above the names of the columns that begin with '#'. errors: for bytes that are not UTF-8.

    Throws InputError as read_rows does, and for a cell of a column of numbers that is none; OSError for a
    file that cannot be read.
    """
    try:
        import pandas
    except ModuleNotFoundError as error:
        raise ModuleNotFoundError(
            f"{error}; pip install 'salbench[run]' brings what tables need", name=error.name
        ) from None
    import numpy as np

    name = os.fspath(path)
    with open(path, encoding="utf-8-sig", errors=errors, newline="") as file:
        remarks, columns, rows = read_rows(file, name)
        places = [place for place, column in enumerate(columns) if is_number(column)]
        texts: dict[int, list[str]] = {place: [] for place in range(len(columns)) if place not in places}
        # row by row: many small arrays take more memory when they are put together
        lines, numbers = list[int](), array("d")
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
    table = pandas.concat(
        [
            pandas.DataFrame(
                {columns[place]: pandas.Series(cells, lines, object) for place, cells in texts.items()}, lines
            ),
            pandas.DataFrame(values, lines, [columns[place] for place in places]),
        ],
        axis=1,
    )[columns]
    if REMARKS in table and not is_number(REMARKS):
        remarks = list(dict.fromkeys([*remarks, *parted(table.pop(REMARKS))]))
    table.attrs.update(name=name, remarks=remarks)
    return table


def fail(table: "pandas.DataFrame", row: int, what: str) -> NoReturn:
    """row: its place."""
    raise InputError(f"{table.attrs['name']}:{table.index[row]}: {what}")


def require(table: "pandas.DataFrame", *names: str) -> None:
    for name in names:
        if name not in table:
            raise missing(table.attrs["name"], name, table.columns)


def joined(remarks: Iterable[str]) -> str:
    """Of a cell: bars within a remark are doubled."""
    return _BETWEEN.join(remark.replace("|", "||") for remark in remarks)


def parted(cells: Iterable[str]) -> Iterator[str]:
    """The remarks of cells that `joined` made, each once, in the order of their first appearance."""
    remarks = (remark.replace("||", "|") for cell in dict.fromkeys(cells) for remark in cell.split(_BETWEEN))
    return iter(dict.fromkeys(filter(None, remarks)))


def missing(name: str, column: str, columns: Iterable[str]) -> InputError:
    return InputError(
        f"{name}: there is no column {quoted(column)}; there are {', '.join(map(quoted, columns))}"
    )


def remarks_above(file: Iterable[str]) -> tuple[list[str], int, str]:
    """The lines that begin with '#', without it; how many lines these and blank ones take, and the line
    below them."""
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


def _numbers(cells: Sequence[str]) -> list[float]:
    """Throws ValueError also for what float() takes and other readers of numbers do not: "1_000", " 1",
    digits of other scripts."""
    if "".join(cells).encode(errors="surrogateescape").translate(None, _OF_NUMBERS):
        raise ValueError
    return [float(cell or "nan") for cell in cells]


def _is_number(cell: str) -> bool:
    try:
        _numbers([cell])
    except ValueError:
        return False
    return True
