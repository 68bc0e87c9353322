# SPDX-License-Identifier: GPL-3.0-or-later
"""The one form of an item from its files: values on the points that they describe, hidden where nothing was seen."""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from salbench import _core
from salbench.datasets._columns import Rows, read_rows
from salbench.datasets._files import read_file
from salbench.datasets._layout import SURFACE, Columns, Indices, Values, positive_rule
from salbench.datasets._order import Elements
from salbench.datasets._values import read_mask, read_picks, read_values
from salbench.datasets.records import AsRead, Floats, Form, InputError, Ints, Item, Truth

MIN_VIEWERS = 2  # one predicts, one is predicted
ROUNDING = 1e-9  # equal parts must not differ by it


def options_of(how: dict[str, Any], kind: type[Any]) -> Any:
    """`values`, `indices` or `columns` of a listing's row."""
    given = how.get(kind.__name__.lower(), {})
    return kind(**{key: tuple(value) if isinstance(value, list) else value for key, value in given.items()})


@dataclass
class _Shape:
    """The points that the files describe. A cloud may have left out some that its file has."""

    path: str
    form: Form
    surface: Ints | None = None  # of a cloud: its partial mesh, computed when it is asked for

    @property
    def left_out(self) -> Ints:
        return np.empty(0, np.int32) if self.form.left_out is None else self.form.left_out

    @property
    def in_file(self) -> Elements:
        if self.form.faces is not None:
            return Elements(len(self.form.points), faces=self.face_counts)
        return Elements(len(self.form.points) + len(self.left_out), "point cloud", "point", "points")

    def described_by(self, values: Values) -> Elements:
        if values.per != "face":
            return self.in_file
        assert self.face_counts is not None
        return Elements(self.face_counts[1], "mesh", "face", "faces", self.face_counts)

    @property
    def face_counts(self) -> tuple[int, int] | None:
        """Of a mesh: the faces of its file, and the triangles that they were split into."""
        if self.form.faces is None:
            return None
        triangles = len(self.form.faces)
        return (triangles if self.form.face_of is None else int(self.form.face_of[-1]) + 1), triangles

    def on_triangles(self, values: Values, found: Floats) -> Floats:
        """Values of the faces of a file, polygons among them, as those of triangles."""
        is_of_file = values.per == "face" and self.face_counts is not None and len(found) != self.face_counts[1]
        return found[self.form.face_of] if is_of_file else found

    @property
    def kept(self) -> Ints:
        """Numbers in the file of the points that are left."""
        return np.delete(np.arange(self.in_file.n or 0, dtype=np.int32), self.left_out)

    def number_left(self, in_file: Ints) -> Ints:
        """Numbers of points of the file among those that are left; -1: left out."""
        numbers = np.full(self.in_file.n or 0, -1, np.int32)
        numbers[self.kept] = np.arange(len(self.form.points), dtype=np.int32)
        return np.asarray(numbers[in_file])

    def left(self, in_file: Floats) -> Floats:
        """Values of the points that are left."""
        return np.delete(in_file, self.left_out) if len(self.left_out) else in_file

    def faces(self) -> Ints:
        if self.form.faces is not None:
            return self.form.faces
        if self.surface is None:
            from salbench._shapes import estimate_normals, partial_mesh

            normals = self.form.normals
            if normals is None:
                normals = estimate_normals(self.form.points, viewpoint=self.form.viewpoint)
            self.surface = partial_mesh(self.form.points, normals)
        return self.surface


@dataclass
class _Reader:
    """The files of an item, each read once, in the order of its listing."""

    item: Item
    digests: dict[str, str] = field(default_factory=dict)
    place: int = 0

    def next(self) -> tuple[str, bytes]:
        file = self.item.files[self.place]
        self.place += 1
        data = read_file(file.path)
        self.digests[file.path] = _core.xxh128(data)
        return file.path, data


def read_item(item: Item) -> Form:
    """The one form of an item; its ground truth as the files have it, with what was not seen as NaN. No saliency is made from picks."""
    reader, how = _Reader(item), item.how
    columns: Columns = options_of(how, Columns)
    path, data = reader.next()
    rows = read_rows(data, path, columns) if columns.position else None
    shape = _Shape(path, _shape_form(path, data, item.kind) if rows is None else
                   _cloud_form(_core.checked_cloud(rows.points, rows.normals, os.fsencode(path))))
    truth: Truth | None = None
    lists = reader.next() if how.get("neighbours") else None
    if rows is not None and (columns.density or columns.flag):
        truth = _truth_in_columns(shape, rows, item.view, options_of(how, Values), lists)
    elif how.get("saliency") or how.get("picks"):
        truth = _read_truth(shape, item, reader, lists)
    if truth is not None:
        shape.form.truths = (_finished(shape, truth, how),)
    while reader.place < len(item.files):
        reader.next()  # beside the shape, such as its texture: known by its digest alone
    shape.form.digests = reader.digests
    return shape.form


def _cloud_form(read: tuple[Any, ...]) -> Form:
    points, normals, viewpoint, left_out = read
    return Form(points, None, normals, viewpoint, left_out)


def _shape_form(path: str, data: bytes, kind: str) -> Form:
    name = os.fsencode(path)
    if kind == "cloud":
        return _cloud_form(_core.read_cloud(data, name))
    points, faces, split, concave, face_of = _core.read_mesh(data, name)
    return Form(points, faces, polygons=(split, concave), face_of=face_of)


def _truth_in_columns(shape: _Shape, rows: Rows, view: str, values: Values, lists: tuple[str, bytes] | None) -> Truth:
    """Flags of rows that are no points do not count."""
    picks = rows.flagged[~np.isin(rows.flagged, shape.left_out)]
    if rows.density is None and not len(picks):
        raise InputError(f"{shape.path}: no point has its flag set: there is nothing to compare with")
    density = None if rows.density is None else _spread(shape, values, shape.left(rows.density), None, lists)
    return Truth(view, density, None, (picks,) if len(picks) else ())


def _read_truth(shape: _Shape, item: Item, reader: _Reader, lists: tuple[str, bytes] | None) -> Truth:
    """All but positives. Picks count the points of the file."""
    how = item.how
    values, indices = options_of(how, Values), options_of(how, Indices)
    if values.per == "face" and shape.form.faces is None and how.get("saliency"):
        raise InputError(f"{item.files[reader.place].path}: has values per face, but {shape.path} is a point cloud, which has none")
    files = [reader.next() for _ in range(how.get("saliency", 0))]
    read = [(path, shape.on_triangles(values, found), points)
            for path, (found, points) in ((path, read_values(data, path, values, shape.described_by(values))) for path, data in files)]
    masks = [_read_mask(reader, values, len(found), shape) if how.get("masks") else None for _, found, _ in read]
    masked = [found if mask is None else np.where(mask == 0, np.nan, found) for (_, found, _), mask in zip(read, masks)]
    maps = [_on_points(shape, values, found, points, lists) for found, (_, _, points) in zip(masked, read)]
    by_viewer = bool(how.get("by_viewer"))
    truth = Truth(item.view)
    if maps:
        truth.saliency = _mean(maps)
        if np.isnan(truth.saliency).all():
            raise InputError(f"{read[0][0]}: no point of the shape has a value; expected are values of what was seen, and points within "
                             "max_distance of it")
        truth.viewers = _enough(maps) if by_viewer else None
        truth.face_values = _mean(masked) if values.per == "face" else None
    is_all = values.per == "vertex" and not how.get("masks") and (len(maps) == 1 or by_viewer) and not values.spread_neighbours
    if not is_all and not (values.per == "face" and len(maps) == 1 and not how.get("masks")):
        truth.as_read = tuple(AsRead(os.path.basename(path), values.per, found, points, mask)
                              for (path, found, points), mask in zip(read, masks))
    picks = [(path, read_picks(data, path, indices, shape.in_file))
             for path, data in (reader.next() for _ in range(how.get("picks", 0)))]
    if any(len(one) for _, one in picks):
        truth.picks = tuple(one for _, one in picks)
    elif truth.saliency is None and picks:
        empty = picks[0][0]
        raise InputError(f"{empty}: nobody picked a point and there is no saliency file; remove the empty {os.path.splitext(empty)[1]} files")
    if how.get("people"):
        truth.viewers = _read_viewers(shape, truth, how["people"], values, reader, lists)
    return truth


def _enough(maps: list[Floats]) -> Floats | None:
    return np.stack(maps) if len(maps) >= MIN_VIEWERS else None


def _read_viewers(shape: _Shape, truth: Truth, count: int, values: Values, reader: _Reader, lists: tuple[str, bytes] | None) -> Floats | None:
    """Files of viewers beside a saliency that is not made of them; what it hides is hidden to them, too."""
    hidden = np.isnan(np.zeros(1) if truth.saliency is None else truth.saliency)
    maps = []
    for _ in range(count):
        path, data = reader.next()
        found, points = read_values(data, path, values, shape.described_by(values))
        maps.append(np.where(hidden, np.nan, _on_points(shape, values, found, points, lists)))
    return _enough(maps)


def _spread(shape: _Shape, values: Values, found: Floats, points: Floats | None, lists: tuple[str, bytes] | None) -> Floats:
    """Densities of the points left of the shape, or of points of their own, with what those that were looked at add to their neighbours."""
    if not values.spread_neighbours:
        return found
    from salbench.datasets._spread import looked_at, nearest_in_space, nearest_on_surface, read_lists, spread

    sources, count = looked_at(found), values.spread_neighbours
    if lists is not None:
        path, data = lists
        listed = read_lists(data, path, (shape.in_file.n or 0) if points is None else len(points), count)
        neighbours = shape.number_left(listed[shape.kept[sources]]) if points is None else listed[sources]
    elif values.spread_along == SURFACE:
        neighbours = nearest_on_surface(shape.form.points, shape.faces(), sources, count)
    else:
        neighbours = nearest_in_space(shape.form.points if points is None else points, sources, count)
    return spread(found, sources, neighbours, count, values.spread_from)


def _read_mask(reader: _Reader, values: Values, count: int, shape: _Shape) -> Floats:
    path, data = reader.next()
    if values.per == "point":
        return read_mask(data, path, Elements(count, "file", "point", "points"))
    return shape.on_triangles(values, read_mask(data, path, shape.described_by(values)))


def _on_points(shape: _Shape, values: Values, found: Floats, points: Floats | None, lists: tuple[str, bytes] | None) -> Floats:
    """Values of a file, carried over to the points of the shape."""
    if values.per == "face":
        return np.asarray(_core.vertex_values_of_faces(shape.form.points, shape.form.faces, found))
    if values.per == "point":
        far = values.max_distance * _radius(shape.form.points)
        found = _spread(shape, values, found, points, lists)
        return np.asarray(_core.vertex_values_of_samples(shape.form.points, points, found, far))
    return _spread(shape, values, shape.left(found), None, lists)


def _radius(points: Floats) -> float:
    """The largest distance of a point to the centroid, summed in the points' order as the program does."""
    if not len(points) or (points == points[0]).all():
        return 0.0
    centre = np.cumsum(points, axis=0)[-1] / len(points)
    with np.errstate(over="ignore"):
        x, y, z = ((points - centre) ** 2).T
        largest = float((x + (y + z)).max())
    return float(np.sqrt(largest)) if largest > 0 else float(np.abs(points - centre).max())


def _mean(maps: list[Floats]) -> Floats:
    """The mean at each point over the maps that have it seen; NaN where none has."""
    if len(maps) == 1:
        return maps[0]
    total, count = np.zeros(len(maps[0])), np.zeros(len(maps[0]))
    for one in maps:
        seen = ~np.isnan(one)
        total[seen] += one[seen]
        count += seen
    with np.errstate(invalid="ignore"):
        return np.asarray(total / count)


def _may_hide(how: dict[str, Any]) -> bool:
    """True if the files of saliency may say that something was not seen."""
    values: Values = options_of(how, Values)
    return bool(how.get("saliency") and (how.get("masks") or values.unseen or values.per != "vertex"))


def _finished(shape: _Shape, truth: Truth, how: dict[str, Any]) -> Truth:
    """Picks by the points that are left, and of what was seen; or those that a rule makes of densities."""
    if len(shape.left_out) and truth.picks:
        for k, picks in enumerate(truth.picks):
            for lost in picks[shape.number_left(picks) < 0][:1]:
                raise InputError(f"{shape.path}: participant {k} picked point {lost} (0-based), which has no position")
        truth.picks = tuple(shape.number_left(picks) for picks in truth.picks)
    if truth.saliency is None:
        return truth
    if _may_hide(how):
        truth.picks = _seen_picks(truth.picks, truth.saliency)
    by, percent = positive_rule(options_of(how, Values).positives) or ("picks", 0.0)
    if by != "picks":
        positives = _points_above_mean(truth.saliency) if by == "mean" else _points_on_top(truth.saliency, percent)
        truth.picks = (positives,) if len(positives) else truth.picks
    return truth


def _seen_picks(picks: tuple[Ints, ...], values: Floats) -> tuple[Ints, ...]:
    """Picks where nothing was seen do not count. Their participants stay."""
    return tuple(one[~np.isnan(values[one])] for one in picks)


def _points_on_top(density: Floats, percent: float) -> Ints:
    """Points that less than `percent` of the points seen lie above. Equal values are all taken or none, and those at the minimum never."""
    values = np.sort(density[~np.isnan(density)])[::-1]
    most = percent / 100 * len(values) * (1 - ROUNDING)
    last = min(int(max(0.0, np.ceil(most) - 1)), len(values) - 1)
    return np.flatnonzero((density >= values[last]) & (density > values[-1])).astype(np.int32)


def _points_above_mean(density: Floats) -> Ints:
    """Likewise of the mean of the points seen."""
    values = np.sort(density[~np.isnan(density)])[::-1]
    mean = np.cumsum(values)[-1] / len(values)
    return np.flatnonzero((density > mean) & (density > values[-1])).astype(np.int32)
