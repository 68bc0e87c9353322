# SPDX-License-Identifier: GPL-3.0-or-later
"""Point clouds in columns of a text, as studies of eye tracking publish them with their ground truth."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from salbench.datasets._layout import Columns
from salbench.datasets._numbers import read_columns
from salbench.datasets._values import wrong_with_points
from salbench.datasets.records import Floats, InputError, Ints

ROUNDING = 8 * np.finfo(float).eps  # of a squared length of 1
SHORTEST, LONGEST = 0.5, 2.0  # of what is called a unit normal


@dataclass
class Cloud:
    """The points that are left of a file."""

    points: Floats
    normals: Floats | None
    left_out: Ints  # rows of the file that are no points here, ascending

    @property
    def size_in_file(self) -> int:
        return len(self.points) + len(self.left_out)


def _squares(vectors: Floats) -> Floats:
    x, y, z = (vectors * vectors).T
    return np.asarray(x + y + z)


def _lengths(vectors: Floats) -> Floats:
    """As Eigen's stableNorm has them, to the bit."""
    largest = np.abs(vectors).max(axis=1)
    inverse = 1 / np.where(largest > 0, largest, 1)
    return np.asarray(largest * np.sqrt(_squares(vectors * inverse[:, None])))


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


def read_cloud(data: bytes, name: str, columns: Columns) -> tuple[Cloud, Floats | None, Ints]:
    """The points that are left, with the density of each row of the file, and the rows whose flag is set."""
    wanted = [*columns.position, *columns.normal, *(column for column in (columns.density, columns.flag) if column)]
    normals = slice(3, 6) if columns.normal else None

    def wrong(rows: list[Floats]) -> tuple[int, str] | None:
        found = [wrong_with_points(np.stack(rows[:3], axis=1))]
        if normals and not columns.normalise_normals:
            lengths = _lengths(np.stack(rows[normals], axis=1))
            odd = np.flatnonzero((lengths > 0) & ((lengths < SHORTEST) | (lengths > LONGEST)))
            found += [(int(row), "the normal is not of unit length: name its columns, or add `normalise_normals: true`") for row in odd[:1]]
        if columns.flag:
            odd = np.flatnonzero((rows[-1] != 0) & (rows[-1] != 1))
            found += [(int(row), "the flag is neither 0 nor 1: name the column of the flag") for row in odd[:1]]
        return min((one for one in found if one), default=None, key=lambda one: one[0])

    table = np.stack(read_columns(data, name, wanted, wrong_with_rows=wrong), axis=1)
    keep = np.arange(len(table)) < _filled_rows(table, columns.padding)
    if columns.duplicates == "dropped":
        # A row that only fills the file up has no place of its own.
        keep[keep] = ~_is_copy(table[keep][:, :3])
    left_out = np.flatnonzero(~keep).astype(np.int32)
    cloud = Cloud(np.ascontiguousarray(table[keep, :3]), unit_normals(table[keep, normals]) if normals else None, left_out)
    density = np.ascontiguousarray(table[:, 3 + len(columns.normal)]) if columns.density else None
    flags = np.flatnonzero(table[:, -1] == 1) if columns.flag else []
    return cloud, density, np.asarray(flags, np.int32)


def unit_normals(normals: Floats) -> Floats | None:
    """Of unit length, those within rounding as they are; None if all are zero. One that is zero among others is left, and refused later."""
    if not normals.any():
        return None
    with np.errstate(over="ignore"):
        x, y, z = (normals * normals).T
        is_unit = np.abs(x + (y + z) - 1) <= ROUNDING
    lengths = _lengths(normals)
    return np.asarray(normals / np.where(is_unit | (lengths == 0), 1, lengths)[:, None])


def truth_in_columns(name: str, cloud: Cloud, density: Floats | None, flagged: Ints) -> tuple[Floats | None, tuple[Ints, ...]]:
    """Values and picks of the points that are left; flags of rows that were left out do not count."""
    picks = flagged[~np.isin(flagged, cloud.left_out)]
    if density is None and not len(picks):
        raise InputError(f"{name}: no point has its flag set: there is nothing to compare with")
    return None if density is None else np.delete(density, cloud.left_out), (picks,) if len(picks) else ()


def numbers_left(cloud: Cloud) -> Ints:
    """For each point of the file its number among those that are left; -1 if it was left out."""
    numbers = np.full(cloud.size_in_file, -1, np.int32)
    kept = np.delete(np.arange(cloud.size_in_file), cloud.left_out)
    numbers[kept] = np.arange(len(kept), dtype=np.int32)
    return numbers
