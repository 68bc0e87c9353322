# SPDX-License-Identifier: GPL-3.0-or-later
"""From recordings of gaze to how densely a shape was looked at: fixations, where on the shape they fall,
their density.

Docstrings have what is a function's own: `documented` adds the arguments that several functions take, and
options.
"""

from typing import NamedTuple

import numpy as np

from salbench import _core
from salbench.shapes.options import Value, documented
from salbench.system.types import ArrayLike, NDArray


class Fixations(NamedTuple):
    """Where an eye rested, in order of time: `start` and `duration` (k,) in ms, mean `origin` (k, 3) and
    `direction` from there (k, 3), and the number of `samples` (k,)."""

    start: NDArray[np.float64]
    duration: NDArray[np.float64]
    origin: NDArray[np.float64]
    direction: NDArray[np.float64]
    samples: NDArray[np.int32]


class Hits(NamedTuple):
    """Where rays meet a mesh: `face` (k,), -1 where one misses it; barycentric `weights` (k, 3) of the
    face's corners; `depth` (k,), the distance from the origin, NaN for a miss; `snapped` (k,), True where
    the nearest direction that meets the mesh was taken; `place` (k, 3), NaN for a miss."""

    face: NDArray[np.int32]
    weights: NDArray[np.float64]
    depth: NDArray[np.float64]
    snapped: NDArray[np.bool_]
    place: NDArray[np.float64] | None = None  # `cast_rays` has it since version 2


@documented
def fixations(
    time: ArrayLike,
    directions: ArrayLike,
    origins: ArrayLike | None = None,
    valid: ArrayLike | None = None,
    places: ArrayLike | None = None,
    **options: Value,
) -> Fixations:
    """Fixations of one participant on one shape, from the samples of an eye tracker.

    `ivt` takes samples between which the eye turns slowly as one fixation, `idt` those of which no two are
    far apart, and for `none` each is one that lasts to the next. Angles are measured between `places`, both
    seen from the eye at the later sample, so that an eye which follows a place on a turning shape makes one
    fixation; without places, between directions. A step longer than 1.5 times the median step is a gap.

    Parameters
    ----------
    time : (n,) array
        In ms, ascending.
    directions : (n, 3) array
        Of gaze, of unit length, in the frame of the shape.
    origins : (n, 3) array or None
        The eye, in the frame of the shape; None: at (0, 0, 0).
    valid : (n,) array of bool or None
        False where the tracker lost the eye; None: nowhere.
    places : (n, 3) array or None
        On the shape, as `cast_rays` finds them; NaN where a ray misses.

    Returns
    -------
    Fixations

    Raises
    ------
    ValueError
        An argument that does not fit, times that do not ascend or are those of no eye tracker, or directions
        that are not of unit length.

    References
    ----------
    [salvucci2000]

    Examples
    --------
    >>> import numpy as np
    >>> import salbench
    >>> angle = np.radians(np.repeat([0, 10], 30))  # half a second here, half a second there, at 60 Hz
    >>> directions = np.stack([np.sin(angle), 0 * angle, np.cos(angle)], axis=-1)
    >>> found = salbench.fixations(np.arange(60) * 1000 / 60, directions)
    >>> found.start.round().tolist(), found.duration.round().tolist()
    ([0.0, 500.0], [483.0, 483.0])
    """
    return Fixations(*_core.fixations(time, directions, origins, valid, places, options))


@documented
def cast_rays(
    points: ArrayLike,
    faces: ArrayLike,
    origins: ArrayLike,
    directions: ArrayLike,
    *,
    threads: int | None = 1,
    **options: Value,
) -> Hits:
    """The first face that each ray meets, and where: exact to double precision; back faces hide.

    Parameters
    ----------
    origins : (k, 3) array
        In the frame of the shape.
    directions : (k, 3) array
        Of any length but 0.

    Returns
    -------
    Hits

    Raises
    ------
    ValueError
        An argument that does not fit, a ray that is not finite or has no direction, or a mesh without area.

    Examples
    --------
    >>> import salbench
    >>> hits = salbench.cast_rays([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], [[0.25, 0.25, 4], [2, 2, 4]], [[0, 0, -1], [0, 0, -1]])
    >>> hits.face.tolist(), hits.weights[0].tolist(), hits.depth.tolist()
    ([0, -1], [0.5, 0.25, 0.25], [4.0, nan])
    """
    return Hits(*_core.cast_rays(points, faces, origins, directions, threads, options))


@documented
def gaze_density(
    points: ArrayLike,
    faces: ArrayLike,
    face: ArrayLike,
    weights: ArrayLike,
    depth: ArrayLike | None = None,
    mass: ArrayLike | None = None,
    origins: ArrayLike | None = None,
    **options: Value,
) -> NDArray[np.float64]:
    """How densely one participant looked at each part of a mesh: a Gaussian around each fixation, over the
    surface.

    Each fixation carries its mass wherever it falls and however the surface is meshed: its Gaussian is
    divided by its own integral, and ends at three standard deviations.

    Parameters
    ----------
    face : (k,) array of int
        That each fixation is on, as `cast_rays` finds it; those of -1 do not count.
    weights : (k, 3) array
        Barycentric, of the face's corners.
    depth : (k,) array or None
        Distance from the eye, which `degrees` needs.
    mass : (k,) array or None
        Of each fixation, such as its duration; None: equal ones.
    origins : (k, 3) array or None
        The eye, which `spread="view"` needs.

    Returns
    -------
    (n,) array
        Per unit of area: its integral over the surface is 1, or 0 where no fixation is on the mesh. NaN at
        points without a face.

    Raises
    ------
    ValueError
        An argument that does not fit.

    References
    ----------
    [lavoue2018], [novotni2002]

    Examples
    --------
    >>> import salbench
    >>> points, faces = [[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]
    >>> density = salbench.gaze_density(points, faces, [0], [[1, 0, 0]], radius=0.2)
    >>> bool(density[0] > density[1]), round(float(salbench.vertex_areas(points, faces) @ density), 9)
    (True, 1.0)
    """
    return _core.gaze_density(points, faces, face, weights, depth, mass, origins, options)
