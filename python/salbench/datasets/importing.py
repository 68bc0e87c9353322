# SPDX-License-Identifier: GPL-3.0-or-later
"""Imports a data set into the HDF5 form. Files that would not change are left alone; failed shapes are
removed."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from salbench import _core
from salbench.datasets import one_form, sets
from salbench.datasets.files import read_file
from salbench.datasets.records import Item, Listing, arrays_of
from salbench.system.errors import InputError, StorageError, UnreadableError, message
from salbench.system.workers import ask_all

if TYPE_CHECKING:
    from salbench.datasets.samples import Fault


@dataclass
class Made:
    """Result of importing the files of one shape, in its own process."""

    image: bytes = b""  # empty if no view could be read
    items: list[Item] = field(default_factory=list)  # as in the index
    # views and recording files that are left out of the set
    problems: list[str] = field(default_factory=list)
    faults: list[Fault] = field(default_factory=list)  # unusable rows of the recording


@dataclass
class Imported:
    """A selected shape."""

    name: str
    outcome: str = ""  # for its file: written, unchanged, failed; "" until it is read
    problem: str = ""  # first reason why the shape, a view or a recording file is left out: one line
    problems: list[str] = field(default_factory=list)  # further ones
    faults: list[Fault] = field(default_factory=list)  # unusable rows of its recording


@dataclass
class Import:
    layout: str
    shapes: list[Imported]
    notes: list[str]
    removed: int = 0  # files of shapes that are no longer in the set
    complete: bool = True  # False: interrupted

    @property
    def problems(self) -> int:
        return sum(bool(shape.problem) for shape in self.shapes)

    def count(self, outcome: str) -> int:
        return sum(shape.outcome == outcome for shape in self.shapes)


def import_set(
    layout: str,
    root: str,
    to: str,
    items: str = "",
    split: str = "",
    done: Callable[[int, int], None] | None = None,
) -> Import:
    """Writes items/NAME.h5 for each selected shape, with all of its views, and index.csv for all of them.
    Throws InputError, and StorageError for trouble of the system: the set is then unchanged."""
    if layout == sets.FORM:
        raise InputError(f"import: {layout} is the HDF5 form already")
    try:
        root = os.path.normpath(root)
        dataset, listing = sets.listed(layout, root)
        theirs = {
            os.path.realpath(folder) for folder in (root, *(os.path.dirname(path) for path in listing.paths))
        }
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
            return _import(writer, dataset, listing, root, selected, done)
    except (UnreadableError, OSError, MemoryError) as error:
        text = "no memory for it" if isinstance(error, MemoryError) else str(error)
        raise StorageError(f"{text}; the set in {to} is as it was") from None


def _import(
    writer: one_form.Writer,
    dataset: sets.Dataset,
    listing: Listing,
    root: str,
    selected: dict[str, list[Item]],
    done: Callable[[int, int], None] | None,
) -> Import:
    shapes = [Imported(name) for name in selected]

    def tell() -> None:
        if done is not None:
            done(sum(bool(shape.outcome) for shape in shapes), len(shapes))

    def take(number: int, made: Made | None, problem: str) -> None:
        shape, made = shapes[number], made or Made(problems=[problem])
        shape.problem, *shape.problems = made.problems or [""]
        shape.faults = made.faults
        shape.outcome = (
            "failed" if not made.image else "written" if writer.put(made.items, made.image) else "unchanged"
        )
        tell()

    tell()
    complete = ask_all(
        [
            dataset.question("salbench.datasets.importing:made_of", views, root, dataset.licence, views)
            for views in selected.values()
        ],
        take,
    )
    unasked = {shape.name for shape in shapes if not shape.outcome}  # interrupted by Ctrl-C
    removed = writer.finish(
        listing.remark,
        [row for row in writer.before if row[0].shape_name in unasked],
        {item.name: number for number, item in enumerate(listing.items)},
    )
    return Import(
        dataset.name, [shape for shape in shapes if shape.outcome], listing.notes, removed, complete
    )


def made_of(layout: str, root: str, licence: str, views: list[Item]) -> Made:
    """Reads a shape with all of its views. Faulty files are left out; trouble of the system is an error."""
    dataset = sets.find(layout)
    made, truths, whole = Made(), {}, None
    for view in views:
        try:
            shape = dataset.read(view)
            if whole is None:
                _core.shape_facts(
                    arrays_of(shape, view.view, view.place),
                    os.fsencode(view.shape_name),
                    os.fsencode(view.place),
                )
        except (UnreadableError, MemoryError) as error:
            raise StorageError(message(error)) from None
        except ValueError as error:
            made.problems.append(str(error))
            continue
        whole = whole or shape
        truths[view.view] = shape
        made.items.append(replace(one_form.row_of(view, shape), shape=view.shape, view=view.view))
    if whole is not None:
        about = one_form.about(
            views[0], dataset.name, files=_digests(made.items, views, root), licence=licence
        )
        made.image = one_form.image(whole, truths, about)
        if whole.recording is not None:
            made.problems, made.faults = [*made.problems, *whole.recording.problems], whole.recording.faults
    return made


def _digests(items: list[Item], views: list[Item], root: str) -> str:
    """Digests of the files of the views that were read, as xxh128sum prints them."""
    names = {item.name for item in items}
    files = {path for view in views if view.name in names for path in view.paths}
    return "".join(
        f"{_core.xxh128(read_file(path))}  {os.path.relpath(path, root)}\n" for path in sorted(files)
    )


def _selected(listing: Listing, items: str, split: str) -> dict[str, list[Item]]:
    """Selected items by shape: all views of a shape if one is named."""
    try:
        chosen = {item.shape_name for item in sets.chosen(listing, items or None, split)}
    except KeyError as error:  # unknown name
        raise InputError(error.args[0]) from None
    selected: dict[str, list[Item]] = {}
    for item in listing.items:
        if item.shape_name in chosen:
            selected.setdefault(item.shape_name, []).append(item)
    return selected
