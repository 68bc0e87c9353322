#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Simulates people who look at a shape according to a known density, and the samples of an eye tracker
(docs/gaze.md)."""

import numpy as np
import salbench
from salbench.datasets import Recording
from scipy.spatial import ConvexHull

SACCADE = 30  # ms
MANY = 6  # upper bound on looks per second


def unit(vectors):
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def bumpy_sphere(n):
    """Points spread evenly over a bumpy sphere, and faces."""
    height, around = 1 - (2 * np.arange(n) + 1) / n, np.pi * (1 + 5**0.5) * np.arange(n)
    points = np.stack(
        [np.sqrt(1 - height**2) * np.cos(around), np.sqrt(1 - height**2) * np.sin(around), height],
        axis=-1,
    )
    faces = ConvexHull(points).simplices
    corners = points[faces]
    inward = (np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) * corners[:, 0]).sum(
        axis=1
    ) < 0
    return points * (1 + 0.1 * np.sin(4 * points).prod(axis=1, keepdims=True)), np.where(
        inward[:, None], faces[:, ::-1], faces
    )


def peaks(points, places, width):
    """Density per area: high around a few places, low elsewhere."""
    squared = ((points[:, None] - np.asarray(places)) ** 2).sum(axis=-1)
    return 0.05 + np.exp(-squared / (2 * width**2)).sum(axis=1)


def eyes_on(points, faces, targets, random):
    """Eye position for each vertex, three radii from the centre, that sees it: people turn the shape towards
    them."""
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
    """Unit vectors, rotated in random directions by an angle with this root mean square."""
    return unit(unit(directions) + np.radians(degrees) / 2**0.5 * random.normal(size=directions.shape))


def recording(points, faces, density, people=30, *, seconds=10, rate=120, error=0.5, noise=0.05, seed=0):
    """Records looks of 150 to 450 ms. Errors of the tracker in degrees, root mean square: `error` per look,
    `noise` per sample."""
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
    # fraction of the way to the next look
    share = np.clip((time - starts[person, look]) / SACCADE + 1, 0, 1)[:, None]
    eye = np.where(share > 0, eyes[person, look + 1], eyes[person, look])
    aims = (1 - share) * seen[person, look] + share * seen[person, look + 1] - eye
    return Recording(
        people=tuple(f"P{number:02}" for number in range(1, people + 1)),
        person=person,
        time=time,
        valid=np.ones(len(time), bool),
        origins=eye,
        directions=turned(aims, noise, random),
    )


def on_turntable(points, faces, density, people=30, *, speed=36, seconds=10, rate=120, noise=0.2, seed=0):
    """Simulates people before a shape that turns around z by `speed` degrees per second, who follow places on
    it: 30 ms between looks of 300 ms. Returns the recording, and the vertex of each sample, -1 between
    looks."""
    random = np.random.default_rng(seed)
    centre, normals = points.mean(axis=0), salbench.estimate_normals(points, faces)
    away = 3 * np.linalg.norm(points - centre, axis=1).max()
    time = np.arange(seconds * rate) * 1000 / rate
    look, since = np.divmod(time, 300 + SACCADE)
    look = look.astype(int)
    chances = density * salbench.vertex_areas(points, faces)
    start = random.uniform(0, 360, people)

    def eyes_at(ms, first):
        angle = np.radians(first - speed * ms / 1000)
        return centre + away * np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=-1)

    eyes, aims, targets = (np.zeros((people, len(time), size)) for size in (3, 3, 1))
    for person in range(people):
        chosen = []
        for middle in (np.arange(look[-1] + 2) + 0.5) * (300 + SACCADE):
            ways = eyes_at(middle, start[person]) - points
            seen = np.where((unit(ways) * normals).sum(axis=1) > 0.5, chances, 0)
            chosen.append(random.choice(len(points), p=seen / seen.sum()))
        chosen = np.array(chosen)
        share = np.clip((since - 300) / SACCADE, 0, 1)[:, None]
        eyes[person] = eyes_at(time, start[person])
        aims[person] = (1 - share) * points[chosen[look]] + share * points[chosen[look + 1]] - eyes[person]
        targets[person, :, 0] = np.where(share[:, 0] > 0, -1, chosen[look])
    recorded = Recording(
        people=tuple(f"P{number:02}" for number in range(1, people + 1)),
        person=np.repeat(np.arange(people, dtype=np.int32), len(time)),
        time=np.tile(time, people),
        valid=np.ones(people * len(time), bool),
        origins=eyes.reshape(-1, 3),
        directions=turned(aims.reshape(-1, 3), noise, random),
    )
    return recorded, targets.ravel().astype(int)


def losses(recorded, number=8, seed=0):
    """Samples lost by a tracker that loses the eye `number` times, for 150 to 400 ms."""
    random, lost = np.random.default_rng(seed), np.zeros(len(recorded.time), bool)
    for person in range(len(recorded.people)):
        own = recorded.person == person
        for begin in random.uniform(0, recorded.time[own].max(), number):
            lost |= own & (recorded.time >= begin) & (recorded.time < begin + random.uniform(150, 400))
    return lost
