# SPDX-License-Identifier: GPL-3.0-or-later
"""Rows of a file of gaze, block by block, whatever its length: columns between commas, semicolons, tabs or blanks, or JSON lines.

The rows of a block are converted at once. Those that are not plainly numbers are converted one by one, and no row ends the reading: one that
cannot be used says why.
"""

from __future__ import annotations

import csv
import json
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from salbench import _core
from salbench._files import open_regular
from salbench.datasets._gaze_causes import MAX_FLAGS, Wrong
from salbench.datasets._layout import Gaze
from salbench.datasets._numbers import MAX_NAMED, NUMPY_BLANKS, are_names, column_number, separator_of
from salbench.datasets._text import BLANKS, BYTE_ORDER_MARK, in_quotes, number_in
from salbench.datasets.records import Floats, InputError, Ints

BLOCK = 4 << 20
MAX_LINE = 1 << 20
MAX_NAME = 256  # bytes of an item or a person
_TOO_LONG = b"\0"  # behind the first MAX_NAME bytes of a longer name: neither an item nor a person can be called so
MAX_COMMENTS = 1000  # above the first row, the last of which may be its header
MAX_NAMES = 100_000
_MISSING = (b"", b"NA", b"N/A", b"null", b"None", b".", b"-")  # beside NaN
_TRUE, _FALSE = (b"true", b"True", b"TRUE"), (b"false", b"False", b"FALSE")
_WORDS = dict.fromkeys(_MISSING, float("nan")) | dict.fromkeys(_TRUE, 1.0) | dict.fromkeys(_FALSE, 0.0)
_TO_BLANKS = bytes.maketrans(b"\t\v\f", b"   ")
_NAN = float("nan")


@dataclass
class Block:
    """n rows."""

    lines: Floats  # (n,) of the file, from 1
    texts: list[Ints]  # of each column of names: (n,) numbers in `Rows.names`
    numbers: Floats  # (n, columns); NaN: missing, or no number
    wrong: Floats  # (n,) of Wrong


@dataclass
class _Row:
    texts: Sequence[bytes]
    numbers: Sequence[float | None]  # None: no number
    wrong: Wrong = Wrong.NOTHING
    words: Sequence[Any] = ()  # as which the numbers are written


class Rows:
    """Of one file. `names`, `flags` and `digest` are complete when all blocks have been read."""

    def __init__(self, path: str, gaze: Gaze, names_only: bool = False) -> None:
        """names_only: numbers are none of the blocks' columns."""
        texts = [name for name in (gaze.item, gaze.person) if name]
        self.path, self._texts, self._numbers = path, texts, gaze.numbers
        self._width = 0 if names_only else len(gaze.numbers)
        self._known: list[dict[bytes, int]] = [{} for _ in texts]
        self._flag = int(bool(gaze.time)) if gaze.valid and not names_only else -1  # its place among the numbers
        self._flags: dict[str, int] = {}
        self._digest = _core.Xxh128()

    @property
    def flags(self) -> list[str]:
        """Words in place of flags: the first MAX_FLAGS."""
        return list(self._flags)

    @property
    def names(self) -> list[list[str]]:
        return [[name.decode("utf-8", "surrogateescape") for name in known] for known in self._known]

    @property
    def digest(self) -> str:
        return str(self._digest.hex())

    def blocks(self) -> Iterator[Block]:
        """Throws InputError for a file that cannot be read, or has other columns than are named."""
        form: _Columns | _Json | None = None
        comments: list[bytes] = []
        has_rows = False
        for number, lines in self._lines():
            found = [(number + k, line) for k, line in enumerate(lines) if line and line[:1] != b"#" and not line.isspace()]
            if form is None:
                above = lines[:found[0][0] - number] if found else lines
                comments = [*comments, *(line[1:] for line in above if line[:1] == b"#")][-MAX_COMMENTS:]
                if found:
                    form, begin = self._form_of(comments, *found[0])
                    found = found[begin:]
            if form is not None and found:
                has_rows = True
                yield self._block(form, [line for line, _ in found], [row for _, row in found])
                if any(len(known) > MAX_NAMES for known in self._known):
                    raise InputError(f"{self.path}: more than {MAX_NAMES} items or people: are these their columns?")
        if not has_rows:
            raise InputError(f"{self.path}: has no rows")

    def _lines(self) -> Iterator[tuple[int, list[bytes]]]:
        """Lines of each block, with the number of the first."""
        number, left = 1, b""
        with open_regular(self.path) as file:
            while data := file.read(BLOCK):
                self._digest.add(data)
                if number == 1 and not left:
                    if data[:2] in (b"\xff\xfe", b"\xfe\xff") or b"\0" in data[:4096]:
                        raise InputError(f"{self.path}: is no text of UTF-8: save it as such")
                    data = data.removeprefix(BYTE_ORDER_MARK)
                data = left + data
                end = data.rfind(b"\n") + 1 or data.rfind(b"\r", 0, len(data) - 1) + 1
                left = data[end:]
                if len(left) > MAX_LINE:
                    raise InputError(f"{self.path}:{number + len(data[:end].splitlines())}: a line of more than {MAX_LINE} bytes")
                if end:
                    lines = data[:end].splitlines()
                    yield number, lines
                    number += len(lines)
        if left:
            yield number, left.splitlines()

    def _form_of(self, comments: list[bytes], line: int, row: bytes) -> tuple[_Columns | _Json, int]:
        """How rows are written, and how many of them are above the first one of numbers."""
        if row.lstrip(BLANKS)[:1] == b"{":
            return _Json(self.path, line, row, self._texts, self._numbers), 0
        form = _Columns(self.path, line, row, self._texts, self._numbers, comments)
        return form, int(form.has_header)

    def _block(self, form: _Columns | _Json, lines: list[int], rows: list[bytes]) -> Block:
        n = len(rows)
        block = Block(np.array(lines, float), [np.empty(n, np.int32) for _ in self._texts], np.full((n, self._width), _NAN), np.zeros(n))
        plain = form.plain(rows)
        if len(plain) and not self._at_once(form, block, plain, rows):
            plain = plain[:0]
        odd = np.ones(n, bool)
        odd[plain] = False
        for k in np.flatnonzero(odd):
            row = form.row(rows[k])
            for column, known, name in zip(block.texts, self._known, row.texts):
                column[k] = known.setdefault(name if len(name) <= MAX_NAME else name[:MAX_NAME] + _TOO_LONG, len(known))
            block.numbers[k] = [_NAN if number is None else number for number in row.numbers[:self._width]]
            block.wrong[k] = self._why(row)
        return block

    def _why(self, row: _Row) -> int:
        """One of Wrong. Words in place of flags have causes of their own: the tracker did not say that it lost the eye."""
        if row.wrong != Wrong.NOTHING or None not in row.numbers:
            return row.wrong
        if self._flag < 0 or row.numbers[self._flag] is not None:
            return Wrong.NO_NUMBER
        word = row.words[self._flag]
        text = word.decode("utf-8", "surrogateescape") if isinstance(word, bytes) else str(word)
        return Wrong.NO_FLAG + (self._flags.setdefault(text, len(self._flags)) if len(self._flags) < MAX_FLAGS else self._flags.get(text, MAX_FLAGS))

    def _at_once(self, form: _Columns | _Json, block: Block, plain: NDArray[np.int64], rows: list[bytes]) -> bool:
        chosen = rows if len(plain) == len(rows) else [rows[k] for k in plain]
        found = form.at_once(chosen, bool(self._width))
        if found is None:
            return False
        texts, numbers = found
        for column, known, names in zip(block.texts, self._known, texts):
            column[plain] = _numbered(names, known)
        if numbers is not None:
            block.numbers[plain] = numbers
        return True


def _numbered(names: NDArray[np.bytes_], known: dict[bytes, int]) -> Ints:
    """Names come in runs."""
    starts = np.flatnonzero(np.append(True, names[1:] != names[:-1]))
    unique, run = np.unique(names[starts], return_inverse=True)
    numbers = np.array([known.setdefault(bytes(name).strip(BLANKS), len(known)) for name in unique], np.int32)
    return np.repeat(numbers[run], np.diff(np.append(starts, len(names))))


def number_of(word: bytes) -> float | None:
    """None for what is no number, and no word for a missing one or for yes or no."""
    return _WORDS[word] if word in _WORDS else number_in(word)


class _Columns:
    def __init__(self, path: str, line: int, first: bytes, texts: Sequence[str], numbers: Sequence[str], comments: list[bytes]) -> None:
        self._separator = separator_of(first)
        cells = self._cells(first)
        if cells is None:
            raise InputError(f"{path}:{line}: a quote opens a field that nothing closes")
        wanted = [*texts, *numbers]
        by_number = [column_number(column) for column in wanted]
        of_numbers = [cells[place - 1] for place in by_number[len(texts):] if 0 < place <= len(cells)]
        self.has_header = not all(by_number) or any(number_of(cell) is None for cell in of_numbers)
        above = [names for comment in comments if (names := self._cells(comment)) and len(names) == len(cells) and are_names(names)]
        if not all(by_number) and all(number_of(cell) is not None for cell in cells) and above:
            cells, self.has_header = above[-1], False
        self._size = len(cells)
        self._is_sure = not all(by_number)
        self._places = [place - 1 if place else _place(column, cells, f"{path}:{line}") for column, place in zip(wanted, by_number)]
        self._texts, self._numbers = self._places[:len(texts)], self._places[len(texts):]
        self._size_of_row = len(numbers)

    def _cells(self, row: bytes) -> list[bytes] | None:
        text = (row.translate(_TO_BLANKS) if self._separator == b" " else row).strip(b" ").decode("latin-1")
        try:
            cells: list[str] = next(csv.reader([text], delimiter=self._separator.decode(), skipinitialspace=True, strict=True), [])
        except csv.Error:
            return None
        return [cell.encode("latin-1").strip(BLANKS) for cell in cells]

    def plain(self, rows: list[bytes]) -> NDArray[np.int64]:
        """Rows that have as many columns as the first one, and no quotes."""
        separator = self._separator
        if separator == b" ":
            plain = [k for k, row in enumerate(rows) if len(row.split()) == self._size and b'"' not in row and not NUMPY_BLANKS.search(row)]
        else:
            plain = [k for k, row in enumerate(rows) if row.count(separator) == self._size - 1 and b'"' not in row]
        return np.array(plain, np.int64) if self._size > max(self._places) else np.empty(0, np.int64)

    def at_once(self, rows: list[bytes], with_numbers: bool) -> tuple[list[NDArray[np.bytes_]], Floats | None] | None:
        """None where a cell is no number."""
        texts = self._loaded(rows, self._texts, f"S{MAX_NAME + 1}", encoding="latin-1") if self._texts else None
        numbers = None
        if with_numbers:
            numbers = self._loaded(rows, self._numbers)
            if numbers is None:
                numbers = self._loaded(self._with_numbers(rows), self._numbers)
            if numbers is None:
                return None
        if self._texts and texts is None:
            return None
        if any(len(found) != len(rows) for found in (texts, numbers) if found is not None):
            return None
        if texts is not None and np.char.str_len(texts).max() > MAX_NAME:
            return None
        return [] if texts is None else [np.ascontiguousarray(column) for column in texts.T], numbers

    def _loaded(self, rows: list[bytes], columns: list[int], kind: Any = float, **others: Any) -> Any:
        """None where a cell is none of this kind."""
        separator = None if self._separator == b" " else self._separator.decode()
        try:
            return np.loadtxt(rows, kind, comments=None, ndmin=2, delimiter=separator, usecols=columns, **others)
        except ValueError:
            return None

    def _with_numbers(self, rows: list[bytes]) -> list[bytes]:
        """Words for missing values, and for yes and no, as numbers."""
        separator = self._separator
        body = b"\n" + b"\n".join(rows) + b"\n"
        if separator == b" ":
            body = body.translate(_TO_BLANKS)
        for word, number in _WORDS.items():
            if separator == b" " and not word:
                continue
            for before, after in ((separator, separator), (separator, b"\n"), (b"\n", separator)):
                old, new = before + word + after, before + repr(number).encode() + after
                while old in body:
                    body = body.replace(old, new)
        return body[1:-1].split(b"\n")

    def row(self, row: bytes) -> _Row:
        cells = self._cells(row)
        if cells is None:
            return self._unusable(Wrong.OPEN_QUOTE, [])
        if max(self._places) >= len(cells):
            return self._unusable(Wrong.TOO_FEW, cells)
        texts, numbers = [cells[place] for place in self._texts], [number_of(cells[place]) for place in self._numbers]
        if self._is_sure and any(cells[self._size:]):
            return _Row(texts, numbers, Wrong.TOO_MANY)
        return _Row(texts, numbers, words=[cells[place] for place in self._numbers])

    def _unusable(self, why: Wrong, cells: list[bytes]) -> _Row:
        return _Row([cells[place] if place < len(cells) else b"" for place in self._texts], [_NAN] * self._size_of_row, why)


def _place(column: str, names: list[bytes], where: str) -> int:
    name = _bytes_of(column)
    if name in names:
        return names.index(name)
    raise InputError(f"{where}: no column {in_quotes(name)}: {_listed('the first line has', names)}")


def _listed(what: str, names: Sequence[bytes]) -> str:
    return f"{what} {', '.join(map(in_quotes, names[:MAX_NAMED]))}{', ...' if len(names) > MAX_NAMED else ''}"


class _Json:
    """An object per line. A column is the path of a key: names, and numbers from 0 of elements of lists, between points."""

    has_header = False

    def __init__(self, path: str, line: int, first: bytes, texts: Sequence[str], numbers: Sequence[str]) -> None:
        self._texts, self._numbers = ([_path_of(column) for column in columns] for columns in (texts, numbers))
        try:
            value = json.loads(first)
        except (ValueError, RecursionError):
            raise InputError(f"{path}:{line}: no JSON: expected an object per line") from None
        for column, find in zip((*texts, *numbers), (*self._texts, *self._numbers)):
            if find(value) is _ABSENT:
                raise InputError(f"{path}:{line}: no key {in_quotes(_bytes_of(column))}: {_listed('there are', [_bytes_of(key) for key in value])}")

    def plain(self, rows: list[bytes]) -> NDArray[np.int64]:
        return np.empty(0, np.int64)

    def at_once(self, rows: list[bytes], with_numbers: bool) -> None:
        return None

    def row(self, row: bytes) -> _Row:
        try:
            value = json.loads(row)
        except (ValueError, RecursionError):
            value = None
        texts, values = [find(value) for find in self._texts], [find(value) for find in self._numbers]
        names = [b"" if text is _ABSENT or text is None else _bytes_of(str(text).strip()) for text in texts]
        if _ABSENT in texts or _ABSENT in values:
            return _Row(names, [_NAN] * len(values), Wrong.NO_JSON)
        return _Row(names, [_json_number(one) for one in values], words=values)


_ABSENT = object()


def _path_of(column: str) -> Callable[[Any], Any]:
    steps = column.split(".")

    def find(value: Any) -> Any:
        if isinstance(value, dict) and column in value:
            return value[column]
        for step in steps:
            if isinstance(value, dict) and step in value:
                value = value[step]
            elif isinstance(value, list) and step.isdecimal() and int(step) < len(value):
                value = value[int(step)]
            else:
                return _ABSENT
        return value

    return find


def _bytes_of(text: str) -> bytes:
    """Those of a surrogate are no UTF-8."""
    try:
        return text.encode("utf-8", "surrogateescape")
    except UnicodeEncodeError:
        return text.encode("utf-8", "surrogatepass")


def _json_number(value: Any) -> float | None:
    if value is None:
        return _NAN
    if isinstance(value, (bool, int, float)):
        try:
            return float(value)
        except OverflowError:
            return float("inf")
    return number_of(value.strip().encode("utf-8", "replace")) if isinstance(value, str) else None
