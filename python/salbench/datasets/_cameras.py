# SPDX-License-Identifier: GPL-3.0-or-later
"""Cameras of a data set: the places that its shapes were seen from, as a description gives them."""

from __future__ import annotations

from dataclasses import dataclass, field

from salbench.datasets._csv import read_csv
from salbench.datasets._files import below
from salbench.datasets._layout import Cameras
from salbench.datasets.records import InputError

MAX_COORDINATE = 1e150  # stages square distances, which must not overflow

Place = tuple[float, float, float]


def wrong_with_camera(place: Place, at_infinity: bool) -> str:
    """"" if the coordinates can be a camera's."""
    if at_infinity and not any(place):
        return "a direction has a length"
    if not all(abs(axis) < float("inf") for axis in place):
        return "a coordinate is not a finite number"
    return "a coordinate is larger than 1e150: scale the mesh" if max(abs(axis) for axis in place) > MAX_COORDINATE else ""


@dataclass
class FoundCameras:
    at_infinity: bool
    places: dict[tuple[str, str], tuple[Place, str]] = field(default_factory=dict)  # (item, view), "" for every one -> place, where

    def find(self, item: str, view: str) -> tuple[Place, str] | None:
        """The most special camera, and where it is written."""
        return next((self.places[key] for key in ((item, view), (item, ""), ("", view), ("", "")) if key in self.places), None)


def find_cameras(root: str, cameras: Cameras, where: str) -> FoundCameras:
    """Reads the file, if there is one: columns x, y, z, and item or view or both."""
    found = FoundCameras(cameras.at_infinity, {("", view): (place, where) for view, place in cameras.by_view.items()})
    if not cameras.file:
        return found
    table = read_csv(below(root, cameras.file))
    if "item" not in table.columns and "view" not in table.columns:
        raise InputError(f"{table.name}:1: has neither a column 'item' nor 'view' ({where})")
    axes = [table.numbers(axis) for axis in "xyz"]
    items, views = (table.column(name) if name in table.columns else [""] * len(table.rows) for name in ("item", "view"))
    for row, (x, y, z) in enumerate(zip(*axes)):
        place = x, y, z
        here = f"{table.name}:{table.lines[row]}"
        if wrong := wrong_with_camera(place, cameras.at_infinity):
            raise InputError(f"{here}: {wrong}")
        key = items[row], views[row]
        if key in found.places:
            raise InputError(f"{here}: {found.places[key][1]} has this camera already: keep one of them")
        found.places[key] = place, here
    return found
