# SPDX-License-Identifier: GPL-3.0-or-later
"""Data sets: one file per public data set, and the types for your own.

A data set is two functions: `items(root)` lists a folder and reads no shape, `read(item)` returns the shape
of an item with its ground truth. Your own file defines the same two: `dataset: {layout: mine.py}`.
docs/data_sets.md has examples.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from salbench.datasets.records import Item as Item, Listing as Listing, Shape as Shape

if TYPE_CHECKING:
    from salbench.datasets import files as files, splits as splits, spread as spread, trackers as trackers
    from salbench.datasets.files import match
    from salbench.datasets.listings import recorded
    from salbench.datasets.one_form import write
    from salbench.datasets.reading import (
        above_mean,
        cloud,
        cloud_of,
        face_values,
        from_faces,
        from_points,
        mask,
        mean,
        mesh,
        picks,
        read_values,
        shape,
        top,
        unit,
        values,
    )
    from salbench.datasets.recordings import Recording, gather
    from salbench.datasets.sets import Dataset
    from salbench.datasets.tables import numbers, table

_OF_READING = [
    "above_mean",
    "cloud",
    "cloud_of",
    "face_values",
    "from_faces",
    "from_points",
    "mask",
    "mean",
    "mesh",
    "picks",
    "read_values",
    "shape",
    "top",
    "unit",
    "values",
]
_HOMES = dict.fromkeys(_OF_READING, "reading") | {
    "Dataset": "sets",
    "Recording": "recordings",
    "gather": "recordings",
    "match": "files",
    "numbers": "tables",
    "recorded": "listings",
    "table": "tables",
    "write": "one_form",
}  # most need NumPy or the compiled part; listing does not
__all__ = [
    "Dataset",
    "Item",
    "Listing",
    "Recording",
    "Shape",
    "above_mean",
    "cloud",
    "cloud_of",
    "face_values",
    "from_faces",
    "from_points",
    "gather",
    "mask",
    "match",
    "mean",
    "mesh",
    "numbers",
    "picks",
    "read_values",
    "recorded",
    "shape",
    "table",
    "top",
    "unit",
    "values",
    "write",
]


_MODULES = ("files", "spread", "splits", "trackers")  # public ones


def __getattr__(name: str) -> Any:
    if name in _MODULES:
        return import_module(f"{__name__}.{name}")
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOMES[name]}"), name)


def __dir__() -> list[str]:
    return __all__
