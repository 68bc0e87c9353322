# SPDX-License-Identifier: GPL-3.0-or-later
"""Columns of a text of numbers, a row per line: CSV, or words between blanks. NumPy reads them; what stands above them is looked at here."""

from __future__ import annotations

import csv
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, NoReturn

import numpy as np

from salbench.datasets._order import Elements, numbering_column, row_of_elements
from salbench.datasets._text import BLANKS, decimal_comma_in, in_quotes, is_number, lines_of, number_in
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
    """Cells without their quotes; a row that the module csv refuses is one cell."""
    text = (b" ".join(row.split()) if separator == b" " else row).replace(b"\0", b"?").decode("latin-1")
    cells: list[str]
    try:
        cells = next(csv.reader([text], delimiter=separator.decode(), skipinitialspace=True, strict=True), [])
    except csv.Error:
        cells = [text]
    return [cell.encode("latin-1").strip(BLANKS) for cell in cells]


@dataclass
class _Table:
    """The rows of a text, and the names of their columns."""

    name: str
    length: int  # lines of the text
    rows: list[tuple[int, bytes]]  # line from 1 and text; without the header, blank lines and comments
    separator: bytes
    first: tuple[int, Cells]  # of the header where the first row is one
    header: Cells | None = None

    def fail(self, what: str, line: int) -> NoReturn:
        raise InputError(f"{self.name}:{line}: {what}" if line else f"{self.name}: {what}")

    def cells(self, row: int) -> Cells:
        return _cells_of(self.rows[row][1], self.separator)

    def place_of(self, column: str) -> int:
        if not column or column_number(column):
            return max(column_number(column) - 1, 0)
        line, name = self.first[0], column.encode("utf-8", "surrogateescape")
        if self.header is None:
            self.fail(f"no column {in_quotes(name)}: the first line has numbers, not names of columns", line)
        if name not in self.header:
            more = ", ..." if len(self.header) > MAX_NAMED else ""
            self.fail(f"no column {in_quotes(name)}: the header has {', '.join(map(in_quotes, self.header[:MAX_NAMED]))}{more}", line)
        return self.header.index(name)

    def numbering(self, expected: Elements | None, places: list[int], only: bool) -> int | None:
        """Place of the column that numbers the elements. Beside the only column, it is the other of two."""
        if expected is None or self.header is None or (only and len(self.header) != 2):
            return None
        try:
            return numbering_column(self.header, expected, () if only else places)
        except InputError as error:
            self.fail(str(error), self.first[0])

    def check_sizes(self) -> None:
        """Each row has as many cells as the first one. A separator may end it."""
        size, separator = len(self.first[1]), self.separator
        for line, text in self.rows:
            n = len(_cells_of(text, separator)) if b'"' in text else len(text.split()) if separator == b" " else 1 + text.count(separator)
            if n != size and n - (separator != b" " and text.rstrip(BLANKS).endswith(separator)) != size:
                advice = "close each quote on its line" if b'"' in text else "write decimal commas, if these are some, as points"
                self.fail(f"{n} {'column' if n == 1 else 'columns'}, but the first line has {size}: {advice}", line)

    def check_commas(self) -> None:
        """Refuses "0,5" that may be one number with a decimal comma, and no two whole ones: numbers of elements, which a first column holds, do not
        repeat, and whole numbers have no zeros in front."""
        if self.header is not None or self.separator != b"," or not all(re.fullmatch(rb"[-+0-9,\s]*", text) for _, text in self.rows):
            return
        seen: set[bytes] = set()
        for line, text in self.rows:
            cells = [cell.strip() for cell in text.split(b",")]
            if any(len(cell) > 1 and cell.startswith(b"0") for cell in cells[1:]) or (len(cells) == 2 and cells[0] in seen):
                self.fail("whole numbers between commas: write decimal commas, if these are some, as points, or name the columns in a first line",
                          line)
            seen.add(cells[0])

    def _for_numpy(self, text: bytes) -> bytes:
        """A row without quotes, and without words that NumPy would part otherwise: they become question marks."""
        if b'"' not in text and not NUMPY_BLANKS.search(text):
            return text
        return self.separator.join(cell if is_number(cell) else b"?" for cell in _cells_of(text, self.separator))

    def numbers(self, wanted: list[int]) -> list[Floats]:
        """The columns at these places. Where NumPy refuses a row, its words are looked at again."""
        if not self.rows:
            return [np.empty(0) for _ in wanted]
        try:
            table = np.loadtxt([self._for_numpy(text) for _, text in self.rows], comments=None, ndmin=2, usecols=wanted,
                               delimiter=None if self.separator == b" " else self.separator.decode())
        except ValueError as error:
            at = re.search(r"at row (\d+)", str(error))
            row = int(at[1]) if at else 0
            cells = self.cells(row)
            word = next((cells[place] for place in wanted if not is_number(cells[place])), self.rows[row][1])
            self.fail(f"{in_quotes(word)} is not a number{decimal_comma_in(word)}", self.rows[row][0])
        return list(table.T.copy())


def _table_of(text: bytes, name: str, columns: Sequence[str]) -> _Table:
    """The header is the first row if a word in it is no number, but not where columns are meant by number and have numbers there; else the last
    line above it that begins with '#' and has as many words."""
    lines = lines_of(text)
    rows = [(line, row) for line, row in enumerate(lines, 1) if row.strip(BLANKS) and not row.lstrip(BLANKS).startswith(b"#")]
    if not rows:
        return _Table(name, len(lines), [], b" ", (len(lines), []))
    line, separator = rows[0][0], separator_of(rows[0][1])
    first = _cells_of(rows[0][1], separator)
    table = _Table(name, len(lines), rows, separator, (line, first))
    by_number = {column_number(column) for column in columns}
    words = {place for place, cell in enumerate(first, 1) if not is_number(cell)}
    if are_names(first) and (0 in by_number or by_number & words or len(words) == len(first)):
        table.header, table.rows = first, rows[1:]
    else:
        above = (_cells_of(row.lstrip(BLANKS)[1:], separator) for row in reversed(lines[:line - 1]) if row.strip(BLANKS))
        table.header = next((cells for cells in above if len(cells) == len(first) and are_names(cells)), None)
    return table


def read_columns(text: bytes, name: str, columns: Sequence[str], unseen: str = "", expected: Elements | None = None,
                 wrong_with_rows: WrongWithRows | None = None) -> list[Floats]:
    """The columns named, each by its name in the header or by its number from 1; "" is the only column. With `expected`, rows come in the order
    of the elements: a column that numbers these is obeyed. A value of the first column that is `unseen` becomes NaN; all others must be finite."""
    table = _table_of(text, name, columns)
    line, first = table.first
    if not first:
        table.fail("the file has no values", line)
    places, only = [table.place_of(column) for column in columns], tuple(columns) == ("",)
    numbering = table.numbering(expected, places, only)
    if only and len(first) > (1 if numbering is None else 2):
        table.fail(f"the line has {len(first)} columns, expected one value: keep that column alone, or name it in the description (`column:`)", line)
    if only and numbering is not None:
        places = [1 - numbering]
    wanted = places if numbering is None else [*places, numbering]
    table.check_sizes()
    table.check_commas()
    if max(wanted) >= len(first):
        table.fail(f"the line has {len(first)} {'column' if len(first) == 1 else 'columns'}, expected column {max(wanted) + 1}", line)
    values = table.numbers(wanted)
    hidden = are_unseen(values[0], unseen.encode())
    values[0][hidden] = 0
    for k, column in enumerate(values):
        for row in np.flatnonzero(~np.isfinite(column))[:1]:
            table.fail(f"{in_quotes(table.cells(row)[wanted[k]])} is not a finite number", table.rows[row][0])
    values[0][hidden] = np.nan
    if wrong_with_rows is not None and table.rows and (wrong := wrong_with_rows(values)):
        table.fail(wrong[1], table.rows[wrong[0]][0])
    if expected is not None and not expected.has(len(values[0])):
        table.fail(expected.wrong_count(len(values[0])), table.length)
    if not table.rows:
        table.fail("the file has no values", table.length)
    if numbering is None or expected is None or table.header is None:
        return values
    order = row_of_elements(values.pop(), expected)
    if isinstance(order, tuple):
        table.fail(f"column {in_quotes(table.header[numbering])} {order[1]}", table.rows[order[0]][0])
    return [column[order] for column in values]
