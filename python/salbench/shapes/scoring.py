# SPDX-License-Identifier: GPL-3.0-or-later
"""Scores of maps: agreement with people's marks."""

from collections.abc import Iterable
from typing import Any

import numpy as np

from salbench import _core
from salbench.shapes.options import Value, documented
from salbench.shapes.reference import density
from salbench.shapes.shape import Shape
from salbench.shapes.stages import vertex_areas
from salbench.system.types import ArrayLike, NDArray

Seed = int | tuple[int, str] | tuple[int, str, str]


def _require_map_first(prediction: object, ground_truth: object) -> None:
    """Refuses a ground truth in place of the map if this is detectable, since most metrics are not
    symmetric."""
    wrong = ""
    if isinstance(prediction, Shape):
        wrong = "prediction must be a map, not a Shape"
    elif isinstance(prediction, np.ndarray) and isinstance(ground_truth, np.ndarray):
        if (prediction.ndim, ground_truth.ndim) == (1, 2) and ground_truth.shape[1] == len(prediction):
            wrong = (
                f"ground_truth must have shape ({len(prediction)},), not {ground_truth.shape}: several maps"
                " are a prediction"
            )
        elif prediction.dtype.kind == "f" and np.isnan(prediction).any():
            wrong = "prediction must be finite: a ground truth alone is NaN where nobody looked"
    if wrong:
        raise ValueError(f"{wrong}; the map comes first, then ground_truth and picks")


@documented
def score(
    prediction: ArrayLike,
    ground_truth: ArrayLike | Shape | None = None,
    picks: Any = None,
    *,
    areas: ArrayLike | None = None,
    points: ArrayLike | None = None,
    faces: ArrayLike | None = None,
    negatives: ArrayLike | None = None,
    mask: ArrayLike | None = None,
    metrics: str | Iterable[str] = ("auc", "nss", "cc"),
    reference: ArrayLike | None = None,
    seed: Seed = 0,
    **options: Value,
) -> dict[str, Any]:
    """Scores a saliency map by the metrics of the benchmark.

    The map comes first, then the ground truth: most metrics are not symmetric. Detectable swaps are refused.

    The map is min-max-normalised; with a `reference` it is histogram-matched first, for the metrics that use
    matched maps in the tables. A metric without its inputs is NaN: pick metrics without picks, saliency
    metrics without ground truth, `cc_area` without areas, interest point metrics without faces.

    Parameters
    ----------
    prediction : (n,) or (k, n) array
        One finite value per point, or k maps of one shape.
    ground_truth : (n,) array or `Shape`, optional
        Saliency, in any unit; points with NaN, which nobody looked at, are ignored. Or a `Shape`, which
        supplies ground truth, picks, points, faces and areas unless they are given.
    picks : (p,) array of int, or a sequence of them, optional
        Marked points, 0 to n - 1; one array, or one per participant.
    areas : (n,) array, optional
        Weight of each point, for `cc_area`: `vertex_areas` of a mesh.
    points : (n, 3) array, optional
        Positions, for metrics corrected for centre bias and interest point metrics.
    faces : (m, 3) array of int, optional
        Faces between the points, for interest point metrics.
    negatives : (n,) array, optional
        Weight of each point as a negative of `sauc`: frequency of marks at such a place on other shapes.
    mask : (n,) array of bool, optional
        Points to include; the others are left out after normalising the map.
    metrics : str or sequence of str
        Columns of the program's tables, or "all".
    reference : (100,) array, optional
        Histogram for matching: `Results.reference` of a run, or `histogram`, or the mean of several. Other
        sums than 100, such as of probabilities, are scaled with a warning.
    seed : int or (int, str)
        Seed of metrics that draw points; (seed, item) gives the draws of a run's table, common to all models.
        A model's name between them, as in 1.0, is ignored.

    Returns
    -------
    dict
        The score by each metric, in the order of the table: a float, or a (k,) array for k maps.

    Raises
    ------
    KeyError
        An unknown metric.
    ValueError
        An argument that does not match the others; the message names it.

    References
    ----------
    [tasse2016], and for each metric the source that `metrics.table` names.

    Examples
    --------
    >>> import salbench
    >>> scores = salbench.score([0.1, 0.9, 0.4, 0.2], ground_truth=[0, 1, 0.5, 0], picks=[1], metrics=["auc_exact", "cc"])
    >>> scores["auc_exact"], round(scores["cc"], 6)
    (1.0, 0.978232)
    """
    _require_map_first(prediction, ground_truth)
    if isinstance(ground_truth, Shape):
        shape, ground_truth = ground_truth, ground_truth.ground_truth
        picks = shape.participants or None if picks is None else picks
        if ground_truth is None and picks is None:
            raise ValueError(f"{shape.id} has neither ground truth nor marks of participants")
        points = shape.points if points is None else points
        faces = shape.faces if faces is None else faces
        areas = (
            vertex_areas(shape.points, shape.faces) if areas is None and shape.faces is not None else areas
        )
    return _core.score(
        prediction,
        ground_truth,
        picks,
        areas,
        points,
        faces,
        negatives,
        mask,
        metrics,
        None if reference is None else density(reference),
        seed,
        options,
    )


def match_histogram(values: ArrayLike, reference: ArrayLike) -> NDArray[np.float64]:
    """Changes the values of a map so that their distribution is the reference's; the order of the points
    stays.

    Parameters
    ----------
    values : (n,) array
        A map; NaN counts as 0.
    reference : (100,) array
        Densities over [0, 1], as from `histogram`. Other sums than 100 are scaled with a warning.

    Returns
    -------
    (n,) array in [0, 1]; a constant map stays as it is

    References
    ----------
    [tasse2016]

    Examples
    --------
    >>> import salbench
    >>> salbench.match_histogram([3, 1, 2], salbench.histogram([0, 0.1, 1])).argsort().tolist()
    [1, 2, 0]
    """
    return _core.match_histogram(values, density(reference))


def histogram(values: ArrayLike) -> NDArray[np.float64]:
    """Density of the min-max-normalised values over 100 bins of [0, 1]; it sums to 100.

    Parameters
    ----------
    values : (n,) array
        A map or a ground truth; NaN, of points that nobody saw, is left out.

    Returns
    -------
    (100,) array

    References
    ----------
    [tasse2016]

    Examples
    --------
    >>> import salbench
    >>> round(float(salbench.histogram([0, 0.5, 1]).sum()), 6)
    100.0
    """
    return _core.histogram(values)
