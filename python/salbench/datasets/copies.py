# SPDX-License-Identifier: GPL-3.0-or-later
"""Near copies among the shapes of two data sets, whatever their names, scale, pose and meshing: `salbench
inspect A --against B`.

Two distributions stand for a shape: the distance between two points of its surface (D2 [osada2002]) and that
of a point from the centroid, both over the mean of the first. Two shapes are as far apart as the farther pair
of distributions, by the mean difference of quantiles (Wasserstein's distance). Copies are named, not judged:
docs/data_sets.md has what was measured, and what this cannot tell.
"""

import os
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from salbench.datasets import sets
from salbench.datasets.arrays import Floats
from salbench.datasets.records import InputError, Item, Shape
from salbench.system.workers import ask_all

# meshes with a quarter of their faces are at most 0.0025 from the whole ones, shapes of other SHREC'07
# classes at least 0.007
WITHIN = 0.005
_PAIRS = 1 << 17
_LEVELS = (np.arange(256) + 0.5) / 256  # of the quantiles
_NEIGHBOURS = 12  # of a point of a cloud; the disc that holds them is the area it stands for


class Pair(NamedTuple):
    shape: str  # of the first set
    other: str  # of the second
    distance: float


class Compared(NamedTuple):
    shapes: int  # of the second set
    near: list[Pair]
    next: Pair | None  # the nearest of all other pairs
    problems: list[str]  # shapes that could not be compared


def signature_of(layout: str, item: Item) -> Floats:
    """Of an item, whatever is wrong with its ground truth."""
    dataset = sets.find(layout)
    return signature(dataset.read(replace(item, problem="", truth=False, saliency="", picks=[])))


def signature(shape: Shape) -> Floats:
    """Quantiles of both distributions, a row each."""
    points = shape.points - shape.points.mean(axis=0)
    size = float(np.abs(points).max())
    if not size > 0:
        raise InputError("all points are at one place: nothing to compare")
    points = points / size  # squares neither overflow nor vanish
    draw = np.random.Generator(np.random.PCG64(2016)).random
    samples = _of_cloud(points, draw) if shape.faces is None else _of_mesh(points, shape.faces, draw)
    between = np.linalg.norm(samples[:_PAIRS] - samples[_PAIRS:], axis=1)
    from_centre = np.linalg.norm(samples - samples.mean(axis=0), axis=1)
    quantiles: Floats = (
        np.stack([np.quantile(between, _LEVELS), np.quantile(from_centre, _LEVELS)]) / between.mean()
    )
    return quantiles


def _of_mesh(points: Floats, faces: Any, draw: Any) -> Floats:
    """Points of the surface, uniform by area."""
    a, b, c = (points[faces[:, corner]] for corner in range(3))
    areas = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    if not areas.max(initial=0) > 0:
        raise InputError("its faces have no extent: nothing to compare")
    face = _chosen(areas, draw)
    u, v = np.sqrt(draw((2 * _PAIRS, 1))), draw((2 * _PAIRS, 1))
    samples: Floats = (1 - u) * a[face] + u * (1 - v) * b[face] + u * v * c[face]
    return samples


def _of_cloud(points: Floats, draw: Any) -> Floats:
    """Points of the cloud, as often as the area that they stand for asks for: clouds are seldom sampled
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
    """Layout and folder of both. A shape is not compared with itself, nor a pair of one set twice."""
    problems: dict[str, None] = {}  # each once
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
    """Of each shape that can be read: name, file, signature. Views of one are one."""
    dataset, listing = sets.listed(layout, os.path.normpath(root))
    shapes = {item.shape_name: item for item in reversed(listing.items)}  # of its first view
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
