# SPDX-License-Identifier: GPL-3.0-or-later
"""Recordings of people's gaze on a shape, from tables with one row per sample or fixation.

    Recording.of(rows, person, time=..., ...)   one person's rows: a data frame, or the path of a table
    gather(sources, read, ...)                  several people; `read` is Recording.of, or a function of
                                                the module `trackers`

A row with a time but without usable gaze stays as a lost sample, because gaps end fixations. A row that
cannot be ordered in time is left out. Both are counted by cause.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from salbench.datasets import samples
from salbench.datasets.files import natural_order
from salbench.datasets.samples import MS, Column, Fault, Faults
from salbench.datasets.tables import table
from salbench.system.errors import InputError, UnreadableError, quoted, wrong_with_line
from salbench.system.files import AnyPath

if TYPE_CHECKING:
    import pandas as pd

    from salbench.datasets.arrays import Bools, Floats, Ints
    from salbench.datasets.cameras import Frames

_COLUMNS = ("time", "valid", "origins", "directions", "points", "durations")
_WIDTHS = {"point": (3,), "origin": (3,), "direction": (2, 3, 4), "pixel": (2,)}


@dataclass
class Recording:
    """Samples of people's gaze on a shape, or fixations: m rows, grouped by person, in order of time.

    They are rays, with `origins` and `directions`, or hits, with `points`.

    Attributes
    ----------
    people : tuple of str
        Names.
    person : (m,) array of int
        Index of the person, ascending from 0.
    time : (m,) array
        In ms, ascending within each person.
    valid : (m,) array of bool
        False if the tracker lost the eye.
    origins : (m, 3) array or None
        The eye, in the frame of the shape; may be unknown for hits.
    directions : (m, 3) array or None
        Unit vectors; only for rays.
    points : (m, 3) array or None
        Gaze targets in the frame of the shape; only for hits.
    durations : (m,) array or None
        In ms, if rows are fixations already.
    faults : list of Fault
        Unusable rows of the tables, by person and cause.
    problems : list of str
        Why tables of people are left out, one line each.
    """

    people: tuple[str, ...]
    person: Ints
    time: Floats
    valid: Bools
    origins: Floats | None = None
    directions: Floats | None = None
    points: Floats | None = None
    durations: Floats | None = None
    faults: list[Fault] = field(default_factory=list)
    problems: list[str] = field(default_factory=list)

    @property
    def remarks(self) -> list[str]:
        """Remarks on unusable parts of the tables: one line per problem, and per cause."""
        return [*self.problems, *samples.summed(self.faults)]

    @classmethod
    def of(
        cls,
        rows: pd.DataFrame | AnyPath,
        person: str,
        *,
        time: Column = "",
        duration: Column = "",
        unit: str = "ms",
        valid: Column = "",
        valid_is: Any = None,
        valid_from: float | None = None,
        missing: float | Collection[float] = (),
        point: Sequence[Column] = (),
        origin: Sequence[Column] = (),
        direction: Sequence[Column] = (),
        pixel: Sequence[Column] = (),
        frame: Column = "",
        cameras: AnyPath | Frames | None = None,
        delay_ms: float = 0.0,
        length: float = 1.0,
        angles: str = "degrees",
        normalise_directions: bool = False,
        forward: str = "z",
        axes: str = "x y z",
    ) -> Recording:
        """Returns the recording of one person, from a data frame or the path of a table. Columns are given by
        name, or by number from 1.

        Required are `point`, `direction` with `origin`, or `pixel`; and `time`, `duration` or both.

        Parameters
        ----------
        rows : data frame or path
            `salbench.datasets.table` reads a path.
        person : str
            Name of the person.
        time, duration : column
            Rows with a duration are fixations; without times, each begins where the previous one ends.
        unit : {"ms", "s", "us", "ns", "ticks"}
            Unit of both; "ticks" of .NET and Unity are 100 ns.
        valid : column
            0, false or "Invalid" if the tracker lost the eye. `valid_is`: numbers or words that mark a valid
            sample; `valid_from`: the least number that does, such as a confidence.
        missing : number, or several
            Marks lost places and directions, all of whose numbers are this one: -1, 1e8, 0.
        point, origin : three columns
            x, y, z of the gaze target, and of the eye.
        direction : two, three or four columns
            Azimuth from x to y and elevation towards z, in `angles` ("degrees" or "radians"); a vector of
            length 1, or of any length with `normalise_directions`; or a quaternion x, y, z, w that turns the
            axis `forward`, such as "-z", into it.
        pixel : two columns
            x to the right and y down from the upper left corner of the picture of `cameras`: the path of
            their file, or what `cameras.read_frames` returns. Column `frame`: the number of the camera;
            without it, the last one at the time of the sample, less `delay_ms`.
        length : float
            Factor from coordinates, and places of cameras, to the shape's unit.
        axes : str
            x, y and z of the shape in axes of the table: "-x y z" mirrors x, as for a left-handed frame.

        Throws InputError for a table that cannot be used, ValueError for columns that make no recording.
        """
        places = {"point": point, "origin": origin, "direction": direction, "pixel": pixel}
        _require_columns(places, time, duration, unit, cameras)
        to_shape, is_path = samples.matrix_of(axes), isinstance(rows, (str, os.PathLike))
        whole: Any = table(rows) if is_path else rows
        faults = Faults(whole, person)
        try:
            if not person or wrong_with_line(person):
                raise InputError(f"{quoted(person)} is no name of a person that tables can have")
            is_valid: Bools = np.ones(len(whole), np.bool_)
            flagged: Bools = np.zeros(len(whole), np.bool_)
            if valid:
                is_valid, flagged = samples.validity(
                    samples.column_of(whole, valid), valid_is, valid_from, faults
                )
            codes = [*missing] if isinstance(missing, Collection) else [missing]
            given = {
                name: samples.place_of(whole, columns, codes if name != "origin" else [], is_valid, faults)
                for name, columns in places.items()
                if columns
            }
            when, durations = samples.times(whole, time, duration, unit, faults)
            with np.errstate(all="ignore"):
                found: dict[str, Any] = {
                    f"{name}s": length * place for name, place in given.items() if name in ("point", "origin")
                }
                if direction:
                    found["directions"] = samples.directions_of(
                        given["direction"], angles, normalise_directions, forward, faults
                    )
                if pixel and cameras is not None:
                    number = samples.numbers(samples.column_of(whole, frame))[0] if frame else None
                    seen = is_valid & (faults.cause == 0)
                    found["origins"], found["directions"] = samples.rays_of_pixels(
                        given["pixel"], seen, number, when, cameras, delay_ms, length, faults
                    )
        except InputError as error:
            path = samples.path_of_table(whole)
            raise (
                error if not path or str(error).startswith(path) else InputError(f"{path}: {error}")
            ) from None
        kept = ~faults.left_out
        faults.cause[kept & ~is_valid & ~flagged] = 0  # samples lost by the tracker are no fault of the file
        is_valid &= faults.cause == 0
        for name, place in found.items():
            found[name] = np.where(is_valid[:, None], place, np.nan)[kept] @ to_shape.T
        return cls(
            (person,),
            np.zeros(int(kept.sum()), np.int32),
            when[kept],
            is_valid[kept],
            durations=None if durations is None else durations[kept],
            faults=faults.listed(),
            **found,
        )


def _require_columns(
    places: Mapping[str, Sequence[Column]], time: Column, duration: Column, unit: str, cameras: object
) -> None:
    kinds = [name for name in ("point", "direction", "pixel") if places[name]]
    if (
        len(kinds) != 1
        or kinds == ["direction"]
        and not places["origin"]
        or not (time or duration)
        or unit not in MS
    ):
        raise ValueError(
            "a recording has columns of one kind (point, direction with origin, or pixel), time or duration,"
            f" and a unit of {', '.join(MS)}"
        )
    if places["pixel"] and cameras is None:
        raise ValueError("pixels need cameras: the path of their file")
    for name, widths in _WIDTHS.items():
        if len(places[name]) not in (0, *widths):
            raise ValueError(
                f"{name} must be {' or '.join(map(str, widths))} columns, not {len(places[name])}"
            )


def gather(
    sources: Iterable[tuple[str | int, Any]], read: Callable[..., Recording], **columns: Any
) -> Recording:
    """Joins the recordings of several people: `read(rows, person, **columns)` for each.

    sources: names (or whole numbers) and rows, such as `zip(names, paths)` or `frame.groupby("person")`; a
    name may come several times. Unreadable rows become a problem; the others are used. Throws InputError if
    no row can be used.
    """
    by_person, faults, problems = dict[str, list[Recording]](), list[Fault](), list[str]()
    for key, rows in sources:
        person = _name_of(key)
        try:
            part, before = read(rows, person, **columns), by_person.setdefault(person, [])
            if len(part.time) and before and part.time[0] <= before[-1].time[-1]:
                raise InputError(
                    f"{_place_of(rows)}: begins before the one before it ends: give them in order of time,"
                    " or add to the times of the later one"
                )
        except UnreadableError:
            raise
        except InputError as error:
            problems.append(f"{error}; {person or 'nobody'} cannot be in the recording")
            continue
        faults += part.faults
        before += [part] * bool(len(part.time))
    people = sorted((name for name, parts in by_person.items() if parts), key=natural_order)
    parts = [part for name in people for part in by_person[name]]
    if not any(part.valid.any() for part in parts):
        raise InputError(
            [*problems, *samples.summed(faults), "no row has gaze"][0]
            + "; nothing is known of the gaze on this shape"
        )
    person_of: Ints = np.repeat(
        np.arange(len(people), dtype=np.int32),
        [sum(len(part.time) for part in by_person[name]) for name in people],
    )
    joined: dict[str, Any] = {
        name: np.concatenate([getattr(part, name) for part in parts])
        for name in _COLUMNS
        if getattr(parts[0], name) is not None
    }
    return Recording(tuple(people), person_of, **joined, faults=faults, problems=problems)


def _place_of(rows: Any) -> str:
    import pandas as pd

    path = samples.path_of_table(rows) if isinstance(rows, pd.DataFrame) else rows
    return os.fspath(path) if path and isinstance(path, (str, os.PathLike)) else "a table"


def _name_of(key: Any) -> str:
    if isinstance(key, (str, int, np.integer)):
        return str(key)
    raise InputError(
        f"{quoted(str(key))} is no name of a person: group by one column of words or whole numbers, such as"
        ' groupby("person")'
    )
