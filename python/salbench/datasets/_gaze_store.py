# SPDX-License-Identifier: GPL-3.0-or-later
"""Rows of files of gaze by item. A file with rows of several items is read once per process: its rows go to a temporary file without a name,
which ends with the process, and an item's are read from there."""

from __future__ import annotations

import functools
import os
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from salbench.datasets._gaze_rows import Block, Rows
from salbench.datasets._layout import Gaze
from salbench.datasets.records import Floats

PERSON, LINE, WRONG = -3, -2, -1  # columns behind those of numbers


@dataclass
class FileRows:
    """Of one item in one file."""

    path: str
    table: Floats  # (n, numbers and three): numbers, number of the person, line, Wrong
    people: list[str]  # by these numbers; of a file of one person none
    flags: list[str]  # words in place of flags, as Rows has them
    digest: str


def rows_of(path: str, gaze: Gaze, item: str) -> FileRows:
    """The rows of an item, by the name that the file has for it. Throws InputError for a file that cannot be read."""
    if gaze.item:
        status = os.stat(path)
        return _stored(path, (status.st_size, status.st_mtime_ns, status.st_ino), replace(gaze, files=Gaze.files, cameras=Gaze.cameras)).of(item)
    rows = Rows(path, gaze)
    tables = [_table(block, gaze) for block in rows.blocks()]
    return FileRows(path, np.concatenate(tables), rows.names[-1] if gaze.person else [], rows.flags, rows.digest)


def _table(block: Block, gaze: Gaze) -> Floats:
    people: Any = block.texts[-1] if gaze.person else np.zeros(len(block.lines))
    return np.column_stack([block.numbers, people, block.lines, block.wrong])


@functools.lru_cache(maxsize=256)
def _stored(path: str, stamp: tuple[int, ...], gaze: Gaze) -> _Store:
    """stamp: of the file as it is now."""
    return _Store(path, gaze)


class _Store:
    def __init__(self, path: str, gaze: Gaze) -> None:
        self._path, self._file = path, tempfile.TemporaryFile()
        self._places: dict[int, list[tuple[int, int]]] = {}  # item -> where its rows are, and how many numbers
        rows = Rows(path, gaze)
        self._width = len(gaze.numbers) + 3
        for block in rows.blocks():
            for item, table in _by_item(block, gaze):
                self._places.setdefault(item, []).append((self._file.tell(), table.size))
                self._file.write(table.tobytes())
        items, *people = rows.names
        self._items = {name: number for number, name in enumerate(items)}
        self._people, self._flags, self._digest = (people[0] if people else []), rows.flags, rows.digest

    def of(self, item: str) -> FileRows:
        places = self._places.get(self._items.get(item, -1), [])
        table = np.empty(sum(size for _, size in places))
        filled = 0
        for place, size in places:
            self._file.seek(place)
            table[filled:filled + size] = np.frombuffer(self._file.read(8 * size))
            filled += size
        return FileRows(self._path, table.reshape(-1, self._width), self._people, self._flags, self._digest)


def _by_item(block: Block, gaze: Gaze) -> Iterator[tuple[int, Any]]:
    items = block.texts[0]
    order = np.argsort(items, kind="stable")
    table, items = _table(block, gaze)[order], items[order]
    starts = np.flatnonzero(np.append(True, items[1:] != items[:-1]))
    for start, end in zip(starts, np.append(starts[1:], len(items))):
        yield int(items[start]), table[start:end]


@dataclass
class Named:
    """An item and a person that rows of a file name."""

    item: str
    person: str
    rows: int
    line: int  # the first


def named_in(path: str, gaze: Gaze) -> list[Named]:
    """Every pair of them, in the order of the file. What names no column is ""."""
    rows = Rows(path, gaze, names_only=True)
    found: dict[tuple[int, ...], list[int]] = {}
    for block in rows.blocks():
        pairs, first, counts = np.unique(np.stack(block.texts, axis=1), axis=0, return_index=True, return_counts=True)
        for k in np.argsort(first):
            known = found.setdefault(tuple(int(number) for number in pairs[k]), [0, int(block.lines[first[k]])])
            known[0] += int(counts[k])
    items, people = rows.names[0] if gaze.item else [""], rows.names[-1] if gaze.person else [""]
    return [Named(items[pair[0]] if gaze.item else "", people[pair[-1]] if gaze.person else "", *told) for pair, told in found.items()]
