# SPDX-License-Identifier: GPL-3.0-or-later
"""Cameras of recordings whose gaze is in pixels, one per frame, and the rays through their pixels.

A file is JSON: a list of frames, an object with `frames` and the values that all of them share, an object per
line, or one object alone. A single object without `frame`, alone or in a list, is the camera of every frame,
except below `frames`. A frame has `frame` (a number; default: its index in the list), `time` (ms), `fx`,
`fy`, `cx`, `cy`, `width`, `height` (pixels), `world_to_camera` and `object_to_world` (4 x 4, by rows; x
right, y down, z forward). `fov_degrees` and `fov_axis` (horizontal or vertical) may replace `fx` and `fy`,
and `frames_per_second` may replace `time`.
"""

import json
import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from salbench.datasets.arrays import Bools, Floats, Ints
from salbench.system.errors import InputError, quoted
from salbench.system.files import read_file

LEAST_STEP = 1.0  # ms between frames
ROUNDING = 1e-3  # tolerance for rotations, and for camera values that must be equal


@dataclass
class Frames:
    """k cameras, by frame number."""

    path: str
    number: Floats  # (k,) ascending; NaN: the only camera, valid for every frame
    time: Floats  # (k,) ms; NaN: unknown
    eye: Floats  # (k, 3) in the frame of the object, in the unit of the file
    object_from_camera: Floats  # (k, 3, 3)
    focal: Floats  # (k, 2) fx, fy
    centre: Floats  # (k, 2) cx, cy
    end: float = math.inf  # ms, end of the last frame; inf: it stays
    # index of an unusable camera -> file, reason, and the first frame with that reason
    problems: dict[int, str] = field(default_factory=dict)

    @property
    def usable(self) -> Bools:  # (k,)
        return np.array([k not in self.problems for k in range(len(self.number))], bool)


def read_frames(path: str) -> Frames:
    """Reads a file of cameras. Unusable cameras are listed in `problems`. Throws InputError for an unreadable
    file."""
    entries, shared = _entries(path)
    every_frame = len(entries) == 1 and "frame" not in entries[0] and shared is None
    entries = [(shared or {}) | entry for entry in entries]
    number = np.array([_or_nan(entry.get("frame", float(k))) for k, entry in enumerate(entries)])
    order = np.argsort(number, kind="stable")
    entries, number = [entries[k] for k in order], number[order]
    if len(twice := np.flatnonzero(np.diff(number) == 0)):
        raise InputError(f"{path}: frame {number[twice[0]]:.15g} has two cameras: keep one of them")
    time = np.array([_time_of(entry, frame) for entry, frame in zip(entries, number)])
    eye, turn, focal, centre = (
        np.full((len(entries), *shape), math.nan) for shape in ((3,), (3, 3), (2,), (2,))
    )
    frames = Frames(path, number, time, eye, turn, focal, centre)
    if entries[-1].get("time") is None and (rate := _or_nan(entries[-1].get("frames_per_second"))) > 0:
        frames.end = time[-1] + 1000 / rate
    first_with: dict[str, str] = {}  # keyed by the problem
    for place, entry in enumerate(entries):
        try:
            _require_times(entry, number[place], time[place])
            frames.eye[place], frames.object_from_camera[place] = _pose(entry)
            frames.focal[place], frames.centre[place] = _intrinsics(entry)
        except ValueError as error:
            frames.problems[place] = first_with.setdefault(
                str(error), f"{path}: frame {number[place]:.15g}: {error}"
            )
    if every_frame:
        number[0] = math.nan
    return frames


def _entries(path: str) -> tuple[list[dict[str, Any]], dict[str, Any] | None]:
    """Returns the frames, and the values beside `frames` that all of them share; None without `frames`."""
    text = read_file(path)
    try:
        try:
            value = json.loads(text, parse_int=float)
        except json.JSONDecodeError as error:
            if error.msg != "Extra data":
                raise
            value = [json.loads(line, parse_int=float) for line in text.splitlines() if line.strip()]
    except ValueError as error:
        raise InputError(f"{path}: no JSON of cameras: {error}") from None
    shared: dict[str, Any] | None = None
    if isinstance(value, dict) and "frames" in value:
        shared = {key: entry for key, entry in value.items() if key != "frames"}
        value = value["frames"]
    entries = value if isinstance(value, list) else [value]
    if not entries or not all(isinstance(entry, dict) for entry in entries):
        raise InputError(f"{path}: expected cameras: a list of objects, or an object with `frames`")
    return entries, shared


def _or_nan(value: Any) -> float:
    return float(value) if isinstance(value, float) and math.isfinite(value) else math.nan


def _time_of(entry: dict[str, Any], number: float) -> float:
    """Time in ms; NaN if unknown."""
    rate = _or_nan(entry.get("frames_per_second"))
    return 1000 * number / rate if entry.get("time") is None and rate > 0 else _or_nan(entry.get("time"))


def _require_times(entry: dict[str, Any], number: float, time: float) -> None:
    for key, value in (("frame", number), ("time", time), ("frames_per_second", time)):
        if key in entry and math.isnan(value):
            expected = "number above 0" if key == "frames_per_second" else "finite number"
            raise ValueError(f"{key} is {quoted(str(entry[key]))}, expected a {expected}")


def _finite(entry: dict[str, Any], key: str) -> float:
    value = entry.get(key)
    if math.isnan(number := _or_nan(value)):
        raise ValueError(
            f"{key} is {'missing' if value is None else quoted(str(value))}, expected a finite number"
        )
    return number


def _positive(entry: dict[str, Any], key: str) -> float:
    value = _finite(entry, key)
    if value <= 0:
        raise ValueError(f"{key} is {value:.15g}, expected a number above 0")
    return value


def _intrinsics(entry: dict[str, Any]) -> tuple[tuple[float, float], tuple[float, float]]:
    """Returns focal lengths and principal point."""
    size = (
        (_positive(entry, "width"), _positive(entry, "height"))
        if "width" in entry and "height" in entry
        else None
    )
    if "fov_degrees" in entry:
        focal = _focal_of_view(entry, size)
    else:
        focal = _positive(entry, "fx"), _positive(entry, "fy")
        if size:
            _require_one_scale(focal, size)
    if "cx" in entry or "cy" in entry:
        return focal, (_finite(entry, "cx"), _finite(entry, "cy"))
    if size is None:
        raise ValueError(
            "cx is missing, and so are width and height: expected where the axis meets the picture"
        )
    return focal, (size[0] / 2, size[1] / 2)


def _focal_of_view(entry: dict[str, Any], size: tuple[float, float] | None) -> tuple[float, float]:
    """Focal lengths from a field of view, with square pixels."""
    axes = {"horizontal": 0, "vertical": 1}
    axis, degrees = entry.get("fov_axis"), _positive(entry, "fov_degrees")
    if axis not in axes:
        raise ValueError(
            f"fov_axis is {'missing' if axis is None else quoted(str(axis))}, expected horizontal or vertical"
        )
    if size is None:
        raise ValueError("fov_degrees is there without width and height")
    if degrees >= 180:
        raise ValueError(f"fov_degrees is {degrees:.15g}, expected an angle below 180")
    by_axis = [side / 2 / math.tan(math.radians(degrees) / 2) for side in size]
    focal, focal_of_other = by_axis[axes[axis]], by_axis[1 - axes[axis]]
    for key in ("fx", "fy"):
        if entry.get(key) is not None and not math.isclose(
            given := _positive(entry, key), focal, rel_tol=ROUNDING
        ):
            is_other = math.isclose(given, focal_of_other, rel_tol=ROUNDING)
            raise ValueError(
                f"a {axis} field of view of {degrees:.15g} degrees makes {key} {focal:.6g}, but it is"
                f" {given:.15g}" + (": the angle is that of the other axis" if is_other else "")
            )
    return focal, focal


def _require_one_scale(focal: tuple[float, float], size: tuple[float, float]) -> None:
    """Refuses pixels as oblong as the picture: one angle was used for both axes."""
    across, sides = focal[0] / focal[1], size[0] / size[1]
    if abs(sides - 1) > ROUNDING and any(
        math.isclose(across, ratio, rel_tol=ROUNDING) for ratio in (sides, 1 / sides)
    ):
        what = "height / width" if math.isclose(across, 1 / sides, rel_tol=ROUNDING) else "width / height"
        raise ValueError(
            f"fx / fy is {across:.6g}, which is {what}: one field of view was taken for both axes"
        )


def _pose(entry: dict[str, Any]) -> tuple[Floats, Floats]:
    """Returns the eye, and the rotation from the camera, in the frame of the object."""
    rotation, place = _rigid(entry, "world_to_camera")
    of_object, moved = (
        _rigid(entry, "object_to_world") if "object_to_world" in entry else (np.eye(3), np.zeros(3))
    )
    return of_object.T @ (-rotation.T @ place - moved), of_object.T @ rotation.T


def _rigid(entry: dict[str, Any], key: str) -> tuple[Floats, Floats]:
    """Returns rotation and translation of a 4 x 4 matrix."""
    try:
        matrix = np.array(entry.get(key), float).reshape(4, 4)
    except (TypeError, ValueError):
        raise ValueError(
            f"{key} is {'missing' if entry.get(key) is None else 'no matrix of 4 x 4 numbers'}"
        ) from None
    if not np.isfinite(matrix).all():
        raise ValueError(f"{key} has a number that is not finite")
    if np.abs(matrix[3] - [0, 0, 0, 1]).max() > ROUNDING:
        hint = ": is it transposed?" if np.abs(matrix[:, 3] - [0, 0, 0, 1]).max() <= ROUNDING else ""
        raise ValueError(f"{key}: the last row is not 0 0 0 1{hint}")
    turn = matrix[:3, :3]
    left, lengths, right = np.linalg.svd(turn)
    if np.abs(turn @ turn.T - np.eye(3)).max() > ROUNDING:
        even = lengths[2] > 0 and lengths[0] / lengths[2] - 1 < ROUNDING
        raise ValueError(
            f"{key} is no rotation: it scales by"
            f" {f'{lengths[0]:.6g}' if even else f'{lengths[2]:.6g} to {lengths[0]:.6g}'}"
        )
    if np.linalg.det(turn) < 0:
        # the object is in front of the camera
        axis = "" if key != "world_to_camera" else " z" if matrix[2, 3] < 0 else " x or y"
        raise ValueError(f"{key} is no rotation: it mirrors{axis}; x points right, y down and z forward")
    return left @ right, matrix[:3, 3]


def frame_of_rows(frames: Frames, number: Floats | None, time: Floats, delay_ms: float) -> Ints:
    """Camera of each row (m,), by frame number or by time: the last frame at or before the time less the
    delay; -1: none, as after the end of a film. Throws InputError if times of frames are needed and missing.
    """
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
    if (timeless & frames.usable).any():
        raise InputError(
            f"{frames.path}: a frame has no time, which"
            f" {'delay_ms' if number is not None else 'rows without a frame'} needs: add `time`, or"
            " `frames_per_second` beside `frames`"
        )
    if (np.diff(frames.time[~timeless]) <= 0).any():
        raise InputError(f"{frames.path}: the times of frames do not ascend")
    if frames.time[~timeless].size > 1 and (step := np.median(np.diff(frames.time[~timeless]))) < LEAST_STEP:
        raise InputError(f"{frames.path}: frames step by {step:.3g} ms: `time` is in ms")
    shown = (time if number is None else np.where(by_number >= 0, frames.time[by_number], np.nan)) - delay_ms
    # A broken camera without a time may have been in use since the frame before it.
    begins = np.maximum.accumulate(np.where(timeless, -np.inf, frames.time))
    place = np.searchsorted(begins, shown, side="right") - 1
    return np.where((place >= 0) & (shown < frames.end), place, -1).astype(np.int32)


def rays_of(frames: Frames, pixels: Floats, camera: Ints, length: float) -> tuple[Floats, Floats]:
    """Rays of pixels (m, 2), by the index of their cameras: (m, 3) origins and (m, 3) unit directions. Rows
    without a camera are undefined."""
    in_camera = np.append(
        (pixels - frames.centre[camera]) / frames.focal[camera], np.ones((len(pixels), 1)), axis=1
    )
    directions = np.einsum("kij,kj->ki", frames.object_from_camera[camera], in_camera)
    with np.errstate(invalid="ignore"):
        return length * frames.eye[camera], directions / np.linalg.norm(directions, axis=1, keepdims=True)
