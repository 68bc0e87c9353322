# SPDX-License-Identifier: GPL-3.0-or-later
"""Splits of a data set (train, val, test): from a table, from a list of paths, or by name. Each function
takes a listing and assigns splits to its items."""

from __future__ import annotations

import io
import math
import os
import re
from collections.abc import Iterable, Mapping

from salbench.datasets.files import exists
from salbench.datasets.records import Listing
from salbench.system.csv import missing, read_rows
from salbench.system.errors import require_line
from salbench.system.files import AnyPath, read_file

ROUNDING = 1e-9  # for the sum of shares, so that no line is lost
_PATH = re.compile(r' *(?:"([^"]*)"|([^,;\t]*)).*')  # first column of a line

Entry = tuple[str, str, str]  # split, name, and where it is written


def from_table(listing: Listing, path: AnyPath, item: str = "item", split: str = "split") -> Listing:
    """Reads splits from a table with these columns, separated by commas, semicolons or tabs. Items without
    one are in no split; an item may be named by its file, "cat.off"."""
    file, text = os.fspath(path), _text(listing, path)
    if text is None:
        return listing
    _, columns, rows = read_rows(io.StringIO(text, newline=""), file, _separator_of(text))
    for column in (item, split):
        if column not in columns:
            raise missing(file, column, columns)
    named, part = columns.index(item), columns.index(split)
    names = {one.shape_name for one in listing.items}

    def name_of(text: str) -> str:
        stem = os.path.splitext(text)[0]
        return stem if text not in names and stem in names else text

    return _divide(
        listing, file, [(row[part], name_of(row[named]), f"{file}:{line}") for line, row in rows if row[part]]
    )


def _separator_of(text: str) -> str:
    """Separator of the first line that is no remark."""
    header = next((line for line in text.splitlines() if line and not line.startswith("#")), "")
    return next((between for between in ",;\t" if between in header), ",")


def from_list(listing: Listing, path: AnyPath, shares: Mapping[str, float]) -> Listing:
    """Reads a file with one path of an item's file per line. Each split has its share of the lines, in their
    order; shares sum to 1."""
    file, lines = os.fspath(path), (_text(listing, path) or "").splitlines()
    paths = [
        (_PATH.sub(r"\1\2", line).strip(), f"{file}:{number}")
        for number, line in enumerate(lines, 1)
        if line.strip()
    ]
    names, total = {one.shape_name for one in listing.items}, 0.0
    entries: list[Entry] = []
    for split, share in shares.items():
        total += share
        for place, where in paths[len(entries) : math.floor(min(1.0, total) * len(paths) + ROUNDING)]:
            name = re.split(r"[/\\]", place)[-1]  # also Windows paths
            entries.append((split, name if name in names else os.path.splitext(name)[0], where))
    return _divide(listing, file, entries)


def from_names(listing: Listing, splits: Mapping[str, Iterable[str]], where: str = "splits") -> Listing:
    """Assigns splits by name: {"train": ["cat", "dog"], "test": ["eel"]}"""
    return _divide(
        listing, where, [(split, name, where) for split, names in splits.items() for name in names]
    )


def _text(listing: Listing, path: AnyPath) -> str | None:
    file = listing.splits_where = os.fspath(path)
    listing.read.append(file)
    listing.no_splits = "" if exists(file) else f"{file}: is missing"
    return None if listing.no_splits else read_file(file).decode("utf-8-sig", "surrogateescape")


def _divide(listing: Listing, where: str, entries: Iterable[Entry]) -> Listing:
    listing.splits_where, names = where, {one.shape_name for one in listing.items}
    first: dict[str, Entry] = {}
    problems: dict[str, str] = {}
    for split, name, place in entries:
        require_line(split, f"{place}: the split")
        if name not in names:
            listing.unknown.append((split, name, place))
        elif (before := first.setdefault(name, (split, name, place)))[0] != split:
            problems.setdefault(
                name,
                (
                    f"{place}: '{name}' is in the split '{split}', and by {before[2]} in '{before[0]}': keep"
                    " one of them, or call the split after both: train+test"
                ),
            )
    for one in listing.items:
        one.problem = one.problem or problems.get(one.shape_name, "")
        one.truth = one.truth or bool(one.problem)
        one.split = (
            "" if one.shape_name in problems or one.shape_name not in first else first[one.shape_name][0]
        )
    # same wording as the engine, where a run over the split reports it as an error
    if listing.unknown:
        split, name, place = listing.unknown[0]
        others = len({name for _, name, _ in listing.unknown})
        listing.notes.append(
            f"{place}: the split '{split}' names '{name}', which is no item of the data set"
            f"{'' if others == 1 else f' ({others} such names)'}: correct the name, or add its files"
        )
    return listing
