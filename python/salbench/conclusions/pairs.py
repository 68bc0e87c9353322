# SPDX-License-Identifier: GPL-3.0-or-later
"""Pairs of models: which differ, by how much, and with what certainty. Differences are a - b."""

from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
import pandas
from scipy import special

from salbench.conclusions.ranks import Ranking
from salbench.conclusions.samples import LEVEL, ROUNDING, summarise
from salbench.conclusions.units import Floats, Level

_MOST_EXACT = 50  # differences for the exact distribution


class Paired(NamedTuple):
    """One value per column of differences; NaN for too few units: one unit suffices for the mean and the
    signed ranks, two are needed for everything else."""

    mean_difference: Floats
    sd: Floats  # divided by n - 1
    ci95_low: Floats  # Student's t
    ci95_high: Floats
    # two-sided; below .05 if the interval excludes 0; NaN if all differences are equal and not 0
    t_p: Floats
    # within +-margin, the two are equivalent at 0.05 by two one-sided tests [schuirmann1987] [lakens2017]
    ci90_low: Floats
    ci90_high: Floats
    d_z: Floats  # [cohen1988]
    rank_biserial: Floats  # [kerby2014]
    superiority: Floats  # P(a > b) + P(a = b) / 2 [agarwal2021]
    superiority_low: Floats
    superiority_high: Floats
    signed_rank: Floats
    signed_rank_p: Floats

    @property
    def p(self) -> Floats:
        """p of the paired t-test, or of the signed ranks if all differences are equal, which leaves t
        undefined."""
        return np.where(np.isnan(self.t_p), self.signed_rank_p, self.t_p)


def compare(differences: Floats) -> Paired:
    """Compares pairs by their differences, units x pairs."""
    n, unknown = len(differences), np.full(differences.shape[1], np.nan)
    _, mean, sd, low, high = summarise(differences)
    of_90 = summarise(differences, LEVEL)
    differences = np.where(
        np.abs(differences) > ROUNDING * np.abs(differences).max(axis=0, initial=0), differences, 0
    )
    positive, statistic, p = signed_rank_test(differences)
    if n < 2:
        return Paired._make([mean, *[unknown] * 11, statistic, p])
    changed = (differences != 0).sum(axis=0)
    all_ranks = changed * (changed + 1) / 2
    with np.errstate(divide="ignore", invalid="ignore"):  # all differences equal: no t unless they are 0
        t = np.where(mean == 0, 0, np.where(sd > 0, mean / (sd / np.sqrt(n)), np.nan))
        biserial = np.where(changed > 0, 2 * positive / all_ranks - 1, 0)
        d_z = np.where(sd > 0, mean / sd, np.nan)
    superiority = ((differences > 0).mean(axis=0) + (differences >= 0).mean(axis=0)) / 2
    t_p = 2 * special.stdtr(n - 1, -np.abs(t))
    return Paired(
        mean,
        sd,
        low,
        high,
        t_p,
        of_90.low,
        of_90.high,
        d_z,
        biserial,
        superiority,
        *wilson_interval(superiority, n),
        statistic,
        p,
    )


def wilson_interval(share: Floats, n: int) -> tuple[Floats, Floats]:
    """Wilson's score interval for shares of n independent cases, 95 % [wilson1927]."""
    z = special.ndtri(1 - LEVEL / 2)
    centre = (share + z**2 / (2 * n)) / (1 + z**2 / n)
    half = z / (1 + z**2 / n) * np.sqrt(share * (1 - share) / n + z**2 / (4 * n**2))
    return np.maximum(0, centre - half), np.minimum(1, centre + half)


def signed_rank_test(differences: Floats) -> tuple[Floats, Floats, Floats]:
    """Wilcoxon's test for units x pairs: sums of the ranks of positive differences, the smaller sums of
    ranks, two-sided p [wilcoxon1945].

    Zeros are left out. Exact for at most 50 remaining differences: over all signs of their mid-ranks.
    Otherwise the normal approximation, corrected for ties; p = 1 if all differences are zero.
    """
    n, pairs = differences.shape
    if n == 0:
        return np.zeros(pairs), np.full(pairs, np.nan), np.full(pairs, np.nan)
    order = np.argsort(np.abs(differences.T), axis=1, kind="stable")
    ordered = np.take_along_axis(differences.T, order, axis=1)
    zeros = (ordered == 0).sum(axis=1)
    ranks, equal = _midranks(np.abs(ordered))
    ranks -= zeros[:, None]  # zeros come first
    positive, negative = np.where(ordered > 0, ranks, 0).sum(axis=1), np.where(ordered < 0, ranks, 0).sum(
        axis=1
    )
    statistic = np.minimum(positive, negative)
    ties = np.where(ordered != 0, equal**2 - 1.0, 0).sum(axis=1)  # t^3 - t for each run of t ties
    m = n - zeros
    with np.errstate(divide="ignore", invalid="ignore"):  # all zeros
        z = (statistic - m * (m + 1) / 4) / np.sqrt((m * (m + 1) * (2 * m + 1) - ties / 2) / 24)
    p = np.where(m > 0, 2 * special.ndtr(-np.abs(z)), 1)
    for pair in np.flatnonzero((m > 0) & (m <= _MOST_EXACT)):
        below = _shares_below((2 * ranks[pair, zeros[pair] :]).astype(np.int64).tobytes())
        p[pair] = min(1, 2 * below[int(2 * statistic[pair])])
    return positive, statistic, p


def _midranks(ordered: Floats) -> tuple[Floats, Floats]:
    """Ranks from 1 in rows of ascending values, and the number of ties of each value. Values equal up to
    rounding share their mean rank."""
    is_new = np.ones(ordered.shape, dtype=bool)
    is_new[:, 1:] = ordered[:, 1:] - ordered[:, :-1] > ROUNDING * ordered[:, -1:]
    runs = pandas.DataFrame(np.cumsum(is_new, axis=1).T)
    first, last = (runs.rank(method=method).to_numpy().T for method in ("min", "max"))
    return (first + last) / 2, last - first + 1


@lru_cache(maxsize=1000)
def _shares_below(twice_ranks: bytes) -> Floats:
    """Share of the subsets of these ranks whose doubled sum is at most 0, 1, ...: mid-ranks are halves.
    Counts of sets are exact in 64 bits."""
    ranks = np.frombuffer(twice_ranks, dtype=np.int64)
    counts = np.zeros(ranks.sum() + 1, dtype=np.int64)
    counts[0] = 1
    for rank in ranks:
        counts[rank:] += counts[:-rank].copy()
    return np.asarray(np.cumsum(counts) / 2.0 ** len(ranks))


def rank_sum_test(x: Floats, y: Floats) -> tuple[float, float]:
    """z and two-sided p for two independent sorted samples, by the normal approximation without tie
    correction, as SciPy's ranksums; NaN if one is empty [mann1947]."""
    if len(x) == 0 or len(y) == 0:
        return np.nan, np.nan
    below, up_to = np.searchsorted(y, x, "left").sum(), np.searchsorted(y, x, "right").sum()
    above = (below + up_to) / 2  # pairs with x above y; ties count one half
    n_x, n_y = len(x), len(y)
    z = (above - n_x * n_y / 2) / np.sqrt(n_x * n_y * (n_x + n_y + 1) / 12)
    return float(z), float(2 * special.ndtr(-abs(z)))


def holm_adjusted(p: Floats) -> Floats:
    """Holm's step-down adjustment: rejecting p at most the level bounds the probability of any false
    rejection by the level. NaN stays NaN and does not count as a test [holm1979]."""
    order = np.argsort(p, kind="stable")[: np.count_nonzero(~np.isnan(p))]  # NaN is last
    adjusted = p.copy()
    adjusted[order] = np.maximum.accumulate(np.minimum(1, p[order] * np.arange(len(order), 0, -1)))
    return adjusted


PAIRS = dict.fromkeys(("dataset", "split", "metric", "model_a", "model_b"), "str") | dict.fromkeys(
    (
        "level",
        "n",
        "n_shapes",
        *Paired._fields,
        "t",
        "t_bound",
        "rank_sum_z",
        "rank_sum_p",
        "signed_rank_p_holm",
        "n_tests",
        "joint95_low",
        "joint95_high",
    ),
    "float64",
)


def pairs_of(level: Level, metric: int, ranking: Ranking) -> dict[str, Any]:
    """Columns of the tables for every pair of models that have scores of a metric. ranking: of the
    competitors."""
    models, names = level.scored(metric), np.array(level.models, dtype=object)
    a, b = (models[numbers] for numbers in np.triu_indices(len(models), 1))
    if not len(a):
        return {name: np.empty(0) for name in PAIRS}
    found = level.pairs(metric, a, b, lambda differences: compare(differences)._asdict())
    by_shape = {
        model: np.sort(level.values[level.defined[:, model, metric], model, metric]) for model in models
    }
    z, p = np.transpose([rank_sum_test(by_shape[x], by_shape[y]) for x, y in zip(a, b)])
    with np.errstate(divide="ignore", invalid="ignore"):
        t = np.where(found["sd"] > 0, found["mean_difference"] / (found["sd"] / np.sqrt(found["n"])), np.nan)
        half = np.where(found["sd"] > 0, ranking.joint * found["sd"] / np.sqrt(found["n"]), np.nan)
    holm = holm_adjusted(found["signed_rank_p"])
    between = ~(level.is_reference[a] | level.is_reference[b])  # both are competitors
    bound, half = np.where(between, ranking.bound, np.nan), np.where(between, half, np.nan)
    return dict(
        found,
        dataset=level.dataset,
        split=level.split,
        metric=level.metrics[metric].name,
        model_a=names[a],
        model_b=names[b],
        t=t,
        t_bound=bound,
        rank_sum_z=z,
        rank_sum_p=p,
        joint95_low=found["mean_difference"] - half,
        joint95_high=found["mean_difference"] + half,
        signed_rank_p_holm=holm,
        n_tests=np.count_nonzero(~np.isnan(holm)),
    )
