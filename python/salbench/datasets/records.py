# SPDX-License-Identifier: GPL-3.0-or-later
"""What a data set hands over: its items, and the shape of each with its ground truth. Importing this loads
no NumPy: a listing reads no shape."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from salbench.system.errors import InputError as InputError, UnreadableError as UnreadableError

if TYPE_CHECKING:
    from salbench.datasets.recordings import Recording


@dataclass
class Item:
    """A unit that is scored: a shape, or one view of it.

    Attributes
    ----------
    name : str
        Unique in the data set.
    files : sequence of path
        What `read` reads, the file of the shape first. Their contents are part of the key of what it returns.
    category, split : str
        Class, and split; "train+test" is in both.
    kind : str
        "mesh" or "cloud"; "": the extension of the first file says it (.pcd, .xyz, .txt and .csv are clouds,
        .ply as its header says).
    truth : bool
        Whether `read` returns a ground truth.
    participants, viewers, recorded : int
        People who picked points, who have a map each, and whose gaze was recorded, as `read` returns them; 0
        where people are not told apart.
    shape, view : str
        Of a view that is scored by itself: name of its shape, and of the view.
    problem : str
        One line, why the item cannot be used: it fails by name, the others go on.
    info : anything that JSON can hold
        For `read`; part of the key.
    saliency, picks : path, sequence of path
        Of a set without `read`: a file of values per vertex, and one of picked vertices per participant.
    """

    name: str
    files: Sequence[Any] = ()
    category: str = ""
    split: str = ""
    kind: str = ""
    truth: bool = True
    participants: int = 0
    viewers: int = 0
    recorded: int = 0
    shape: str = ""
    view: str = ""
    problem: str = ""
    info: Any = None
    saliency: Any = ""
    picks: Sequence[Any] = ()

    @property
    def shape_name(self) -> str:
        return self.shape or self.name

    @property
    def place(self) -> str:
        """The first file, or the name: messages begin with it."""
        return str(self.files[0]) if self.files else self.name

    @property
    def paths(self) -> list[str]:
        """Every file that it is read from."""
        return [path for path in (*self.files, self.saliency, *self.picks) if path]


@dataclass
class Listing:
    """Items of a folder, and what there is to say about it. A list of items will do where there is
    nothing."""

    items: list[Item]
    # a line each, for the user: ground truth without a shape, missing numbers
    notes: list[str] = field(default_factory=list)
    read: list[str] = field(default_factory=list)  # files beside those of items, such as splits
    splits_where: str = ""  # the file that names the splits
    no_splits: str = ""  # why no item is in a split
    # split, name, file and line: names in splits that are no items
    unknown: list[tuple[str, str, str]] = field(default_factory=list)
    remark: str = ""  # on the ground truth, repeated in every table

    @property
    def paths(self) -> set[str]:
        """Every file that it and its items are read from."""
        return {*self.read, *(path for item in self.items for path in item.paths)}


@dataclass
class Shape:
    """A shape with its ground truth, as `read` returns it.

    Attributes
    ----------
    points : (n, 3) array
    faces : (m, 3) array of int, or None
        Corners, 0-based; None: a point cloud.
    normals : (n, 3) array or None
        Unit normals of a cloud, (0, 0, 0) where not known; None: they are computed.
    truth : (n,) array or None
        Saliency, NaN for what nobody saw; None: it is made from `picks`, or from `recording`.
    picks : sequence of (p,) arrays of int
        Points that each participant picked, 0-based.
    viewers : (v, n) array or None
        Saliency by viewer, beside `truth`.
    face_truth : (m,) array or None
        Values per face, as published; `truth` is then what the vertices make of them.
    recording : Recording or None
        Gaze of people on the shape.
    """

    points: Any
    faces: Any = None
    normals: Any = None
    truth: Any = None
    picks: Sequence[Any] = ()
    viewers: Any = None
    face_truth: Any = None
    recording: Recording | None = None
    # What readers of files tell beside the shape.
    viewpoint: Any = None  # (3,) of a cloud that one camera saw
    left_out: Any = None  # of a cloud: rows of the file that have no position, ascending
    polygons: tuple[int, int] = (0, 0)  # that were split into triangles, and how many of them were concave
    # (m,) the polygon of the file that each face is part of, from 0; None: that of the same number
    face_of: Any = None


# --- in the HDF5 form
# -------------------------------------------------------------------------------------------------------------------------
# C++ takes and gives a shape as the data sets that the form has of it (docs/hdf5_form.md), and checks them:
# arrays by name, the ground truth of a view in a group of its own.

_POINTS, _FACES, _POLYGONS = "shape/points", "shape/faces", "shape/polygons"
_OF_CLOUD = ("normals", "viewpoint", "left_out")
_OF_RECORDING = ("time", "origins", "directions", "points", "durations")

Arrays = dict[str, Any]


def _group(view: str) -> str:
    return f"views/{view}/" if view else "truth/"


def has_truth(arrays: Arrays, view: str) -> bool:
    return any(name.startswith(_group(view)) for name in arrays)


def arrays_of(shape: Shape, view: str = "", place: str = "shape") -> Arrays:
    """Of a shape with its ground truth. Throws InputError, one line that begins with `place`, for what is
    no array of numbers."""
    found = {_POINTS: _typed(shape.points, "float64", f"{place}: points")}

    def put(group: str, given: Any, **types: str) -> None:
        for name, type in types.items():
            if (values := getattr(given, name)) is not None:
                found[group + name] = _typed(values, type, f"{place}: {name}")

    if shape.faces is None:
        put("shape/", shape, normals="float64", viewpoint="float64", left_out="int32")
    else:
        put("shape/", shape, faces="int32")
    if shape.polygons[0]:
        found[_POLYGONS] = _typed(shape.polygons, "int64", f"{place}: polygons")
    if shape.recording is not None:
        put("recording/", shape.recording, person="int32", **dict.fromkeys(_OF_RECORDING, "float64"))
        found["recording/valid"] = _typed(shape.recording.valid, "uint8", f"{place}: valid")
        found["recording/people"] = _typed(
            [*b"".join(os.fsencode(name) + b"\n" for name in shape.recording.people)],
            "uint8",
            f"{place}: people",
        )
    return found | truth_arrays(shape, view, place)


def truth_arrays(shape: Shape, view: str = "", place: str = "shape") -> Arrays:
    """Of the ground truth alone; none where none is known."""
    picks = [_typed(one, "int32", f"{place}: picks") for one in shape.picks]
    named = {"saliency": shape.truth, "viewers": shape.viewers, "faces": shape.face_truth}
    if shape.truth is None and shape.viewers is None and not any(map(len, picks)):
        return {}
    found = {
        name: _typed(values, "float64", f"{place}: {name}")
        for name, values in named.items()
        if values is not None
    }
    if picks:
        import numpy as np

        found |= {"picks": np.concatenate(picks), "picks_of": np.array([*map(len, picks)], np.int32)}
    return {_group(view) + name: values for name, values in found.items()}


def _typed(given: Any, type: str, name: str) -> Any:
    """An array; whole numbers are made of whole numbers alone."""
    import numpy as np

    kinds, what = ("iu", "whole numbers") if type.startswith("int") else ("biuf", "real numbers")
    try:
        values = np.asarray(given)
    except (TypeError, ValueError) as error:
        raise InputError(f"{name} must be an array of numbers: {error}") from None
    if isinstance(given, np.ma.MaskedArray):
        raise InputError(f"{name} must not be a masked array: give its data")
    if values.size and values.dtype.kind not in kinds:
        raise InputError(f"{name} must have {what}, not {values.dtype}")
    if type == "int32" and values.size and not -(2**31) <= values.min() <= values.max() < 2**31:
        raise InputError(f"{name} must have numbers of points, below 2^31")
    return values.astype(type, copy=False)


def shape_of(arrays: Arrays, view: str = "") -> Shape:
    """The inverse, with the ground truth of a view."""
    group = _group(view)
    of_cloud: dict[str, Any] = {name: arrays.get(f"shape/{name}") for name in _OF_CLOUD}
    picks: tuple[Any, ...] = ()
    if (counts := arrays.get(f"{group}picks_of")) is not None:
        picks = tuple(
            arrays[f"{group}picks"][end - count : end] for end, count in zip(counts.cumsum(), counts)
        )
    split, concave = map(int, arrays.get(_POLYGONS, (0, 0)))
    return Shape(
        arrays[_POINTS],
        arrays.get(_FACES),
        truth=arrays.get(f"{group}saliency"),
        picks=picks,
        viewers=arrays.get(f"{group}viewers"),
        face_truth=arrays.get(f"{group}faces"),
        recording=_recording_of(arrays),
        polygons=(split, concave),
        **of_cloud,
    )


def _recording_of(arrays: Arrays) -> Recording | None:
    if "recording/person" not in arrays:
        return None
    from salbench.datasets.recordings import Recording

    people = tuple(map(os.fsdecode, arrays["recording/people"].tobytes().split(b"\n")[:-1]))
    columns: dict[str, Any] = {name: arrays.get(f"recording/{name}") for name in _OF_RECORDING}
    return Recording(
        people, arrays["recording/person"], valid=arrays["recording/valid"].astype(bool), **columns
    )
