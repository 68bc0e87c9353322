# SPDX-License-Identifier: GPL-3.0-or-later
"""Ranks of models, and how sure they are.

All pairs of models are compared at once: the intervals of their mean differences hold together with 95 % probability (the largest of
the standardised differences over the resamples is what bounds them), so that no pair stands out by its number alone. Ranks and groups
follow from these intervals: a model's rank lies between 1 + the models above it and k - the models below it [romano2005]
[mogstad2024] [piepho2004].

The bound is single-step: the 95 % quantile, over the resamples, of the largest |difference - resampled difference| in standard errors.
Resampling knows the deviation of n units as that of the sample itself, which is too small by sqrt((n - 1) / n), and takes it for
known; both are put right by the ratio of Student's quantile to the normal one, which makes the bound of a single pair Student's own.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import NDArray
from scipy import special

from salbench.conclusions.samples import CONFIDENCE, TAIL, means, summarise
from salbench.conclusions.units import Floats, Numbers

@dataclass(frozen=True)
class Ranking:
    """Of the columns of scores."""

    mean: Floats
    rank: Floats  # 1: best; equal means share the best rank; NaN without a unit
    low: Floats  # 95 %, jointly; NaN for fewer than two units
    high: Floats
    first: Floats  # share of the resamples where it is best
    letters: list[str]  # two models without a letter in common differ; empty for fewer than two units
    critical: float  # standard errors that bound every pair

    def order(self) -> Numbers:
        """Columns, best first."""
        return np.argsort(self.rank, kind="stable")


def rank_models(values: Floats, resampled: Floats, higher_is_better: bool) -> Ranking:
    """Ranks the columns of units x models with their resampled means, which are not read for fewer than two units."""
    n, k = values.shape
    unknown = np.full(k, np.nan)
    if n == 0:
        return Ranking(unknown, unknown, unknown, unknown, unknown, [""] * k, np.nan)
    sign = 1 if higher_is_better else -1
    mean = means(values)
    ahead = sign * (mean[:, None] - mean)  # of model a before model b
    rank = 1.0 + (ahead < 0).sum(axis=1)
    if n < 2:
        return Ranking(mean, rank, unknown, unknown, unknown, [""] * k, np.nan)
    a, b = np.triu_indices(k, 1)
    differences = summarise(values[:, a] - values[:, b])
    error = differences.sd / np.sqrt(n)
    critical = critical_value(differences.mean, error, resampled[:, a] - resampled[:, b], n)
    better = np.zeros((k, k), dtype=bool)  # model a is better than model b, and not by chance
    differ = np.abs(differences.mean) > critical * error
    better[a, b] = differ & (sign * differences.mean > 0)
    better[b, a] = differ & (sign * differences.mean < 0)
    order = np.argsort(rank, kind="stable")
    return Ranking(mean, rank, 1.0 + better.sum(axis=0), k - better.sum(axis=1).astype(float), first_shares(sign * resampled),
                   compact_letters(better | better.T, order), critical)


def critical_value(difference: Floats, error: Floats, resampled: Floats, n: int) -> float:
    """Standard errors that bound the differences of all pairs together; resampled: resamples x pairs."""
    varies = error > 0
    away = np.abs(resampled[:, varies] - difference[varies]) / error[varies]
    of_unknown_deviation = np.sqrt(n / (n - 1)) * special.stdtrit(n - 1, 1 - TAIL) / special.ndtri(1 - TAIL)
    return float(np.quantile(away.max(axis=1, initial=0), CONFIDENCE) * of_unknown_deviation)


def first_shares(resampled: Floats) -> Floats:
    """Share of the resamples in which each model has the largest mean; several largest ones share it."""
    best = resampled == resampled.max(axis=1, keepdims=True)
    shares: Floats = (best / best.sum(axis=1, keepdims=True)).mean(axis=0)
    return shares


def compact_letters(differ: NDArray[np.bool_], order: Sequence[int] | Numbers) -> list[str]:
    """A letter for each largest group of items of which no two differ; the first of `order` are in group "a" [piepho2004]."""
    groups = {frozenset(range(len(order)))}  # items are numbered by their place in the order
    for i, j in combinations(range(len(order)), 2):
        if not differ[order[i], order[j]]:
            continue
        split = {part for group in groups for part in ((group - {i}, group - {j}) if i in group and j in group else (group,))}
        groups = {group for group in split if not any(group < other for other in split)}
    letters = [""] * len(order)
    for place, group in enumerate(sorted(groups, key=sorted)):
        for i in sorted(group):
            letters[order[i]] += chr(ord("a") + place % 26) + "'" * (place // 26)  # a to z, then a', b', ...
    return letters
