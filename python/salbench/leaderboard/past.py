# SPDX-License-Identifier: GPL-3.0-or-later
"""Submissions that left. A maintainer names them in withdrawn.csv beside the archives; what an earlier call had ranked and this one has not is
noted in left.csv of the site, without a date: no result depends on a clock. Both calls of two over the same files write the same."""

from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path

import pandas

from salbench._errors import InputError, quoted
from salbench._files import fail
from salbench.conclusions import csv_file
from salbench.leaderboard import texts
from salbench.leaderboard.cells import plain, text_of

WITHDRAWN = "withdrawn.csv"  # beside the archives
COLUMNS = ("file", "model", "date", "why")
_MOST_BYTES = 1 << 20  # of withdrawn.csv


@dataclass(frozen=True)
class Left:
    """A submission that is no longer ranked."""

    file: str
    model: str
    date: str  # of withdrawn.csv; empty: it is not named there
    why: str


@dataclass(frozen=True)
class Past:
    """What was before this call."""

    withdrawn: tuple[Left, ...] = ()
    noted: tuple[Left, ...] = ()  # by earlier calls
    ranked: tuple[tuple[str, str], ...] = ()  # file and model of what the last call had ranked, or beside the ranking

    def left(self, ranked: Mapping[str, str], refused: Mapping[str, str]) -> list[Left]:
        """Those of withdrawn.csv in its order, then others by name. ranked: file -> its model, now; refused: file -> why."""
        known = {one.file for one in self.withdrawn}
        files_of = {model: file for file, model in ranked.items()}

        def why(file: str, model: str) -> str:
            if file in refused:
                return f"refused: {refused[file]}"
            if file in ranked:
                return f"its file holds {ranked[file]} now"
            return f"{files_of[model]} took its place" if model in files_of else "its file is no longer there"
        found = {(file, model): why(file, model) for file, model in self.ranked}
        found |= {(one.file, one.model): why(one.file, one.model) if one.file in {*refused, *ranked} else one.why for one in self.noted}
        return [*self.withdrawn, *(Left(file, model, "", found[file, model]) for file, model in sorted(found)
                                   if file not in known and ranked.get(file) != model)]


def read_past(submissions: Path, files: Iterable[str], site: Path) -> Past:
    """files: names of the archives. Throws InputError for a withdrawn.csv that cannot be used, and for a site with tables that are not its own."""
    withdrawn = _read_withdrawn(submissions / WITHDRAWN, set(files))
    rows = _rows(site / "data/submissions.csv", ("file", "model", "status"))  # before left.csv, which is written before it: folder.py
    ranked = tuple((row["file"], row["model"]) for row in rows if row["status"] in ("ranked", "beside"))
    return Past(withdrawn, tuple(Left(**row) for row in _rows(site / "data/left.csv", COLUMNS) if not row["date"]), ranked)


def framed(left: Iterable[Left]) -> pandas.DataFrame:
    return pandas.DataFrame([{name: plain(text) for name, text in asdict(one).items()} for one in left], columns=[*COLUMNS], dtype=object)


def _read_withdrawn(path: Path, files: set[str]) -> tuple[Left, ...]:
    found: dict[str, Left] = {}
    if path.is_file() and path.stat().st_size > _MOST_BYTES:
        raise InputError(f"{path}: has {path.stat().st_size} bytes, expected at most {_MOST_BYTES}; shorten it")
    for line, row in _lines(path, COLUMNS):
        def refuse(what: str, line: int = line) -> InputError:
            return InputError(f"{path}:{line}: {what}")
        if row["file"] in files:
            raise refuse(f"{row['file']} is still among the submissions; move it elsewhere, or take this line out: a new version is a new file")
        if not row["file"] or row["file"] in found:
            raise refuse(f"{row['file']} is there twice" if row["file"] else "names no file")
        if not texts.is_date(row["date"]):
            raise refuse(f"date is {quoted(row['date'])}, expected one such as 2026-11-23")
        found[row["file"]] = Left(**{name: texts.line(cell, f"{path}:{line}: {name}") for name, cell in row.items()})
    return tuple(found.values())


def _rows(path: Path, columns: tuple[str, ...]) -> list[dict[str, str]]:
    """Of a table of the site, where an earlier call made one."""
    if path.is_symlink():
        return []
    try:
        return [{name: texts.shown(text_of(cell)) for name, cell in row.items()} for _, row in _lines(path, columns)]
    except InputError as error:
        raise InputError(f"{error}; remove the folder of the site, which forgets what left before") from None


def _lines(path: Path, columns: tuple[str, ...]) -> list[tuple[int, dict[str, str]]]:
    """None where there is no such file."""
    if not path.is_file():
        return []
    try:
        table = csv_file.read_csv(path)
    except OSError as error:
        fail(path, "read", error)
    csv_file.require(table, *columns)
    return [(int(line), row) for line, row in zip(table.index, table[[*columns]].to_dict("records"))]
