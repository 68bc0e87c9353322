# SPDX-License-Identifier: GPL-3.0-or-later
"""From gaze recordings to a density on a shape: fixations, their positions on the shape, and their density.

Docstrings describe arguments of a single function; `documented` adds shared arguments and options.
"""

from typing import NamedTuple

import numpy as np

from salbench import _core
from salbench.shapes.options import Value, documented
from salbench.system.types import ArrayLike, NDArray


class Fixations(NamedTuple):
    """Fixations in order of time: `start` and `duration` (k,) in ms, mean `origin` (k, 3) and `direction`
    from there (k, 3), and the number of `samples` (k,)."""

    start: NDArray[np.float64]
    duration: NDArray[np.float64]
    origin: NDArray[np.float64]
    direction: NDArray[np.float64]
    samples: NDArray[np.int32]


class Hits(NamedTuple):
    """Intersections of rays with a mesh: `face` (k,), -1 for a miss; barycentric `weights` (k, 3) of the
    face's corners; `depth` (k,), the distance from the origin, NaN for a miss; `snapped` (k,), True if the
    nearest direction that meets the mesh was taken; `place` (k, 3), NaN for a miss."""

    face: NDArray[np.int32]
    weights: NDArray[np.float64]
    depth: NDArray[np.float64]
    snapped: NDArray[np.bool_]
    place: NDArray[np.float64] | None = None  # from `cast_rays` since version 2


@documented
def fixations(
    time: ArrayLike,
    directions: ArrayLike,
    origins: ArrayLike | None = None,
    valid: ArrayLike | None = None,
    places: ArrayLike | None = None,
    **options: Value,
) -> Fixations:
    """Detects the fixations of one participant on one shape in the samples of an eye tracker.

    With `ivt`, samples with slow eye movement between them form a fixation; with `idt`, samples of which no
    two are far apart; with `none`, each sample is a fixation that lasts to the next. Angles are measured
    between `places`, both seen from the eye at the later sample, so that following a place on a turning shape
    is one fixation; without places, between directions. A step longer than 1.5 times the median step is a
    gap.

    Parameters
    ----------
    time : (n,) array
        In ms, ascending.
    directions : (n, 3) array
        Gaze directions of unit length, in the frame of the shape.
    origins : (n, 3) array or None
        The eye, in the frame of the shape; None: at (0, 0, 0).
    valid : (n,) array of bool or None
        False if the tracker lost the eye; None: all valid.
    places : (n, 3) array or None
        Gaze positions on the shape from `cast_rays`; NaN for a miss.

    Returns
    -------
    Fixations

    Raises
    ------
    ValueError
        An invalid argument, times that do not ascend or have an implausible rate, or directions that are not
        of unit length.

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
    """Finds the first face that each ray meets, and the position, to double precision; back faces occlude.

    Parameters
    ----------
    origins : (k, 3) array
        Origins in the frame of the shape.
    directions : (k, 3) array
        Directions of any length except 0.

    Returns
    -------
    Hits

    Raises
    ------
    ValueError
        An invalid argument, a ray that is not finite or has no direction, or a mesh without area.

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
    """Density of one participant's gaze on a mesh: a Gaussian around each fixation, over the surface.

    The mass of a fixation is independent of its position and of the mesh: its Gaussian is divided by its own
    integral, and truncated at three standard deviations.

    Parameters
    ----------
    face : (k,) array of int
        Face of each fixation, from `cast_rays`; -1 is ignored.
    weights : (k, 3) array
        Barycentric weights of the face's corners.
    depth : (k,) array or None
        Distance from the eye, required by `degrees`.
    mass : (k,) array or None
        Mass of each fixation, such as its duration; None: equal.
    origins : (k, 3) array or None
        The eye, required by `spread="view"`.

    Returns
    -------
    (n,) array
        Density per unit of area: its integral over the surface is 1, or 0 without fixations on the mesh. NaN
        at points without a face.

    Raises
    ------
    ValueError
        An invalid argument.

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
