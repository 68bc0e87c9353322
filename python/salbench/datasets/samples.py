# SPDX-License-Identifier: GPL-3.0-or-later
"""Columns of a table of gaze as arrays: validity, places, times and rays; and unusable rows, by cause."""

from __future__ import annotations

import os
from bisect import bisect_left
from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from salbench.datasets.cameras import Frames, frame_of_rows, rays_of, read_frames
from salbench.system.errors import InputError, quoted
from salbench.system.files import AnyPath

if TYPE_CHECKING:
    import pandas as pd

    from salbench.datasets.arrays import Bools, Floats, Ints

MS = {"s": 1000.0, "ms": 1.0, "us": 0.001, "ns": 1e-6, "ticks": 1e-4}  # .NET counts ticks of 100 ns
STEPS_MS = 0.3, 200.0  # between samples of an eye tracker: 5 to 3000 Hz
UNIT_ROUNDING = 1e-3  # tolerance for the length of a direction
CORNER = 2.0  # pixels
MOST_NAMED = 5  # words of a column in a message
MIN_ROWS = 10  # needed to decide which side of a jump in time is wrong
Column = str | int  # a name, or a number from 1

MISSING = "", "NA", "N/A", "NAN", "NULL", "NONE", ".", "-"  # words of empty cells, in capitals

_NAN = float("nan")
_WORDS = dict.fromkeys(MISSING, _NAN) | {"TRUE": 1.0, "VALID": 1.0, "FALSE": 0.0, "INVALID": 0.0}


@dataclass
class Fault:
    """Rows of a person that are unusable for the same reason."""

    cause: str
    person: str
    rows: int
    outcome: str  # "lost": they stay, as samples without gaze; "left out"; "kept"
    first: str  # file and line of the first row

    def __str__(self) -> str:
        return (
            f"{self.first}: {self.rows} row{'s' * (self.rows != 1)} of {self.person} {self.outcome}:"
            f" {self.cause}"
        )


def summed(faults: Iterable[Fault]) -> list[str]:
    """One line per cause, with its rows and people."""
    by_cause: dict[tuple[str, str], list[Fault]] = {}
    for fault in faults:
        by_cause.setdefault((fault.cause, fault.outcome), []).append(fault)
    lines = list[str]()
    for some in by_cause.values():
        people = {fault.person for fault in some}
        whose = f"{len(people)} people" if len(people) > 1 else some[0].person
        lines.append(
            str(
                Fault(some[0].cause, whose, sum(fault.rows for fault in some), some[0].outcome, some[0].first)
            )
        )
    return lines


class Faults:
    """Reasons why rows of a person are unusable. The first cause of a row counts, except that leaving a row
    out replaces losing its sample."""

    def __init__(self, frame: pd.DataFrame, person: str) -> None:
        self.frame, self.person = frame, person
        self.cause: Ints = np.zeros(len(frame), np.int32)  # index into `texts`; 0: none
        self.texts, self.leaves_out = [""], [False]
        self.of_kept_rows = list[Fault]()

    @property
    def left_out(self) -> Bools:
        return np.array(self.leaves_out)[self.cause]

    def mark(self, rows: Bools, text: str, leaves_out: bool = False) -> None:
        if text not in self.texts:
            self.texts, self.leaves_out = [*self.texts, text], [*self.leaves_out, leaves_out]
        self.cause[rows & ((self.cause == 0) | (leaves_out & ~self.left_out))] = self.texts.index(text)

    def place(self, row: int) -> str:
        """File and line; for a data frame without a file, the label of the row."""
        return f"{path_of_table(self.frame) or 'row'}:{self.frame.index[row]}"

    def listed(self) -> list[Fault]:
        return [
            Fault(
                self.texts[cause],
                self.person,
                int(n),
                "left out" if self.leaves_out[cause] else "lost",
                self.place(int(first)),
            )
            for cause, first, n in zip(*np.unique(self.cause, return_index=True, return_counts=True))
            if cause
        ] + self.of_kept_rows


def path_of_table(rows: pd.DataFrame) -> str:
    """Path of rows from `tables.table`: the name of their index."""
    return rows.index.name if isinstance(rows.index.name, str) else ""


def column_of(frame: pd.DataFrame, column: Column) -> pd.Series:
    """Returns a column by name, or by number from 1. Throws InputError if it is missing or ambiguous."""
    names = [*map(str, frame.columns)]
    places = (
        [column - 1] if isinstance(column, int) else [k for k, name in enumerate(names) if name == column]
    )
    if len(places) > 1:
        raise InputError(
            f"{quoted(str(column))} is the name of the columns {' and '.join(str(k + 1) for k in places)}:"
            " take one by its number"
        )
    if not places or not 0 <= places[0] < len(names):
        raise InputError(f"no column {quoted(str(column))}: there are {', '.join(map(quoted, names[:20]))}")
    return frame.iloc[:, places[0]]


def numbers(column: pd.Series) -> tuple[Floats, Bools]:
    """Values, NaN for empty cells; and True for cells with another word."""
    try:
        blank = column.where(column != "", _NAN) if column.dtype == object else column
        return blank.to_numpy(float, na_value=_NAN), np.zeros(len(column), bool)
    except (TypeError, ValueError, OverflowError):
        found = [_number(cell) for cell in column]
    return np.array([_NAN if value is None else value for value in found], float), np.array(
        [value is None for value in found], bool
    )


def _number(cell: Any) -> float | None:
    """Number in a cell; None if it is not a number."""
    try:
        known = _WORDS.get(cell.strip().upper()) if isinstance(cell, str) else _NAN if cell is None else None
        # accepts decimal commas
        return float(cell.replace(",", ".") if isinstance(cell, str) else cell) if known is None else known
    except (TypeError, ValueError, OverflowError):
        return None


def validity(
    cells: pd.Series, valid_is: Any, valid_from: float | None, faults: Faults
) -> tuple[Bools, Bools]:
    """Returns two masks: valid samples, and rows whose word is neither valid nor invalid."""
    values, words = numbers(cells)
    if valid_is is not None:
        several = (
            valid_is if isinstance(valid_is, Collection) and not isinstance(valid_is, str) else [valid_is]
        )
        texts = cells.astype(str).str.strip().to_numpy()
        matching: Bools = np.logical_or.reduce(
            [texts == one if isinstance(one, str) else values == one for one in several]
        )
        others = (np.isfinite(values) | words) & ~matching.any()
        there = ", ".join(map(quoted, [*dict.fromkeys(texts[others])][:MOST_NAMED]))
        faults.mark(others, f"no cell of `valid` is one of valid_is; there are {there}")
        return matching, others
    word = quoted(str(cells.iloc[int(np.argmax(words))])) if words.any() else ""
    faults.mark(
        words,
        (
            f"`valid` is a word such as {word}, expected a number, true or false: valid_is says which words"
            " stand for valid samples"
        ),
    )
    return (values >= valid_from if valid_from is not None else np.isfinite(values) & (values != 0)), words


def place_of(
    frame: pd.DataFrame, columns: Sequence[Column], codes: Sequence[float], is_valid: Bools, faults: Faults
) -> Floats:
    """Coordinates (m, k) of a place. Clears `is_valid` for rows all of whose numbers equal one of the
    codes."""
    of_columns = [numbers(column_of(frame, column)) for column in columns]
    place = np.stack([values for values, _ in of_columns], axis=1)
    for code in codes:
        is_valid &= ~(place == code).all(axis=1)
    faults.mark(np.logical_or.reduce([words for _, words in of_columns]), "a word that is no number")
    faults.mark(
        ~np.logical_and.reduce(np.isfinite(place), axis=1), "a coordinate is missing, NaN or infinite"
    )
    return place


def times(
    frame: pd.DataFrame, time: Column, duration: Column, unit: str, faults: Faults
) -> tuple[Floats, Floats | None]:
    """Times and durations in ms. Rows that cannot be ordered in time are left out."""
    durations = None
    if duration:
        durations = MS[unit] * numbers(column_of(frame, duration))[0]
        faults.mark(
            ~(np.isfinite(durations) & (durations > 0)), "the duration is no number above 0", leaves_out=True
        )
        if not time:
            usable = np.where(faults.left_out, 0.0, durations)
            return np.cumsum(usable) - usable, durations
    when = MS[unit] * numbers(column_of(frame, time))[0]
    faults.mark(~np.isfinite(when), "the time is no finite number", leaves_out=True)
    there = np.flatnonzero(~faults.left_out)
    in_order = there[_ascending(when[there])]
    others = np.isin(np.arange(len(when)), np.setdiff1d(there, in_order))
    begins_again = (
        (np.diff(when[there]) < 0).any() and len(there) > MIN_ROWS and 4 * others.sum() > len(there)
    )
    advice = ": if these are two recordings, add to the times of the later one" if begins_again else ""
    faults.mark(
        others & np.isin(when, when[in_order]), f"the time is that of another row{advice}", leaves_out=True
    )
    faults.mark(others, f"the time is out of order{advice}", leaves_out=True)
    if durations is None:
        _require_steps(when, in_order, unit, faults)
    else:
        _require_apart(when[in_order], durations[in_order], in_order, faults)
    return when, durations


def _ascending(when: Floats) -> Ints:
    """Indices of the longest strictly ascending series of times; of equal ones the first. A wrong time thus
    costs only its own row."""
    if (np.diff(when) > 0).all():
        return np.arange(len(when), dtype=np.int32)
    # by length of a series: the least time that ends one, and its index
    ends, last, before = list[float](), list[int](), list[int]()
    for place, value in enumerate(map(float, when)):
        length = bisect_left(ends, value)
        before.append(last[length - 1] if length else -1)
        if length == len(ends):
            ends.append(value)
            last.append(place)
        elif value < ends[length]:
            ends[length], last[length] = value, place
    found, place = list[int](), last[-1]
    while place >= 0:
        found.append(place)
        place = before[place]
    return np.array(found[::-1], np.int32)


def _require_steps(when: Floats, rows: Ints, unit: str, faults: Faults) -> None:
    """Throws InputError for samples whose spacing is not that of an eye tracker. A last row far from all
    others is left out."""
    if len(rows) < 3:
        return
    steps = np.diff(when[rows])
    usual, longest = float(np.median(steps)), int(np.argmax(steps))
    if not STEPS_MS[0] <= usual <= STEPS_MS[1]:
        by_unit = {name: usual / MS[unit] * scale for name, scale in MS.items()}
        fits = ", ".join(
            f"unit={name!r} fits ({1000 / step:.0f} Hz)"
            for name, step in by_unit.items()
            if STEPS_MS[0] <= step <= STEPS_MS[1]
        )
        raise InputError(
            f"times step by {usual:.4g} ms, expected {STEPS_MS[0]} to {STEPS_MS[1]:.0f}{': ' * bool(fits)}{fits}"
        )
    if len(rows) < MIN_ROWS or steps[longest] <= steps.sum() - steps[longest]:
        return
    if longest == len(steps) - 1:
        faults.mark(np.arange(len(when)) == rows[-1], "the time is out of order", leaves_out=True)
    else:
        faults.of_kept_rows.append(
            Fault(
                f"the time jumps by {steps[longest] / 1000:.4g} s, longer than all the rest lasts",
                faults.person,
                1,
                "kept",
                faults.place(rows[longest + 1]),
            )
        )


def _require_apart(begins: Floats, lasts: Floats, rows: Ints, faults: Faults) -> None:
    overlaps = np.flatnonzero(begins[:-1] + lasts[:-1] - begins[1:] > np.minimum(lasts[:-1], lasts[1:]) / 2)
    if len(overlaps):
        raise InputError(
            f"{faults.place(rows[overlaps[0] + 1])}: the fixation begins while another lasts: of two eyes,"
            " take the rows of one"
        )


def directions_of(given: Floats, angles: str, of_any_length: bool, forward: str, faults: Faults) -> Floats:
    """Unit vectors (m, 3) of angles, vectors or quaternions."""
    if given.shape[1] == 2:
        azimuth, elevation = np.radians(given.T) if angles == "degrees" else given.T
        given = np.stack(
            [np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth), np.sin(elevation)],
            axis=1,
        )
    elif given.shape[1] == 4:
        ahead = [(-1.0 if forward[0] == "-" else 1.0) * (axis == forward[-1]) for axis in "xyz"]
        given, of_any_length = turned(given, np.tile(ahead, (len(given), 1))), True
    largest = np.abs(given).max(axis=1, keepdims=True)
    scaled = given / largest  # squares neither overflow nor underflow
    lengths = np.linalg.norm(scaled, axis=1)
    faults.mark(largest[:, 0] == 0, "the direction has no length")
    if not of_any_length:
        faults.mark(
            ~(np.abs(lengths * largest[:, 0] - 1) <= UNIT_ROUNDING),
            "the direction is not of length 1; for directions of any length give normalise_directions=True",
        )
    return np.asarray(scaled / lengths[:, None])


def turned(quaternions: Floats, vectors: Floats) -> Floats:
    """Rotates vectors (m, 3) by quaternions (m, 4), x y z w; the result is scaled by the quaternion's squared
    length."""
    axis, w = quaternions[:, :3], quaternions[:, 3:]
    along = (axis * vectors).sum(axis=1, keepdims=True)
    return np.asarray(
        (w**2 - (axis**2).sum(axis=1, keepdims=True)) * vectors
        + 2 * along * axis
        + 2 * w * np.cross(axis, vectors)
    )


def rays_of_pixels(
    pixels: Floats,
    seen: Bools,
    number: Floats | None,
    when: Floats,
    cameras: AnyPath | Frames,
    delay_ms: float,
    length: float,
    faults: Faults,
) -> tuple[Floats, Floats]:
    """Origins and directions (m, 3). Throws InputError for unusable cameras, and for invalid pixels."""
    frames = cameras if isinstance(cameras, Frames) else read_frames(os.fspath(cameras))
    across, down = 2 * frames.centre[frames.usable][0] if frames.usable.any() else (0.0, 0.0)
    for corner in ((0, 0), (across, 0), (0, down), (across, down)):
        if seen.sum() > 2 and (np.abs(pixels[seen] - corner) <= CORNER).all():
            raise InputError(
                f"all pixels are within {CORNER:.0f} of the corner {corner[0]:.6g} {corner[1]:.6g} of the"
                " picture: places from 0 to 1 have to be multiplied by its width and height"
            )
    camera = frame_of_rows(frames, number, when, delay_ms)
    n_frames = len(frames.number)
    last = int(camera.max(initial=-1))
    if number is None and n_frames > 2 and 0 <= last < max(1, n_frames / 100):
        cause = f"they use {last + 1} of {n_frames} frames: `time` of cameras is in ms"
        faults.of_kept_rows.append(Fault(cause, faults.person, len(camera), "kept", faults.place(0)))
    faults.mark(
        camera < 0,
        (
            "there is no camera of its frame"
            if number is not None
            else "there is no camera at its time: delay_ms is the time at which the frames begin"
        ),
    )
    for place, problem in frames.problems.items():
        faults.mark(camera == place, problem)
    return rays_of(frames, pixels, camera, length)


def matrix_of(axes: str) -> Floats:
    """Matrix (3, 3) from coordinates of a table to those of a shape: for "-x y z", x of the shape is -x of
    the table."""
    words = axes.split()
    if sorted(word.removeprefix("-") for word in words) != ["x", "y", "z"]:
        raise ValueError(
            "axes must be x, y and z in some order, each perhaps with a minus, such as '-x y z', not"
            f" {axes!r}"
        )
    return np.array(
        [[(-1.0 if word[0] == "-" else 1.0) * (word[-1] == axis) for axis in "xyz"] for word in words]
    )
