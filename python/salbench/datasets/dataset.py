# SPDX-License-Identifier: GPL-3.0-or-later
"""Data sets as their authors published them."""

from __future__ import annotations

import errno
import html
import operator
import os
from collections.abc import Iterable, Iterator, Sequence
from typing import Any, SupportsIndex, overload

from numpy import integer

from salbench import _core
from salbench.datasets import records, sets
from salbench.datasets.files import read_file
from salbench.datasets.one_form import own_shape
from salbench.datasets.records import InputError, Item, Listing
from salbench.shapes.shape import Read, Shape, set_viewpoint
from salbench.system.files import path_of, require_folder
from salbench.system.names import fail_unknown, names_of
from salbench.system.types import NDArray
from salbench.system.workers import asked

Path = str | os.PathLike[str]


class Dataset:
    """The meshes and point clouds of a data set, with their ground truth.

    A sequence of `Shape`, each read on access, and so a map-style data set of PyTorch: workers may be forked
    or spawned. Warnings go to the logger "salbench".

    Parameters
    ----------
    layout : str, path or salbench.datasets.Dataset
        How the folder is laid out: "automatic", a name such as "schelling", "gs", "folder", "sal3d" or
        "hdf5", your own Python file (.py), or your own functions. docs/data_sets.md lists them all.
    root : path
        The folder; "" for a data set of functions that has none.
    split : str, optional
        Items of one split alone, such as "test".
    items : str or sequence of str, optional
        Items to take: "1-20,52", "scored" for those with ground truth, or their names. All by default. They
        keep the order of the data set.

    Raises
    ------
    FileNotFoundError
        A missing folder or file.
    KeyError
        An unknown layout, split or item.
    ValueError
        A folder without shapes, or an unusable file; on access to a shape, a damaged file: the message names
        file and line.

    Examples
    --------
    >>> import pathlib, salbench, tempfile
    >>> folder = tempfile.TemporaryDirectory()
    >>> wedge = "OFF\\n4 4 0\\n0 0 0\\n1 0 0\\n0 1 0\\n0 0 1\\n3 0 2 1\\n3 0 1 3\\n3 1 2 3\\n3 2 0 3\\n"
    >>> written = pathlib.Path(folder.name, "wedge.off").write_text(wedge)
    >>> dataset = salbench.Dataset("folder", folder.name)
    >>> len(dataset), dataset.ids, dataset["wedge"].points.shape, dataset[0].faces.shape
    (1, ('wedge',), (4, 3), (4, 3))
    >>> folder.cleanup()
    """

    def __init__(
        self,
        layout: Path | sets.Dataset,
        root: Path = "",
        split: str | None = None,
        items: str | Iterable[str] | None = None,
    ) -> None:
        self._given = layout if isinstance(layout, sets.Dataset) else None
        self._layout = layout.name if isinstance(layout, sets.Dataset) else path_of(layout, "layout")
        self._root = os.fspath(root) if self._given else path_of(root, "root")
        self._dataset, listing = self._listed()
        self._items = sets.chosen(
            listing, items if items is None or isinstance(items, str) else names_of(items), split or ""
        )
        self._notes, self._splits = tuple(listing.notes), tuple(
            sorted({name for item in listing.items for name in item.split.split("+") if name})
        )
        self._numbers = {item.name: number for number, item in enumerate(self._items)}
        self._order = list(range(len(self._items)))

    def _listed(self) -> tuple[sets.Dataset, Listing]:
        if self._given is not None:
            return self._given, self._given.items(self._root)
        require_folder(self._root)
        if self._layout not in sets.LAYOUTS:
            if not sets.is_file(self._layout):
                sets.refuse_description(self._layout)
                fail_unknown("layout", self._layout, sets.LAYOUTS)
            if not os.path.exists(self._layout):
                raise FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT), self._layout)
        return sets.listed(self._layout, self._root)

    @property
    def layout(self) -> str:
        """Name of the layout; for "automatic", the detected one."""
        return self._dataset.name

    @property
    def notes(self) -> tuple[str, ...]:
        """Remarks on the folder: ground truth without a shape, missing numbers."""
        return self._notes

    @property
    def ids(self) -> tuple[str, ...]:
        """Names of the items, in order."""
        return tuple(self._items[number].name for number in self._order)

    @property
    def categories(self) -> tuple[str, ...]:
        """Class of each item, "" if it has none; reads no file."""
        return tuple(self._items[number].category for number in self._order)

    @property
    def splits(self) -> tuple[str, ...]:
        """Names of the splits, such as "train" and "test"; reads no file."""
        return self._splits

    def __len__(self) -> int:
        return len(self._order)

    @overload
    def __getitem__(self, index: int | integer[Any] | str) -> Shape:
        ...

    @overload
    def __getitem__(self, index: slice | list[Any] | range | NDArray[Any]) -> Dataset:
        ...

    def __getitem__(
        self, index: SupportsIndex | str | slice | list[Any] | range | NDArray[Any]
    ) -> Shape | Dataset:
        """Returns the shape for a number (negative: from the end) or a name, and a `Dataset` for a slice, a
        sequence of numbers or names, or a boolean mask."""
        if not isinstance(index, (slice, list, range)) and not getattr(index, "shape", ()):
            return self._load(self._number_of(index))
        part = object.__new__(Dataset)
        part.__dict__.update(self.__dict__)
        part._order = self._order[index] if isinstance(index, slice) else self._numbers_of([*index])  # type: ignore[misc]
        return part

    def _numbers_of(self, wanted: Sequence[Any]) -> list[int]:
        kinds = {type(one).__name__ in ("bool", "bool_") for one in wanted}
        if True not in kinds:
            return [self._number_of(one) for one in wanted]
        if False in kinds or len(wanted) != len(self):
            raise ValueError(
                f"a mask of {len(wanted)} values, but the data set has {len(self)} items: expected True or"
                " False for each"
            )
        return [number for number, is_wanted in zip(self._order, wanted) if is_wanted]

    def _number_of(self, index: Any) -> int:
        if isinstance(index, str):
            if index not in self:
                fail_unknown("item", index, self.ids)
            return self._numbers[index]
        try:
            return self._order[operator.index(index)]
        except IndexError:
            raise IndexError(
                f"index {operator.index(index)}, but the data set has {len(self)} items"
            ) from None

    def _load(self, number: int) -> Shape:
        item = self._items[number]
        shape = _usable(self._dataset, item)
        read = Read(
            item.name,
            shape.points,
            shape.faces,
            shape.normals,
            None,
            item.category,
            item.split,
            shape.ground_truth,
            tuple(shape.participants),
            () if shape.viewers is None else shape.viewers,
        )
        if shape.faces is None:
            set_viewpoint(read, shape.viewpoint)
        return read

    def __iter__(self) -> Iterator[Shape]:
        return map(self._load, self._order)

    def __contains__(self, name: object) -> bool:
        """True if an item has this name."""
        return isinstance(name, str) and self._numbers.get(name, -1) in self._order

    def __repr__(self) -> str:
        return f"Dataset({self._layout!r}, {self._root!r}, {len(self)} items)"

    def _repr_html_(self) -> str:
        """Table of the first items; reads no file."""
        shown = 10
        first = [self._items[number] for number in self._order[:shown]]
        cells = [[html.escape(text) for text in (item.name, item.category, item.split)] for item in first]
        rows = "".join(f"<tr><td>{'</td><td>'.join(row)}</td></tr>" for row in cells)
        more = f"<p>and {len(self) - shown} more</p>" if len(self) > shown else ""
        return (
            f"<p>{html.escape(repr(self))}</p><table><thead><tr><th>item</th><th>class</th><th>split</th></tr></thead>"
            f"<tbody>{rows}</tbody></table>{more}"
        )

    def __getstate__(self) -> dict[str, object]:
        layout = self._given or (
            self._layout if self._layout in sets.LAYOUTS else os.path.abspath(self._layout)
        )
        return {"layout": layout, "root": self._root and os.path.abspath(self._root), "ids": self.ids}

    def __setstate__(self, state: dict[str, Any]) -> None:
        ids: tuple[str, ...] = state["ids"]
        self.__init__(state["layout"], state["root"], items=ids)  # type: ignore[misc]
        self._order = [self._numbers[name] for name in ids]


def _usable(dataset: sets.Dataset, item: Item) -> records.Shape:
    """The shape as a run uses it: saliency is made from picks if there is no other."""
    if item.problem:
        raise InputError(item.problem)
    shape: records.Shape | None = (
        own_shape(item, read_file(item.place)) if dataset.layout == sets.FORM else None
    )
    if shape is None:
        shape = (
            asked(dataset.question("salbench.datasets.sets:read_of", [item], item))
            if dataset.layout
            else dataset.read(item)
        )
    view = os.fsencode(item.view) if item.truth or item.recorded else None
    arrays = _core.finished(
        records.arrays_of(shape, item.view, item.place), view, os.fsencode(item.name), os.fsencode(item.place)
    )
    for array in arrays.values():
        array.flags.writeable = False
    return records.shape_of(arrays, item.view)
