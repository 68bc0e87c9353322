# SPDX-License-Identifier: GPL-3.0-or-later
"""Columns of a text of numbers, a row per line: CSV, or words between blanks. NumPy reads them; what stands above them is looked at here."""

from __future__ import annotations

import csv
import re
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, NoReturn

import numpy as np

from salbench.datasets._order import Elements, numbering_column, row_of_elements
from salbench.datasets._text import BLANKS, in_quotes, is_number, lines_of, number_in
from salbench.datasets.records import Floats, InputError

if TYPE_CHECKING:
    from numpy.typing import NDArray

MAX_NAMED = 20  # columns in a message
NUMPY_BLANKS = re.compile(rb"[\0\x1c-\x1f\x85\xa0]")  # what NumPy takes for a blank, or for an end
Cells = list[bytes]
WrongWithRows = Callable[[list[Floats]], "tuple[int, str] | None"]  # the first row that cannot be used, and why


def are_unseen(values: Floats, word: bytes) -> NDArray[np.bool_]:
    """True of the number that this word is."""
    number = number_in(word)
    return np.zeros(len(values), bool) if number is None else np.asarray(np.isnan(values) if number != number else values == number)


def separator_of(row: bytes) -> bytes:
    """Semicolons, tabs or commas, whichever the first row has outside quotes; else blanks."""
    outside = re.sub(rb'"[^"]*"', b"", row)
    return next((separator for separator in (b";", b"\t", b",") if separator in outside), b" ")


def are_names(cells: Cells) -> bool:
    """True if a word is no number, and none that another program wrote: 0,5 or 1.#INF."""
    return any(word and not is_number(word) and not re.match(rb"[-+]?[0-9.]+[#,]", word) for word in cells)


def column_number(column: str) -> int:
    """From 1, of a column without a header; 0 for a name."""
    return int(column) if re.fullmatch("[0-9]{1,9}", column) else 0


def _cells_of(row: bytes, separator: bytes) -> Cells:
    text = (b" ".join(row.split()) if separator == b" " else row).decode("latin-1")
    return [cell.encode("latin-1").strip(BLANKS) for cell in next(csv.reader([text], delimiter=separator.decode(), skipinitialspace=True), [])]


def _for_numpy(line: bytes, separator: bytes) -> bytes:
    """A line without quotes, of which NumPy knows some alone; a cell that is no number anyway is a question mark."""
    if b'"' not in line:
        return line
    return separator.join(cell if is_number(cell) else b"?" for cell in _cells_of(line, separator))


def _decimal_commas(rows: Sequence[tuple[int, bytes]]) -> int:
    """The first line that shows that "0,5" may be one number with a decimal comma and no two whole ones; 0 if none does. Numbers of elements, which a
    first column holds, do not repeat, and have no zeros in front."""
    if not all(re.fullmatch(rb"[-+0-9,\s]*", line) for _, line in rows):
        return 0
    seen: set[bytes] = set()
    for number, line in rows:
        cells = [cell.strip() for cell in line.split(b",")]
        if any(len(cell) > 1 and cell.startswith(b"0") for cell in cells[1:]) or len(cells) == 2 and cells[0] in seen:
            return number
        seen.add(cells[0])
    return 0


def read_columns(text: bytes, name: str, columns: Sequence[str], unseen: str = "", expected: Elements | None = None,
                 wrong_with_rows: WrongWithRows | None = None) -> list[Floats]:
    """The columns named, each by its name in the header or by its number from 1; "" is the only column. A first row in which a word is no number
    is the header; so is the last line above it that begins with '#' and has as many words. With `expected`, rows come in the order of the
    elements: a column that numbers these is obeyed. A value of the first column that is `unseen` becomes NaN; all others must be finite."""
    def fail(what: str, line: int) -> NoReturn:
        raise InputError(f"{name}:{line}: {what}" if line else f"{name}: {what}")

    lines = lines_of(text)
    rows = [(number, line) for number, line in enumerate(lines, 1) if line.strip(BLANKS) and not line.lstrip(BLANKS).startswith(b"#")]
    if not rows:
        fail("the file has no values", len(lines))
    separator = separator_of(rows[0][1])
    first = _cells_of(rows[0][1], separator)
    comments = [_cells_of(line.lstrip(BLANKS)[1:], separator) for line in lines[:rows[0][0] - 1] if line.strip(BLANKS)]
    by_number = [column_number(column) for column in columns]
    no_numbers = [place for place, cell in enumerate(first, 1) if not is_number(cell)]
    header = first if are_names(first) and (not all(by_number) or set(by_number) & set(no_numbers) or len(no_numbers) == len(first)) else next(
        (cells for cells in reversed(comments) if len(cells) == len(first) and are_names(cells)), None)
    begin = int(header is first)
    if header is None and (named := [column for column in columns if column and not column_number(column)]):
        fail(f"no column {in_quotes(named[0].encode())}: the first line has numbers, not names of columns", rows[0][0])
    places = []
    for column in columns:
        word = column.encode("utf-8", "surrogateescape")
        if column and not column_number(column) and word not in (header or ()):
            fail(f"no column {in_quotes(word)}: the header has {', '.join(map(in_quotes, (header or [])[:MAX_NAMED]))}", rows[0][0])
        places.append(max(column_number(column) - 1, 0) if not column or column_number(column) else (header or []).index(word))
    numbering = None
    if expected is not None and header is not None and (columns != ("",) or len(header) == 2):
        try:
            numbering = numbering_column(header, expected, () if tuple(columns) == ("",) else places)
        except InputError as error:
            fail(str(error), rows[0][0])
        if numbering is not None and tuple(columns) == ("",):
            places = [1 - numbering]
    if tuple(columns) == ("",) and len(first) > 1 + (numbering is not None):
        fail(f"the line has {len(first)} columns, expected one value: keep that column alone, or name it in the description (`column:`)", rows[0][0])
    wanted = [*places, *([numbering] if numbering is not None else [])]
    for number, line in rows[begin:]:
        n = len(_cells_of(line, separator)) if b'"' in line else len(line.split()) if separator == b" " else 1 + line.count(separator)
        if n - (separator != b" " and line.rstrip(BLANKS).endswith(separator)) != len(first) != n:  # a separator may end each line
            fail(f"{n} columns, but the first line has {len(first)}: write decimal commas, if these are some, as points", number)
        if NUMPY_BLANKS.search(line):
            fail(f"{in_quotes(line)} is not a number", number)
    if header is None and separator == b"," and (line := _decimal_commas(rows)):
        fail("whole numbers between commas: write decimal commas, if these are some, as points, or name the columns in a first line", line)
    if max(wanted) >= len(first):
        fail(f"the line has {len(first)} columns, expected column {max(wanted) + 1}", rows[0][0])
    values: list[Floats] = [np.empty(0) for _ in wanted]
    if rows[begin:]:
        try:
            table = np.loadtxt([_for_numpy(line, separator) for _, line in rows[begin:]], comments=None, ndmin=2, usecols=wanted,
                               delimiter=None if separator == b" " else separator.decode())
        except ValueError as error:  # NumPy names the row and the word
            at = re.search(r"at row (\d+)", str(error))
            row = rows[begin + int(at[1])] if at else rows[begin]
            word = next((cell for cell in (_cells_of(row[1], separator)[place] for place in wanted) if not is_number(cell)), row[1])
            fail(f"{in_quotes(word)} is not a number", row[0])
        values = list(table.T.copy())
    hidden = are_unseen(values[0], unseen.encode())
    for k, column in enumerate(values):
        for row in np.flatnonzero(~np.isfinite(column) & ~(hidden if k == 0 else False))[:1]:
            fail(f"{in_quotes(_cells_of(rows[begin + row][1], separator)[wanted[k]])} is not a finite number", rows[begin + row][0])
    values[0][hidden] = np.nan
    if wrong_with_rows is not None and rows[begin:] and (wrong := wrong_with_rows(values)):
        fail(wrong[1], rows[begin + wrong[0]][0])
    if expected is not None and not expected.has(len(values[0])):
        fail(expected.wrong_count(len(values[0])), len(lines))
    if not len(values[0]):
        fail("the file has no values", len(lines))
    if numbering is None or expected is None:
        return values
    order = row_of_elements(values.pop(), expected)
    if isinstance(order, tuple):
        fail(f"column {in_quotes((header or [])[numbering])} {order[1]}", rows[begin + order[0]][0])
    return [column[order] for column in values]
