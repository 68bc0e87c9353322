# SPDX-License-Identifier: GPL-3.0-or-later
"""Sizes of the shapes of a data set: one that is much larger or smaller than the others is in another unit. The only listing that reads
shapes, and so imports NumPy: of descriptions that name a unit."""

from __future__ import annotations

import os
from collections.abc import Sequence

import numpy as np

from salbench import _core
from salbench.datasets._columns import read_rows
from salbench.datasets._files import read_file
from salbench.datasets._layout import Columns
from salbench.datasets._truth import options_of
from salbench.datasets.records import Item, Listing

MOST = 100  # between a diagonal and the median: shapes of one unit are nearer


def odd_sizes(diagonals: Sequence[float]) -> list[str]:
    """For each diagonal how far it is from the median, where that is more than a factor of MOST; else "". One of 0 is not known."""
    usual = float(np.median([diagonal for diagonal in diagonals if diagonal > 0] or [0.0]))
    return [f"its diagonal, {diagonal:.4g}, is {diagonal / usual:.3g} times the median of the data set, {usual:.4g}"
            if diagonal > 0 and not usual / MOST <= diagonal <= usual * MOST else "" for diagonal in diagonals]


def _diagonal(item: Item) -> float:
    """Of the bounding box in the file; 0 if that cannot be read, which fails by itself."""
    path = item.files[0].path
    try:
        data = read_file(path)
        if "columns" in item.how:
            points = read_rows(data, path, options_of(item.how, Columns)).points
        elif item.kind == "cloud":
            points = _core.read_cloud(data, os.fsencode(path))[0]
        else:
            points = _core.read_mesh(data, os.fsencode(path))[0]
    except ValueError:
        return 0.0
    points = points[np.isfinite(points).all(axis=1)]
    return float(np.linalg.norm(points.max(axis=0) - points.min(axis=0))) if len(points) else 0.0


def fail_mixed_units(listing: Listing) -> None:
    """Gives shapes in another unit than most a problem, where they have none."""
    of_file: dict[str, float] = {}
    for item in listing.items:
        if item.files[0].path not in of_file:
            of_file[item.files[0].path] = _diagonal(item)
    diagonals = [of_file[item.files[0].path] for item in listing.items]
    for item, odd in zip(listing.items, odd_sizes(diagonals)):
        if odd and not item.problem:
            item.truth = True
            item.problem = f"{item.files[0].path}: {odd}: it is in another unit than {listing.unit_where} says: scale it, or take it out of the set"
