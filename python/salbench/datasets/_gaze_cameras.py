# SPDX-License-Identifier: GPL-3.0-or-later
"""Cameras of recordings whose gaze is in pixels, a frame each, and the rays that they make of pixels.

A file is JSON: a list of frames, an object with `frames` and what all of them share, an object per line, or one object alone. Alone, or in a
list of its own, an object without `frame` is the camera of every frame, but not below `frames`. A frame has `frame` (a number; its place in
the list), `time` (ms), `fx`, `fy`, `cx`, `cy`, `width`, `height` (pixels), `world_to_camera` and `object_to_world` (4 x 4, by rows; x right, y
down, z forward). `fov_degrees` and `fov_axis` (horizontal or vertical) may stand in place of `fx` and `fy`, and `frames_per_second` in place
of `time`.
"""

from __future__ import annotations

import bisect
import json
import math
import re
from dataclasses import dataclass
from typing import Any

import numpy as np

from salbench.datasets._files import read_file
from salbench.datasets._gaze_causes import Wrong
from salbench.datasets._layout import number_text
from salbench.datasets._text import quoted
from salbench.datasets.records import Floats, InputError, Ints

ROUNDING = 1e-3  # of a rotation, and of what must be equal among the numbers of a camera
MAX_BYTES = 256 << 20
_LINE = "\n line"  # of an object in its file; no key of JSON at hand is called so


@dataclass
class Frames:
    """k cameras, by the number of their frame."""

    path: str
    number: Floats  # (k,) ascending; of the only camera of every frame NaN
    time: Floats  # (k,) ms; NaN: not known
    eye: Floats  # (k, 3) in the frame of the object, in the unit of the file
    object_from_camera: Floats  # (k, 3, 3)
    focal: Floats  # (k, 2) fx, fy
    centre: Floats  # (k, 2) cx, cy
    wrong: Ints  # (k,) 0, or 1 + the place in `texts`
    texts: list[str]  # what is wrong with cameras: file, line and why


@dataclass
class _Camera:
    number: float
    time: float
    eye: Floats
    object_from_camera: Floats
    focal: tuple[float, float]
    centre: tuple[float, float]


class _Bad(ValueError):
    """What is wrong with a camera."""


def read_frames(path: str) -> Frames:
    """Throws InputError for a file that cannot be read. A camera that cannot be used is known by what is wrong with it."""
    entries, shared = _entries(path, read_file(path, MAX_BYTES))
    number, wrong, texts = np.empty(len(entries)), np.zeros(len(entries), np.int32), []
    cameras = []
    for k, entry in enumerate(entries):
        entry = (shared or {}) | entry
        try:
            cameras.append(_camera(entry, k))
        except _Bad as error:
            texts.append(f"{path}:{entry[_LINE]}: {error}")
            wrong[k] = len(texts)
            cameras.append(_Camera(_frame_of(entry, k), _time_of(entry, k), np.full(3, math.nan), np.full((3, 3), math.nan), (1, 1), (0, 0)))
        number[k] = cameras[-1].number
    if len(entries) == 1 and "frame" not in entries[0] and shared is None:
        number[0] = math.nan
    order = np.argsort(number, kind="stable")
    ordered = [cameras[k] for k in order]
    if len(twice := np.flatnonzero(np.diff(number[order]) == 0)):
        second = entries[order[twice[0] + 1]]
        raise InputError(f"{path}:{second[_LINE]}: the frame {number_text(number[order][twice[0]])} has a camera already: keep one of them")
    return Frames(path, number[order], np.array([one.time for one in ordered]), np.array([one.eye for one in ordered]),
                  np.array([one.object_from_camera for one in ordered]), np.array([one.focal for one in ordered], float),
                  np.array([one.centre for one in ordered], float), wrong[order], texts)


# --- the file


class _WithLines(json.JSONDecoder):
    """Objects of a text know the line on which they begin."""

    def __init__(self, text: str) -> None:
        super().__init__(parse_int=float)  # a whole number may be too long for one, and is then infinite
        as_it_is, ends = self.parse_object, [end.start() for end in re.finditer("\n", text)]

        def parse_object(state: tuple[str, int], *others: Any) -> tuple[Any, int]:
            value, end = as_it_is(state, *others)
            value[_LINE] = bisect.bisect(ends, state[1]) + 1
            return value, end

        self.parse_object = parse_object
        self.scan_once = json.scanner.py_make_scanner(self)  # type: ignore[attr-defined]


def _entries(path: str, data: bytes) -> tuple[list[dict[str, Any]], dict[str, Any] | None]:
    """Frames, and what stands beside `frames`, which all of them share; None without `frames`."""
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise InputError(f"{path}: is no text of UTF-8, where cameras in JSON are expected") from None
    try:
        value, lines = _parsed(text)
    except json.JSONDecodeError as error:
        raise InputError(f"{path}:{error.lineno}: no JSON: {error.msg}") from None
    except (RecursionError, ValueError):
        raise InputError(f"{path}: no JSON of cameras: too deep, or numbers too long") from None
    shared: dict[str, Any] | None = None
    if not lines and isinstance(value, dict) and "frames" in value:
        shared = {key: one for key, one in value.items() if key != "frames"}
        value = value["frames"]
    entries = value if isinstance(value, list) else [value]
    if not entries or not all(isinstance(entry, dict) for entry in entries):
        raise InputError(f"{path}: expected cameras: a list of objects, or an object with `frames`")
    return entries, shared


def _parsed(text: str) -> tuple[Any, bool]:
    """The value; a list of those of lines, where there are several objects."""
    decoder = _WithLines(text)
    place, values = 0, []
    while place < len(text):
        if text[place].isspace():
            place += 1
            continue
        value, place = decoder.raw_decode(text, place)
        values.append(value)
    return (values[0], False) if len(values) == 1 else (values, True)


# --- a camera


def _camera(entry: dict[str, Any], k: int) -> _Camera:
    rotation, place = _rigid(entry, "world_to_camera")
    of_object, moved = _rigid(entry, "object_to_world") if "object_to_world" in entry else (np.eye(3), np.zeros(3))
    eye_in_world = -rotation.T @ place
    number, time = _frame_of(entry, k), _time_of(entry, k)
    for key, value in (("frame", number), ("time", time), ("frames_per_second", time)):
        if key in entry and math.isnan(value):
            raise _Bad(f"{key} is {quoted(str(entry[key]))}, expected a {'number above 0' if key == 'frames_per_second' else 'finite number'}")
    focal, centre = _intrinsics(entry)
    return _Camera(number, time, of_object.T @ (eye_in_world - moved), of_object.T @ rotation.T, focal, centre)


def _frame_of(entry: dict[str, Any], k: int) -> float:
    """NaN for what is no number."""
    value = entry.get("frame", k)
    return float(value) if isinstance(value, (int, float)) and math.isfinite(value) else math.nan


def _time_of(entry: dict[str, Any], k: int) -> float:
    """ms; NaN where none is known."""
    value, rate = entry.get("time"), entry.get("frames_per_second")
    if value is None and isinstance(rate, (int, float)) and rate > 0:
        return 1000 * _frame_of(entry, k) / rate
    return float(value) if isinstance(value, (int, float)) and math.isfinite(value) else math.nan


def _number(entry: dict[str, Any], key: str) -> float:
    value = entry.get(key)
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not math.isfinite(value):
        raise _Bad(f"{key} is {'missing' if value is None else quoted(str(value))}, expected a finite number")
    return float(value)


def _positive(entry: dict[str, Any], key: str) -> float:
    value = _number(entry, key)
    if value <= 0:
        raise _Bad(f"{key} is {number_text(value)}, expected a number above 0")
    return value


def _intrinsics(entry: dict[str, Any]) -> tuple[tuple[float, float], tuple[float, float]]:
    has_size = "width" in entry and "height" in entry
    size = (_positive(entry, "width"), _positive(entry, "height")) if has_size else None
    if "fov_degrees" in entry:
        focal = _focal_of_view(entry, size)
    else:
        focal = _positive(entry, "fx"), _positive(entry, "fy")
        if size:
            _check_pixels(focal, size)
    if "cx" in entry or "cy" in entry:
        return focal, (_number(entry, "cx"), _number(entry, "cy"))
    if size is None:
        raise _Bad("cx is missing, and so are width and height: expected where the axis meets the picture")
    return focal, (size[0] / 2, size[1] / 2)


def _focal_of_view(entry: dict[str, Any], size: tuple[float, float] | None) -> tuple[float, float]:
    """Pixels are taken as square."""
    axes = {"horizontal": 0, "vertical": 1}
    axis, degrees = entry.get("fov_axis"), _positive(entry, "fov_degrees")
    if axis not in axes:
        raise _Bad(f"fov_axis is {'missing' if axis is None else quoted(str(axis))}, expected horizontal or vertical")
    if size is None:
        raise _Bad("fov_degrees is there without width and height")
    if degrees >= 180:
        raise _Bad(f"fov_degrees is {number_text(degrees)}, expected an angle below 180")
    of_axis = [side / 2 / math.tan(math.radians(degrees) / 2) for side in size]
    focal = of_axis[axes[axis]]
    for given, key in ((entry.get("fx"), "fx"), (entry.get("fy"), "fy")):
        if given is not None and not math.isclose(_positive(entry, key), focal, rel_tol=ROUNDING):
            other = next(name for name in axes if name != axis)
            is_other = math.isclose(_positive(entry, key), of_axis[axes[other]], rel_tol=ROUNDING)
            raise _Bad(f"a {axis} field of view of {number_text(degrees)} degrees makes {key} {focal:.6g}, but it is {number_text(float(given))}"
                       + (f": the angle is that of the {other} axis" if is_other else ""))
    return focal, focal


def _check_pixels(focal: tuple[float, float], size: tuple[float, float]) -> None:
    """One angle that was taken for both axes makes pixels that are as oblong as the picture."""
    across, sides = focal[0] / focal[1], size[0] / size[1]
    if abs(sides - 1) > ROUNDING and any(math.isclose(across, ratio, rel_tol=ROUNDING) for ratio in (sides, 1 / sides)):
        what = "height / width" if math.isclose(across, 1 / sides, rel_tol=ROUNDING) else "width / height"
        raise _Bad(f"fx / fy is {across:.6g}, which is {what}: one field of view was taken for both axes")


def _rigid(entry: dict[str, Any], key: str) -> tuple[Floats, Floats]:
    """Rotation and translation of a 4 x 4 matrix."""
    try:
        matrix = np.array(entry.get(key), float).reshape(4, 4)
    except (TypeError, ValueError):
        raise _Bad(f"{key} is {'missing' if entry.get(key) is None else 'no matrix of 4 x 4 numbers'}") from None
    if not np.isfinite(matrix).all():
        raise _Bad(f"{key} has a number that is not finite")
    if np.abs(matrix[3] - [0, 0, 0, 1]).max() > ROUNDING:
        hint = ": is it transposed?" if np.abs(matrix[:, 3] - [0, 0, 0, 1]).max() <= ROUNDING else ""
        raise _Bad(f"{key}: the last row is not 0 0 0 1{hint}")
    turn = matrix[:3, :3]
    left, lengths, right = np.linalg.svd(turn)
    if np.abs(turn @ turn.T - np.eye(3)).max() > ROUNDING:
        even = lengths[2] > 0 and lengths[0] / lengths[2] - 1 < ROUNDING
        raise _Bad(f"{key} is no rotation: it scales by {f'{lengths[0]:.6g}' if even else f'{lengths[2]:.6g} to {lengths[0]:.6g}'}")
    if np.linalg.det(turn) < 0:
        raise _Bad(f"{key} is no rotation: it mirrors")
    return left @ right, matrix[:3, 3]


# --- rays


def frame_of_rows(frames: Frames, number: Floats | None, time: Floats, delay_ms: float) -> Ints:
    """(m,) the camera of each row, by the number of its frame, or by its time: the last frame at or before it, less the delay; -1: there
    is none. Throws InputError where times of frames are needed and not there."""
    k = len(frames.number)
    if k == 1 and np.isnan(frames.number[0]):
        return np.zeros(len(time), np.int32)
    by_number: Ints = np.full(len(time), -1, np.int32)
    if number is not None:
        place = np.minimum(np.searchsorted(frames.number, number), k - 1)
        by_number = np.where(frames.number[place] == number, place, -1).astype(np.int32)
        if delay_ms == 0:
            return by_number
    timeless = ~np.isfinite(frames.time)
    if (timeless & (frames.wrong == 0)).any():
        raise InputError(f"{frames.path}: a frame has no time, which {'delay_ms' if number is not None else 'rows without a frame'} needs: add `time`, "
                         "or `frames_per_second` beside `frames`")
    if (np.diff(frames.time[~timeless]) <= 0).any():
        raise InputError(f"{frames.path}: the times of frames do not ascend")
    shown = (time if number is None else np.where(by_number >= 0, frames.time[by_number], np.nan)) - delay_ms
    # A broken camera without a time may have been there since the frame before it.
    begins = np.maximum.accumulate(np.where(timeless, -np.inf, frames.time))
    place = np.searchsorted(begins, shown, side="right") - 1
    return np.where((place >= 0) & np.isfinite(shown), place, -1).astype(np.int32)


def rays_of(frames: Frames, pixels: Floats, camera: Ints, length: float) -> tuple[Floats, Floats, Floats]:
    """(m, 3) origins, (m, 3) unit directions, and (m,) Wrong."""
    known = np.maximum(camera, 0)
    wrong = np.where(camera < 0, float(Wrong.NO_CAMERA), 0.0)
    wrong = np.where((camera >= 0) & (frames.wrong[known] > 0), float(Wrong.CAMERA) - 1 + frames.wrong[known], wrong)
    in_camera = np.append((pixels - frames.centre[known]) / frames.focal[known], np.ones((len(pixels), 1)), axis=1)
    directions = np.einsum("kij,kj->ki", frames.object_from_camera[known], in_camera)
    with np.errstate(invalid="ignore"):
        return length * frames.eye[known], directions / np.linalg.norm(directions, axis=1, keepdims=True), wrong
