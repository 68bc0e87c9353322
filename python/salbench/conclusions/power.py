# SPDX-License-Identifier: GPL-3.0-or-later
"""Which differences between models the scores can show, and how many units would show those seen [cohen1988]: power.csv.

The power of a paired t-test at 0.05, both sides, the deviation of the differences being known: by the noncentral t distribution.
"""

from functools import cache

import numpy as np
import pandas
from numpy.typing import NDArray
from scipy import special

from salbench.conclusions.pairs import Pairs
from salbench.conclusions.samples import LEVEL
from salbench.conclusions.study import Study
from salbench.conclusions.tables import DATASET, METRIC, N, N_SHAPES, SPLIT, Part, framed, number, optional_count, text
from salbench.conclusions.units import Floats, Level

COLUMNS = (
    DATASET, SPLIT, METRIC, text("model_a", "first model"), text("model_b", "second model"), N, N_SHAPES,
    number("sd", "standard deviation of the differences, by n - 1"),
    number("detectable", "the mean difference that so many units show with probability 0.8"),
    number("mean_difference", "mean over the units of a - b"),
    optional_count("n_to_detect", "units that show a true difference as large with probability 0.8; empty beyond 10^9"))

POWER = 0.8
_MOST = 10**9
_CERTAIN = 30  # beyond the critical value, the distribution's series do not converge
_ONE_SIDED = 7  # beyond it the other tail has less than 2e-12, and is NaN by SciPy 1.15


def power_of_paired_test(noncentrality: Floats, n: Floats) -> Floats:
    """Probability that n units show a mean difference; noncentrality: |difference| / deviation * sqrt(n)."""
    from scipy import stats

    critical = special.stdtrit(n - 1, 1 - LEVEL / 2)
    certain = noncentrality - critical > _CERTAIN
    shift = np.where(certain, 1, noncentrality)
    with np.errstate(all="ignore"):
        above = stats.nct.sf(critical, n - 1, shift)
        below = np.where(shift > _ONE_SIDED, 0, stats.nct.cdf(-critical, n - 1, np.minimum(shift, _ONE_SIDED)))
    return np.where(certain, 1, np.where(noncentrality == 0, LEVEL, above + below))


@cache
def detectable(n: int) -> float:
    """In standard deviations of the differences, the smallest mean difference that n units show."""
    from scipy import optimize

    root = optimize.brentq(lambda shift: power_of_paired_test(np.array([shift]), np.array([float(n)]))[0] - POWER, 0, 100, xtol=1e-12)
    return float(root) / float(np.sqrt(n))


def units_to_detect(difference: Floats, deviation: Floats) -> Floats:
    """Units that show differences as large, 2 at least; NaN beyond 10^9, or where nothing varies."""
    with np.errstate(divide="ignore", invalid="ignore"):
        size = np.where(deviation > 0, np.abs(difference) / deviation, np.nan)
        # A test that knows the deviation needs almost as many and never more, but for the other tail, a millionth of the power.
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
    return np.asarray(power_of_paired_test(size * np.sqrt(n), n) >= POWER)  # not where one of them is NaN


def power(study: Study) -> pandas.DataFrame:
    """A row per data set, metric and pair of models, references included."""
    parts = (_part(level, metric, pairs) for level, of_level in study.pairs for metric, pairs in enumerate(of_level))
    return framed(COLUMNS, parts, study.in_splits)


def _part(level: Level, metric: int, pairs: Pairs) -> Part:
    deviation, difference = pairs.paired.sd, pairs.paired.mean_difference
    shown = np.array([detectable(int(n)) if sd > 0 else np.nan for n, sd in zip(pairs.n, deviation)]) * deviation
    names = np.array(level.models, dtype=object)
    return {"dataset": level.dataset, "split": level.split, "metric": level.metrics[metric].name, "model_a": names[pairs.a],
            "model_b": names[pairs.b], "n": pairs.n, "n_shapes": pairs.n_shapes, "sd": deviation, "detectable": shown,
            "mean_difference": difference, "n_to_detect": units_to_detect(difference, deviation)}
