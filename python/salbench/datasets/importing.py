# SPDX-License-Identifier: GPL-3.0-or-later
"""`salbench import`: a data set in the one form. What is there and would be the same is left alone; what fails is taken out."""

from __future__ import annotations

import argparse
import json
import os
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from salbench._console import ALL_DONE, SOME_FAILED, report, warn
from salbench._errors import InputError, StorageError, UnreadableError
from salbench._files import OwnFolder
from salbench._serving import message
from salbench._workers import ask_all
from salbench.datasets import described, one_form, sets
from salbench.datasets.records import Item, Listing
from salbench.datasets.worker import Told


MAX_SHOWN = 20  # remarks


@dataclass
class Imported:
    """A shape that was selected."""

    name: str
    outcome: str = "failed"  # of its file: written, unchanged, failed
    problem: str = ""  # why it, one of its views, or a file of its recording is not in the set: one line
    remarks: list[str] = field(default_factory=list)  # on rows of its recording that cannot be used, and further problems: a line each
    rows: list[one_form.Row] = field(default_factory=list)


@dataclass
class Import:
    layout: str
    shapes: list[Imported]
    notes: list[str]
    removed: int = 0  # files of shapes that the source no longer has
    complete: bool = True  # False: interrupted

    @property
    def problems(self) -> int:
        return sum(bool(shape.problem) for shape in self.shapes)

    def count(self, outcome: str) -> int:
        return sum(shape.outcome == outcome for shape in self.shapes)


def import_set(layout: str, root: str, to: str, items: str = "", split: str = "", done: Callable[[int, int], None] | None = None) -> Import:
    """Writes items/NAME.h5 for each selected shape, with all of its views, and index.csv of them and of those that were there before. Throws
    InputError, and StorageError where the system is in trouble: then the set is as it was."""
    if layout == sets.ONE_FORM:
        raise InputError(f"import: {layout} is the one form already")
    try:
        return _import_set(layout, os.path.normpath(root), to, items, split, done)
    except (UnreadableError, OSError, MemoryError) as error:
        raise StorageError(f"{message(error)}; the set in {to} is as it was") from None


def _import_set(layout: str, root: str, to: str, items: str, split: str, done: Callable[[int, int], None] | None) -> Import:
    layout_name, listing = sets.listed(layout, root)
    theirs = {os.path.realpath(folder) for folder in (root, *(os.path.dirname(path) for path in listing.files()))}
    if theirs & {os.path.realpath(to), os.path.realpath(os.path.join(to, "items"))}:
        raise InputError(f"--to {to}: is a folder of the data set itself; choose another")
    selected = _selected(listing, items, split)
    with one_form.own(to) as own:
        return _import(layout if layout != sets.AUTOMATIC else layout_name, root, own, layout_name, listing, selected, done)


def _import(archive: str, root: str, to: OwnFolder, layout_name: str, listing: Listing, selected: list[Item],
            done: Callable[[int, int], None] | None) -> Import:
    places = {item.name: number for number, item in enumerate(listing.items)}
    before = _rows_before(to.path, root, layout_name, places)
    shapes: dict[str, list[Item]] = {}
    for item in selected:
        shapes.setdefault(item.shape_name, []).append(item)
    to.require_folder("items")

    found = [Imported(name) for name in shapes]
    answered = [False] * len(found)

    def take(number: int, made: bytes | None, problems: list[str]) -> None:
        _take(found[number], shapes[found[number].name], made, problems, to, layout_name)
        answered[number] = True
        if done is not None:
            done(sum(answered), len(found))

    requests = [{"do": "shape", "layout": archive, "root": root, "licence": listing.licence, "items": [item.to_json() for item in views]}
                for views in shapes.values()]
    complete = ask_all(requests, take)
    found = [shape for shape, known in zip(found, answered) if known]
    renewed = {shape.name for shape in found}
    rows = [row for row in before if row[0] not in renewed and _name(row) in places] + [row for shape in found for row in shape.rows]
    removed = one_form.put_index(to, sorted(rows, key=lambda row: places[_name(row)]), [row for row in before if row[0] not in renewed],
                                 listing.remark)
    for shape in found:
        if shape.outcome == "failed":
            to.remove(one_form.name_of(shape.name))
    return Import(layout_name, found, listing.notes, removed, complete)


def _take(shape: Imported, views: list[Item], made: bytes | None, problems: list[str], to: OwnFolder, source: str) -> None:
    """Puts what a worker made of a shape into the set."""
    told = Told(**json.loads(problems.pop())) if problems and problems[-1].startswith("\t") else None
    failed = dict(line.partition("\t")[::2] for line in problems if "\t" in line)
    wrong = [*failed.values(), *problems[:not failed], *(told.problems if told else ())]
    shape.problem = wrong[0] if wrong else ""
    shape.remarks = wrong[1:] + told.remarks if told else []
    if made is None:
        return
    shape.outcome = "written" if one_form.put(to, one_form.name_of(shape.name), made) else "unchanged"
    shape.rows = [(shape.name, view.view, view.category, view.split, view.kind or described.kind_of(sets.shape_file(view)), view.truth,
                   view.participants, view.viewers, source, told.recorded if told else 0) for view in views if view.name not in failed]


def _rows_before(to: str, root: str, layout: str, places: dict[str, int]) -> list[one_form.Row]:
    """The index that is there, of the same set."""

    def refuse(what: str) -> InputError:
        return InputError(f"--to {to}: {what}; choose another folder")

    if other := one_form.foreign_in(to):
        raise refuse(f"holds {other!r}, and no data set")
    try:
        rows = one_form.read_index(to)
    except UnreadableError:
        raise
    except ValueError as error:
        raise refuse(f"holds something else: {error}") from None
    for row in rows:
        if row[one_form.SOURCE] != layout:
            raise refuse(f"holds another set, read with the layout {row[one_form.SOURCE]}")
    if rows and not any(_name(row) in places for row in rows):
        raise refuse(f"holds another set, of which no item is in {root}")
    return rows


def _name(row: one_form.Row) -> str:
    return f"{row[0]}_{row[1]}" if row[1] else row[0]


def _selected(listing: Listing, items: str, split: str) -> list[Item]:
    """Shapes as a whole, whichever of their views are named."""
    try:
        chosen = sets.chosen(listing, items or None, split)
    except KeyError as error:  # a name that there is not
        raise InputError(error.args[0]) from None
    shapes = {item.shape_name for item in chosen}
    return [item for item in listing.items if item.shape_name in shapes]


class _Progress:
    """On standard error: a line that is written over on a terminal, else one every ten seconds."""

    def __init__(self) -> None:
        self._begin = self._shown = time.monotonic()
        self._on_terminal = sys.stderr.isatty()

    def __call__(self, done: int, items: int) -> None:
        now = time.monotonic()
        if done < items and now - self._shown < (0.1 if self._on_terminal else 10):
            return
        self._shown = now
        left = (items - done) * (now - self._begin) / done
        text = f"importing: {done}/{items} items, {left:.0f} s left"
        print(f"\r{text}\033[K" if self._on_terminal else text, end="" if self._on_terminal and done < items else "\n", file=sys.stderr, flush=True)


def command(given: argparse.Namespace) -> int:
    """given: the arguments of the command. Returns the status."""
    layout, data = sets.given_data("import", given)
    done = import_set(layout, data, given.to, given.items, given.split, None if given.quiet else _Progress())
    for note in done.notes:
        warn("warning", note)
    for shape in done.shapes:
        if shape.problem:
            warn("error", f"{shape.name}: {shape.problem}")
    for line in _shown([f"{shape.name}: {remark}" for shape in done.shapes for remark in shape.remarks]):
        warn("warning", line)
    if not done.complete:
        print(f"\n{len(done.shapes)} shapes are done", file=sys.stderr)
        raise KeyboardInterrupt
    report(given, "import", _document(done), _text(done, given.to))
    return SOME_FAILED if done.problems else ALL_DONE


def _shown(remarks: list[str]) -> list[str]:
    more = len(remarks) - MAX_SHOWN
    return remarks[:MAX_SHOWN] + ([f"{more} more remarks on rows of recordings, which --format json has"] if more > 0 else [])


def _document(done: Import) -> dict[str, Any]:
    return {"layout": done.layout, "shapes": [{"name": shape.name, "outcome": shape.outcome, "problem": shape.problem, "remarks": shape.remarks} for shape in done.shapes],
            "written": done.count("written"), "unchanged": done.count("unchanged"), "removed": done.removed, "n_problems": done.problems}


def _text(done: Import, to: str) -> str:
    return (f"{done.count('written')} of {len(done.shapes)} shapes written to {to}, {done.count('unchanged')} unchanged, {done.removed} removed, "
            f"{done.problems} with problems\n")
