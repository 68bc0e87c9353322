# SPDX-License-Identifier: GPL-3.0-or-later
"""Samples of scores, one value per unit: mean, standard deviation and Student's interval of each column."""

from typing import NamedTuple

import numpy as np
from scipy import special

from salbench.conclusions.units import Floats

CONFIDENCE = 0.95  # of every interval
LEVEL = 0.05  # of every test
TAIL = LEVEL / 2


class Summary(NamedTuple):
    """Of columns; NaN where there are too few units: one for the mean, two for everything else."""

    n: int
    mean: Floats
    sd: Floats  # by n - 1
    low: Floats  # Student's interval; NaN where the values do not vary: a width of 0 says that they are few or equal,
    high: Floats  # not that the mean is known


def means(values: Floats) -> Floats:
    """Of the columns of units x columns. Summed from the first value on: the mean of equal values is that value."""
    averaged: Floats = values[0] + (values - values[0]).mean(axis=0)
    return averaged


def summarise(values: Floats, tail: float = TAIL) -> Summary:
    """Of the columns of units x columns: mean -+ t(1 - tail; n - 1) sd / sqrt(n)."""
    n, unknown = len(values), np.full(values.shape[1], np.nan)
    if n == 0:
        return Summary(0, unknown, unknown, unknown, unknown)
    scale = _scale(values)
    mean = means(values * scale)
    if n == 1:
        return Summary(1, mean / scale, unknown, unknown, unknown)
    sd = np.sqrt(((values * scale - mean) ** 2).sum(axis=0) / (n - 1))
    half = np.where(sd > 0, special.stdtrit(n - 1, 1 - tail) * sd / np.sqrt(n), np.nan)
    return Summary(n, mean / scale, sd / scale, (mean - half) / scale, (mean + half) / scale)


def _scale(values: Floats) -> np.float64:
    """A power of two by which squares of the values do not overflow: 1 but for values of more than 10^144."""
    _, exponent = np.frexp(np.abs(values).max(initial=0))
    return np.float64(np.ldexp(1.0, min(0, 480 - int(exponent))))
