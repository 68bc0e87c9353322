# SPDX-License-Identifier: GPL-3.0-or-later
"""Ranks of models, and their uncertainty.

All pairs of models are compared at once, which corrects for their number: by sign flips, one for each unit
and draw, the same for all pairs. If models are equal and their differences symmetric, flipped differences are
as likely as the observed ones. The largest |mean| / standard error over the pairs then exceeds the 95 %
quantile over the draws in at most 5 % of data sets, for any number of units and models. Each draw has its own
standard errors. Step-down: pairs found to differ are set aside, and the others compared with the quantile
over themselves, until no more are found [romano2005]. Ranks and groups follow from the pairs that differ: a
model's rank lies between 1 + the models above it and k - the models below it [mogstad2024] [piepho2004].

Intervals of all differences at once need another bound, since the true differences are not 0: flips of the
differences less their means. It is at least the bound of the first step, so a pair whose interval excludes 0
differs. The reverse need not hold: step-down finds more pairs than joint intervals do.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from salbench.conclusions.resampling import FEWEST, on_grid
from salbench.conclusions.samples import CONFIDENCE, ROUNDING, means
from salbench.conclusions.units import Floats, Numbers

_OF_DRAWS = 1e-9  # relative tolerance for equal values computed in different ways
_MOST_LETTERS = 26  # the alphabet


@dataclass(frozen=True)
class Ranking:
    """Ranks of the columns of scores. Without units all is NaN; with fewer than six, only the means are
    known."""

    mean: Floats
    order: Numbers  # columns, best mean first
    rank: Floats  # 1: best; equal means share the best rank
    low: Floats  # 95 %, jointly
    high: Floats
    first: Floats  # share of the resamples in which it is best
    letters: list[str]  # two models without a common letter differ; empty if there would be too many letters
    better: NDArray[np.bool_]  # [a, b]: a is significantly better than b
    bound: float  # standard errors beyond which a mean difference is significant
    joint: float  # half of joint 95 % intervals of all mean differences, in standard errors; NaN: none


class Differing(NamedTuple):
    """Result of comparing pairs of columns simultaneously."""

    better: NDArray[np.bool_]  # [a, b]: a is significantly better than b
    bound: float  # at the last step, in standard errors
    joint: float  # as in Ranking


def rank_models(
    values: Floats, flipped: Floats, signs: Floats, resampled: Floats, higher_is_better: bool = True
) -> Ranking:
    """Ranks the columns of units x models. flipped: their sums in Bootstrap.signs; signs: sums of these;
    resampled: means in the resamples."""
    n, k = values.shape
    sign = 1 if higher_is_better else -1
    unknown = np.full(k, np.nan)
    mean = means(values) if n else unknown
    order = np.argsort(-sign * mean, kind="stable")
    if n < FEWEST:
        return Ranking(
            mean,
            order,
            unknown,
            unknown,
            unknown,
            unknown,
            [""] * k,
            np.zeros((k, k), dtype=bool),
            np.nan,
            np.nan,
        )
    better, bound, joint = differing(on_grid(values), flipped, signs, higher_is_better)
    return Ranking(
        mean,
        order,
        ranks(mean, higher_is_better),
        1.0 + better.sum(axis=0),
        k - better.sum(axis=1).astype(float),
        first_shares(sign * resampled),
        compact_letters(better | better.T, order),
        better,
        bound,
        joint,
    )


def ranks(mean: Floats, higher_is_better: bool) -> Floats:
    """1: best; equal means share the best rank. All NaN if any mean is."""
    ahead = mean[:, None] - mean if higher_is_better else mean - mean[:, None]
    rounding = ROUNDING * np.abs(mean).max(initial=0)
    return np.where(np.isnan(mean).any(), np.nan, 1.0 + (ahead < -rounding).sum(axis=1))


def differing(
    values: Floats, flipped: Floats, signs: Floats, higher_is_better: bool = True, of: int | None = None
) -> Differing:
    """Compares the columns of units x models. flipped: their sums in each draw of signs; signs: sums of
    these. of: a column to restrict the pairs to, as in Dunnett's test [dunnett1955]."""
    k = values.shape[1]
    sums = flipped.T.copy()  # models x draws: contiguous per pair
    pairs = np.triu(np.ones((k, k), dtype=bool), 1)
    if of is not None:
        columns = np.arange(k) == of
        pairs &= columns[:, None] | columns
    weights = _weights(values, 0)
    seen = (sums[:, [0]] - sums[:, 0]) ** 2 * weights  # the first draw is the sample
    compared, bounds = pairs & (weights > 0), list[float]()  # pairs that are equal on every unit never differ
    while compared.any():
        bounds.append(_quantile(sums, weights, compared))
        differ = compared & (seen > bounds[-1] * (1 + _OF_DRAWS))
        compared &= ~differ
        if not differ.any():
            break
    ahead = sums[:, [0]] - sums[:, 0] if higher_is_better else sums[:, 0] - sums[:, [0]]
    bound = bounds[-1] if bounds else np.nan
    better = (seen > bound * (1 + _OF_DRAWS)) & (ahead > 0)
    largest = max(bounds[0], _joint_quantile(values, sums, signs, pairs)) if bounds else 1
    return Differing(
        better, _in_standard_errors(bound, len(values)), _in_standard_errors(largest, len(values))
    )


def _joint_quantile(values: Floats, sums: Floats, signs: Floats, pairs: NDArray[np.bool_]) -> float:
    """As _quantile, for the values less their means; 1 if no difference varies."""
    centre = means(values)
    weights = _weights(values - centre, ROUNDING * np.abs(values).max())
    varying = pairs & (weights > 0)
    return _quantile(sums - centre[:, None] * signs, weights, varying) if varying.any() else 1


def _weights(values: Floats, least: float) -> Floats:
    """Factors from the squared sum of a pair's differences to q, its share of n times the sum of squares,
    where t squared = (n - 1) q / (1 - q); 0 for pairs that differ by no more than `least`."""
    n = len(values)
    squares = np.stack([((values - values[:, [a]]) ** 2).sum(axis=0) for a in range(values.shape[1])])
    with np.errstate(divide="ignore"):
        return np.where(squares > n * least**2, 1 / (n * squares), 0)


def _in_standard_errors(q: float, n: int) -> float:
    return float(np.sqrt((n - 1) * q / (1 - q))) if q < 1 else np.nan


def _quantile(sums: Floats, weights: Floats, compared: NDArray[np.bool_]) -> float:
    """Quantile of the largest q over the compared pairs."""
    largest = np.zeros(sums.shape[1])
    for a in np.flatnonzero(compared.any(axis=1)):
        b = np.flatnonzero(compared[a])
        squared = sums[b] - sums[a]
        np.square(squared, out=squared)
        squared *= weights[a, b, None]
        np.maximum(largest, squared.max(axis=0), out=largest)
    place = int(np.ceil(CONFIDENCE * len(largest))) - 1
    return float(np.partition(largest, place)[place])


def first_shares(resampled: Floats) -> Floats:
    """Share of the resamples in which each model has the largest mean; ties share it. NaN without
    resamples."""
    if not len(resampled):
        return np.full(resampled.shape[1], np.nan)
    best = resampled >= resampled.max(axis=1, keepdims=True) - ROUNDING * np.abs(resampled).max(initial=0)
    shares: Floats = (best / best.sum(axis=1, keepdims=True)).mean(axis=0)
    return shares


def compact_letters(differ: NDArray[np.bool_], order: Sequence[int] | Numbers) -> list[str]:
    """Letters such that two items share one exactly if they do not differ; the first of `order` are in group
    "a" [piepho2004].

    Groups are filled in this order, each from the first pair not yet in a group. More than 26 groups give no
    letters.
    """
    places = np.asarray(order, dtype=np.intp)
    same = ~differ[np.ix_(places, places)]  # items in this order
    missing = np.triu(same)
    groups: list[list[int]] = []
    while missing.any():
        if len(groups) == _MOST_LETTERS:
            return [""] * len(order)
        group = np.zeros(len(order), dtype=bool)
        fits = np.ones(len(order), dtype=bool)
        pair = np.unravel_index(np.argmax(missing), missing.shape)
        for item in (*pair, *range(len(order))):
            if fits[item]:
                group[item], fits = True, fits & same[item]
        missing &= ~np.outer(group, group)
        groups.append([int(place) for place in np.flatnonzero(group)])
    letters = [""] * len(order)
    for place, members in enumerate(sorted(groups)):
        for item in members:
            letters[order[item]] += chr(ord("a") + place)
    return letters
