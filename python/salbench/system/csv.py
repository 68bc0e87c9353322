# SPDX-License-Identifier: GPL-3.0-or-later
"""CSV files (RFC 4180), read strictly: messages name the file, the line and the expected content. Rows are
read without any library."""

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

Row = tuple[int, list[str]]  # line on which it begins, and its fields
REMARKS = "remarks"  # last column of a table with remarks: all of them, in each row
_BETWEEN = " | "
_OF_NUMBERS = b"+-.0123456789eEinfatyINFATY"  # characters of "1e-3", "nan" and "infinity"
_EMPTY = ("", "NA")  # of numbers; R writes NA
_UTF16 = ("\udcff\udcfe", "\udcfe\udcff")  # its byte order marks, read as UTF-8 with surrogateescape

# Messages of the module csv, reworded.
WRONG = {
    "unexpected end of data": "a quote opens a field that nothing closes",
    "',' expected after '\"'": "there is text after the quote that closes a field",
}


def read_rows(
    file: Iterable[str], name: str, separator: str = ","
) -> tuple[list[str], list[str], Iterator[Row]]:
    """Parses lines with their ends. Returns the remarks (lines with '#' at the top, commas and quotes
    included), the names of the columns, and the rows.

    Throws InputError for a wrong number of fields or another separator, UTF-16, an unclosed quote, a
    duplicate column, and missing columns.
    """
    remarks, above, first = remarks_above(file)
    if first.startswith(_UTF16):
        raise InputError(f"{name}: is in UTF-16: save it as UTF-8")
    rows = _rows(csv.reader(chain([first], file), delimiter=separator, strict=True), name, above)
    header = next(rows, None)
    if header is None:
        raise InputError(f"{name}: the file is empty, where a line of column names is expected")
    line, columns = header
    for mark in (";", "\t") if len(columns) == 1 else ():
        if mark in columns[0]:
            raise InputError(
                f"{name}:{line}: separated by {mark!r}: save it with commas between fields and decimal points"
            )
    for column in columns:
        if columns.count(column) > 1:
            raise InputError(f"{name}:{line}: two columns are named {quoted(column)}")
    return remarks, columns, _of_width(rows, len(columns), name)


def read_csv(
    path: str | os.PathLike[str],
    is_number: Callable[[str], bool] = lambda column: False,
    errors: str = "surrogateescape",
) -> "pandas.DataFrame":
    """Reads any table. Columns are unchanged texts, or exact doubles with NaN for empty cells and R's NA; the
    index holds the first line of each row. `attrs` has the `name` of the file, and the `remarks`: from lines
    with '#' at the top, and from the column of that name, which is removed unless it is numeric. errors: for
    bytes that are not UTF-8.

    Throws InputError as read_rows does, and for other text in numeric columns; OSError for an unreadable
    file.
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
        # in pieces, since concatenating many small arrays takes more memory
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
    """Throws an error for a row, given by position."""
    raise InputError(f"{table.attrs['name']}:{table.index[row]}: {what}")


def require(table: "pandas.DataFrame", *names: str) -> None:
    for name in names:
        if name not in table:
            raise missing(table.attrs["name"], name, table.columns)


def joined(remarks: Iterable[str]) -> str:
    """Joins remarks in a cell; bars within a remark are doubled."""
    return _BETWEEN.join(remark.replace("|", "||") for remark in remarks)


def parted(cells: Iterable[str]) -> Iterator[str]:
    """Inverse of `joined` over several cells: each remark once, in the order of first appearance."""
    remarks = (remark.replace("||", "|") for cell in dict.fromkeys(cells) for remark in cell.split(_BETWEEN))
    return iter(dict.fromkeys(filter(None, remarks)))


def missing(name: str, column: str, columns: Iterable[str]) -> InputError:
    return InputError(
        f"{name}: there is no column {quoted(column)}; there are {', '.join(map(quoted, columns))}"
    )


def remarks_above(file: Iterable[str]) -> tuple[list[str], int, str]:
    """Lines that begin with '#', without it; their number including blank lines; and the line below them."""
    remarks = []
    for before, line in enumerate(file):
        if line.startswith("#"):
            remarks.append(line.rstrip("\r\n").lstrip("# \t"))
        elif line.rstrip("\r\n"):
            return remarks, before, line
    return remarks, 0, ""


def _rows(reader: Any, name: str, above: int) -> Iterator[Row]:
    """Yields rows; lines without fields are skipped."""
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
    """Throws ValueError also for text that float() accepts, but other readers of numbers do not: "1_000", "
    1", digits of other scripts."""
    if "".join(cells).encode(errors="surrogateescape").translate(None, _OF_NUMBERS):
        raise ValueError
    return [float("nan" if cell in _EMPTY else cell) for cell in cells]


def _is_number(cell: str) -> bool:
    try:
        _numbers([cell])
    except ValueError:
        return False
    return True
