# SPDX-License-Identifier: GPL-3.0-or-later
"""How far each model is behind the one with the best mean, with intervals that are joint for all pairs of models: they leave out 0 where ranks
and groups have the two differ."""

from dataclasses import dataclass

from salbench.pages.blocks import Missing
from salbench.report import statistics
from salbench.report.results import Results

NAN = float("nan")


@dataclass(frozen=True)
class Behind:
    """A model beside the best. Distances are negative behind it, whichever way the metric is better; NaN: no interval."""

    model: str
    mean: float
    distance: float
    low: float = NAN
    high: float = NAN
    wins: float = NAN       # share of the units on which the best has the better score, ties half; and its own interval (Wilson)
    wins_low: float = NAN
    wins_high: float = NAN


def lags(results: Results, dataset: str, metric: str) -> list[Behind]:
    """The ranked models, the best first, then references."""
    ranked = statistics.ranking(results, dataset, metric).dropna(subset=["mean"])
    if ranked.empty:
        raise Missing(f"ranking.csv ranks no model by {results.metric(metric).label}.")
    best, first = ranked["model"].iloc[0], float(ranked["mean"].iloc[0])
    sign = -1 if results.metric(metric).lower else 1
    found = [Behind(best, first, 0.0)]
    found += [behind(results, dataset, metric, best, first, row.model, row.mean, sign) for row in ranked.iloc[1:].itertuples()]
    named = {one.model for one in found}
    means = statistics.compact(results, dataset, metric).dropna(subset=["mean"])
    return found + [Behind(row.model, row.mean, sign * (row.mean - first)) for row in means.itertuples() if row.model not in named]


def behind(results: Results, dataset: str, metric: str, best: str, of_best: float, model: str, mean: float, sign: int) -> Behind:
    try:
        pair = statistics.pair(results, dataset, metric, model, best)
    except Missing:
        return Behind(model, mean, sign * (mean - of_best))
    distance = sign * pair["mean_difference"]
    half = abs(distance / pair["t"]) * pair["t_bound"] if pair["t"] else NAN  # standard errors, as many as the bound
    shares = [1 - pair[name] if sign > 0 else pair[name] for name in ("superiority", "superiority_low", "superiority_high")]
    return Behind(model, mean, distance, distance - half, distance + half, shares[0], *sorted(shares[1:]))
