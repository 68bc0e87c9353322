# SPDX-License-Identifier: GPL-3.0-or-later
"""Columns of a text of numbers, a row per line: CSV, or words between blanks.

The first lines tell separator, header and columns. All rows are then converted at once; where one of them is not plainly numbers, row by
row, which takes what else may stand in a text, and names the line that cannot be used.
"""

from __future__ import annotations

import csv
import itertools
import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NoReturn

import numpy as np

from salbench._csv import WRONG
from salbench.datasets._order import Elements, numbering_column, row_of_elements
from salbench.datasets._text import BLANKS, decimal_comma_in, fits, in_quotes, is_number, is_same_number, lines_of, number_in
from salbench.datasets.records import Floats, InputError

if TYPE_CHECKING:
    from numpy.typing import NDArray

MAX_NAMED = 20  # columns in a message
_PLAIN = b"0123456789+-.eE,; \t\r\nnNaA"  # and nan
_ODD = re.compile(rb'["#\v\f\x80-\xff]')  # outside quotes
NUMPY_BLANKS = re.compile(rb"[\0\x1c-\x1f\x85\xa0]")  # what NumPy takes for a blank, or for an end
_TINY = re.compile(rb"[eE]-0*(?:[3-9][0-9]{2}|[0-9]{4})")  # numbers that no double may hold
_LONG = re.compile(rb"[0-9.]{300}")
_ZEROS_IN_FRONT = re.compile(rb",[ \t]*[-+]?0[0-9]")
_WHOLE = re.compile(rb"[-+]?[0-9]+")
_ANY_IN_QUOTES = re.compile(rb'"(?:[^"]|"")*"')
_IN_QUOTES = {  # whole cells within a line
    separator: re.compile(rb'(?:^|(?<=[%b])) *"(?:[^"\n]|"")*" *(?=[%b]|$)' % (blanks, blanks), re.MULTILINE)
    for separator, blanks in ((b",", b","), (b";", b";"), (b"\t", b"\t"), (b" ", b" \t"))}
_NO_NAME = re.compile(rb"[-+]?[0-9.]+#")  # 1.#INF, as Microsoft's C library wrote an infinity
_TO_BLANKS = bytes.maketrans(b"\t\v\f", b"   ")

Cells = list[bytes]
WrongWithRows = Callable[[list[Floats]], "tuple[int, str] | None"]  # the first row that cannot be used, and why


def are_unseen(values: Floats, word: bytes) -> NDArray[np.bool_]:
    """True of the number that this word is."""
    number = number_in(word)
    return np.zeros(len(values), bool) if number is None else np.asarray(np.isnan(values) if number != number else values == number)


def _rows_of(lines: Sequence[bytes], separator: bytes, begin: int = 0) -> Iterator[tuple[int, Cells]]:
    """The line on which each row begins, from `begin` on, and its cells. Blank lines and comments are no rows; a row has several lines where
    a quoted cell has line ends. Throws _BadRow."""
    row = -1  # the line on which the row begins that is read; -1: none

    def texts() -> Iterator[str]:
        nonlocal row
        for line in range(begin, len(lines)):
            text = lines[line].translate(_TO_BLANKS).strip() if separator == b" " else lines[line].strip(b" ")
            if row < 0:
                start = text.lstrip(BLANKS)[:1]
                if start in (b"", b"#"):
                    continue
                row = line
            yield text.decode("latin-1") + "\n"

    reader = csv.reader(texts(), delimiter=separator.decode(), skipinitialspace=True, strict=True)
    try:
        for cells in reader:
            yield row, [cell.encode("latin-1").strip(BLANKS) for cell in cells]
            row = -1
    except csv.Error as error:
        raise _BadRow(row, WRONG.get(str(error), str(error))) from None


class _BadRow(Exception):
    """The line on which it begins, and what is wrong."""


def _cells_of(text: bytes, separator: bytes) -> Cells:
    """Of one row; none where its quotes are not those of such a row."""
    try:
        for _, cells in _rows_of(text.split(b"\n"), separator):
            return cells
    except _BadRow:
        pass
    return []


def _separates_decimal_commas(separator: bytes, row: bytes) -> bool:
    """True of "0,5;1" for semicolons: numbers, with a comma within one of them at least."""
    cells = _cells_of(row, separator)
    return (len(cells) > 1 and any(decimal_comma_in(cell) for cell in cells)
            and all(is_number(cell) or decimal_comma_in(cell) for cell in cells))


def separator_of(row: bytes) -> bytes:
    """Commas, semicolons or tabs, whichever the first row has outside quotes; else blanks."""
    outside = _ANY_IN_QUOTES.sub(b"", row)
    of_commas = next((separator for separator in (b";", b"\t", b" ") if _separates_decimal_commas(separator, row)), None)
    return next((separator for separator in (b",", b";", b"\t") if separator in outside), b" ") if of_commas is None else of_commas


def are_names(cells: Cells) -> bool:
    return any(word and not is_number(word) and not decimal_comma_in(word) and not _NO_NAME.match(word) for word in cells)


def _filled(cells: Cells) -> int:
    """How many there are, without empty ones at the end."""
    return next((n for n in range(len(cells), 0, -1) if cells[n - 1]), 0)


def column_number(column: str) -> int:
    """From 1, of a column without a header; 0 for a name."""
    return int(column) if re.fullmatch("[0-9]{1,9}", column) else 0


@dataclass
class _Table:
    """The lines of a text, and which cells of them are wanted."""

    name: str
    lines: list[bytes]
    columns: Sequence[str]
    unseen: bytes = b""  # of the first column: what stands for NaN
    separator: bytes = b" "
    header: Cells | None = None
    size: int = 0  # cells of the first line
    filled: int = 0  # without empty ones at its end
    places: tuple[int, ...] = ()
    numbering: int = -1  # place of the column that numbers the rows; -1: none
    begin: int = 0  # line of the first row, from 0

    def fail(self, what: str, line: int | None = None) -> NoReturn:
        number = len(self.lines) if line is None else line + 1
        raise InputError(f"{self.name}:{number}: {what}" if number else f"{self.name}: {what}")

    def read_header(self, elements: Elements | None) -> None:
        """The first row, or the last comment above it that has a name per column."""
        starts = ((line, text.lstrip(BLANKS)) for line, text in enumerate(self.lines))
        line = next((line for line, text in starts if text and not text.startswith(b"#")), len(self.lines))
        self.begin = line
        if line == len(self.lines):
            return
        quotes = itertools.accumulate(text.count(b'"') for text in self.lines[line:])
        end = next((k for k, before in enumerate(quotes, line + 1) if before % 2 == 0), len(self.lines))
        self.separator = separator_of(b"\n".join(self.lines[line:end]))
        rows = self.rows()
        _, first = next(rows)
        self.size, self.filled = len(first), _filled(first)
        comments = [text.lstrip(BLANKS)[1:] for text in self.lines[:line] if text.strip(BLANKS)]
        has_header = self._is_header(first)
        above = [names for comment in comments if len(names := _cells_of(comment, self.separator)) == self.size and are_names(names)]
        self.header = first if has_header else above[-1] if above else None
        self.places = tuple(self._place(column, line) for column in self.columns)
        if elements is not None and self.header is not None:
            self._find_numbering(elements, line)
        if has_header:
            self.begin = next(rows, (len(self.lines),))[0]

    def _is_header(self, first: Cells) -> bool:
        """True of names, but not where a column is meant by its number and has one."""
        by_number = [place for column in self.columns if 0 < (place := column_number(column)) <= len(first)]
        return are_names(first) and not (len(by_number) == len(self.columns) and all(is_number(first[place - 1]) for place in by_number))

    def rows(self) -> Iterator[tuple[int, Cells]]:
        try:
            yield from _rows_of(self.lines, self.separator, self.begin)
        except _BadRow as error:
            line, what = error.args
            self.fail(what, line)

    def _place(self, column: str, line: int) -> int:
        number = column_number(column)
        if not column or number:
            return max(number - 1, 0)
        if self.header is None:
            self.fail(f"no column {in_quotes(column.encode())}: the first line has numbers, not names of columns", line)
        name = column.encode("utf-8", "surrogateescape")
        if name in self.header:
            return self.header.index(name)
        known = ", ".join(in_quotes(name) for name in self.header[:MAX_NAMED]) + (", ..." if len(self.header) > MAX_NAMED else "")
        self.fail(f"no column {in_quotes(name)}: the header has {known}", line)

    def _find_numbering(self, elements: Elements, line: int) -> None:
        """Beside the only column, one that numbers the rows is no other."""
        assert self.header is not None
        only = self.columns == ("",)
        if only and len(self.header) != 2:
            return
        try:
            place = numbering_column(self.header, elements, () if only else self.places)
        except InputError as error:
            self.fail(str(error), line)
        if place is not None:
            self.numbering = place
            self.places = (1 - place,) if only else self.places

    def is_sure(self) -> bool:
        """Names of columns are wanted, or obeyed: none may stand above other columns, as R writes names of rows."""
        return self.header is not None and (self.numbering >= 0 or not all(map(column_number, self.columns)))

    # --- all rows at once

    def all_at_once(self) -> list[Floats] | None:
        """The columns, and that which numbers the rows; None if a row may have other cells than the first one, or a cell that `row` must
        judge. The first may have NaN."""
        rows = [line for line in self.lines[self.begin:] if line and not line.isspace()]
        body = b"\n".join(rows)
        is_plain = not body.translate(None, _PLAIN)  # NumPy sees by itself where rows have other cells
        cells = _IN_QUOTES[self.separator].sub(b"0", body) if b'"' in body else body
        if not rows or _TINY.search(body) or (max(map(len, rows)) > 300 and _LONG.search(body)):
            return None
        if not is_plain and (_ODD.search(cells) or NUMPY_BLANKS.search(body)):
            return None
        if self.separator == b"," and self.header is None and _ZEROS_IN_FRONT.search(cells):
            return None
        if self.columns == ("",) and self.size > (2 if self.numbering >= 0 else 1):
            return None
        wanted = [*self.places, *([self.numbering] if self.numbering >= 0 else [])]
        if max(wanted) >= self.size or not (is_plain or self._have_size(cells)):
            return None
        chosen: Any = None if is_plain else wanted
        try:
            table = np.loadtxt(rows, comments=None, ndmin=2, usecols=chosen, quotechar='"',
                               delimiter=None if self.separator == b" " else self.separator.decode())
        except ValueError:
            return None
        if is_plain and table.shape[1] != self.size:
            return None
        values = [table[:, place].copy() for place in (wanted if is_plain else range(len(wanted)))]
        unseen = are_unseen(values[0], self.unseen)
        if not all(np.isfinite(column[~unseen] if k == 0 else column).all() for k, column in enumerate(values)):
            return None
        values[0][unseen] = np.nan
        return values

    def _have_size(self, rows: bytes) -> bool:
        """True of as many cells in each as the first row has."""
        separator = self.separator
        return {len(row.split()) if separator == b" " else 1 + row.count(separator) for row in rows.split(b"\n")} == {self.size}

    # --- row by row

    def row(self, cells: Cells, line: int) -> list[float]:
        if self.separator == b",":
            self._check_commas(cells, line)
        if self.is_sure() and _filled(cells) > self.size:
            self.fail(f"{_filled(cells)} columns, but the header names {self.size}", line)
        wanted = [self._cell(cells, k, line) for k in range(len(self.places))]
        values = [self._value(cell, line, b"" if k else self.unseen) for k, cell in enumerate(wanted)]
        if self.numbering < 0:
            return values
        if self.numbering >= len(cells):
            assert self.header is not None
            self.fail(f"the line has no column {in_quotes(self.header[self.numbering])}", line)
        return [*values, self._value(cells[self.numbering], line, b"")]

    def _check_commas(self, cells: Cells, line: int) -> None:
        """A comma that separates may be a decimal one: "0,05" as two cells, or one cell more than the others have."""
        advice, filled = "write decimal commas, if these are some, as points", _filled(cells)
        if filled > self.size if self.header is not None else len(cells) != self.size and filled != self.filled:
            self.fail(f"{len(cells)} columns between commas, but the first line has {self.size}: {advice}", line)
        if (self.header is None and all(map(_WHOLE.fullmatch, cells)) and any(len(cell) > 1 and cell[:1] == b"0" for cell in cells[1:])):
            self.fail(f"whole numbers between commas, some with zeros in front: {advice}, or name the columns in a first line", line)

    def _cell(self, cells: Cells, k: int, line: int) -> bytes:
        if not self.columns[k] and len(cells) > (2 if self.numbering >= 0 else 1):
            comma = ", or write its decimal comma as a point" if len(cells) == 2 and decimal_comma_in(b",".join(cells)) else ""
            self.fail(f"the line has {len(cells)} columns, expected one value: keep that column alone, or, of ground truth, name it in the "
                      f"description (`column:`){comma}", line)
        if self.places[k] >= len(cells):
            column = self.columns[k]
            told = column if column_number(column) else in_quotes(column.encode())
            self.fail(f"the line has {len(cells)} {'column' if len(cells) == 1 else 'columns'}, expected column {told}", line)
        return cells[self.places[k]]

    def _value(self, cell: bytes, line: int, unseen: bytes) -> float:
        number = number_in(cell)
        if number is None:
            self.fail(f"{in_quotes(cell)} is not a number{decimal_comma_in(cell)}", line)
        if not fits(cell, number):
            self.fail(f"{in_quotes(cell)} does not fit a double", line)
        if unseen and is_same_number(number, unseen):
            return float("nan")
        if not abs(number) < float("inf"):
            self.fail(f"{in_quotes(cell)} is not a finite number", line)
        return number


def read_columns(text: bytes, name: str, columns: Sequence[str], unseen: str = "", expected: Elements | None = None,
                 wrong_with_rows: WrongWithRows | None = None) -> list[Floats]:
    """The columns named, each by its name in the header or by its number from 1, in the order of `columns`; "" is the only column of the
    text. A first row in which a word is no number is the header, unless columns are meant by numbers and have numbers there. Blank lines are
    skipped, and so are lines that begin with '#', of which the last before the numbers is a header if it has a word per column. Decimal commas
    are refused.

    With `expected`, rows come in the order of the elements: a column that numbers these is obeyed, and is none beside which the only column
    would not be the only one. A value of the first column that is `unseen` becomes NaN; all others must be finite."""
    table = _Table(name, lines_of(text), tuple(columns), unseen.encode())
    table.read_header(expected)
    values = table.all_at_once()
    if values is None:
        values = _row_by_row(table, wrong_with_rows)

    def line_of(row: int) -> int:
        return next(itertools.islice(table.rows(), row, None))[0]

    if wrong_with_rows is not None and (wrong := wrong_with_rows(values)):
        table.fail(wrong[1], line_of(wrong[0]))
    if expected is not None and not expected.has(len(values[0])):
        table.fail(expected.wrong_count(len(values[0])))
    if not len(values[0]):
        table.fail("the file has no values")
    if table.numbering < 0 or expected is None:
        return values
    assert table.header is not None
    order = row_of_elements(values.pop(), expected)
    if isinstance(order, tuple):
        table.fail(f"column {in_quotes(table.header[table.numbering])} {order[1]}", line_of(order[0]))
    return [column[order] for column in values]


def _row_by_row(table: _Table, wrong_with_rows: WrongWithRows | None) -> list[Floats]:
    rows: list[list[float]] = []
    lines: list[int] = []
    width = len(table.columns) + (table.numbering >= 0)

    def columns() -> list[Floats]:
        return list(np.array(rows).reshape(len(rows), width).T.copy())

    try:
        for line, cells in table.rows():
            rows.append(table.row(cells, line))
            lines.append(line)
    except InputError:
        if wrong_with_rows is not None and rows and (wrong := wrong_with_rows(columns())):
            table.fail(wrong[1], lines[wrong[0]])  # an earlier line
        raise
    return columns()
