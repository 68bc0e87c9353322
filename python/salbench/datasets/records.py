# SPDX-License-Identifier: GPL-3.0-or-later
"""What importers hand over: the items of a data set as its folders list them, and the one form of a shape.

Importing this costs no NumPy: a listing opens no shape.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields
from typing import TYPE_CHECKING, Any

from salbench._errors import InputError as InputError
from salbench._errors import UnreadableError as UnreadableError

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]
    Ints = NDArray[np.int32]
    Bools = NDArray[np.bool_]
else:
    Floats = Ints = Bools = Any


@dataclass(frozen=True)
class Source:
    """A file of an item. The name says how it is read, and is part of the key of what is computed from it."""

    name: str  # "saliency file (per: face, column: 3)"; no path in it
    path: str
    title: str = ""  # for people: "saliency file cow.csv"


@dataclass
class Item:
    """A unit that is scored: a shape, or one view of it, with where its ground truth lies."""

    name: str
    shape: str = ""  # name of the shape; of a view that is scored the item is called SHAPE_VIEW
    view: str = ""
    category: str = ""
    split: str = ""
    kind: str = "mesh"  # or "cloud"; "" where only the file tells
    truth: bool = False
    participants: int = 0
    viewers: int = 0
    recorded: int = 0  # people whose gaze on it was recorded
    problem: str = ""  # why its ground truth cannot be used: one line
    files: tuple[Source, ...] = ()  # in the order in which they are read
    how: dict[str, Any] = field(default_factory=dict)  # what `read` needs beside the files; plain JSON
    native: bool = False  # C++ reads it by itself: a mesh, files of values per vertex, and of picks per participant

    @property
    def shape_name(self) -> str:
        return self.shape or self.name

    def take_native(self, mesh: str, saliency: Sequence[str], picks: Sequence[str]) -> None:
        paths = [mesh, *saliency, *picks]
        self.files, self.native = tuple(Source("", path) for path in paths), True
        self.how = {key: len(part) for key, part in (("saliency", saliency), ("picks", picks)) if part}

    @property
    def native_files(self) -> tuple[str, list[str], list[str]]:
        """Of a native item: its mesh, saliency and picks."""
        mesh, *paths = (file.path for file in self.files)
        n = self.how.get("saliency", 0)
        return mesh, paths[:n], paths[n:]

    def to_json(self) -> dict[str, Any]:
        row = {entry.name: getattr(self, entry.name) for entry in fields(self)}
        row["shape"] = self.shape_name
        if self.native:
            del row["files"], row["how"]
            return row | {"native": dict(zip(("mesh", "saliency", "picks"), self.native_files))}
        del row["native"]
        return row | {"files": [{"name": file.name, "path": file.path, "title": file.title} for file in self.files]}

    @classmethod
    def from_json(cls, row: Mapping[str, Any]) -> Item:
        known = {entry.name for entry in fields(cls)}
        values = {key: value for key, value in row.items() if key in known}
        values["files"] = tuple(Source(**file) for file in row.get("files", ()))
        native = values.pop("native", None)
        item = cls(**values)
        if native:
            item.take_native(**native)
        return item


@dataclass
class Listing:
    """A data set as its folders show it."""

    items: list[Item]
    notes: list[str] = field(default_factory=list)  # a line each: ground truth without a shape, missing numbers
    read: list[str] = field(default_factory=list)  # files beside those of items: splits
    splits_where: str = ""  # file and line of the description
    no_splits: str = ""  # why no item is in a split; "": some are, or none are described
    unknown: list[dict[str, str]] = field(default_factory=list)  # split, name, where: names in splits that are no items
    scale: float = 1.0  # of coordinates, where lengths are shown
    unit_where: str = ""
    licence: str = ""
    positives: str = "picks"
    remark: str = ""  # on the ground truth, repeated in every table; one of the notes

    def files(self) -> set[str]:
        """Every file that the items and the listing are read from."""
        used = set(self.read)
        for item in self.items:
            used |= {file.path for file in item.files} | ({item.how["form"]} if "form" in item.how else set())
        return used


@dataclass
class AsRead:
    """One file of saliency, where what is scored is not what it holds."""

    file: str  # its name, without folders
    per: str  # "vertex", "face" or "point"
    values: Floats  # one per element, before the mask; NaN: not seen
    points: Floats | None = None  # (k, 3), of values per point
    mask: Floats | None = None  # 0 hidden, 1 seen


@dataclass
class Truth:
    view: str = ""  # that is scored by itself; "": the shape
    saliency: Floats | None = None  # (n,); NaN: not seen. None: people's picks are all that is known
    viewers: Floats | None = None  # (v, n)
    picks: tuple[Ints, ...] = ()  # 0-based, a participant each
    face_values: Floats | None = None  # (f,), as published
    as_read: tuple[AsRead, ...] = ()


@dataclass
class Recording:
    """Samples of people's gaze on a shape, or fixations: m rows, person after person, each one's in order of time.

    They are rays, with `origins` and `directions`, or hits, with `points`.

    Attributes
    ----------
    people : tuple of str
        Names.
    person : (m,) array of int
        Whose row it is, from 0 and ascending.
    time : (m,) array
        In ms, ascending within each person.
    valid : (m,) array of bool
        False where the tracker lost the eye.
    origins : (m, 3) array or None
        The eye, in the frame of the shape; of hits it may be unknown.
    directions : (m, 3) array or None
        Unit vectors, of rays.
    points : (m, 3) array or None
        Places looked at, of hits, in the frame of the shape.
    durations : (m,) array or None
        In ms, where rows are fixations already.
    """

    people: tuple[str, ...]
    person: Ints
    time: Floats
    valid: Bools
    origins: Floats | None = None
    directions: Floats | None = None
    points: Floats | None = None
    durations: Floats | None = None


@dataclass
class Form:
    """The one form of a shape in memory (docs/hdf5_form.md)."""

    points: Floats  # (n, 3)
    faces: Ints | None = None  # (f, 3); None: a point cloud
    normals: Floats | None = None  # of clouds
    viewpoint: Floats | None = None
    left_out: Ints | None = None  # of clouds: rows of the file that are no points here, ascending
    polygons: tuple[int, int] = (0, 0)  # that were split, and how many of them were concave
    face_of: Ints | None = None  # (f,) which face of the mesh's file, from 0, each of `faces` is part of; None: it is that of the same number
    truths: tuple[Truth, ...] = ()
    recording: Recording | None = None
    about: dict[str, str] = field(default_factory=dict)  # item, class, split, source, source_files, viewers, licence
    digests: dict[str, str] = field(default_factory=dict)  # path of each file that was read -> what xxh128sum prints of it
    remarks: list[str] = field(default_factory=list)  # on rows of the recording that cannot be used; these and `problems` go into no file
    problems: list[str] = field(default_factory=list)  # files of the recording that cannot be read
