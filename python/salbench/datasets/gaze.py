# SPDX-License-Identifier: GPL-3.0-or-later
"""Recordings of gaze in tables of text, a row per sample or fixation.

    table(path, columns)       the text of a file -> a data frame
    rows_of(frame, gaze)       a data frame -> the recording of one person, and why rows cannot be used
    gather(files, read, gaze)  the data frames of several people -> one recording
    read_gaze(files, gaze)     all of these

A row that has a time stays in the recording as a sample that was lost: how long nothing is known of the eye decides where a fixation ends,
and losses are reported per person. One that cannot be put in order of time is left out. Both are counted by cause and person.
"""

from __future__ import annotations

import csv
import functools
import io
import json
import os
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pandas as pd

from salbench.datasets.cameras import Frames, frame_of_rows, rays_of, read_frames
from salbench.datasets.files import natural_order
from salbench.datasets.records import Bools, Floats, InputError, Ints, Recording, Shape, UnreadableError
from salbench.system.errors import quoted, wrong_with_line
from salbench.system.files import read_file

MS = {"ms": 1.0, "s": 1000.0, "us": 0.001}
UNIT_ROUNDING = 1e-3  # of the length of a direction
Column = str | int  # its name in the header, in JSON lines the path of a key ("gaze.x", "gaze.0"), or its number from 1
Columns = Sequence[Column]

_NAN = float("nan")
_MISSING = ("", "NA", "N/A", "null", "None", ".", "-", "nan", "NaN", "NAN")
_WORDS = dict.fromkeys((None, *_MISSING), _NAN) | dict.fromkeys(("true", "True", "TRUE"), 1.0) | dict.fromkeys(("false", "False", "FALSE"), 0.0)
_ABSENT = object()
_WIDTHS = {"point": (3,), "origin": (3,), "direction": (2, 3), "pixel": (2,)}


@dataclass(frozen=True)
class Gaze:
    """Columns and units of a table. It has points, pixels with cameras, or directions with the place of the eye."""

    item: Column = ""
    person: Column = ""
    time: Column = ""  # "": each row begins when the one before it ends
    valid: Column = ""  # 0 or false where the tracker lost the eye
    duration: Column = ""  # of rows that are fixations already
    point: Columns = ()  # x, y, z of places looked at
    origin: Columns = ()  # x, y, z of the eye
    direction: Columns = ()  # x, y, z of its gaze; or two: azimuth and elevation
    pixel: Columns = ()  # x and y
    frame: Column = ""  # number of the camera that shows the pixel; "": the last one at the time of the sample
    valid_is: float | None = None  # the number that stands for a valid sample; None: any but 0
    unit: str = "ms"  # of times and durations: ms, s or us
    length: float = 1.0  # what coordinates, and the places of cameras, are multiplied by to be in the shape's unit
    angles: str = "degrees"  # or radians, of azimuth and elevation
    normalise_directions: bool = False  # False: one of another length than 1 is no direction
    delay_ms: float = 0.0  # how much later than what was shown a person responds to it

    def __post_init__(self) -> None:
        kinds = bool(self.point) + bool(self.direction) + bool(self.pixel)
        if kinds != 1 or bool(self.direction) > bool(self.origin) or not (self.time or self.duration) or self.unit not in MS:
            raise ValueError("a recording has columns of one kind (point, direction with origin, or pixel), time or duration, and a unit of "
                             f"{', '.join(MS)}: {self}")
        for name, widths in _WIDTHS.items():
            if len(getattr(self, name)) not in (0, *widths):
                raise ValueError(f"{name} must be {' or '.join(map(str, widths))} columns, not {len(getattr(self, name))}")

    @property
    def names(self) -> tuple[Column, ...]:  # of words
        return tuple(column for column in (self.item, self.person) if column)

    @property
    def numbers(self) -> dict[str, Column]:
        """Columns of numbers, by what they hold: "time", "point 0"."""
        single = {name: getattr(self, name) for name in ("valid", "time", "duration", "frame")}
        places = {f"{name} {k}": column for name in _WIDTHS for k, column in enumerate(getattr(self, name))}
        return {name: column for name, column in single.items() if column} | places


@dataclass
class Gathered:
    recording: Recording | None = None
    remarks: list[str] = field(default_factory=list)  # rows that cannot be used: a line per person and cause
    problems: list[str] = field(default_factory=list)  # files that cannot be read, a line each

    def added_to(self, shape: Shape) -> Shape:
        """The shape with this recording. Throws InputError where nothing would be known of it."""
        if self.recording is None and shape.truth is None and not len(shape.picks):
            raise InputError([*self.problems, *self.remarks, "there is no row of gaze on this shape"][0])
        shape.recording = self.recording
        shape.remarks, shape.problems = [*shape.remarks, *self.remarks], [*shape.problems, *self.problems]
        return shape


def read_gaze(files: Iterable[tuple[Any, str]], gaze: Gaze, item: str = "", cameras: Mapping[str, Any] | None = None) -> Gathered:
    """The recording in files (path, person), of an item of theirs.

    `person` is "" where a column names people, and `item` the name that the column of items has. `cameras`: the file of each person's
    cameras; that of "" is of all others. A file that cannot be read is a problem, and the others go on."""

    def rows(path: str) -> pd.DataFrame:
        frame = _whole(path, gaze)
        return frame[frame[gaze.item] == item] if gaze.item else frame

    return gather(files, rows, gaze, cameras)


def named(path: Any, gaze: Gaze) -> dict[str, list[str]]:
    """Items that rows of a file name, and the people of each; "" stands for what no column names."""
    frame = _whole(os.fspath(path), gaze)
    found: dict[str, list[str]] = {}
    for item, person in dict.fromkeys(zip(*(frame[column] if column else [""] * len(frame) for column in (gaze.item, gaze.person)))):
        if bool(item) == bool(gaze.item) and bool(person) == bool(gaze.person):
            found.setdefault(item, []).append(person)
    return found


def _whole(path: str, gaze: Gaze) -> pd.DataFrame:
    """A file that has rows of several items is read once."""
    columns = tuple(gaze.numbers.values()), gaze.names
    if not gaze.item or not os.path.isfile(path):
        return table(path, *columns)
    status = os.stat(path)
    return _kept(path, (status.st_size, status.st_mtime_ns, status.st_ino), *columns)


@functools.lru_cache(maxsize=64)
def _kept(path: str, stamp: tuple[int, ...], columns: tuple[Column, ...], names: tuple[Column, ...]) -> pd.DataFrame:
    return table(path, columns, names)


def table(path: str, columns: Columns, names: Columns = ()) -> pd.DataFrame:
    """Columns of numbers and of names, with the lines of the rows as index. `attrs["faults"]`: line -> why a row has no cells.

    The text is CSV, with commas, semicolons, tabs or blanks, or JSON lines. Lines that are blank or begin with '#' are skipped. Throws InputError."""
    data = read_file(path)
    if data[:2] in (b"\xff\xfe", b"\xfe\xff") or b"\0" in data[:4096]:
        raise InputError(f"{path}: is no text of UTF-8: save it as such")
    lines = [line.decode("utf-8", "surrogateescape") for line in data.removeprefix(b"\xef\xbb\xbf").splitlines()]
    numbers = [number for number, line in enumerate(lines, 1) if line[:1] != "#" and line.strip()]
    if not numbers:
        raise InputError(f"{path}: has no rows")
    read = _json_lines if lines[numbers[0] - 1].lstrip()[:1] == "{" else _delimited
    frame, faults = read(path, lines, numbers, columns, names)
    frame.attrs["faults"] = faults
    return frame


def _delimited(path: str, lines: list[str], numbers: list[int], columns: Columns, names: Columns) -> tuple[pd.DataFrame, dict[int, str]]:
    first, line = lines[numbers[0] - 1], numbers[0]
    separator = next((separator for separator in ";\t," if separator in re.sub('"[^"]*"', "", first)), " ")
    header, wanted = _cells(first, separator), (*names, *columns)
    by_name = {column for column in wanted if isinstance(column, str)}
    if by_name and all(_number(cell) is not None for cell in header):
        comments = (_cells(above[1:], separator) for above in lines[:line - 1])
        header = [header, *(cells for cells in comments if by_name <= {*cells} and len(cells) == len(header))][-1]  # as NumPy writes it
    elif by_name or any(_number(cell) is None for k, cell in enumerate(header, 1) if k in columns):
        numbers = numbers[1:]
    if missing := [column for column in wanted if column in by_name and column not in header]:
        raise InputError(f"{path}:{line}: no column {quoted(str(missing[0]))}: the first line has {', '.join(map(quoted, header[:20]))}")
    if not numbers:
        raise InputError(f"{path}: has no rows")
    place = {column: header.index(column) if isinstance(column, str) else column - 1 for column in wanted}
    rows = [lines[number - 1] for number in numbers]
    if separator == " ":
        rows = [" ".join(row.split()) for row in rows]
    faults, needed = dict[int, str](), 1 + max(place.values())
    width = max(needed, len(header))
    try:
        for number, row in zip(numbers, csv.reader(rows, delimiter=separator, skipinitialspace=True, strict=True), strict=True):
            width = max(width, len(row))
            if len(row) < needed:
                faults[number] = "fewer columns than are named"
            elif by_name and any(map(str.strip, row[len(header):])):
                faults[number] = "more columns than the header has: write decimal commas, if these are some, as points"
    except (csv.Error, ValueError):
        line = next((number for number, text in zip(numbers, rows) if text.count('"') % 2), line)
        raise InputError(f"{path}:{line}: a quote that nothing closes on its line, or text behind one: correct it") from None
    rows[0] += f'{separator}""' * (width - len(_cells(rows[0], separator)))  # pandas wants one row with all columns
    words = {place[column] for column in names}
    text = io.BytesIO("\n".join(rows).encode("utf-8", "surrogateescape"))
    cells = pd.read_csv(text, sep=separator, header=None, names=range(width), usecols=sorted({*place.values()}), index_col=False, low_memory=False,
                        dtype=dict.fromkeys(words, str), na_values=dict.fromkeys({*place.values()} - words, _MISSING), keep_default_na=False,
                        skipinitialspace=True, skip_blank_lines=False, encoding_errors="surrogateescape", float_precision="round_trip")
    frame = pd.DataFrame({column: cells[k].fillna("").str.strip() if k in words else cells[k] for column, k in place.items()})
    return frame.set_axis(numbers), faults


def _cells(row: str, separator: str) -> list[str]:
    text = " ".join(row.split()) if separator == " " else row
    return [cell.strip() for cell in next(csv.reader([text], delimiter=separator, skipinitialspace=True), [])]


def _json_lines(path: str, lines: list[str], numbers: list[int], columns: Columns, names: Columns) -> tuple[pd.DataFrame, dict[int, str]]:
    """An object per line. A column is the path of a key: names, and numbers from 0 of elements of lists, between points."""
    wanted, rows, faults = [*dict.fromkeys((*names, *columns))], list[list[Any]](), dict[int, str]()
    for number in numbers:
        try:
            value = json.loads(lines[number - 1])
        except (ValueError, RecursionError):
            value = None
        cells = [_at(value, str(column)) for column in wanted]
        if _ABSENT in cells:
            if not rows:
                raise InputError(f"{path}:{number}: no object of JSON with the keys {', '.join(quoted(str(column)) for column in wanted)}")
            faults[number] = "no object of JSON with these keys"
        rows.append([None if cell is _ABSENT else cell for cell in cells])
    frame = pd.DataFrame(rows, numbers, wanted)
    for name in names:
        frame[name] = ["" if cell is None else str(cell).strip() for cell in frame[name]]
    return frame, faults


def _at(value: Any, path: str) -> Any:
    try:
        return value[path] if path in value else functools.reduce(lambda at, step: at[int(step) if isinstance(at, list) else step], path.split("."), value)
    except (LookupError, TypeError, ValueError):
        return _ABSENT


class Faults:
    """Why rows cannot be used. The first cause of a row counts, except that one which leaves it out replaces one by which it is lost."""

    def __init__(self, n: int) -> None:
        self.cause: Ints = np.zeros(n, np.int32)  # place in `texts`; 0: none
        self.texts, self.leave_out = [""], [False]

    @property
    def left_out(self) -> Bools:
        return np.array(self.leave_out)[self.cause]

    def mark(self, rows: Bools, text: str, leaves_out: bool = False) -> None:
        if text not in self.texts:
            self.texts, self.leave_out = [*self.texts, text], [*self.leave_out, leaves_out]
        self.cause[rows & ((self.cause == 0) | (leaves_out & ~self.left_out))] = self.texts.index(text)


def rows_of(frame: pd.DataFrame, gaze: Gaze, person: str, before: float = -np.inf,
            frames: Frames | str = "there is no file of its cameras") -> tuple[Recording, Faults, float]:
    """Rows of one person from a data frame with the columns of `gaze`, why others cannot be used, and when the last one ends, in ms.
    before: when the rows of a table before this one end. frames: the cameras of pixels, or why there are none."""
    faults, everywhere = Faults(len(frame)), np.ones(len(frame), bool)
    faults.mark(everywhere & (not person or bool(wrong_with_line(person))), "no person is named, or with characters that tables cannot have", True)
    unread: dict[int, str] = frame.attrs.get("faults", {})
    for text in dict.fromkeys(unread.values()):
        faults.mark(np.array([unread.get(line) == text for line in frame.index], bool), text, leaves_out=True)
    columns, valid, flagged = dict[str, Floats](), everywhere.copy(), ~everywhere
    for name, column in gaze.numbers.items():
        columns[name], words = _numbers(frame[column])
        if name != "valid":
            faults.mark(words, "a word that is no number")
            continue
        flag, flagged = columns[name], words
        valid = np.isfinite(flag) & (flag != 0 if gaze.valid_is is None else flag == gaze.valid_is)
        word = quoted(str(frame[column].iloc[np.argmax(words)])) if words.any() else ""
        faults.mark(words, f"`valid` is a word such as {word}, expected a number, true or false")
    time, durations, end = _times(columns, faults, gaze, before)
    with np.errstate(all="ignore"):
        places = _rays_of_pixels(columns, faults, gaze, time, frames) if gaze.pixel else _places(columns, faults, gaze)
    kept = ~faults.left_out
    faults.cause[kept & ~valid & ~flagged] = 0  # what the tracker lost is no fault of the file
    valid &= faults.cause == 0
    for place in places.values():
        place[~valid] = _NAN
    return Recording((person,), np.zeros(int(kept.sum()), np.int32), time[kept], valid[kept], durations=None if durations is None else durations[kept],
                     **{name: place[kept] for name, place in places.items()}), faults, end


def _numbers(column: pd.Series) -> tuple[Floats, Bools]:
    """Values, NaN where there is none, and where another word stands in place of one."""
    if column.dtype != object:
        return column.to_numpy(float), np.zeros(len(column), bool)
    found = [_number(cell) for cell in column]
    return np.array([_NAN if value is None else value for value in found], float), np.array([value is None for value in found], bool)


def _number(cell: Any) -> float | None:
    """None for a word that is no number."""
    try:
        word = cell.strip() if isinstance(cell, str) else cell
        return _WORDS[word] if word in _WORDS else float(word)
    except (TypeError, ValueError, OverflowError):
        return None


def _times(columns: dict[str, Floats], faults: Faults, gaze: Gaze, before: float) -> tuple[Floats, Floats | None, float]:
    """Times, durations and when the last row ends, in ms. Where no times are given, each row begins when the one before it ends."""
    durations = columns["duration"] * MS[gaze.unit] if gaze.duration else None
    if durations is not None:
        faults.mark(~(np.isfinite(durations) & (durations > 0)), "the duration is no number above 0", leaves_out=True)
    if not gaze.time:
        usable = np.where(faults.left_out, 0.0, columns["duration"] * MS[gaze.unit])
        ends = np.cumsum(usable) + (before if np.isfinite(before) else 0.0)
        return ends - usable, durations, float(ends[-1]) if len(ends) else before
    time = columns["time"] * MS[gaze.unit]
    faults.mark(~np.isfinite(time), "the time is no finite number", leaves_out=True)
    reached = np.maximum.accumulate(np.append(before, np.where(faults.left_out, -np.inf, time)))
    faults.mark(time < reached[:-1], "the time runs back", leaves_out=True)
    faults.mark(time == reached[:-1], "the time is that of a row before", leaves_out=True)
    return time, durations, float(reached[-1])


def _stacked(columns: dict[str, Floats], name: str, faults: Faults) -> Floats:
    place = np.stack([columns[key] for key in columns if key.startswith(f"{name} ")], axis=1)
    faults.mark(~np.isfinite(place).all(axis=1), "a coordinate is missing, NaN or infinite")
    return place


def _places(columns: dict[str, Floats], faults: Faults, gaze: Gaze) -> dict[str, Floats]:
    """Points, origins and directions of those that there are."""
    found = {f"{name}s": gaze.length * _stacked(columns, name, faults) for name in ("point", "origin") if getattr(gaze, name)}
    if not gaze.direction:
        return found
    directions = _stacked(columns, "direction", faults)
    if directions.shape[1] == 2:
        azimuth, elevation = np.radians(directions.T) if gaze.angles == "degrees" else directions.T
        directions = np.stack([np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth), np.sin(elevation)], axis=1)
    largest = np.abs(directions).max(axis=1, keepdims=True)
    scaled = directions / largest  # squares of these neither overflow nor vanish
    lengths = np.linalg.norm(scaled, axis=1)
    faults.mark(largest[:, 0] == 0, "the direction has no length")
    if not gaze.normalise_directions:
        faults.mark(~(np.abs(lengths * largest[:, 0] - 1) <= UNIT_ROUNDING),
                    "the direction is not of length 1; for directions of any length give normalise_directions=True")
    return found | {"directions": scaled / lengths[:, None]}


def _rays_of_pixels(columns: dict[str, Floats], faults: Faults, gaze: Gaze, time: Floats, frames: Frames | str) -> dict[str, Floats]:
    pixels = _stacked(columns, "pixel", faults)
    try:
        if isinstance(frames, str):
            raise InputError(frames)
        camera = frame_of_rows(frames, columns.get("frame"), time, gaze.delay_ms)
    except InputError as error:
        faults.mark(np.ones(len(pixels), bool), str(error))
        return {name: np.full((len(pixels), 3), _NAN) for name in ("origins", "directions")}
    faults.mark(camera < 0, "there is no camera of its frame")
    for place, problem in frames.problems.items():
        faults.mark(camera == place, problem)
    return dict(zip(("origins", "directions"), rays_of(frames, pixels, camera, gaze.length)))


def gather(files: Iterable[tuple[Any, str]], read: Callable[[str], pd.DataFrame], gaze: Gaze, cameras: Mapping[str, Any] | None = None) -> Gathered:
    """As `read_gaze`, with a function of one's own that makes a data frame of a path. Its index has the lines."""
    found, counts, totals, ends = Gathered(), dict[tuple[str, str, bool], list[Any]](), dict[str, int](), dict[str, float]()
    parts = dict[str, list[Recording]]()
    frames: dict[str, Frames | str] = {"": "there is no file of its cameras"}
    paths = {person: os.fspath(path) for person, path in (cameras or {}).items()}
    for path in dict.fromkeys(paths.values()):
        frames[path] = _attempt(read_frames, path, found.problems, "gaze in its frames is lost") or "the file of its cameras cannot be read"
    for path, person in files:
        frame = _attempt(read, os.fspath(path), found.problems, f"{person or 'its people'} cannot be in the recording")
        for name, rows in () if frame is None else frame.groupby(gaze.person, sort=False) if gaze.person else [(person, frame)]:
            rows.attrs = frame.attrs
            recording, faults, ends[name] = rows_of(rows, gaze, name, ends.get(name, -np.inf), frames[paths.get(name, paths.get("", ""))])
            parts.setdefault(name, []).append(recording)
            totals[name] = totals.get(name, 0) + len(rows)
            for cause, first, n in zip(*np.unique(faults.cause, return_index=True, return_counts=True)):
                key = name, faults.texts[cause], faults.leave_out[cause]
                counts.setdefault(key, [f"{os.fspath(path)}:{rows.index[first]}", 0])[1] += int(n)
    found.remarks = [f"{where}: {n} of {totals[name]} rows of {(name if name.isprintable() else quoted(name)) or 'nobody'} {'is' if n == 1 else 'are'} "
                     f"{'left out' if left_out else 'lost'}: {text} (the first is here)" for (name, text, left_out), (where, n) in counts.items() if text]
    found.recording = _together(parts)
    return found


def _attempt(read: Callable[[str], Any], path: str, problems: list[str], what: str) -> Any:
    """None for a file that cannot be read, which is a problem."""
    try:
        return read(path)
    except UnreadableError:
        raise
    except InputError as error:
        problems.append(f"{error}; {what}")


def _together(by_person: dict[str, list[Recording]]) -> Recording | None:
    people = sorted((name for name, parts in by_person.items() if any(len(part.time) for part in parts)), key=natural_order)
    if not people:
        return None
    parts = [part for name in people for part in by_person[name]]
    person: Ints = np.repeat(np.arange(len(people), dtype=np.int32), [sum(len(part.time) for part in by_person[name]) for name in people])
    columns: list[Any] = [[getattr(part, name) for part in parts] for name in ("time", "valid", "origins", "directions", "points", "durations")]
    joined: list[Any] = [None if column[0] is None else np.concatenate(column) for column in columns]
    return Recording(tuple(people), person, *joined)
