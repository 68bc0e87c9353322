# SPDX-License-Identifier: GPL-3.0-or-later
"""The splits of a data set (train, val, test), as a description says where they are written."""

from __future__ import annotations

import math
import os
import re
from collections.abc import Container
from dataclasses import dataclass, field

from salbench._errors import InputError, quoted, wrong_with_line
from salbench.datasets._csv import read_csv
from salbench.datasets._files import below, exists, read_file
from salbench.datasets._layout import Splits
from salbench.datasets._text import lines_of

ROUNDING = 1e-9  # of the sum of shares, which must not lose a line


@dataclass(frozen=True)
class Entry:
    """One item of a split, and where that is written."""

    item: str
    split: str
    where: str


@dataclass
class FoundSplits:
    of_item: dict[str, str] = field(default_factory=dict)  # those that are in one split
    problems: dict[str, str] = field(default_factory=dict)  # item -> why its split is not known
    unknown: list[Entry] = field(default_factory=list)  # names that are no items
    missing: str = ""  # the file that is not there: one line


def _last_name(line: bytes) -> str:
    """ "data\\rgb/Apple_v01.obj, maps/Apple_v01.csv" -> "Apple_v01.obj"; of a path in quotes all of it."""
    in_quotes = re.match(rb' *"((?:[^"]|"")*)"', line)
    path = in_quotes[1].replace(b'""', b'"') if in_quotes else re.split(rb"[,;\t]", line, maxsplit=1)[0].strip(b" ")
    return os.fsdecode(re.split(rb"[/\\]", path)[-1])


def _listed(file: str, splits: Splits, items: Container[str]) -> list[Entry]:
    names = [(name, number) for number, line in enumerate(lines_of(read_file(file)), 1) if (name := _last_name(line))]
    ends, total = [], 0.0
    for _, share in splits.shares:
        total += share
        ends.append(math.floor(min(1.0, total) * len(names) + ROUNDING))
    entries = []
    for place, (name, number) in enumerate(names):
        split = next((split for (split, _), end in zip(splits.shares, ends) if place < end), "")
        entries.append(Entry(name if name in items else os.path.splitext(name)[0], split, f"{file}:{number}"))
    return entries


def _entries(file: str, splits: Splits, items: Container[str]) -> list[Entry]:
    if splits.named:
        return [Entry(item, split, where) for split, named, where in splits.named for item in named]
    if splits.list:
        return _listed(file, splits, items)
    table = read_csv(file)
    rows = zip(table.column(splits.item), table.column(splits.split), table.lines)
    return [Entry(item, split, f"{file}:{line}") for item, split, line in rows if split]


def read_splits(root: str, splits: Splits, where: str, items: Container[str]) -> FoundSplits:
    """Reads the file of the splits, if there is one. A line of a list names an item by its last name, with or without extension."""
    found = FoundSplits()
    file = below(root, splits.table or splits.list)
    if not splits.named and not exists(file):
        found.missing = f"{file}: is missing ({where})"
        return found
    first: dict[str, Entry] = {}
    for entry in _entries(file, splits, items):
        if wrong := wrong_with_line(entry.split):
            raise InputError(f"{entry.where}: the split {quoted(entry.split)} has {wrong}, which tables cannot have: rename it")
        if entry.item not in items:
            found.unknown.append(entry)
        elif entry.item not in first:
            first[entry.item] = entry
            found.of_item[entry.item] = entry.split
        elif first[entry.item].split != entry.split:
            before = first[entry.item]
            found.of_item.pop(entry.item, None)
            found.problems.setdefault(entry.item, f"{entry.where}: '{entry.item}' is in the split '{entry.split}', and by {before.where} in "
                                                  f"'{before.split}': keep one of them")
    return found


def text_of_unknown(unknown: list[Entry]) -> str:
    """Of names that are no items: file and line of the first one, and what to do."""
    first, names = unknown[0], len({entry.item for entry in unknown})
    return (f"{first.where}: the split '{first.split}' names '{first.item}', which is no item of the data set"
            f"{'' if names == 1 else f' ({names} such names)'}: correct the name, or add its files")
