# SPDX-License-Identifier: GPL-3.0-or-later
"""The recording of an item from its files: rows of people in order of time, in the shape's frame and in milliseconds. Gaze in pixels becomes
rays of its cameras."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from salbench import _core
from salbench._errors import wrong_with_line
from salbench.datasets._files import read_file
from salbench.datasets._gaze_cameras import Frames, frame_of_rows, rays_of, read_frames
from salbench.datasets._gaze_causes import Causes, Wrong, has_no_flag, is_left_out
from salbench.datasets._gaze_store import LINE, PERSON, WRONG, FileRows, rows_of
from salbench.datasets._layout import Gaze
from salbench.datasets._patterns import natural_order
from salbench.datasets._text import finite_number
from salbench.datasets.records import Bools, Floats, InputError, Ints, Item, Recording, UnreadableError

MS = {"ms": 1.0, "s": 1000.0, "us": 0.001}
UNIT_ROUNDING = 1e-3  # of the length of a direction
_OF_GAZE = ("origins", "directions", "points")


@dataclass
class _Part:
    """Rows of one person in one file that have a place in the recording, in their order."""

    time: Floats
    valid: Bools
    durations: Floats | None
    origins: Floats | None = None
    directions: Floats | None = None
    points: Floats | None = None


@dataclass
class Gathered:
    recording: Recording | None = None
    causes: Causes = field(default_factory=Causes)
    problems: list[str] = field(default_factory=list)  # files that cannot be read, a line each
    digests: dict[str, str] = field(default_factory=dict)


def read_recording(item: Item) -> Gathered:
    """Of an item whose last files are those of its recording (described.py)."""
    from salbench.datasets._truth import options_of

    gaze: Gaze = options_of(item.how, Gaze)
    told: dict[str, Any] = item.how["recording"]
    paths = [file.path for file in item.files[len(item.files) - len(told["people"]) - len(told["cameras"]):]]
    found = Gathered()
    reader = _Reader(gaze, told, dict(zip(told["cameras"], paths[len(told["people"]):])), found)
    by_person: dict[str, list[_Part]] = {}
    for path, person in zip(paths, told["people"]):
        try:
            rows = rows_of(path, gaze, told["rows_of"])
        except UnreadableError:
            raise
        except InputError as error:
            found.problems.append(f"{error}; {person or 'its people'} cannot be in the recording")
            continue
        found.digests[path] = rows.digest
        for name, part in reader.people_in(rows, person):
            by_person.setdefault(name, []).append(part)
    found.recording = _together({name: parts for name, parts in by_person.items() if any(len(part.time) for part in parts)})
    return found


@dataclass
class _Reader:
    gaze: Gaze
    told: dict[str, Any]
    cameras: dict[str, str]  # person, "" for everybody -> path
    found: Gathered
    frames: dict[str, Frames | None] = field(default_factory=dict)  # path -> None for a file that cannot be read
    latest: dict[str, float] = field(default_factory=dict)  # person -> the time of the last row so far

    def people_in(self, rows: FileRows, person: str) -> list[tuple[str, _Part]]:
        if not self.gaze.person:
            if wrong := wrong_with_line(person):
                self.found.problems.append(f"{rows.path}: names a person, and has {wrong}, which tables cannot have: rename it")
                return []
            return [(person, self._part(rows, person, rows.table))]
        order = np.argsort(rows.table[:, PERSON], kind="stable")
        table = rows.table[order]
        starts = np.flatnonzero(np.append(True, np.diff(table[:, PERSON]) != 0)) if len(table) else np.empty(0, np.int64)
        parts = [(rows.people[int(table[start, PERSON])], table[start:end]) for start, end in zip(starts, np.append(starts[1:], len(table)))]
        for name, part in parts:
            if not name or wrong_with_line(name):
                part[:, WRONG] = Wrong.NO_PERSON
        return [(name, self._part(rows, name, part)) for name, part in parts]

    def _part(self, rows: FileRows, person: str, table: Floats) -> _Part:
        columns: dict[str, Floats] = {name: table[:, k] for k, name in enumerate(_names_of(self.gaze))}
        wrong, cameras = table[:, WRONG].copy(), []
        time, durations = self._times(columns, wrong, person)
        kept = ~is_left_out(wrong)
        self.found.causes.rows[person] = self.found.causes.rows.get(person, 0) + len(table)
        part = _Part(time[kept], _flags(columns, self.gaze)[kept], None if durations is None else durations[kept])
        columns = {name: column[kept] for name, column in columns.items()}
        of_kept = wrong[kept]
        if self.gaze.pixel:
            cameras = self._add_rays_of_pixels(part, columns, of_kept, person)
        else:
            self._add_places(part, columns, of_kept)
        of_kept[~part.valid & ~has_no_flag(of_kept)] = 0  # what the tracker lost is no fault of the file
        wrong[kept] = of_kept
        self.found.causes.add(person, rows.path, wrong, table[:, LINE], rows.flags, cameras)
        part.valid &= of_kept == 0
        for name in _OF_GAZE:
            if (column := getattr(part, name)) is not None:
                column[~part.valid] = np.nan
        return part

    def _times(self, columns: dict[str, Floats], wrong: Floats, person: str) -> tuple[Floats, Floats | None]:
        """In ms. Where none are given, each row begins when the one before it ends."""
        durations = columns["duration"] * MS[self.gaze.unit] if self.gaze.duration else None
        if durations is not None:
            _mark(wrong, ~(np.isfinite(durations) & (durations > 0)), Wrong.NO_DURATION, instead_of_lost=True)
        before = self.latest.get(person, -np.inf)
        if not self.gaze.time:
            assert durations is not None
            usable = np.where(is_left_out(wrong), 0.0, durations)
            ends = (before if np.isfinite(before) else 0.0) + np.cumsum(usable)
            if len(ends):
                self.latest[person] = float(ends[-1])
            return ends - usable, durations
        time = columns["time"] * MS[self.gaze.unit]
        _mark(wrong, ~np.isfinite(time), Wrong.NO_TIME, instead_of_lost=True)
        reached = np.maximum.accumulate(np.append(before, np.where(is_left_out(wrong), -np.inf, time)))
        _mark(wrong, time < reached[:-1], Wrong.BACK, instead_of_lost=True)
        _mark(wrong, time == reached[:-1], Wrong.REPEATED, instead_of_lost=True)
        self.latest[person] = float(reached[-1])
        return time, durations

    def _add_places(self, part: _Part, columns: dict[str, Floats], wrong: Floats) -> None:
        for kind in ("point", "origin"):
            if getattr(self.gaze, kind):
                place = self.gaze.length * np.stack([columns[f"{kind} {k}"] for k in range(3)], axis=1)
                _mark(wrong, ~_are_finite(place), Wrong.NOT_FINITE)
                setattr(part, f"{kind}s", place)
        if self.gaze.direction:
            part.directions = self._directions([columns[f"direction {k}"] for k in range(len(self.gaze.direction))], wrong)

    def _directions(self, columns: list[Floats], wrong: Floats) -> Floats:
        if len(columns) == 2:
            azimuth, elevation = (np.radians(angle) if self.gaze.angles == "degrees" else angle for angle in columns)
            columns = [np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth), np.sin(elevation)]
        directions = np.stack(columns, axis=1)
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            _mark(wrong, ~_are_finite(directions), Wrong.NOT_FINITE)
            largest = np.abs(directions).max(axis=1, keepdims=True)
            scaled = directions / largest
            scaled_lengths = np.linalg.norm(scaled, axis=1)
            _mark(wrong, largest[:, 0] == 0, Wrong.ZERO)
            if not self.gaze.normalise_directions:
                _mark(wrong, ~(np.abs(scaled_lengths * largest[:, 0] - 1) <= UNIT_ROUNDING), Wrong.LENGTH)
            return np.asarray(scaled / scaled_lengths[:, None])

    def _add_rays_of_pixels(self, part: _Part, columns: dict[str, Floats], wrong: Floats, person: str) -> list[str]:
        """What is wrong with the cameras."""
        pixels = np.stack([columns["pixel 0"], columns["pixel 1"]], axis=1)
        _mark(wrong, ~_are_finite(pixels), Wrong.NOT_FINITE)
        part.origins = part.directions = np.full((len(pixels), 3), np.nan)
        path = self.cameras.get(person) or self.cameras.get("")
        frames = None if path is None else self._frames_in(path)
        if frames is None:
            _mark(wrong, np.ones(len(wrong), bool), Wrong.NO_CAMERAS if path is None else Wrong.UNREADABLE_CAMERAS)
            return []
        try:
            camera = frame_of_rows(frames, columns.get("frame"), part.time, self.gaze.delay_ms)
        except InputError as error:
            _mark(wrong, np.ones(len(wrong), bool), Wrong.CAMERA)
            return [str(error)]
        part.origins, part.directions, of_camera = rays_of(frames, pixels, camera, self.gaze.length)
        for code in np.unique(of_camera[of_camera > 0]):
            _mark(wrong, of_camera == code, float(code))
        return frames.texts

    def _frames_in(self, path: str) -> Frames | None:
        if path not in self.frames:
            try:
                self.frames[path] = read_frames(path)
                self.found.digests[path] = _core.xxh128(read_file(path))
            except UnreadableError:
                raise
            except InputError as error:
                self.frames[path] = None
                self.found.problems.append(f"{error}; gaze in its frames is lost")
        return self.frames[path]


def _names_of(gaze: Gaze) -> list[str]:
    """Of the columns, in the order of Gaze.numbers."""
    own = [name for name in ("time", "valid", "duration", "frame") if getattr(gaze, name)]
    return own + [f"{kind} {k}" for kind in ("point", "origin", "direction", "pixel") for k in range(len(getattr(gaze, kind)))]


def _flags(columns: dict[str, Floats], gaze: Gaze) -> Bools:
    """True where the tracker has the eye, or does not say."""
    if not gaze.valid:
        return np.ones(len(next(iter(columns.values()))), bool)
    flag = columns["valid"]
    value = finite_number(gaze.valid_is) if gaze.valid_is else None
    return np.asarray(np.isfinite(flag) & (flag != 0 if value is None else flag == value))


def _are_finite(rows: Floats) -> Bools:
    return np.asarray(np.isfinite(rows).all(axis=1))


def _mark(wrong: Floats, rows: Bools, code: float, instead_of_lost: bool = False) -> None:
    """The first cause of a row counts, but for one of a row that is lost where another one leaves it out."""
    wrong[rows & ((wrong == 0) | (instead_of_lost & (wrong > Wrong.LAST_LEFT_OUT)))] = code


def _together(by_person: dict[str, list[_Part]]) -> Recording | None:
    people = sorted(by_person, key=natural_order)
    parts = [part for name in people for part in by_person[name]]
    if not parts:
        return None

    def joined(name: str) -> Any:
        columns = [getattr(part, name) for part in parts]
        return None if columns[0] is None else np.concatenate(columns)

    counts = [sum(len(part.time) for part in by_person[name]) for name in people]
    person: Ints = np.repeat(np.arange(len(people), dtype=np.int32), counts)
    return Recording(tuple(people), person, joined("time"), joined("valid"), joined("origins"), joined("directions"), joined("points"),
                     joined("durations"))
