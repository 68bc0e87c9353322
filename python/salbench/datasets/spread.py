# SPDX-License-Identifier: GPL-3.0-or-later
"""Densities of gaze spread over neighbours, as the authors of SAL3D smooth theirs: a point that was looked at
adds to its neighbours, from first to last, values that fall linearly from a share of its own value to 0.
[martin2024]"""

from __future__ import annotations

import re

import numpy as np

from salbench.datasets.arrays import Floats, Ints
from salbench.system.errors import InputError
from salbench.system.files import AnyPath, read_file

CHUNK = 1 << 22  # numbers per chunk of work
ROUNDING = 1e-9  # tolerance for distances
LARGEST = np.finfo(float).max

_LINE = re.compile(rb"[^\r\n]+")
_HEAD = re.compile(rb"\s*([0-9]{1,9}) neighbors\s*")


def spread(values: Floats, sources: Ints, neighbours: Ints, count: int, share: float) -> Floats:
    """Spreads values over neighbours (len(sources), k <= count), nearest first; -1: none. NaN stays NaN."""
    found = values.copy()
    steps = np.linspace(share, 0, count)[: neighbours.shape[1]]
    rows = max(1, CHUNK // max(1, neighbours.shape[1]))
    with np.errstate(over="ignore"):
        for begin in range(0, len(sources), rows):
            of, to = values[sources[begin : begin + rows]], neighbours[begin : begin + rows]
            there = to >= 0
            found += np.bincount(to[there], np.outer(of, steps)[there], len(values))
    return np.minimum(found, LARGEST)


def nearest_in_space(points: Floats, sources: Ints, count: int) -> Ints:
    """Points nearest to each source, without the source itself; ties: smallest index."""
    from scipy.spatial import cKDTree

    tree, count = cKDTree(points), min(count, len(points) - 1)
    found = np.empty((len(sources), count), np.int32)
    # keeps ties at the last distance complete
    reaches = tree.query(points[sources], [count + 1])[0][:, 0] * (1 + ROUNDING)
    for row, (source, reach) in enumerate(zip(map(int, sources), reaches)):
        near = np.array(tree.query_ball_point(points[source], reach, return_sorted=True))
        near = near[near != source]
        far = ((points[near] - points[source]) ** 2).sum(axis=1)
        found[row] = near[np.argsort(far, kind="stable")[:count]]
    return found


def read_lists(path: AnyPath, n: int, count: int, needed: Ints) -> Ints:
    """Reads neighbours (len(needed), count) of the given points from a text of the authors: "ID neighbors",
    then a line per point of neighbours between semicolons, the last of which is the "ID neighbors" of the
    next line's point. IDs number the points from 0. Other points need no list."""
    data = read_file(path)

    def fail(line: re.Match[bytes] | None, what: str) -> InputError:
        before = data[: line.start() if line else len(data)]
        return InputError(f"{path}:{len(before.splitlines()) + (line is not None)}: {what}")

    lines = _LINE.finditer(data)
    head = next(lines, None)
    begin = _HEAD.fullmatch(head[0]) if head else None
    if begin is None:
        raise fail(
            head, "does not begin with a point's number and the word neighbors: expected lists of neighbours"
        )
    lists, seen, length, point = np.empty((n, count), np.int32), np.zeros(n, bool), 0, int(begin[1])
    for line in lines:
        if not 0 <= point < n or seen[point]:
            raise fail(
                line,
                (
                    f"expected neighbours of a point from 0 to {n - 1}, each once: the line before names"
                    f" {'none' if point < 0 else point}"
                ),
            )
        listed, _, last = line[0].rpartition(b";")
        ahead = _HEAD.fullmatch(last)
        words = (listed if ahead else line[0]).rstrip(b"; \t").split(b";")
        length = length or len(words)
        if len(words) != length or length < count:
            raise fail(
                line,
                (
                    f"point {point} has {len(words)} neighbours, expected {max(length, count)}: is the file"
                    " cut short?"
                ),
            )
        try:
            numbers = np.array(words[:count], np.int64)
        except (ValueError, OverflowError):
            raise fail(line, "is not a list of whole numbers between semicolons") from None
        if (outside := (numbers < 0) | (numbers >= n)).any():
            raise fail(
                line,
                (
                    f"neighbour {numbers[outside][0]} of point {point} is out of range: there are {n} points,"
                    " numbered from 0"
                ),
            )
        lists[point], seen[point] = numbers, True
        point = int(ahead[1]) if ahead else -1
    for missing in needed[~seen[needed]][:1]:
        raise fail(
            None,
            (
                f"the file ends after the neighbours of {seen.sum()} points, and without those of point"
                f" {missing}, which was looked at: it is cut short, copy it again"
            ),
        )
    return lists[needed]
