# SPDX-License-Identifier: GPL-3.0-or-later
"""`salbench import`: a data set in the HDF5 form. What is there and would be the same is left alone; what fails is taken out."""

from __future__ import annotations

import argparse
import os
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

from salbench import _core
from salbench.datasets import one_form, sets
from salbench.datasets.files import read_file
from salbench.datasets.records import Item, Listing
from salbench.system.console import ALL_DONE, SOME_FAILED, report, warn
from salbench.system.errors import InputError, StorageError, UnreadableError, message
from salbench.system.workers import Question, ask_all

MAX_SHOWN = 20  # remarks


@dataclass
class Made:
    """What a process made of the files of a shape."""

    image: bytes = b""  # empty where no view could be read
    items: list[Item] = field(default_factory=list)  # as the index has them
    problems: list[str] = field(default_factory=list)  # views, and files of the recording, that are not in the set
    remarks: list[str] = field(default_factory=list)  # on rows of the recording that cannot be used


@dataclass
class Imported:
    """A shape that was selected."""

    name: str
    outcome: str = "failed"  # of its file: written, unchanged, failed
    problem: str = ""  # why it, one of its views, or a file of its recording is not in the set: one line
    remarks: list[str] = field(default_factory=list)  # further problems, and remarks: a line each


@dataclass
class Import:
    layout: str
    shapes: list[Imported]
    notes: list[str]
    removed: int = 0  # files of shapes that are not in the set any more
    complete: bool = True  # False: interrupted

    @property
    def problems(self) -> int:
        return sum(bool(shape.problem) for shape in self.shapes)

    def count(self, outcome: str) -> int:
        return sum(shape.outcome == outcome for shape in self.shapes)


def import_set(layout: str, root: str, to: str, items: str = "", split: str = "", done: Callable[[int, int], None] | None = None) -> Import:
    """Writes items/NAME.h5 for each selected shape, with all of its views, and index.csv of them. Throws InputError, and StorageError where the
    system is in trouble: then the set is as it was."""
    if layout == sets.FORM:
        raise InputError(f"import: {layout} is the HDF5 form already")
    try:
        dataset, listing = sets.listed(layout, os.path.normpath(root))
        layout = dataset.layout or dataset.name
        theirs = {os.path.realpath(folder) for folder in (root, *(os.path.dirname(path) for path in sets.files_of(listing)))}
        if theirs & {os.path.realpath(to), os.path.realpath(os.path.join(to, "items"))}:
            raise InputError(f"--to {to}: is a folder of the data set itself; choose another")
        selected = _selected(listing, items, split)
        try:
            writer = one_form.Writer(to, dataset.name, "choose another with --to")
        except UnreadableError:
            raise
        except InputError as error:
            raise InputError(f"--to {error}") from None
        with writer:
            return _import(layout, root, writer, dataset, listing, selected, done)
    except (UnreadableError, OSError, MemoryError) as error:
        text = "no memory for it" if isinstance(error, MemoryError) else str(error)
        raise StorageError(f"{text}; the set in {to} is as it was") from None


def _import(layout: str, root: str, writer: one_form.Writer, dataset: sets.Dataset, listing: Listing, selected: dict[str, list[Item]],
            done: Callable[[int, int], None] | None) -> Import:
    found = [Imported(name) for name in selected]
    answered: list[Imported] = []

    def take(number: int, made: Made | None, problem: str) -> None:
        shape = found[number]
        wrong = [problem] if made is None else made.problems
        shape.problem, shape.remarks = wrong[0] if wrong else "", wrong[1:] + (made.remarks if made else [])
        if made and made.image:
            shape.outcome = "written" if writer.put(made.items, made.image) else "unchanged"
        answered.append(shape)
        if done is not None:
            done(len(answered), len(found))

    complete = ask_all([Question("salbench.datasets.importing:made_of", (layout, os.path.normpath(root), dataset.licence, views), sets.place_of(views[0]),
                                 tuple(path for view in views for path in (*view.files, view.saliency, *view.picks) if path))
                        for views in selected.values()], take)
    unasked = {shape.name for shape in found} - {shape.name for shape in answered}  # after Ctrl-C
    removed = writer.finish(listing.remark, [row for row in writer.before if row[0].shape_name in unasked],
                            {item.name: number for number, item in enumerate(listing.items)})
    return Import(dataset.name, [shape for shape in found if shape in answered], listing.notes, removed, complete)


def made_of(layout: str, root: str, licence: str, views: list[Item]) -> Made:
    """A shape with all of its views. What is wrong with a file is taken out; what the system lacks is an error."""
    dataset = sets.find(layout)
    made, truths, whole = Made(), {}, None
    for view in views:
        try:
            shape = dataset.read(view)
            if whole is None:
                _core.shape_facts(shape, os.fsencode(view.shape_name), os.fsencode(sets.place_of(view)))
        except (UnreadableError, MemoryError) as error:
            raise StorageError(message(error)) from None
        except ValueError as error:
            made.problems.append(str(error))
            continue
        whole = whole or shape
        truths[view.view] = shape
        made.items.append(replace(one_form.row_of(view, shape), shape=view.shape, view=view.view))
    if whole is not None:
        about = one_form.about(views[0], dataset.name, files=_digests(made.items, views, root), licence=licence)
        made.image = one_form.image(whole, truths, about)
        made.problems += whole.problems
        made.remarks = whole.remarks
    return made


def _digests(items: list[Item], views: list[Item], root: str) -> str:
    """What xxh128sum prints of the files of the views that were read."""
    names = {item.name for item in items}
    files = {path for view in views if view.name in names for path in (*view.files, view.saliency, *view.picks) if path}
    return "".join(f"{_core.xxh128(read_file(path))}  {os.path.relpath(path, root)}\n" for path in sorted(files))


def _selected(listing: Listing, items: str, split: str) -> dict[str, list[Item]]:
    """Items by shape, as a whole, whichever of its views are named."""
    try:
        chosen = {item.shape_name for item in sets.chosen(listing, items or None, split)}
    except KeyError as error:  # a name that there is not
        raise InputError(error.args[0]) from None
    selected: dict[str, list[Item]] = {}
    for item in listing.items:
        if item.shape_name in chosen:
            selected.setdefault(item.shape_name, []).append(item)
    return selected


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
