# SPDX-License-Identifier: GPL-3.0-or-later
"""Samples of scores, one value per unit: mean, standard deviation and Student's interval of each column."""

from typing import NamedTuple

import numpy as np
from scipy import special

from salbench.conclusions.units import Floats, Level

CONFIDENCE = 0.95  # for every interval
LEVEL = 0.05  # for every test
TAIL = LEVEL / 2
# relative tolerance: equal values include .4 - .1 and .7 - .4, and sums in another order
ROUNDING = 1e-12


class Summary(NamedTuple):
    """One value per column; NaN for too few units: one suffices for the mean, two are needed for everything
    else."""

    n: int
    mean: Floats
    sd: Floats  # divided by n - 1
    # Student's interval; NaN if the values do not vary: a width of 0 would come from few or equal values,
    low: Floats
    high: Floats  # not from a known mean


def means(values: Floats) -> Floats:
    """Means of the columns of units x columns, summed from the first value: the mean of equal values is
    exactly that value."""
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
    """n, n_shapes, mean and interval, models x metrics, for each model on the shapes that it and all
    competitors are scored on. with_average: appends the mean over the competitors, unit by unit, as a
    model."""
    shape = len(level.models) + with_average, len(level.metrics)
    cells = {name: np.zeros(shape) for name in ("n", "n_shapes")} | {
        name: np.full(shape, np.nan) for name in ("mean", "ci95_low", "ci95_high")
    }
    for metric in range(len(level.metrics)):
        competitors = level.competitors(metric)
        for _, scores in level.groups(metric, [[model] for model in level.scored(metric)]):
            models, values = scores.models, scores.values
            # complete: only shapes that all competitors are scored on count
            if with_average and np.isin(models, competitors).any():
                average = values[:, np.searchsorted(models, competitors)].mean(axis=1, keepdims=True)
                models, values = np.append(models, len(level.models)), np.hstack([values, average])
            n, mean, _, low, high = summarise(values)
            for name, found in zip(cells, (n, scores.n_shapes, mean, low, high)):
                cells[name][models, metric] = found
    return cells
