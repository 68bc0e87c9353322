#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""People who look at a shape as a known density has it, and the samples that an eye tracker would record of them (docs/gaze.md)."""

import numpy as np
import salbench
from salbench.datasets import Recording
from scipy.spatial import ConvexHull

SACCADE = 30  # ms
MANY = 6  # looks a second are no fewer than there can be


def unit(vectors):
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def bumpy_sphere(n):
    """Points spread evenly over a sphere with bumps, and faces."""
    height, around = 1 - (2 * np.arange(n) + 1) / n, np.pi * (1 + 5**0.5) * np.arange(n)
    points = np.stack([np.sqrt(1 - height**2) * np.cos(around), np.sqrt(1 - height**2) * np.sin(around), height], axis=-1)
    faces = ConvexHull(points).simplices
    corners = points[faces]
    inward = (np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) * corners[:, 0]).sum(axis=1) < 0
    return points * (1 + 0.1 * np.sin(4 * points).prod(axis=1, keepdims=True)), np.where(inward[:, None], faces[:, ::-1], faces)


def peaks(points, places, width):
    """A density per area: high around some places, low everywhere else."""
    squared = ((points[:, None] - np.asarray(places)) ** 2).sum(axis=-1)
    return 0.05 + np.exp(-squared / (2 * width**2)).sum(axis=1)


def eyes_on(points, faces, targets, random):
    """An eye for each vertex, three radii from the middle, that sees it: people turn the shape to what they look at."""
    centre, normals = points.mean(axis=0), salbench.estimate_normals(points, faces)[targets]
    away = 3 * np.linalg.norm(points - centre, axis=1).max()
    eyes, hidden = np.zeros_like(normals), np.arange(len(targets))
    for spread in np.linspace(0.3, 2, 20):
        eyes[hidden] = centre + away * unit(normals[hidden] + spread * random.normal(size=(len(hidden), 3)))
        ways = points[targets[hidden]] - eyes[hidden]
        depth = salbench.cast_rays(points, faces, eyes[hidden], ways).depth
        hidden = hidden[~(depth > np.linalg.norm(ways, axis=1) - 1e-3 * away)]
    return eyes


def turned(directions, degrees, random):
    """Unit vectors, turned any way by an angle with that root mean square."""
    return unit(unit(directions) + np.radians(degrees) / 2**0.5 * random.normal(size=directions.shape))


def recording(points, faces, density, people=30, *, seconds=10, rate=120, error=0.5, noise=0.05, seed=0):
    """Looks of 150 to 450 ms. Errors of the tracker in degrees, root mean square: `error` of a look, `noise` of a sample."""
    random = np.random.default_rng(seed)
    chances = density * salbench.vertex_areas(points, faces)
    starts = np.cumsum(SACCADE + random.uniform(150, 450, (people, MANY * seconds)), axis=1)
    targets = random.choice(len(points), (people, MANY * seconds + 1), p=chances / chances.sum())
    eyes = eyes_on(points, faces, targets.ravel(), random).reshape(*targets.shape, 3)
    ways = points[targets] - eyes
    seen = eyes + np.linalg.norm(ways, axis=-1, keepdims=True) * turned(ways, error, random)
    time = np.arange(seconds * rate) * 1000 / rate
    person, time = np.repeat(np.arange(people, dtype=np.int32), len(time)), np.tile(time, people)
    look = (starts[person] <= time[:, None]).sum(axis=1)
    share = np.clip((time - starts[person, look]) / SACCADE + 1, 0, 1)[:, None]  # of the way to the next look
    eye = np.where(share > 0, eyes[person, look + 1], eyes[person, look])
    aims = (1 - share) * seen[person, look] + share * seen[person, look + 1] - eye
    return Recording(people=tuple(f"P{number:02}" for number in range(1, people + 1)), person=person, time=time,
                     valid=np.ones(len(time), bool), origins=eye, directions=turned(aims, noise, random))
