# SPDX-License-Identifier: GPL-3.0-or-later
"""The one form of data sets: a folder with index.csv and items/NAME.h5, a file per shape (docs/hdf5_form.md).

Files are written by the program's own writer, so that equal shapes give equal bytes, and the program reads them without the HDF5 library.
Files that anybody else wrote are read by h5py and checked.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from salbench import _core
from salbench._errors import quoted, wrong_with_line
from salbench._files import OwnFolder
from salbench.datasets._files import exists, read_file
from salbench.datasets.records import Form, InputError, Recording, Truth

INDEX = "index.csv"
FORM, VERSION = "salbench item", 3
OWN = "own"  # source of a set that did not come from an archive

Row = tuple[str, str, str, str, str, bool, int, int, str, int]
"""Item, view, class, split, kind, truth, participants, viewers, source, people recorded."""
SOURCE = 8  # of these

_OF_SHAPE = ("points", "faces", "normals", "viewpoint", "left_out", "polygons")
_OF_RECORDING = ("people", "person", "time", "valid", "origins", "directions", "points", "durations")
_OF_TRUTH = ("saliency", "viewers", "picks", "picks_of", "faces")


def name_of(shape: str) -> str:
    """Of its file in the folder."""
    return f"items/{shape}.h5"


def read(path: str) -> Form:
    """The shape in a file, whoever wrote it."""
    data = read_file(path)
    fields = _core.read_one_form(data, os.fsencode(path))
    return form_of_fields(fields) if fields is not None else read_foreign(path, data)


def read_foreign(path: str, data: bytes | None = None) -> Form:
    """The same from a file of another program, which may hold anything."""
    from salbench.datasets._hdf5 import Hdf5File

    file = Hdf5File(path, data)
    if file.attribute("form") != FORM:
        raise InputError(f"{path}: has no attribute form = '{FORM}': it is no file of an imported data set")
    version = file.attribute("form_version")
    if not isinstance(version, int) or not 1 <= version <= VERSION:
        raise InputError(f"{path}: is of version {version} of the form, and this program reads 1 to {VERSION}: import the set again")
    parts = [*(f"shape/{part}" for part in _OF_SHAPE), *(f"recording/{part}" for part in _OF_RECORDING)]
    arrays = {name: file.read(name) for name in parts if file.has(name)}
    groups = ["truth/", *(f"views/{view}/" for view in file.members("views"))]
    arrays |= {name: file.read(name) for name in (group + part for group in groups for part in _OF_TRUTH) if file.has(name)}
    if version == 1 and (split := file.attribute("polygons_split")):
        arrays["shape/polygons"] = np.array([split, file.attribute("polygons_concave") or 0], np.int64)
    form = form_of_fields(_core.form_of_arrays(arrays, os.fsencode(path)))
    if isinstance(item := file.attribute("item"), str):
        form.about["item"] = item
    return form


def image(form: Form) -> bytes:
    """The bytes of a file."""
    return _core.one_form_image(form)


def own(folder: str) -> OwnFolder:
    """The folder of a set, to be written."""
    return OwnFolder(folder, "choose another with --to", below=["items"])


def put(folder: OwnFolder, name: str, data: bytes) -> bool:
    """Writes the file, unless it holds these bytes; true if it did not. One that is there is replaced when the index is put, so that the set
    stays as it is until all of the next one is there."""
    if folder.read(name, len(data)) == data:
        return False
    (folder.write_later if folder.head(name) else folder.write)(name, data)
    return True


def read_index(folder: str) -> list[Row]:
    """Rows of the index; none of a folder without one."""
    path = os.path.join(folder, INDEX)
    return _core.read_index(os.fsencode(path)) if exists(path) else []


def foreign_in(folder: str) -> str:
    """Something that lies in a folder without an index and is no part of a set; "" where there is nothing."""
    if exists(os.path.join(folder, INDEX)) or not os.path.isdir(folder):
        return ""
    return min((name for name in os.listdir(folder) if name != "items" and not name.startswith(".")), default="")


def put_index(folder: OwnFolder, rows: list[Row], before: list[Row], remark: str = "") -> int:
    """Writes the index after what was put, and removes files of shapes that only the one before it has. How many these are. remark: of the
    ground truth."""
    put(folder, INDEX, _core.index_text(rows, remark))
    folder.write_all()
    gone = {row[0] for row in before} - {row[0] for row in rows}
    for shape in gone:
        folder.remove(name_of(shape))
    return len(gone)


def write(folder: str | os.PathLike[str], shapes: Iterable[Any], *, source: str = OWN) -> None:
    """A data set of one's own, as the layout "hdf5".

    Parameters
    ----------
    folder : path
        It is made if it is missing. Files that would be the same are left alone; shapes that are no longer in the set are removed.
    shapes : iterable of salbench.Shape
        Or of anything with its `id` and `points` (n, 3), and where they are known `faces` (m, 3), `normals` of a cloud (n, 3), `ground_truth`
        (n,) with NaN for what nobody saw, `participants` (indices of the points that each of them picked), `viewers` (v, n), `recording`
        (`salbench.datasets.Recording`), `category` and `split`.
    source : str
        Name of the set's origin, which the index repeats. A folder of another source is left alone.

    Raises
    ------
    ValueError
        A shape that cannot be used, named; two of one name; a folder that holds another set, or anything else.

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
    if wrong := wrong_with_line(source):
        raise InputError(f"source {quoted(source)} has {wrong}, which tables cannot have: rename it")
    with own(folder) as opened:
        _write(opened, shapes, source)


def _write(folder: OwnFolder, shapes: Iterable[Any], source: str) -> None:
    if other := foreign_in(folder.path):
        raise InputError(f"{folder.path}: holds {quoted(other)}, and no data set; choose another folder")
    before = read_index(folder.path)
    for row in before:
        if row[SOURCE] != source:
            raise InputError(f"{folder.path}: holds another set, of source {row[SOURCE]}; choose another folder")
    folder.require_folder("items")
    rows: dict[str, Row] = {}
    for number, shape in enumerate(shapes):
        name = str(getattr(shape, "id", "")) or f"shape {number}"
        if not is_name(name):
            raise InputError(f"shape {name!r}: its id is no name of a file; leave out '/'")
        if name in rows:
            raise InputError(f"shape {name!r}: its id is given twice")
        try:
            form = form_of(shape, name, source)
            data = image(form)
            _core.shape_facts(form, os.fsencode(name), os.fsencode(name))
            if form.recording is not None:
                _core.read_one_form(data, os.fsencode(name))  # which checks its rows
        except (AttributeError, TypeError, ValueError) as error:
            raise InputError(f"shape {name!r}: {error}") from None
        put(folder, name_of(name), data)
        rows[name] = row_of(name, form)
    put_index(folder, list(rows.values()), before)


def form_of(shape: Any, name: str, source: str) -> Form:
    """The one form of a shape in memory."""

    def floats(key: str) -> Any:
        value = getattr(shape, key, None)
        return None if value is None or len(value) == 0 else np.asarray(value, np.float64)

    def text(key: str) -> str:
        value = getattr(shape, key, None)
        return "" if value is None or value != value else str(value)  # a table's empty cell is NaN

    points, faces = np.asarray(shape.points, np.float64), getattr(shape, "faces", None)
    picks = tuple(np.asarray(one) for one in getattr(shape, "participants", None) or ())
    truth = Truth("", floats("ground_truth"), floats("viewers"), picks)
    if truth.viewers is not None and truth.saliency is None:
        raise InputError("has viewers, but no ground_truth: give the mean of what they saw")
    has_truth = truth.saliency is not None or any(len(one) for one in picks)
    for key in ("category", "split"):
        if wrong := wrong_with_line(text(key)):
            raise InputError(f"its {key} {quoted(text(key))} has {wrong}, which tables cannot have: rename it")
    about = {"item": name, "class": text("category"), "split": text("split"), "source": source,
             "source_files": "", "viewers": "", "licence": ""}
    return Form(points, None if faces is None else np.asarray(faces), floats("normals") if faces is None else None,
                truths=(truth,) if has_truth else (), recording=getattr(shape, "recording", None), about=about)


def row_of(name: str, form: Form) -> Row:
    """Row of the index for a shape that `form_of` made, which has no views."""
    about, truth = form.about, form.truths[0] if form.truths else None
    return (name, "", about["class"], about["split"], "cloud" if form.faces is None else "mesh", truth is not None,
            len(truth.picks) if truth is not None else 0, len(truth.viewers) if truth is not None and truth.viewers is not None else 0,
            about["source"], 0 if form.recording is None else len(form.recording.people))


def is_name(word: str) -> bool:
    """True of what a file or a group can be called, which leads nowhere else."""
    return word not in ("", ".", "..") and not {"/", "\0"} & set(word)


def form_of_fields(fields: Mapping[str, Any]) -> Form:
    """What the compiled part has read."""
    form = Form(**fields)
    form.truths = tuple(Truth(**truth) for truth in fields["truths"])
    form.recording = Recording(**recording) if (recording := fields["recording"]) else None
    return form
