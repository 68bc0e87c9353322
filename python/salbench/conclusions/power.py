# SPDX-License-Identifier: GPL-3.0-or-later
"""Power: detectable differences between models, and the number of units needed to detect the observed ones
[cohen1988]: power.csv.

For a two-sided paired t-test at 0.05 with known deviation of the differences, by the noncentral t
distribution.
"""

from functools import cache

import numpy as np
import pandas
from numpy.typing import NDArray
from scipy import special

from salbench.conclusions.samples import LEVEL
from salbench.conclusions.study import Study
from salbench.conclusions.tables import (
    DATASET,
    METRIC,
    N,
    N_SHAPES,
    SPLIT,
    framed,
    number,
    optional_count,
    text,
)
from salbench.conclusions.units import Floats

COLUMNS = (
    DATASET,
    SPLIT,
    METRIC,
    text("model_a", "first model"),
    text("model_b", "second model"),
    N,
    N_SHAPES,
    number("sd", "standard deviation of the differences, by n - 1"),
    number(
        "detectable",
        "smallest true difference that n units show with probability 0.8 by a paired t-test at 0.05",
    ),
    number("mean_difference", "mean over the units of a - b"),
    optional_count(
        "n_to_detect", "units that show a true difference as large with probability 0.8; empty beyond 10^9"
    ),
)

POWER = 0.8
_MOST = 10**9
_NODES, _WEIGHTS = special.roots_legendre(200)


def power_of_paired_test(noncentrality: Floats | float, n: Floats | float) -> Floats:
    """Probability that n units detect a mean difference; noncentrality: |difference| / deviation * sqrt(n).

    Integrates over estimates of the deviation by Gauss-Legendre quadrature, accurate to 1e-12. scipy.stats
    takes longer to import than most runs take to conclude.
    """
    shift, of = (np.asarray(values, dtype=float)[..., None] for values in (noncentrality, np.asarray(n) - 1))
    with np.errstate(all="ignore"):  # one unit detects nothing
        # relative deviation of the estimates
        low, high = np.maximum(-10 / np.sqrt(2 * of), -1), 10 / np.sqrt(2 * of)
        away = low + (high - low) * (_NODES + 1) / 2
        density = _WEIGHTS * np.exp((of - 1) * np.log1p(away) - of * away * (2 + away) / 2)
        critical = special.stdtrit(of, 1 - LEVEL / 2) * (1 + away)
        shown = special.ndtr(shift - critical) + special.ndtr(-shift - critical)
    return np.asarray((density * shown).sum(axis=-1) / density.sum(axis=-1))


@cache
def detectable(n: int) -> float:
    """Smallest mean difference that n units detect, in standard deviations of the differences."""
    low, high = 0.0, 100.0
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (low, middle) if power_of_paired_test(middle, n) >= POWER else (middle, high)
    return high / float(np.sqrt(n))


def units_to_detect(difference: Floats, deviation: Floats) -> Floats:
    """Number of units that detect these differences, at least 2; NaN beyond 10^9, or without variation."""
    with np.errstate(divide="ignore", invalid="ignore"):
        size = np.where(deviation > 0, np.abs(difference) / deviation, np.nan)
        # A test with known deviation needs almost as many units and never more, except for the other tail, a
        # millionth of the power.
        of_known = (special.ndtri(1 - LEVEL / 2) + special.ndtri(POWER)) ** 2 / size**2
    high = np.clip(np.ceil(of_known) + 3, 2, _MOST)
    while (short := ~_is_enough(size, high) & (high < _MOST)).any():
        high = np.where(short, np.minimum(2 * high, _MOST), high)
    low = np.clip(np.floor(of_known * (1 - 1e-5)) - 1, 1, high - 1)
    while (high - low > 1).any():
        middle = low + (high - low) // 2
        enough = _is_enough(size, middle)
        high, low = np.where(enough, middle, high), np.where(enough, low, middle)
    return np.where(_is_enough(size, high), high, np.nan)


def _is_enough(size: Floats, n: Floats) -> NDArray[np.bool_]:
    return np.asarray(power_of_paired_test(size * np.sqrt(n), n) >= POWER)  # False for NaN


def power(study: Study) -> pandas.DataFrame:
    """A row per data set, metric and pair of models, references included."""
    known = study.pairs
    shown = known["n"].map(lambda n: detectable(n) if n > 1 else np.nan).where(known["sd"] > 0) * known["sd"]
    needed = [
        units_to_detect(*rows[["mean_difference", "sd"]].to_numpy().T)
        for _, rows in known.groupby(["level", "metric"], sort=False)
    ]
    return framed(
        COLUMNS,
        [dict(known) | {"detectable": shown, "n_to_detect": np.concatenate([*needed, []])}],
        study.in_splits,
    )
