# SPDX-License-Identifier: GPL-3.0-or-later
"""Ground truth: from marks of people on a mesh to values at its points, and transfer to its scans."""

from typing import Any, NamedTuple

import numpy as np

from salbench import _core
from salbench.shapes.options import Value, documented
from salbench.system.types import ArrayLike, NDArray


class CarriedTruth(NamedTuple):
    """Ground truth of a scan: `ground_truth` (n,) or None, and the `picks` of each participant, a (p,)
    array of int32."""

    ground_truth: NDArray[np.float64] | None
    picks: tuple[NDArray[np.int32], ...]


@documented
def smooth_picks(points: ArrayLike, faces: ArrayLike, picks: Any, **options: Value) -> NDArray[np.float64]:
    """Computes saliency on a mesh from the participants' picks: a Gaussian along edges around each pick.

    Returns
    -------
    (n,) array

    References
    ----------
    [chen2012]

    Examples
    --------
    >>> import salbench
    >>> salbench.smooth_picks([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], [[1], [1, 2]]).tolist()
    [0.0, 1.0, 0.5]
    """
    return _core.smooth_picks(points, faces, picks, options)


@documented
def carry_ground_truth(
    points: ArrayLike, scan_points: ArrayLike, ground_truth: ArrayLike | None = None, picks: Any = None
) -> CarriedTruth:
    """Transfers ground truth of a mesh to the points of its scan.

    A point of the scan takes the saliency of the nearest point of the mesh. A pick is transferred to the
    first point of the scan whose nearest point of the mesh it is; without such a point it is lost.

    Parameters
    ----------
    points : (n, 3) array
        Positions of the mesh.
    scan_points : (k, 3) array
        Positions of the scan, in the same coordinates: `Scan.points`.
    ground_truth : (n,) array, optional
        Saliency; NaN for points that nobody looked at.
    picks : (p,) array of int, or a sequence of them, optional
        Points of the mesh that were marked; one array, or one for each participant.

    Returns
    -------
    CarriedTruth
        ground_truth : (k,) array, or None if none was given.
        picks : tuple of (p,) arrays of int32, one per participant.

    References
    ----------
    [tasse2016]

    Examples
    --------
    >>> import salbench
    >>> carried = salbench.carry_ground_truth([[0, 0, 0], [1, 0, 0]], [[0.9, 0, 0], [0.8, 0, 0]], [0.25, 0.5], [[0], [1]])
    >>> carried.ground_truth.tolist(), [own.tolist() for own in carried.picks]
    ([0.5, 0.5], [[], [0]])
    """
    return CarriedTruth(*_core.carry_ground_truth(points, ground_truth, picks, scan_points))


@documented
def vertex_values_of_faces(points: ArrayLike, faces: ArrayLike, values: ArrayLike) -> NDArray[np.float64]:
    """Transfers values of faces to points: the mean over the faces around each, weighted by their areas.

    Parameters
    ----------
    values : (m,) array
        Values of faces; NaN for faces that nobody looked at.

    Returns
    -------
    (n,) array
        NaN for points without a seen face of positive area.

    Examples
    --------
    >>> import salbench
    >>> salbench.vertex_values_of_faces([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]], [[0, 1, 2], [1, 3, 2]], [0, 2]).tolist()
    [0.0, 1.0, 1.0, 2.0]
    """
    return _core.vertex_values_of_faces(points, faces, values)


@documented
def vertex_values_of_samples(
    points: ArrayLike, samples: ArrayLike, values: ArrayLike, max_distance: float = float("inf")
) -> NDArray[np.float64]:
    """Transfers values from sample positions to the points of a shape: each point takes the value of the
    nearest sample.

    Parameters
    ----------
    points : (n, 3) array
        Positions of the shape.
    samples : (k, 3) array
        Positions of the samples, in the same coordinates; k > 0.
    values : (k,) array
        Values of the samples; NaN if nobody looked there.
    max_distance : float
        Points farther than this from all samples take NaN.

    Returns
    -------
    (n,) array

    Examples
    --------
    >>> import salbench
    >>> salbench.vertex_values_of_samples([[0, 0, 0], [5, 0, 0]], [[0, 0, 1]], [0.5], max_distance=2).tolist()
    [0.5, nan]
    """
    return _core.vertex_values_of_samples(points, samples, values, max_distance)
