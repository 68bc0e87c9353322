# SPDX-License-Identifier: GPL-3.0-or-later
"""Readers of eye tracker files, one function per format: (rows, person, ...) -> Recording. `gather` calls one
for each person.

Rows are the path of a file, or a data frame with some of its rows (`table(path)`). Column names follow the
makers' documentation; tests have a miniature of each file. Further arguments are passed to `Recording.of`:
`cameras`, `delay_ms`, `length`.
"""

from __future__ import annotations

import os
import re
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from salbench.datasets.recordings import Recording
from salbench.datasets.samples import MISSING, Column, column_of, numbers, path_of_table, turned
from salbench.datasets.tables import read_lines, table
from salbench.system.errors import InputError, quoted
from salbench.system.files import AnyPath

if TYPE_CHECKING:
    import pandas as pd

    from salbench.datasets.arrays import Floats

Rows = Any  # a data frame, or the path of a file


def tobii_pro_lab(rows: Rows, person: str, *, unit: str = "", **others: Any) -> Recording:
    """Tobii Pro Lab, TSV: "Gaze point X" and "Y", pixels of the display. Rows of events and of other sensors
    are skipped.

    unit: us or ms, for "Recording timestamp" of versions that do not name it in brackets ("[ms]", "[\u03bcs]").
    """
    frame = _frame(rows)
    frame = frame[_words(frame, "Event").eq("") & _words(frame, "Sensor").isin(["", "Eye Tracker"])]
    is_valid = column_of(frame, "Validity left").eq("Valid") | column_of(frame, "Validity right").eq("Valid")
    time, x, y = (
        next(
            (name for name in frame.columns if re.fullmatch(rf"{known}( \[(DACS px|.?s)\])?", str(name))),
            known,
        )
        for known in ("Recording timestamp", "Gaze point X", "Gaze point Y")
    )
    named = re.search(r"\[(.?)s\]", time)
    unit = unit or (("m" if named[1] == "m" else "u") + "s" if named else "us")
    return Recording.of(
        frame.assign(is_valid=is_valid),
        person,
        time=time,
        unit=unit,
        valid="is_valid",
        pixel=(x, y),
        **others,
    )


def tobii_glasses(
    rows: Rows, person: str, *, size: tuple[int, int] = (1920, 1080), **others: Any
) -> Recording:
    """Tobii Pro Glasses 3, `gazedata.gz`, JSON lines: gaze2d, from 0 to 1 from the upper left of the scene
    camera's picture of `size` pixels. `data` is {} if the eyes were lost. Times in s."""
    frame = _frame(rows)
    frame = frame[_words(frame, "type").isin(["", "gaze"])]
    return _in_picture(
        frame.assign(is_valid=_words(frame, "data.gaze2d.0").ne("")),
        person,
        ("data.gaze2d.0", "data.gaze2d.1"),
        size,
        time="timestamp",
        unit="s",
        valid="is_valid",
        **others,
    )


def pupil_core(
    rows: Rows, person: str, *, size: tuple[int, int], confidence: float = 0.6, **others: Any
) -> Recording:
    """Pupil Core, `gaze_positions.csv`: norm_pos, from 0 to 1 from the lower left of the world camera's
    picture of `size` pixels. Samples below `confidence` are lost. Times in s. `frame="world_index"` takes
    cameras by number."""
    frame = _frame(rows)
    frame = frame.assign(down=1 - numbers(column_of(frame, "norm_pos_y"))[0])
    return _in_picture(
        frame,
        person,
        ("norm_pos_x", "down"),
        size,
        time="gaze_timestamp",
        unit="s",
        valid="confidence",
        valid_from=confidence,
        **others,
    )


def pupil_neon(rows: Rows, person: str, **others: Any) -> Recording:
    """Pupil Neon, `gaze.csv` of Pupil Cloud: pixels of the scene camera. Samples during blinks, and without a
    wearer, are lost; an empty `worn` is unknown, and taken. Times in ns since 1970."""
    frame = _frame(rows)
    is_worn = (numbers(column_of(frame, "worn"))[0] == 1) | _words(frame, "worn").eq("")
    is_valid = is_worn & _words(frame, "blink id").eq("")
    return Recording.of(
        frame.assign(is_valid=is_valid),
        person,
        time="timestamp [ns]",
        unit="ns",
        valid="is_valid",
        pixel=("gaze x [px]", "gaze y [px]"),
        **others,
    )


def eyelink(
    path: AnyPath, person: str, *, eye: str = "", trial: str = "", fixations: bool = False, **others: Any
) -> Recording:
    """EyeLink, `.asc` as edf2asc writes it: samples in pixels of the display, or the tracker's own fixations
    with `fixations`.

    eye: "L" or "R", needed if both were recorded. trial: text behind TRIALID in the message before the block;
    "": all blocks.
    """
    import pandas as pd

    rows: dict[int, Sequence[str]] = {}
    eyes, is_wanted = [eye], not trial
    for number, line in enumerate(read_lines(path), 1):
        words = line.decode("utf-8", "replace").split() or [""]
        if words[0] == "MSG" and "TRIALID" in words:
            is_wanted = not trial or words[words.index("TRIALID") + 1 :] == trial.split()
        elif words[0] == "START":
            eyes = [word[0] for word in words if word in ("LEFT", "RIGHT")]
            if (eye or len(eyes) > 1) and eye not in eyes:
                raise InputError(
                    f"{path}:{number}: has the eyes {' and '.join(eyes)}: eye={eyes[0]!r} takes one"
                )
        elif is_wanted and fixations and words[0] == "EFIX" and words[1] == (eye or eyes[0]):
            rows[number] = [words[2], *words[4:7]]
        elif is_wanted and not fixations and words[0][:1].isdigit():
            at = 1 + 3 * eyes.index(eye or eyes[0])
            rows[number] = [words[0], "", *words[at : at + 2]]
    if not rows:
        raise InputError(
            f"{path}: has no"
            f" {'fixations' if fixations else 'samples'}{' of the trial ' + quoted(trial) if trial else ''}"
        )
    frame = (
        pd.DataFrame.from_dict(rows, "index", object, ["time", "duration", "x", "y"])
        .fillna("")
        .rename_axis(os.fspath(path))
    )
    return Recording.of(
        frame.assign(is_valid=(frame[["x", "y"]] != ".").all(axis=1)),
        person,
        time="time",
        duration="duration" if fixations else "",
        valid="is_valid",
        pixel=("x", "y"),
        **others,
    )


def gazepoint(
    rows: Rows, person: str, *, size: tuple[int, int], fixations: bool = False, **others: Any
) -> Recording:
    """Gazepoint Analysis, CSV: the best point of gaze (BPOG), from 0 to 1 from the upper left of the display
    of `size` pixels, or the tracker's own fixations with `fixations` (FPOG). Times in s."""
    frame = _frame(rows)
    if fixations:  # fixations grow from row to row; the last row is complete
        frame = frame[numbers(column_of(frame, "FPOGV"))[0] == 1]
        frame = frame[~_words(frame, "FPOGID").duplicated(keep="last")]
        return _in_picture(
            frame, person, ("FPOGX", "FPOGY"), size, time="FPOGS", duration="FPOGD", unit="s", **others
        )
    # as in "TIME(2024/05/17 10:31:02.100)"
    time = next((name for name in frame.columns if re.match(r"TIME\b", str(name))), "TIME")
    return _in_picture(frame, person, ("BPOGX", "BPOGY"), size, time=time, unit="s", valid="BPOGV", **others)


def unity(
    rows: Rows,
    person: str,
    *,
    time: Column = "CaptureTime",
    unit: str = "ns",
    valid: Column = "GazeStatus",
    position: str = "HMDPosition",
    rotation: str = "HMDRotation",
    origin: str = "CombinedGazePosition",
    direction: str = "CombinedGazeForward",
    object_to_world: Any = None,
    axes: str = "-x y z",
    **others: Any,
) -> Recording:
    """Headsets in Unity, with the columns of Varjo's example plugin, or others by name. A vector is a cell
    "(x, y, z)", or columns of its name with X, Y, Z (and W) appended.

    position, rotation : str
        Columns of the head in the world, rotation as a quaternion; origin and direction are relative to it.
        "": they are in the world frame.
    object_to_world : (4, 4) array
        The shape's `localToWorldMatrix`; None: the identity.
    axes : str
        x, y and z of the shape's file in the left-handed frame of its object, y up: Unity mirrors x of OBJ
        and FBX files when it imports them.
    """
    frame = _frame(rows)
    eye, ahead = _vector(frame, origin, 3), _vector(frame, direction, 3)
    if rotation:
        head = _vector(frame, rotation, 4)
        eye, ahead = _vector(frame, position, 3) + turned(head, eye), turned(head, ahead)
    if object_to_world is not None:
        object_from_world = np.linalg.inv(np.asarray(object_to_world, float))
        eye, ahead = (
            eye @ object_from_world[:3, :3].T + object_from_world[:3, 3],
            ahead @ object_from_world[:3, :3].T,
        )
    columns = {
        f"{name} {axis}": place[:, k]
        for name, place in (("eye", eye), ("ahead", ahead))
        for k, axis in enumerate("xyz")
    }
    return Recording.of(
        frame.assign(**columns),
        person,
        time=time,
        unit=unit,
        valid=valid,
        origin=[*columns][:3],
        direction=[*columns][3:],
        normalise_directions=True,
        missing=others.pop("missing", 0),
        axes=axes,
        **others,
    )


def eyenavgs(rows: Rows, person: str, **others: Any) -> Recording:
    """Recordings of the data set EyeNavGS, CSV: rays of the left eye (ViewIndex 0), whose quaternion turns
    -z; the last column is the time."""
    frame = _frame(rows)
    frame = frame[numbers(column_of(frame, "ViewIndex"))[0] == 0]
    return Recording.of(
        frame,
        person,
        time=len(frame.columns),
        origin=("GazePosX", "GazePosY", "GazePosZ"),
        direction=("GazeQX", "GazeQY", "GazeQZ", "GazeQW"),
        forward="-z",
        missing=0,
        **others,
    )


def _frame(rows: Rows) -> pd.DataFrame:
    return table(rows) if isinstance(rows, (str, os.PathLike)) else rows


def _words(frame: pd.DataFrame, name: str) -> pd.Series:
    """A column of words; "" for missing values, and in all rows if the column is missing."""
    import pandas as pd

    if name not in frame.columns:
        return pd.Series("", frame.index)
    column = column_of(frame, name)
    words = column.astype(str).str.strip()
    return words.mask(column.isna() | words.str.upper().isin(MISSING), "")


def _in_picture(
    frame: pd.DataFrame, person: str, columns: tuple[str, str], size: tuple[int, int], /, **others: Any
) -> Recording:
    """Converts positions from 0 to 1, from the upper left of a picture."""
    x, y = (side * numbers(column_of(frame, column))[0] for column, side in zip(columns, size))
    return Recording.of(frame.assign(px=x, py=y), person, pixel=("px", "py"), **others)


def _vector(frame: pd.DataFrame, name: str, n: int) -> Floats:
    """Vectors (m, n) from cells "(x, y, z)", or from columns such as NAMEX, name_x or name.x."""
    if name in frame.columns:
        words = column_of(frame, name).astype(str)
        cells = words.str.strip("()").str.split(",", expand=True)
        if n in cells.columns:
            row = int(np.argmax(cells[n].notna()))
            raise InputError(
                f"{path_of_table(frame) or 'row'}:{frame.index[row]}: {quoted(words.iloc[row])} in column"
                f" {quoted(name)} has more than {n} numbers: write decimal commas, if these are some, as points"
            )
        cells = cells.reindex(columns=range(n))
        return np.stack([numbers(cells[k])[0] for k in range(n)], axis=1)
    spelled = {re.sub(r"[._ ]", "", str(column)).lower(): column for column in frame.columns}
    wanted = [f"{name}{axis}" for axis in "XYZW"[:n]]
    return np.stack(
        [
            numbers(column_of(frame, spelled.get(re.sub(r"[._ ]", "", column).lower(), column)))[0]
            for column in wanted
        ],
        axis=1,
    )
