# SPDX-License-Identifier: GPL-3.0-or-later
"""Samples of scores, one value per unit: mean, standard deviation and Student's interval of each column."""

from typing import NamedTuple

import numpy as np
from scipy import special

from salbench.conclusions.units import Floats, Level

CONFIDENCE = 0.95  # of every interval
LEVEL = 0.05  # of every test
TAIL = LEVEL / 2
# relative: what is no farther apart is equal, such as .4 - .1 and .7 - .4, or sums in another order
ROUNDING = 1e-12


class Summary(NamedTuple):
    """Statistics of columns; NaN where there are too few units: one for the mean, two for everything else."""

    n: int
    mean: Floats
    sd: Floats  # by n - 1
    # Student's interval; NaN where the values do not vary: a width of 0 says that they are few or equal,
    low: Floats
    high: Floats  # not that the mean is known


def means(values: Floats) -> Floats:
    """Means of the columns of units x columns, summed from the first value on: the mean of equal values is
    that value."""
    averaged: Floats = values[0] + (values - values[0]).mean(axis=0)
    return averaged


def summarise(values: Floats, tail: float = TAIL) -> Summary:
    """Statistics of the columns of units x columns: mean -+ t(1 - tail; n - 1) sd / sqrt(n)."""
    n, unknown = len(values), np.full(values.shape[1], np.nan)
    if n == 0:
        return Summary(0, unknown, unknown, unknown, unknown)
    mean = means(values)
    if n == 1:
        return Summary(1, mean, unknown, unknown, unknown)
    sd = np.sqrt(((values - mean) ** 2).sum(axis=0) / (n - 1))
    sd = np.where(sd > ROUNDING * np.abs(values).max(axis=0), sd, 0)
    half = np.where(sd > 0, special.stdtrit(n - 1, 1 - tail) * sd / np.sqrt(n), np.nan)
    return Summary(n, mean, sd, mean - half, mean + half)


def by_model(level: Level, with_average: bool = False) -> dict[str, Floats]:
    """n, n_shapes, mean and interval, models x metrics, of each model on the shapes that it and all
    competitors have a score for. with_average: and, as one more model, of the mean over the competitors,
    unit by unit."""
    shape = len(level.models) + with_average, len(level.metrics)
    cells = {name: np.zeros(shape) for name in ("n", "n_shapes")} | {
        name: np.full(shape, np.nan) for name in ("mean", "ci95_low", "ci95_high")
    }
    for metric in range(len(level.metrics)):
        competitors = level.competitors(metric)
        for _, scores in level.groups(metric, [[model] for model in level.scored(metric)]):
            models, values = scores.models, scores.values
            # they are all there: no shape counts that one of them has no score for
            if with_average and np.isin(models, competitors).any():
                average = values[:, np.searchsorted(models, competitors)].mean(axis=1, keepdims=True)
                models, values = np.append(models, len(level.models)), np.hstack([values, average])
            n, mean, _, low, high = summarise(values)
            for name, found in zip(cells, (n, scores.n_shapes, mean, low, high)):
                cells[name][models, metric] = found
    return cells
