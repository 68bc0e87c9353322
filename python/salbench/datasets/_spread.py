# SPDX-License-Identifier: GPL-3.0-or-later
"""Densities of gaze spread over neighbours, as the authors of SAL3D smooth theirs: a point that was looked at adds to its neighbours, from
the first to the last, what falls in even steps from a share of its own value to 0. [martin2024]"""

from __future__ import annotations

import re

import numpy as np

from salbench.datasets.records import Floats, InputError, Ints

CHUNK = 1 << 22  # numbers that are worked on at a time
LARGEST = np.finfo(float).max

_LINE = re.compile(rb"[^\r\n]+")
_HEAD = re.compile(rb"\s*([0-9]{1,9}) neighbors\s*")


def spread(values: Floats, sources: Ints, neighbours: Ints, count: int, share: float) -> Floats:
    """neighbours: (len(sources), k <= count), nearest first; -1: none. NaN stays NaN."""
    found = values.copy()
    steps = np.linspace(share, 0, count)[:neighbours.shape[1]]
    rows = max(1, CHUNK // max(1, neighbours.shape[1]))
    with np.errstate(over="ignore"):
        for begin in range(0, len(sources), rows):
            of, to = values[sources[begin:begin + rows]], neighbours[begin:begin + rows]
            there = to >= 0
            found += np.bincount(to[there], np.outer(of, steps)[there], len(values))
    return np.minimum(found, LARGEST)


def looked_at(values: Floats) -> Ints:
    return np.flatnonzero(values > 0).astype(np.int32)


def nearest_in_space(points: Floats, sources: Ints, count: int) -> Ints:
    """The points nearest to each source, itself left out; of equal distances the first point."""
    from scipy.spatial import cKDTree

    n = len(points)
    count = min(count, n - 1)
    tree = cKDTree(points)
    further = min(n, count + 64)  # so that a tie at the end is seen whole
    found = np.empty((len(sources), count), np.int32)
    rows = max(1, CHUNK // further)
    for begin in range(0, len(sources), rows):
        of = sources[begin:begin + rows]
        near = tree.query(points[of], further)[1].reshape(len(of), further)
        for row, source in enumerate(map(int, of)):
            candidates = _by_distance(points, source, near[row])
            if len(candidates) <= count or (further < n and _ends_in_tie(points, source, candidates, count)):
                candidates = _by_distance(points, source, np.arange(n))
            found[begin + row] = candidates[:count]
    return found


def _distances(points: Floats, source: int, of: Ints) -> Floats:
    return np.asarray(((points[of] - points[source]) ** 2).sum(axis=1))


def _by_distance(points: Floats, source: int, of: Ints) -> Ints:
    of = of[of != source]
    of = np.sort(of)
    return of[np.argsort(_distances(points, source, of), kind="stable")]


def _ends_in_tie(points: Floats, source: int, candidates: Ints, count: int) -> bool:
    """True if the point farthest away that was found is no farther than the last one wanted: there may be more like it."""
    last, farthest = _distances(points, source, candidates[[count - 1, -1]])
    return bool(last == farthest)


def nearest_on_surface(points: Floats, faces: Ints, sources: Ints, count: int) -> Ints:
    """Likewise along edges; -1 behind the last point that they reach."""
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import dijkstra

    n = len(points)
    edges = np.unique(np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1), axis=0)
    edges = edges[edges[:, 0] != edges[:, 1]]
    lengths = np.linalg.norm(points[edges[:, 0]] - points[edges[:, 1]], axis=1)
    graph = csr_array((np.maximum(lengths, np.finfo(float).tiny), edges.T), shape=(n, n))  # 0 would be no edge
    count = min(count, n - 1)
    found = np.full((len(sources), count), -1, np.int32)
    rows = max(1, CHUNK // n)
    for begin in range(0, len(sources), rows):
        of = sources[begin:begin + rows]
        for row, (source, far) in enumerate(zip(of, dijkstra(graph, directed=False, indices=of))):
            far[source] = np.inf
            order = np.argsort(far, kind="stable")[:count]
            found[begin + row] = np.where(np.isfinite(far[order]), order, -1)
    return found


def read_lists(data: bytes, name: str, n: int, count: int) -> Ints:
    """(n, count) from a text as the authors write it: "ID neighbors", then a line per point of neighbours between semicolons, the last of which
    is the "ID neighbors" of the next line's point. IDs number the points from 0."""

    def fail(line: re.Match[bytes] | None, what: str) -> InputError:
        before = data[:line.start() if line else len(data)]
        return InputError(f"{name}:{len(before.splitlines()) + (line is not None)}: {what}")

    lines = _LINE.finditer(data)
    head = next(lines, None)
    begin = _HEAD.fullmatch(head[0]) if head else None
    if begin is None:
        raise fail(head, "does not begin with a point's number and the word neighbors: expected lists of neighbours")
    lists, length, seen, point = np.empty((n, count), np.int32), 0, np.zeros(n, bool), int(begin[1])
    for line in lines:
        if point < 0:
            raise fail(line, "lists neighbours, but the line before names no next point")
        if point >= n:
            raise fail(line, f"point {point} is out of range: there are {n} points, numbered from 0")
        if seen[point]:
            raise fail(line, f"point {point} has neighbours twice")
        listed, _, last = line[0].rpartition(b";")
        ahead = _HEAD.fullmatch(last)
        words = (listed if ahead else line[0]).rstrip(b"; \t").split(b";")
        length = length or len(words)
        if len(words) != length or length < count:
            raise fail(line, f"point {point} has {len(words)} neighbours, expected {max(length, count)}: is the file cut short?")
        try:
            numbers = np.array(words[:count], np.int64)
        except (ValueError, OverflowError):
            raise fail(line, "is not a list of whole numbers between semicolons") from None
        if (outside := (numbers < 0) | (numbers >= n)).any():
            raise fail(line, f"neighbour {numbers[outside][0]} of point {point} is out of range: there are {n} points, numbered from 0")
        lists[point], seen[point] = numbers, True
        point = int(ahead[1]) if ahead else -1
    if point >= 0 or not seen.all():
        raise fail(None, f"the file ends after the neighbours of {seen.sum()} of {n} points: it is cut short, copy it again")
    return lists

