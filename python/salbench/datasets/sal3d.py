# SPDX-License-Identifier: GPL-3.0-or-later
"""Gaze of 32 people on 58 meshes in virtual reality: 20 000 points of the surface of each, with fixation
densities. [martin2024]

Published: supplement of the paper; an earlier state in the public repository
FandosA/3D_Mesh_Saliency_Prediction_PyTorch.
Seen: 52 point clouds of that state, and their splits. A line has the position, a direction along the normal,
the density, and 1 for the points looked at most, separated by blanks. In 26 of the 52 clouds the directions
are sums around a vertex, mostly 2 pi long, in the others unit normals. None of them is padded. Points with
the same position are clones of one vertex: each is scored, as by the authors.
Assumed: Models_3D/ and dataset_*/ of the earlier state, and meshes/ and gaze/ of another public repository,
whose meshes take the value of the nearest point.
Truth: the density is raw, and not 0 on a quarter of the points. The published scores use spread densities:
each point that was looked at adds to its first 500 neighbours, from 0.9 of its own value at the first to 0 at
the last. The lists of neighbours are in Smooth_Gaze of the final release (not seen; as a public re-analysis
reads them). If they are present, the ground truth is spread; otherwise it stays raw, and every table says so.
Cannot answer: who looked where (pooled over people).
"""

import os
from collections.abc import Sequence

from salbench.datasets import splits
from salbench.datasets.arrays import Bools, Floats
from salbench.datasets.files import below, by_name, extension, first, left_over, match
from salbench.datasets.records import Item, Listing, Shape
from salbench.system.errors import InputError

VERSION = 1
LICENCE = "not known; ask the authors"

# Folders of shapes, and of the gaze on them; "": as published, points and ground truth in one file.
PLACES = (
    ("Gaze/*.txt", ""),
    ("Models_3D/*.obj", "dataset_*/{item}.txt"),
    ("meshes/*.obj", "gaze/{item}.txt"),
)
LISTS = "Smooth_Gaze/{item}_neighbors.txt"
NEIGHBOURS, SHARE = 500, 0.9
UNLISTED = (
    "TRUTH: raw gaze densities; the published scores are measured on smoothed ones, whose lists of neighbours"
    " (Smooth_Gaze) are not here"
)


def items(root: str) -> Listing:
    return listed(root)


def listed(
    root: str, places: Sequence[tuple[str, str]] = PLACES, has_lists: bool = True, remark: str = UNLISTED
) -> Listing:
    """Lists shapes. has_lists: densities are spread over neighbours, given a folder of lists. remark: used
    without one."""
    number, shapes = first(root, [pattern for pattern, _ in places])
    gaze = by_name(match(root, places[number][1], shapes)) if places[number][1] else {}
    if places[number][1] and not gaze:
        raise InputError(f"{below(root, places[number][1])}: there is no such file of a shape")
    is_spread = has_lists and os.path.isdir(below(root, os.path.dirname(LISTS)))
    lists = by_name(match(root, LISTS, shapes)) if is_spread else {}
    listing = Listing([], remark="" if is_spread else remark)
    for name, path in shapes.items():
        item = Item(
            name, [path], truth=(name in gaze or not places[number][1]) and (name in lists or not is_spread)
        )
        if item.truth:
            item.files = [path, *filter(None, (gaze.get(name), lists.get(name)))]
            item.info = {"lists": is_spread}
        listing.items.append(item)
    listing.notes += left_over(
        root, places[number][1] or places[number][0], [*gaze.values(), *shapes.values()]
    ) + left_over(root, LISTS, lists.values())
    if without := [name for name in shapes if is_spread and name not in lists]:
        listing.notes.append(
            f"{len(without)} of {len(shapes)} items have no list of neighbours ({below(root, LISTS)}), and so"
            f" no ground truth: {', '.join(without[:5])}{', ...' if len(without) > 5 else ''}"
        )
    listing.notes += filter(None, [listing.remark])
    return splits.from_table(listing, os.path.join(root, "splits.csv"))


def read(item: Item, nearest: bool = False) -> Shape:
    """Reads a shape. nearest: spreads densities over the nearest points instead of the lists."""
    import numpy as np

    from salbench.datasets import reading

    path, *files = item.files
    lists = files.pop() if item.info and item.info["lists"] else ""
    if extension(path) != ".txt":
        found = reading.shape(path)
        for table in map(_table, files):
            found.ground_truth = reading.from_points(
                found,
                table[:, :3],
                _smoothed(table[:, :3], table[:, 6], np.ones(len(table), bool), lists, nearest),
            )
        return found
    table = _table(path)
    padding = _is_padding(table)
    found = reading.cloud_of(np.where(padding[:, None], np.nan, table[:, :3]), table[:, 3:6], path)
    if item.info:
        found.ground_truth = _smoothed(found.points, table[:, 6], ~padding, lists, nearest)
        flagged = np.flatnonzero(table[~padding, 7])
        found.participants = [flagged.astype(np.int32)] if len(flagged) else []
    return found


def _table(path: str) -> Floats:
    import numpy as np

    from salbench import _core
    from salbench.datasets.tables import numbers, require

    table = numbers(path, 8)
    require(path, np.isfinite(table), "a value is not a finite number")
    require(
        path,
        np.abs(table[:, :3]) <= _core.largest_coordinate,
        "a coordinate is larger than 1e50: scale the shape",
    )
    require(path, (table[:, 7] == 0) | (table[:, 7] == 1), "the flag in column 8 is neither 0 nor 1")
    return table


def _is_padding(table: Floats) -> Bools:
    """True for padding at the end of a file: zeros, or copies of earlier rows."""
    import numpy as np

    is_new = np.zeros(len(table), bool)
    is_new[np.unique(table + 0.0, axis=0, return_index=True)[1]] = True
    real = np.flatnonzero(is_new & table.any(axis=1))
    return np.asarray(np.arange(len(table)) > (real[-1] if len(real) else -1))


def _smoothed(points: Floats, density: Floats, kept: Bools, lists: str, nearest: bool) -> Floats:
    """Spread densities of the points that are kept; the lists number all points of the file."""
    import numpy as np

    from salbench.datasets import spread

    values: Floats = density[kept]
    sources = np.flatnonzero(values > 0)
    if lists:
        rows = np.flatnonzero(kept)
        numbers = np.where(kept, np.cumsum(kept) - 1, -1).astype(np.int32)
        neighbours = numbers[spread.read_lists(lists, len(density), NEIGHBOURS, rows[sources])]
    elif nearest:
        neighbours = spread.nearest_in_space(points, sources, NEIGHBOURS)
    else:
        return values
    return spread.spread(values, sources, neighbours, NEIGHBOURS, SHARE)
