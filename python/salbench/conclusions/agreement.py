# SPDX-License-Identifier: GPL-3.0-or-later
"""Agreement of the rankings by two metrics: ranking_agreement.csv.

Rankings are compared by the signs of the differences of their models' means, pair by pair; matrix products of
these signs count the pairs on which each two metrics agree, in every resample.
"""

import warnings
from collections.abc import Mapping
from itertools import combinations_with_replacement

import numpy as np
import pandas
from numpy.typing import NDArray

from salbench.conclusions.parallel import mapped
from salbench.conclusions.ranked import RankedMetric
from salbench.conclusions.resampling import FEWEST
from salbench.conclusions.samples import ROUNDING, TAIL, means
from salbench.conclusions.study import Study
from salbench.conclusions.tables import CI95, DATASET, SPLIT, N, Part, count, framed, number, text
from salbench.conclusions.units import Floats, Level, Numbers

COLUMNS = (
    DATASET,
    SPLIT,
    text("metric_a", "first metric"),
    text("metric_b", "second metric"),
    N,
    count("n_models", "competitors"),
    number("tau", "Kendall's tau-b of the two rankings of the means, 1: the same order"),
    *CI95,
)

# rows (the sample, then its resamples) x pairs of models x metrics: 1 if the first is better, -1 if the
# second is, 0 for ties
Signs = NDArray[np.int8]
_METRICS = 12  # block size: metrics whose tau with as many others is computed at once


def agreement(study: Study) -> pandas.DataFrame:
    """A row per data set and pair of metrics, over the units and competitors for which both are defined;
    intervals are percentiles over resampled units, from six units on [kendall1945]."""
    return framed(COLUMNS, (_part(study, level, ranked) for level, ranked in study.ranked), study.in_splits)


def signs_of(values: Floats, resampled: Floats, higher_is_better: bool) -> NDArray[np.int8]:
    """Compares each pair of models: rows x pairs. values: units x models; resampled: resamples x models."""
    rows = np.vstack([means(values), resampled]) * (1 if higher_is_better else -1)
    a, b = np.triu_indices(rows.shape[1], 1)
    ahead = rows[:, a] - rows[:, b]
    ahead[np.abs(ahead) <= ROUNDING * np.abs(rows).max(initial=0)] = 0
    return np.sign(ahead).astype(np.int8)


def tau_b(x: Signs, y: Signs) -> Floats:
    """Kendall's tau-b, each metric of x with each of y: rows x metrics x metrics. NaN if all models tie.
    Single precision adds up these small whole numbers exactly."""
    agreeing = x.transpose(0, 2, 1).astype(np.float32) @ y.astype(np.float32)
    untied_x, untied_y = (np.count_nonzero(signs, axis=1).astype(float) for signs in (x, y))
    with np.errstate(invalid="ignore"):
        tau: Floats = agreeing / np.sqrt(untied_x[:, :, None] * untied_y[:, None, :])
    return tau


def _part(study: Study, level: Level, ranked: list[RankedMetric]) -> Part:
    """Groups metrics over the same units and models. `cells` holds their rows of the table, metrics x
    metrics."""
    cells = {
        name: np.zeros((len(ranked), len(ranked)))
        for name in ("n", "n_models", "tau", "ci95_low", "ci95_high")
    }
    groups: dict[tuple[bytes, bytes], list[int]] = {}
    for metric, of_metric in enumerate(ranked):
        scores = of_metric.competitors
        groups.setdefault((scores.models.tobytes(), scores.units.tobytes()), []).append(metric)
    for one, other in combinations_with_replacement(groups.values(), 2):
        _fill(cells, study, ranked, one, other)
    a, b = np.nonzero(np.triu(cells["n"], 1))
    names = np.array([metric.name for metric in level.metrics], dtype=object)
    return {
        "dataset": level.dataset,
        "split": level.split,
        "metric_a": names[a],
        "metric_b": names[b],
        **{name: values[a, b] for name, values in cells.items()},
    }


def _fill(
    cells: Mapping[str, Floats], study: Study, ranked: list[RankedMetric], one: list[int], other: list[int]
) -> None:
    """Fills the cells of each metric of one group with each of another; left empty for fewer than two common
    units or models."""
    x, y = (ranked[metrics[0]].competitors for metrics in (one, other))
    models, units = np.intersect1d(x.models, y.models), np.intersect1d(x.units, y.units)
    if len(models) < 2 or len(units) < 2 or (one is other and len(one) == 1):
        return
    signs_x = _signs(study, ranked, one, models, units)
    signs_y = signs_x if one is other else _signs(study, ranked, other, models, units)
    tiles = [
        (a, b)
        for a in range(0, len(one), _METRICS)
        for b in range(a if one is other else 0, len(other), _METRICS)
    ]

    def fill(tile: tuple[int, int]) -> None:
        a, b = (slice(first, first + _METRICS) for first in tile)
        tau = tau_b(signs_x[:, :, a], signs_y[:, :, b])
        low, high = _ends(tau[1:])
        if len(units) < FEWEST:
            low, high = np.full_like(low, np.nan), np.full_like(high, np.nan)
        found = {
            "n": np.full_like(low, len(units)),
            "n_models": np.full_like(low, len(models)),
            "tau": tau[0],
            "ci95_low": low,
            "ci95_high": high,
        }
        for name, values in found.items():
            cells[name][np.ix_(one[a], other[b])] = values
            cells[name][np.ix_(other[b], one[a])] = values.T

    with warnings.catch_warnings():
        # all models tie in all resamples: no interval
        warnings.simplefilter("ignore", RuntimeWarning)
        mapped(fill, tiles, study.threads)


def _signs(
    study: Study, ranked: list[RankedMetric], metrics: list[int], models: Numbers, units: Numbers
) -> Signs:
    """Signs of metrics over the same units and models, restricted to some of these."""
    samples = [ranked[metric].competitors for metric in metrics]
    scores = samples[0]
    if len(models) < len(scores.models) or len(units) < len(scores.units):
        kept = np.ix_(np.searchsorted(scores.units, units), np.searchsorted(scores.models, models))
        values = [sample.values[kept] for sample in samples]
        resampled = study.bootstrap.means_of_each(values)
    else:
        values, resampled = [sample.values for sample in samples], [sample.resampled for sample in samples]
    directions = [study.scores.metrics[metric].higher_is_better for metric in metrics]
    return np.stack(list(map(signs_of, values, resampled, directions)), axis=2)


def _ends(taus: Floats) -> tuple[Floats, Floats]:
    """95 % percentile interval from resamples x metrics x metrics, without resamples in which all models
    tie."""
    quantile = np.nanquantile if np.isnan(taus).any() else np.quantile
    low, high = quantile(taus, [TAIL, 1 - TAIL], axis=0)
    return low, high
