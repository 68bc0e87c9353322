# SPDX-License-Identifier: GPL-3.0-or-later
"""Items of folders with gaze recordings. Importing this loads no NumPy."""

import os

from salbench.datasets.files import below, first, left_over, match
from salbench.datasets.records import Item, Listing
from salbench.system.errors import InputError
from salbench.system.files import AnyPath


def recorded(root: AnyPath, shapes: str, recordings: str, *beside: str, kind: str = "") -> Listing:
    """Items without published ground truth: shapes that match a pattern, with files of people's gaze, whose
    names go into `info`.

    recordings: a pattern such as "gaze/{item}_{person}.csv"; without {item}, one file covers all shapes.
    beside: patterns of further files per shape, such as "cameras/{item}.json"; they come last in its `files`.
    """
    paths = first(root, [shapes])[1]
    found = match(root, recordings, paths)
    if not found:
        raise InputError(f"{os.fspath(root)}: no recording of gaze fits {recordings}")
    items = []
    for name, path in paths.items():
        own = [one for one in found if one.item == name or "{item}" not in recordings]
        others = [below(os.fspath(root), one.replace("{item}", name)) for one in beside]
        items.append(
            Item(
                name,
                [path, *(one.path for one in own), *others],
                kind=kind,
                truth=False,
                recorded=len({one.viewer for one in own}),
                info=[one.viewer for one in own],
            )
        )
    return Listing(items, left_over(root, recordings, [one.path for one in found]))
