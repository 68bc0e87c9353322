# SPDX-License-Identifier: GPL-3.0-or-later
"""Near copies among the shapes of two data sets, whatever their names, scale, pose and meshing: `salbench
inspect A --against B`.

The signature of a shape is two distributions: the distance between two points of its surface (D2 [osada2002])
and the distance of a point from the centroid, both divided by the mean of the first. The distance of two
shapes is the larger of the two Wasserstein distances (mean difference of quantiles). Copies are named, not
judged: docs/data_sets.md has measurements and limits.
"""

import os
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from salbench.datasets import sets
from salbench.datasets.arrays import Floats
from salbench.datasets.records import InputError, Item, Shape
from salbench.system.workers import ask_all

# measured: simplification to a quarter of the faces moves a mesh by at most 0.0025; shapes of different
# SHREC'07 classes are at least 0.007 apart
WITHIN = 0.005
_PAIRS = 1 << 17
_LEVELS = (np.arange(256) + 0.5) / 256  # levels of the quantiles
_NEIGHBOURS = 12  # per point of a cloud; the disc that holds them estimates the point's area


class Pair(NamedTuple):
    shape: str  # in the first set
    other: str  # in the second set
    distance: float


class Compared(NamedTuple):
    shapes: int  # in the second set
    near: list[Pair]
    next: Pair | None  # the nearest of all other pairs
    problems: list[str]  # shapes that could not be compared


def signature_of(layout: str, item: Item) -> Floats:
    """Signature of an item; faults of its ground truth do not matter."""
    dataset = sets.find(layout)
    return signature(dataset.read(replace(item, problem="", truth=False, saliency="", picks=[])))


def signature(shape: Shape) -> Floats:
    """Returns the quantiles of both distributions, one row each."""
    points = shape.points - shape.points.mean(axis=0)
    size = float(np.abs(points).max())
    if not size > 0:
        raise InputError("all points are at one place: nothing to compare")
    points = points / size  # so that squares neither overflow nor underflow
    draw = np.random.Generator(np.random.PCG64(2016)).random
    samples = _of_cloud(points, draw) if shape.faces is None else _of_mesh(points, shape.faces, draw)
    between = np.linalg.norm(samples[:_PAIRS] - samples[_PAIRS:], axis=1)
    from_centre = np.linalg.norm(samples - samples.mean(axis=0), axis=1)
    quantiles: Floats = (
        np.stack([np.quantile(between, _LEVELS), np.quantile(from_centre, _LEVELS)]) / between.mean()
    )
    return quantiles


def _of_mesh(points: Floats, faces: Any, draw: Any) -> Floats:
    """Samples points of the surface, uniformly by area."""
    a, b, c = (points[faces[:, corner]] for corner in range(3))
    areas = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    if not areas.max(initial=0) > 0:
        raise InputError("its faces have no extent: nothing to compare")
    face = _chosen(areas, draw)
    u, v = np.sqrt(draw((2 * _PAIRS, 1))), draw((2 * _PAIRS, 1))
    samples: Floats = (1 - u) * a[face] + u * (1 - v) * b[face] + u * v * c[face]
    return samples


def _of_cloud(points: Floats, draw: Any) -> Floats:
    """Samples points of the cloud in proportion to the area around each, since clouds are seldom sampled
    evenly."""
    from scipy.spatial import cKDTree

    points = np.unique(points, axis=0)
    k = min(_NEIGHBOURS, len(points) - 1)
    radius = cKDTree(points).query(points, k + 1)[0][:, -1]
    samples: Floats = points[_chosen(radius**2, draw)]
    return samples


def _chosen(areas: Floats, draw: Any) -> Any:
    total = np.cumsum(areas)
    return np.searchsorted(total, draw(2 * _PAIRS) * total[-1], side="right").clip(max=len(areas) - 1)


def compared(first: tuple[str, str], second: tuple[str, str]) -> Compared:
    """Compares two data sets, each given by layout and folder. A shape is not compared with itself, nor a
    pair of one set twice."""
    problems: dict[str, None] = {}  # as a set in order
    (ours, files, values), (theirs, other_files, others) = (
        _signatures(*side, problems) for side in (first, second)
    )
    pairs: list[Pair] = []
    for place, (name, file, own) in enumerate(zip(ours, files, values)):
        distances = np.abs(others - own).mean(axis=-1).max(axis=-1).tolist()
        begin = place if files == other_files else 0
        pairs += [
            Pair(name, theirs[k], distances[k]) for k in range(begin, len(theirs)) if other_files[k] != file
        ]
    pairs.sort(key=lambda pair: pair.distance)
    n = sum(pair.distance <= WITHIN for pair in pairs)
    return Compared(len(theirs), pairs[:n], pairs[n] if n < len(pairs) else None, [*problems])


def _signatures(layout: str, root: str, problems: dict[str, None]) -> tuple[list[str], list[str], Floats]:
    """Name, file and signature of each readable shape. Views of a shape count once."""
    dataset, listing = sets.listed(layout, os.path.normpath(root))
    shapes = {item.shape_name: item for item in reversed(listing.items)}  # first view of each shape
    items = [item for item in listing.items if shapes[item.shape_name] is item]
    found: dict[int, Floats] = {}

    def take(number: int, made: Floats | None, problem: str) -> None:
        if made is None:
            problems[f"{items[number].shape_name}: {problem or 'cannot be read'}"] = None
        else:
            found[number] = made

    if not ask_all(
        [dataset.question("salbench.datasets.copies:signature_of", [item], item) for item in items], take
    ):
        raise KeyboardInterrupt
    numbers = sorted(found)
    values = np.array([found[number] for number in numbers]).reshape(-1, 2, len(_LEVELS))
    return (
        [items[number].shape_name for number in numbers],
        [os.path.realpath(items[number].place) for number in numbers],
        values,
    )
