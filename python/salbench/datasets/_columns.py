# SPDX-License-Identifier: GPL-3.0-or-later
"""Point clouds in columns of a text, as studies of eye tracking publish them with their ground truth."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from salbench.datasets._layout import Columns
from salbench.datasets._numbers import read_columns
from salbench.datasets._values import wrong_with_points
from salbench.datasets.records import Floats, Ints

ROUNDING = 0.01  # of the length of a unit normal; three numbers of another length may be a colour


@dataclass
class Rows:
    """The rows of a file. Those that are no points, such as padding, have NaN as their position."""

    points: Floats
    normals: Floats | None
    density: Floats | None
    flagged: Ints  # rows whose flag is 1


def _filled_rows(table: Floats, padding: str) -> int:
    """Number of the rows before those that fill the file up: zeros, or copies of rows before them."""
    zeros, copies = padding in ("zeros", "any"), padding in ("copies", "any")
    last = table[-1]
    if not (zeros and not last.any()) and not (copies and (table[:-1] == last).all(axis=1).any()):
        return len(table)
    is_padding = np.zeros(len(table), bool)
    if zeros:
        is_padding |= (table == 0).all(axis=1)
    if copies:
        is_padding |= _is_copy(table)
    real = np.flatnonzero(~is_padding)
    return int(real[-1]) + 1 if len(real) else 0


def _is_copy(rows: Floats) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
    """True of a row that is equal to one before it."""
    _, first = np.unique(rows + 0.0, axis=0, return_index=True)
    copies = np.ones(len(rows), bool)
    copies[first] = False
    return copies


def read_rows(data: bytes, name: str, columns: Columns) -> Rows:
    """A cloud in columns. Normals have length 1, or 0 where none is known, unless directions are to be normalised."""
    wanted = [*columns.position, *columns.normal, *(column for column in (columns.density, columns.flag) if column)]
    normals = slice(3, 6) if columns.normal else None

    def wrong(rows: list[Floats]) -> tuple[int, str] | None:
        found = [wrong_with_points(np.stack(rows[:3], axis=1))]
        if normals and not columns.normalise_normals:
            lengths = np.linalg.norm(np.stack(rows[normals], axis=1), axis=1)
            odd = np.flatnonzero((lengths > 0) & ~(np.abs(lengths - 1) <= ROUNDING))
            found += [(int(row), f"the normal has length {lengths[row]:.3g}, not 1: are these colours? name the columns of the normals, or none; "
                                 "for directions of any length add `normalise_normals: true`") for row in odd[:1]]
        if columns.flag:
            odd = np.flatnonzero((rows[-1] != 0) & (rows[-1] != 1))
            found += [(int(row), "the flag is neither 0 nor 1: name the column of the flag") for row in odd[:1]]
        return min((one for one in found if one is not None), default=None)

    table = np.stack(read_columns(data, name, wanted, wrong_with_rows=wrong), axis=1)
    keep = np.arange(len(table)) < _filled_rows(table, columns.padding)
    if columns.duplicates == "dropped":
        keep[keep] = ~_is_copy(table[keep, :3])  # padding has no place of its own
    return Rows(np.where(keep[:, None], table[:, :3], np.nan), table[:, normals] if normals else None,
                table[:, 3 + len(columns.normal)].copy() if columns.density else None,
                np.flatnonzero(table[:, -1] == 1).astype(np.int32) if columns.flag else np.empty(0, np.int32))
