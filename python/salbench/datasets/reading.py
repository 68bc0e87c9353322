# SPDX-License-Identifier: GPL-3.0-or-later
"""Readers of data set files: shapes, values, picks and masks, and conversions between them. Readers take a
path first, and name it in their errors."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import takewhile

import numpy as np
from numpy.typing import ArrayLike

from salbench import _core
from salbench.datasets.arrays import Bools, Floats, Ints
from salbench.datasets.clouds import read_cloud
from salbench.datasets.files import extension, kind_of
from salbench.datasets.records import Shape, shape_of
from salbench.datasets.tables import is_number, numbers, read_lines, require, rows_of
from salbench.system.errors import InputError, in_quotes
from salbench.system.files import AnyPath, read_file
from salbench.system.npy import MAGIC, doubles_of, read_npy

ROUNDING = 1e-9  # so that equal parts do not differ by rounding
_NPY_TYPES = [
    order + kind for order in "<>" for kind in ("f2", "f4", "f8", "i2", "i4", "i8", "u2", "u4", "u8")
] + ["|i1", "|u1"]


def shape(path: AnyPath) -> Shape:
    """Reads a mesh or a point cloud."""
    return cloud(path) if kind_of(os.fspath(path)) == "cloud" else mesh(path)


def mesh(path: AnyPath) -> Shape:
    """Reads the mesh in a .off, .obj or .ply file. Polygons are split into triangles."""
    with _named(path):
        arrays, face_of = _core.read_mesh(read_file(path), os.fsencode(path))
    return replace(shape_of(arrays), face_of=face_of)


def cloud(path: AnyPath) -> Shape:
    """Reads the point cloud in a .ply, .pcd or .xyz file."""
    kind = extension(os.fspath(path))
    if kind == ".ply":
        with _named(path):
            return shape_of(_core.read_cloud(read_file(path), os.fsencode(path)))
    if kind not in (".pcd", ".xyz"):
        raise InputError(
            f"{path}: is not named as a point cloud: convert it to .ply, .pcd or .xyz, a mesh to .off, .obj or"
            " .ply"
        )
    points, normals, viewpoint = read_cloud(path)
    found = cloud_of(points, normals, path)
    found.viewpoint = viewpoint
    return found


def cloud_of(points: ArrayLike, normals: ArrayLike | None = None, path: AnyPath = "points") -> Shape:
    """A point cloud of rows, each a position and a direction of any length along the normal. Rows whose
    position is NaN are left out; `left_out` holds their numbers. path: for messages."""
    with _named(path):
        return shape_of(_core.checked_cloud(points, normals, os.fsencode(path)))


def numbering(of: Shape) -> Ints:
    """Number in the shape of each point of its file; -1 if left out."""
    left_out = np.empty(0, np.int32) if of.left_out is None else of.left_out
    found = np.full(len(of.points) + len(left_out), -1, np.int32)
    found[np.delete(np.arange(len(found)), left_out)] = np.arange(len(of.points))
    return found


@contextlib.contextmanager
def _named(path: AnyPath) -> Iterator[None]:
    """Prefixes errors of C++, which may not know the file, with the file."""
    try:
        yield
    except ValueError as error:
        raise InputError(
            str(error) if os.fspath(path) in str(error) else f"{os.fspath(path)}: {error}"
        ) from None


def read_values(path: AnyPath) -> Floats:
    """Reads one number per line, or a .npy with one number per element; the content decides."""
    data = read_file(path)
    if not data.startswith(MAGIC):
        return numbers(path, 1)[:, 0]
    try:
        return doubles_of(
            read_npy(data, _NPY_TYPES, "expected float16, float32, float64, or whole numbers").ravel()
        )
    except InputError as error:
        raise InputError(f"{path}: not a .npy file that can be read: {error}") from None


def values(path: AnyPath, n: int, unseen: float | None = None) -> Floats:
    """Reads one number per vertex, point or face, n in all, in their order. Values equal to `unseen`, such as
    -1 or NaN, become NaN."""
    return _seen(path, read_values(path), n, unseen, f"{n} are expected")


def face_values(path: AnyPath, of: Shape, unseen: float | None = None) -> Floats:
    """Reads one number per triangle of a mesh. The file may instead have one per face of the mesh's file,
    polygons included."""
    if of.faces is None:
        raise InputError(f"{path}: has values per face, but the shape is a point cloud, which has none")
    triangles, polygon_of = len(of.faces), np.arange(len(of.faces)) if of.face_of is None else of.face_of
    in_file, found = int(polygon_of.max(initial=-1)) + 1, read_values(path)
    if len(found) == triangles:
        return _seen(path, found, triangles, unseen)
    there = f"the mesh has {in_file} faces" + (
        "" if in_file == triangles else f", split into {triangles} triangles"
    )
    return np.asarray(_seen(path, found, in_file, unseen, there)[polygon_of])


def _seen(path: AnyPath, found: Floats, n: int, unseen: float | None, expected: str = "") -> Floats:
    if len(found) != n:
        raise InputError(f"{path}: the file has {len(found)} values, but {expected}")
    hidden = np.zeros(n, bool) if unseen is None else np.isnan(found) if unseen != unseen else found == unseen
    for place in np.flatnonzero(~np.isfinite(found) & ~hidden)[:1]:
        where = (
            f"{path}: value {place} (0-based)"
            if read_file(path).startswith(MAGIC)
            else f"{path}:{rows_of(read_lines(path))[1][place]}: the value"
        )
        raise InputError(f"{where} is {found[place]}, expected a finite number")
    found[hidden] = np.nan
    return found


def mask(path: AnyPath, n: int) -> Bools:
    """Reads a mask with one number per vertex or face: True (1) if seen, 0 if hidden."""
    found = values(path, n)
    require(path, (found == 0) | (found == 1), "a mask has 0 for hidden and 1 for seen, and nothing else")
    if not found.any():
        raise InputError(
            f"{path}: hides everything: nothing is left to be scored; correct it, or take it and its ground"
            " truth away"
        )
    return np.asarray(found == 1)


def picks(path: AnyPath, n: int, base: int = 0) -> Ints:
    """Reads numbers of picked vertices, one per line or element of a .npy, in the file's order. base: number
    of the first vertex. Empty files are valid: the participant picked nothing."""
    if read_file(path).startswith(MAGIC):
        lines = [repr(float(value)).encode() for value in read_values(path)]
    else:
        lines = [
            b" ".join([*takewhile(lambda word: not word.startswith(b"#"), line.split())])
            for line in read_lines(path)
        ]
    header, numbered = rows_of(lines)
    if len(header) > 1:
        raise InputError(f"{path}: has {len(header)} columns, expected one number per line")
    found = []
    for number in numbered:
        word = lines[number - 1]
        if not is_number(word) or not float(word).is_integer():  # 3.000e+00 is whole
            raise InputError(f"{path}:{number}: {in_quotes(word)} is not a whole number")
        if not 0 <= int(float(word)) - base < n:
            raise InputError(
                f"{path}:{number}: vertex {float(word):.0f} is out of range: the shape has {n}, numbered"
                f" from {base}"
            )
        found.append(int(float(word)) - base)
    return np.array(found, np.int32)


def unit(directions: ArrayLike) -> Floats:
    """Divides rows by their lengths; rows of length 0 stay 0."""
    rows = np.asarray(directions, float)
    lengths = np.linalg.norm(rows, axis=1, keepdims=True)
    return np.asarray(rows / np.where(lengths == 0, 1, lengths))


def from_faces(of: Shape, values_of_faces: Floats) -> Floats:
    """Values of vertices: area-weighted means over the triangles around each. NaN if all of these are NaN."""
    return np.asarray(_core.vertex_values_of_faces(of.points, of.faces, values_of_faces))


def from_points(of: Shape, points: Floats, values_of_points: Floats, max_distance: float = 0.02) -> Floats:
    """Values of vertices: the value of the nearest point; NaN if it is farther than `max_distance` times the
    radius of the shape."""
    return np.asarray(
        _core.vertex_values_of_samples(of.points, points, values_of_points, max_distance * radius(of.points))
    )


def radius(points: Floats) -> float:
    """Largest distance of a point from the centroid, summed in the same order as in the program."""
    if not len(points) or (points == points[0]).all():
        return 0.0
    centre = np.cumsum(points, axis=0)[-1] / len(points)
    with np.errstate(over="ignore"):
        x, y, z = ((points - centre) ** 2).T
        largest = float((x + (y + z)).max())
    return float(np.sqrt(largest)) if largest > 0 else float(np.abs(points - centre).max())


def mean(maps: Sequence[Floats]) -> Floats:
    """Mean at each point over the maps that saw it; NaN if none did."""
    if len(maps) == 1:
        return maps[0]
    total, count = np.zeros(len(maps[0])), np.zeros(len(maps[0]))
    for one in maps:
        seen = ~np.isnan(one)
        total[seen] += one[seen]
        count += seen
    with np.errstate(invalid="ignore"):
        return np.asarray(total / count)


def above_mean(density: Floats) -> Ints:
    """Points above the mean of the seen ones: picks from a density."""
    falling = np.sort(density[~np.isnan(density)])[::-1]
    average = np.cumsum(falling)[-1] / len(falling)
    return np.flatnonzero((density > average) & (density > falling[-1])).astype(np.int32)


def top(density: Floats, percent: float) -> Ints:
    """Points with less than `percent` of the seen points above them. Ties are all taken or all left, and
    points at the minimum are never taken."""
    falling = np.sort(density[~np.isnan(density)])[::-1]
    most = percent / 100 * len(falling) * (1 - ROUNDING)
    last = min(int(max(0.0, np.ceil(most) - 1)), len(falling) - 1)
    return np.flatnonzero((density >= falling[last]) & (density > falling[-1])).astype(np.int32)
