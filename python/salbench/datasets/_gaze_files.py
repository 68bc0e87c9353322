# SPDX-License-Identifier: GPL-3.0-or-later
"""Which files hold the recordings of gaze on the items of a data set, and of whom."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field

from salbench.datasets._files import below
from salbench.datasets._layout import Layout
from salbench.datasets._patterns import expected_name, files_like, filled_in, place_of
from salbench.datasets._text import quoted
from salbench.datasets.records import InputError

MAX_NAMED = 5  # of what belongs to no item, in notes


@dataclass
class OfItem:
    """Recordings of an item."""

    rows_of: str = ""  # its name in the files
    files: list[tuple[str, str]] = field(default_factory=list)  # path, person; "": a column names people
    people: set[str] = field(default_factory=set)
    cameras: list[tuple[str, str]] = field(default_factory=list)  # path, person; "": of everybody who has none of their own


def find_gaze(layout: Layout, root: str, items: Iterable[str], notes: list[str]) -> dict[str, OfItem]:
    """By item. A file is read where its name does not say of what and of whom it is."""
    gaze, known, aliases = layout.recording, set(items), dict(layout.aliases)
    found = files_like(root, gaze.files, {*known, *aliases})
    if not found.fit and layout.needs_truth:
        raise InputError(f"{layout.where(gaze.files.where)}: '{gaze.files}' fits no recording of gaze; expected are such as "
                         f"{place_of(root, gaze.files)}")
    notes += [f"{path}: is not named {expected_name(gaze.files)} and was left out" for path in found.left_out]
    of_items: dict[str, OfItem] = {}
    unknown: list[str] = []
    for file in found.fit:
        for item, person, note in _named(layout, file.path, file.item, file.viewer, notes):
            name = item if item in known else aliases.get(item, item)
            if name not in known:
                unknown.append(note)
                continue
            entry = of_items.setdefault(name, OfItem(item))
            if (file.path, file.viewer) not in entry.files:
                entry.files.append((file.path, file.viewer))
            entry.people.add(person)
    notes += unknown[:MAX_NAMED] + ([f"{len(unknown) - MAX_NAMED} more recordings of no item"] if len(unknown) > MAX_NAMED else [])
    _add_cameras(layout, root, known, of_items, notes)
    return of_items


def _named(layout: Layout, path: str, item: str, person: str, notes: list[str]) -> list[tuple[str, str, str]]:
    """Items and people of a file, and what there is to say where there is no such item."""
    gaze = layout.recording
    if not (gaze.item or gaze.person):
        return [(item, person, f"{path}: a recording of no item")]
    from salbench.datasets._gaze_store import named_in  # which needs NumPy

    try:
        pairs = named_in(path, gaze)
    except InputError as error:
        if item:  # and its item says so
            return [(item, person, "")]
        notes.append(f"{error}; its rows are in no recording")
        return []
    if not gaze.item:
        return [(item, pair.person, f"{path}: a recording of no item") for pair in pairs]
    told: dict[str, str] = {}
    rows = Counter[str]()
    for pair in pairs:
        rows[pair.item] += pair.rows
    for pair in pairs:
        told.setdefault(pair.item, f"{path}:{pair.line}: {quoted(pair.item)} ({rows[pair.item]} rows, the first is here) is no item of the data set: "
                                   "correct the name, or add its mesh")
    return [(pair.item, person or pair.person, told[pair.item]) for pair in pairs]


def _add_cameras(layout: Layout, root: str, known: set[str], of_items: dict[str, OfItem], notes: list[str]) -> None:
    pattern = layout.recording.cameras
    if not pattern:
        return
    cameras = {(file.item, file.viewer): file.path for file in files_like(root, pattern, known).fit}
    where = layout.where(pattern.where)
    for name, entry in of_items.items():
        for person in ("", *sorted(entry.people)):
            path = cameras.get((name, person)) or (cameras.get(("", person)) if "{item}" not in pattern else None)
            if path is not None:
                entry.cameras.append((path, person))
            elif person and "{person}" in pattern:
                notes.append(f"{below(root, filled_in(pattern, name, '', person))}: is missing, the cameras of {person}, whose gaze on {name} is lost ({where})")
        if not entry.cameras and "{person}" not in pattern:
            notes.append(f"{below(root, filled_in(pattern, name, '', ''))}: is missing, the cameras of all gaze on {name} ({where})")
