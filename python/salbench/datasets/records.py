# SPDX-License-Identifier: GPL-3.0-or-later
"""Types that a data set returns: its items, and the shape of each with its ground truth. Importing this loads
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
        Files that `read` reads, the file of the shape first. Their contents are part of the key.
    category, split : str
        Class, and split; "train+test" is in both.
    kind : str
        "mesh" or "cloud"; "": by the extension of the first file (.pcd, .xyz, .txt and .csv are clouds, .ply
        as its header says).
    truth : bool
        True if `read` returns a ground truth.
    participants, viewers, recorded : int
        Number of people who picked points, who have a map each, and whose gaze was recorded, as `read`
        returns them; 0 if people are not told apart.
    shape, view : str
        For a view that is scored by itself: name of its shape, and of the view.
    problem : str
        One line, why the item cannot be used: it fails by name, the others are used.
    info : any JSON value
        For `read`; part of the key.
    saliency, picks : path, sequence of path
        For a set without `read`: a file of values per vertex, and one file of picked vertices per
        participant.
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
        """The first file, or the name; used at the beginning of messages."""
        return str(self.files[0]) if self.files else self.name

    @property
    def paths(self) -> list[str]:
        """Every file of the item."""
        return [path for path in (*self.files, self.saliency, *self.picks) if path]


@dataclass
class Listing:
    """Items of a folder, and remarks on it. A plain list of items will do without remarks."""

    items: list[Item]
    # one line each, for the user: ground truth without a shape, missing numbers
    notes: list[str] = field(default_factory=list)
    read: list[str] = field(default_factory=list)  # files beside those of items, such as splits
    splits_where: str = ""  # the file that names the splits
    no_splits: str = ""  # reason why no item is in a split
    # split, name, file and line: names in splits that are no items
    unknown: list[tuple[str, str, str]] = field(default_factory=list)
    remark: str = ""  # on the ground truth, repeated in every table

    @property
    def paths(self) -> set[str]:
        """Every file of the listing and its items."""
        return {*self.read, *(path for item in self.items for path in item.paths)}


@dataclass(slots=True)  # a name in `read` that no field has is an error
class Shape:
    """A shape with its ground truth, as `read` returns it.

    Attributes
    ----------
    points : (n, 3) array
    faces : (m, 3) array of int, or None
        Corners, 0-based; None: a point cloud.
    normals : (n, 3) array or None
        Normals of a cloud, of any length above 0; None: computed.
    ground_truth : (n,) array or None
        Saliency, NaN for points that nobody saw; None: made from `participants`, or from `recording`.
    participants : sequence of (p,) arrays of int
        Points that each participant picked, 0-based.
    viewers : (v, n) array or None
        Saliency by viewer, beside `ground_truth`.
    face_truth : (m,) array or None
        Values per face, as published; `ground_truth` then holds their means at the vertices.
    recording : Recording or None
        Gaze of people on the shape.
    """

    points: Any
    faces: Any = None
    normals: Any = None
    ground_truth: Any = None
    participants: Sequence[Any] = ()
    viewers: Any = None
    face_truth: Any = None
    recording: Recording | None = None
    # Facts from readers of files, beside the shape.
    viewpoint: Any = None  # (3,) for a cloud that one camera saw
    left_out: Any = None  # for a cloud: rows of the file without a position, ascending
    polygons: tuple[int, int] = (0, 0)  # split into triangles, and the number of concave ones
    # (m,) polygon of the file for each face, from 0; None: face k is polygon k
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
    """Arrays of a shape with its ground truth. Throws InputError, one line that begins with `place`, for
    values that are no array of numbers."""
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
    """Arrays of the ground truth alone; empty if there is none."""
    picks = [_typed(one, "int32", f"{place}: participants") for one in shape.participants]
    if shape.ground_truth is None and shape.viewers is None and not any(map(len, picks)):
        return {}
    found = {}
    for name, own in (("saliency", "ground_truth"), ("viewers", "viewers"), ("faces", "face_truth")):
        if (given := getattr(shape, own)) is not None:
            found[name] = values = _typed(given, "float64", f"{place}: {own}")
            if name != "faces" and values.shape[-1:] != (len(shape.points),):
                raise InputError(
                    f"{place}: {own} has the shape {values.shape}, expected a value for each of"
                    f" {len(shape.points)} points"
                )
    if picks:
        import numpy as np

        found |= {"picks": np.concatenate(picks), "picks_of": np.array([*map(len, picks)], np.int32)}
    return {_group(view) + name: values for name, values in found.items()}


def _typed(given: Any, type: str, name: str) -> Any:
    """Converts to an array; integer types accept only whole numbers."""
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
    """Inverse of `arrays_of`, with the ground truth of a view."""
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
        ground_truth=arrays.get(f"{group}saliency"),
        participants=picks,
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
