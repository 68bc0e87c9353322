# SPDX-License-Identifier: GPL-3.0-or-later
"""The HDF5 form of data sets: a folder with index.csv and items/NAME.h5, one file per shape
(docs/hdf5_form.md).

The program's own writer gives equal bytes for equal shapes, and the program reads such files without the HDF5
library. Files by other programs are read by h5py and checked.
"""

from __future__ import annotations

import io
import os
from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from salbench import _core
from salbench.datasets.files import exists, is_name, read_file
from salbench.datasets.records import (
    Arrays,
    InputError,
    Item,
    Shape,
    UnreadableError,
    arrays_of,
    has_truth,
    shape_of,
    truth_arrays,
)
from salbench.system.csv import REMARKS, joined, missing, read_rows
from salbench.system.errors import quoted, require_line
from salbench.system.files import FolderUpdate, holds

INDEX = "index.csv"
FORM, VERSION = "salbench item", 3
OWN = "own"  # source of a set that did not come from an archive

Row = tuple[Item, str]
"""A row of the index: an item, and the data set that it came from."""

_COLUMNS = ("item", "view", "class", "split", "kind", "truth", "participants", "viewers", "source")
_OF_SHAPE = ("points", "faces", "normals", "viewpoint", "left_out", "polygons")
_OF_RECORDING = ("people", "person", "time", "valid", "origins", "directions", "points", "durations")
_OF_TRUTH = ("saliency", "viewers", "picks", "picks_of", "faces")


def name_of(shape: str) -> str:
    """Path of a shape's file in the folder."""
    return f"items/{shape}.h5"


# --- reading ------------------------------------------------------------------------------------------------


def read_item(item: Item) -> Shape:
    """Reads the shape in an item's file, with the ground truth of its view."""
    data = read_file(item.files[0])
    return own_shape(item, data) or _shape_in(*foreign_form(item.files[0], data), item)


def own_shape(item: Item, data: bytes) -> Shape | None:
    """Same for the bytes of a file; None if another program wrote them."""
    form = _core.read_form(data, os.fsencode(item.files[0]))
    return form and _shape_in(*form, item)


def _shape_in(arrays: Arrays, about: dict[str, str], item: Item) -> Shape:
    path, shape = item.files[0], shape_of(arrays, item.view)
    require_form_of(about.get("item", item.shape_name), item.shape_name, path)
    if item.truth and not has_truth(arrays, item.view):
        raise InputError(
            f"{path}: has no ground truth{' of view ' * bool(item.view)}{item.view}, and index.csv says that"
            " it has"
        )
    require_people(item, len(shape.participants), 0 if shape.viewers is None else len(shape.viewers))
    return shape


def require_form_of(named: str, shape: str, path: str) -> None:
    if named != shape:
        raise InputError(
            f"{path}: is of the item {quoted(named)}, and index.csv says that it is of {quoted(shape)}: put"
            " the right file there, or import the set again"
        )


def require_people(item: Item, participants: int, viewers: int) -> None:
    """Checks the counts against the index; neither is known if people are not told apart."""
    for what, found, listed in (
        ("picks of participants", participants, item.participants),
        ("values of viewers", viewers, item.viewers),
    ):
        if found and listed and found != listed:
            raise InputError(
                f"{item.files[0]}: has {found} {what}, and index.csv says {listed}: put the right file there,"
                " or import the set again"
            )


def foreign_form(path: str, data: bytes | None = None) -> tuple[Arrays, dict[str, str]]:
    """Reads the shape in another program's file, which may hold anything, and the attributes about its
    name."""
    from salbench.system.hdf5 import Hdf5File

    file = Hdf5File(path, data)
    if file.attribute("form") != FORM:
        raise InputError(f"{path}: has no attribute form = '{FORM}': it is no file of an imported data set")
    version = file.attribute("form_version")
    if not isinstance(version, int) or not 1 <= version <= VERSION:
        raise InputError(
            f"{path}: is of version {version} of the form, and this program reads 1 to {VERSION}: import the"
            " set again"
        )
    parts = [*(f"shape/{part}" for part in _OF_SHAPE), *(f"recording/{part}" for part in _OF_RECORDING)]
    arrays = {name: file.read(name) for name in parts if file.has(name)}
    groups = ["truth/", *(f"views/{view}/" for view in file.members("views"))]
    arrays |= {
        name: file.read(name)
        for name in (group + part for group in groups for part in _OF_TRUTH)
        if file.has(name)
    }
    if version == 1 and (split := file.attribute("polygons_split")):
        arrays["shape/polygons"] = np.array([split, file.attribute("polygons_concave") or 0], np.int64)
    item = file.attribute("item")
    return _core.checked_form(arrays, os.fsencode(path)), {"item": item} if isinstance(item, str) else {}


def foreign_arrays(path: str, shape: str) -> Arrays:
    """Arrays of the shape in another program's file, with all its views. shape: the expected name."""
    arrays, about = foreign_form(path)
    require_form_of(about.get("item", shape), shape, path)
    return arrays


# --- writing ------------------------------------------------------------------------------------------------


def image(shape: Shape, truths: Mapping[str, Shape], about: Mapping[str, str]) -> bytes:
    """Bytes of a file: a shape with the ground truth of `truths`, by view. about: item, class, split, source,
    source_files, viewers, licence."""
    whole = arrays_of(replace(shape, ground_truth=None, viewers=None, participants=()), place=about["item"])
    for view, of_view in truths.items():
        whole |= truth_arrays(of_view, view, about["item"])
    return _core.form_image(whole, dict(about), os.fsencode(about["item"]))


def about(item: Item, source: str, *, files: str = "", licence: str = "") -> dict[str, str]:
    return {
        "item": item.shape_name,
        "class": item.category,
        "split": item.split,
        "source": source,
        "source_files": files,
        "viewers": "",
        "licence": licence,
    }


class Writer:
    """Writes the folder of a set. Files that would not change are left alone; until `finish` the set is
    unchanged."""

    def __init__(self, folder: str, source: str, advice: str) -> None:
        self.before = _rows_before(folder, source) if os.path.isdir(folder) else []
        self.rows: list[Row] = []
        self._source = source
        self._update = FolderUpdate(folder, advice)

    def __enter__(self) -> Writer:
        return self

    def __exit__(self, *_: object) -> None:
        self._update.__exit__()

    def put(self, items: Iterable[Item], data: bytes) -> bool:
        """Writes a file and keeps its rows for the index. True if written, False if unchanged."""
        rows = [(item, self._source) for item in items]
        self.rows += rows
        return self._put(name_of(rows[0][0].shape_name), data)

    def _put(self, name: str, data: bytes) -> bool:
        if holds(self._update.path / name, data):
            return False
        self._update.write(name, data)
        return True

    def finish(
        self, remark: str = "", kept: Iterable[Row] = (), order: Mapping[str, int] | None = None
    ) -> int:
        """Writes the index and returns the number of removed shapes. remark: on the ground truth; kept:
        earlier rows that stay; order: of items by name."""
        rows = [*kept, *self.rows]
        if order is not None:
            places = order
            rows.sort(key=lambda row: places[row[0].name])
        self._put(INDEX, index_text(rows, remark))
        self._update.finish(last=INDEX)
        gone = {item.shape_name for item, _ in self.before} - {item.shape_name for item, _ in rows}
        for shape in gone:
            self._update.remove(name_of(shape))
        return len(gone)


def _rows_before(folder: str, source: str) -> list[Row]:
    """Rows of the index that will be replaced. Throws InputError for a folder that holds something else."""
    path = os.path.join(folder, INDEX)
    if not exists(path):
        if other := min(
            (name for name in os.listdir(folder) if name != "items" and not name.startswith(".")), default=""
        ):
            raise InputError(f"{folder}: holds {quoted(other)}, and no data set; choose another folder")
        return []
    try:
        rows = _rows_in(path)
    except UnreadableError:
        raise
    except InputError as error:
        raise InputError(f"{folder}: holds something else: {error}; choose another folder") from None
    if other := next((of for _, of in rows if of != source), ""):
        raise InputError(f"{folder}: holds another set, of source {other}; choose another folder")
    return rows


def index_text(rows: Iterable[Row], remark: str = "") -> bytes:
    """Text of index.csv, whose columns docs/hdf5_form.md describes. remark: on the ground truth, repeated in
    each row."""
    rows = list(rows)
    recorded = any(item.recorded for item, _ in rows)
    lines = [[*_COLUMNS, *["recorded"] * recorded, *[REMARKS] * bool(remark)]]
    for item, source in rows:
        lines.append(
            [
                item.shape_name,
                item.view,
                item.category,
                item.split,
                "cloud" if item.kind == "cloud" else "mesh",
                "yes" if item.truth else "no",
                str(item.participants),
                str(item.viewers),
                source,
                *[str(item.recorded)] * recorded,
                *[joined([remark])] * bool(remark),
            ]
        )
    return b"".join(os.fsencode(",".join(map(_cell, line)) + "\n") for line in lines)


def _cell(text: str) -> str:
    return '"' + text.replace('"', '""') + '"' if {*text} & {*',"\r\n'} else text


def _rows_in(path: str) -> list[Row]:
    """Rows of an index, with items as C++ reads and checks them."""
    text = read_file(path).decode("utf-8-sig", "surrogateescape")
    _, columns, rows = read_rows(io.StringIO(text, newline=""), path)
    if "source" not in columns:
        raise missing(path, "source", columns)
    sources = [fields[columns.index("source")] for _, fields in rows]
    if not sources:
        return []
    _, listing = _core.native_listing(b"hdf5", os.fsencode(os.path.dirname(path)))
    return [(Item(**fields), source) for fields, source in zip(listing["items"], sources)]


def write(folder: str | os.PathLike[str], shapes: Iterable[Any], *, source: str = OWN) -> None:
    """Writes your own data set in the layout "hdf5".

    Parameters
    ----------
    folder : path
        Created if missing. Files that would not change are left alone; shapes that are no longer in the set
        are removed.
    shapes : iterable of salbench.Shape
        Or any objects with `id` and `points` (n, 3), and if known `faces` (m, 3), `normals` (n, 3) of a
        cloud, `ground_truth` (n,) with NaN for points that nobody saw, `participants` (indices of the points
        that each of them picked), `viewers` (v, n), `recording` (`salbench.datasets.Recording`), `category`
        and `split`. Or pairs of an `Item`, which is no view, and the shape that `read` of a data set returned
        for it.
    source : str
        Name of the set's origin, which the index repeats. A folder with another source is refused.

    Raises
    ------
    ValueError
        An unusable shape, named; two shapes of one name; a folder that holds another set or anything else.

    Examples
    --------
    >>> import numpy, tempfile, types
    >>> folder = tempfile.TemporaryDirectory()
    >>> wedge = types.SimpleNamespace(id="wedge", points=numpy.eye(4, 3), faces=[[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]],
    ...                               ground_truth=[0, 1, 2, 3])
    >>> write(folder.name, [wedge])
    >>> import salbench
    >>> salbench.Dataset("hdf5", folder.name)["wedge"].ground_truth
    array([0., 1., 2., 3.])
    >>> folder.cleanup()
    """
    folder = os.fspath(folder)
    if not folder:
        raise InputError("folder is empty: name one")
    require_line(source, "source")
    with Writer(folder, source, "choose another") as writer:
        names: set[str] = set()
        for number, given in enumerate(shapes):
            item, shape = given if isinstance(given, tuple) else (item_of(given, number), None)
            if not is_name(item.name):
                raise InputError(f"shape {item.name!r}: its id is no name of a file; leave out '/'")
            if item.name in names:
                raise InputError(f"shape {item.name!r}: its id is given twice")
            if item.view:
                raise InputError(
                    f"shape {item.name!r}: is a view: salbench import writes data sets with views"
                )
            names.add(item.name)
            try:
                shape = shape_like(given) if shape is None else shape
                data = checked_image(item, shape, source)
            except (AttributeError, TypeError, ValueError) as error:
                raise InputError(f"shape {item.name!r}: {error}") from None
            writer.put([row_of(item, shape)], data)
        writer.finish()


def checked_image(item: Item, shape: Shape, source: str) -> bytes:
    """Bytes of the file of a shape without views, after checking that a run can use all of it."""
    if shape.viewers is not None and shape.ground_truth is None:
        raise InputError("has viewers, but no ground_truth: give the mean of what they saw")
    require_line(item.category, "its category")
    require_line(item.split, "its split")
    data = image(shape, {"": shape}, about(item, source))
    _core.shape_facts(arrays_of(shape, place=item.name), os.fsencode(item.name), os.fsencode(item.name))
    return data


def item_of(given: Any, number: int) -> Item:
    """Item of a `salbench.Shape`, or of an object with its attributes."""

    def text(key: str) -> str:
        value = getattr(given, key, None)
        return "" if value is None or value != value else str(value)  # empty cells of tables are NaN

    return Item(
        str(getattr(given, "id", "")) or f"shape {number}", category=text("category"), split=text("split")
    )


def shape_like(given: Any) -> Shape:
    def floats(key: str) -> Any:
        value = getattr(given, key, None)
        return None if value is None or len(value) == 0 else np.asarray(value, np.float64)

    faces = getattr(given, "faces", None)
    return Shape(
        np.asarray(given.points, np.float64),
        None if faces is None else np.asarray(faces),
        floats("normals") if faces is None else None,
        floats("ground_truth"),
        tuple(np.asarray(one) for one in getattr(given, "participants", None) or ()),
        floats("viewers"),
        recording=getattr(given, "recording", None),
    )


def row_of(item: Item, shape: Shape) -> Item:
    """The item as in the index: with the facts of its shape."""
    picked = any(len(one) for one in shape.participants)
    has_truth = shape.ground_truth is not None or picked
    return Item(
        item.name,
        category=item.category,
        split=item.split,
        shape=item.shape,
        view=item.view,
        kind="cloud" if shape.faces is None else "mesh",
        truth=has_truth,
        participants=len(shape.participants) if has_truth else 0,
        viewers=0 if shape.viewers is None else len(shape.viewers),
        recorded=0 if shape.recording is None else len(shape.recording.people),
    )
