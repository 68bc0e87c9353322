# SPDX-License-Identifier: GPL-3.0-or-later
"""What a description says of a data set: where its files lie, and how they are read. Defaults are those of the Schelling study: a
number per vertex, and 0-based indices. [chen2012]"""

from __future__ import annotations

from dataclasses import dataclass, field, fields, replace
from typing import Any

from salbench.datasets._text import finite_number

Words = tuple[str, ...]
SPACE, SURFACE, LISTED = "space", "surface", "listed"
METRES = {"m": 1.0, "dm": 0.1, "cm": 0.01, "mm": 0.001, "um": 1e-6, "in": 0.0254, "ft": 0.3048}


# Fields that are keys of a description say here what else is expected of them than their type; _section.py reads them.


def one_of(default: str, *others: str, **told: Any) -> Any:
    return field(default=default, metadata={"one_of": {name: name for name in (default, *others)}, **told})


def above_0(default: float) -> Any:
    return field(default=default, metadata={"above_0": True})


def no_key() -> Any:
    return field(default="", metadata={"key": None})


def pattern(*parts: str) -> Any:
    """Of a file per item; parts: placeholders that it may have beside {item}. With {item} among them it need not have that."""
    return field(default=Pattern(), metadata={"parts": parts})


class Pattern(str):
    """Names of files below the folder of the data set (_patterns.py), with the place in the description that has them."""

    where: str = ""

    @classmethod
    def at(cls, text: str, where: str) -> Pattern:
        pattern = cls(text)
        pattern.where = where
        return pattern


_SPREAD = {"section": "spread"}  # of `values`


@dataclass(frozen=True)
class Values:
    """How files of saliency are read."""

    per: str = one_of("vertex", "face", "point")  # what a value belongs to: vertex, face (in the order of the mesh's file), or a point beside the value
    column: str = ""  # its name in the header, or its number from 1; "": the only one
    points: Words = ("1", "2", "3")  # columns of x, y and z, of values per point
    max_distance: float = above_0(0.02)  # in R: a vertex farther from every point was not seen
    unseen: str = ""  # value in the file of what was not seen, such as "-1" or "nan"
    scale: float = above_0(1.0)  # what the coordinates beside values are multiplied by to be in the shape's unit
    positives: str = "picks"  # points that count as picked: picks, above mean, or "top 20%" of what was seen
    spread_neighbours: int = field(default=0, metadata=_SPREAD | {"key": "neighbours"})  # how many neighbours a point that was looked at adds to; 0: densities stay as the file has them
    spread_from: float = field(default=0.9, metadata=_SPREAD | {"key": "from"})  # what the first of them gets, as a share of the point's value; the last one gets 0
    spread_along: str = one_of(SPACE, SURFACE, LISTED, key="along", **_SPREAD)  # how neighbours are found: space, surface (along edges), or listed in files of their own


@dataclass(frozen=True)
class Indices:
    """How files of picks are read."""

    base: int = 0  # number of the first vertex


@dataclass(frozen=True)
class Columns:
    """A point cloud in columns of a text, with its ground truth beside it. Columns are named as in `Values`."""

    position: Words = ()  # x, y, z; (): shapes are no such texts
    normal: Words = ()  # x, y, z; (): computed
    normalise_normals: bool = False  # False: another length than 1 is an error
    padding: str = one_of("none", "zeros", "copies", "any")  # rows at the end that fill up the file: none, zeros, copies of a row before them, any
    duplicates: str = one_of("kept", "dropped")  # or dropped: points at the coordinates of one before them
    density: str = ""  # the saliency
    flag: str = ""  # 0 and 1, 1 for picks


@dataclass(frozen=True)
class TruthPlace:
    saliency: Pattern = pattern("{view}", "{viewer}")  # one file per item, or one per view or viewer
    picks: Pattern = pattern("{participant}")  # one file per participant, or one per item
    viewers: Pattern = pattern("{view}", "{viewer}")  # one file per viewer, or per view and viewer, beside a saliency that is not made of them
    mask: Pattern = pattern("{view}", "{viewer}")  # 0 for hidden, 1 for seen; one file per file of saliency, or one per item


_NAMED = {"section": "columns"}  # of `recording`


def _column() -> Any:
    return field(default="", metadata=_NAMED)


def _three() -> Any:
    return field(default=(), metadata=_NAMED)


@dataclass(frozen=True)
class Gaze:
    """How recordings of gaze are read. A column is its name in the header or its number from 1, in JSON lines the path of a key ("gaze.x")."""

    files: Pattern = pattern("{item}", "{person}")  # one per item and person, one per either, or one of all; columns say what names do not
    item: str = _column()
    person: str = _column()
    time: str = _column()  # "": each row begins when the one before it ends
    valid: str = _column()  # 0 or false where the tracker lost the eye
    duration: str = _column()  # of rows that are fixations already
    point: Words = _three()  # x, y, z of places looked at
    origin: Words = _three()  # x, y, z of the eye
    direction: Words = _three()  # x, y, z of its gaze; or two: azimuth and elevation
    pixel: Words = _three()  # x and y
    frame: str = _column()  # number of the camera that shows the pixel; "": the last one at the time of the sample
    valid_is: str = ""  # the number that stands for a valid sample; "": any but 0
    unit: str = one_of("ms", "s", "us", key="time")  # of times and durations
    length: float = field(default=1.0, metadata={"key": None})  # a unit or a number: what coordinates, and the places of cameras, are multiplied by to be in the shape's unit
    angles: str = one_of("degrees", "radians")  # of azimuth and elevation
    normalise_directions: bool = False  # False: one of another length than 1 is no direction
    cameras: Pattern = pattern("{item}", "{person}")  # JSON, of pixels
    delay_ms: float = 0.0  # how much later than what was shown a person responds to it

    def __bool__(self) -> bool:
        return bool(self.files)

    @property
    def numbers(self) -> Words:
        """Columns of numbers, in the order in which rows have them."""
        own = (self.time, self.valid, self.duration, self.frame)
        return (*(name for name in own if name), *self.point, *self.origin, *self.direction, *self.pixel)


@dataclass(frozen=True)
class Place:
    meshes: Pattern  # the name without extension is the item's
    truth: tuple[TruthPlace, ...] = ()  # the first that has an existing folder is taken
    needs: str = ""  # folder without which the place is not looked at
    root_is: str = ""  # the name that the root itself must have
    views: str = one_of("averaged", "scored")  # or scored: each is a unit of its own
    neighbours: Pattern = pattern()  # lists that saliency is spread over, one file per item


@dataclass(frozen=True)
class Splits:
    """One of three: a table, a list whose first lines are one split, or names in the description itself."""

    table: str = field(default="", metadata={"key": "file"})  # CSV file below the folder of the data set
    item: str = "item"  # its columns
    split: str = "split"
    list: str = ""  # file with the path of an item's file in each line
    shares: tuple[tuple[str, float], ...] = ()  # of its lines, in their order; they sum to 1
    named: tuple[tuple[str, Words, str], ...] = ()  # split, items, where that is written
    where: str = no_key()

    def __bool__(self) -> bool:
        return bool(self.table or self.list or self.named)


@dataclass(frozen=True)
class Layout:
    name: str = field(metadata={"key": None})
    places: tuple[Place, ...]  # below the folder that the user names; the first with a mesh is taken
    classes: str = one_of("none", "folder", "shrec07")  # of an item: none, its mesh's folder, or shrec07: the class of a mesh named 1 to 400 [giorgi2007]
    domain: str = one_of("any", "meshes", "points")  # which of the files that fit are shapes: meshes, points, or any
    needs_truth: bool = field(default=True, metadata={"key": "ground_truth", "one_of": {"required": True, "optional": False}})  # patterns of ground truth that fit no file are an error
    values: Values = Values()
    indices: Indices = Indices()
    columns: Columns = Columns()
    recording: Gaze = Gaze()
    splits: Splits = Splits()
    scale: float = above_0(1.0)
    unit_where: str = no_key()  # where a unit of length is given; "": nowhere
    licence: str = ""  # on what terms the authors give the data, as far as is known
    aliases: tuple[tuple[str, str], ...] = ()  # name of an item in files of viewers, and its name elsewhere
    remark: str = no_key()  # on the ground truth, repeated in every table
    remark_unlisted: str = no_key()  # likewise, where lists of neighbours would lie but do not

    def where(self, written: str) -> str:
        """Of something in a user's description, its file and line; of an archive's own layout its name."""
        return written or f"layout {self.name}"


def described(options: Any, **others: Any) -> str:
    """" (per: face, column: 3)": options that are not at their defaults, in a key and for people."""
    options = replace(options, **others)
    told = [f"{entry.name}: {_text(getattr(options, entry.name))}" for entry in fields(options)
            if getattr(options, entry.name) != entry.default]
    return f" ({', '.join(told)})" if told else ""


def number_text(value: float) -> str:
    """The shortest that reads back as the same bits."""
    return repr(float(value)).removesuffix(".0")


def _text(value: Any) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, float):
        return number_text(value)
    return f"[{', '.join(value)}]" if isinstance(value, tuple) else str(value)


def positive_rule(text: str) -> tuple[str, float] | None:
    """("picks", 0), ("mean", 0) or ("top", percent); None for what is no rule."""
    if text in ("picks", "above mean"):
        return text.removeprefix("above "), 0.0
    if text.startswith("top ") and text.endswith("%"):
        percent = finite_number(text[4:-1])
        if percent is not None and 0 < percent < 100:
            return "top", percent
    return None
