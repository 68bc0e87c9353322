# SPDX-License-Identifier: GPL-3.0-or-later
"""Distance of each model from the best mean, with intervals that are joint for all pairs of models: an interval excludes 0 exactly where the
ranking shows the two to differ."""

from dataclasses import dataclass

from salbench.conclusions.significance import joint_interval
from salbench.pages import dots
from salbench.pages.blocks import Missing
from salbench.report import statistics
from salbench.report.results import Results

NAN = float("nan")


@dataclass(frozen=True)
class Behind(dots.Behind):
    """A model beside the best."""

    model: str = ""
    mean: float = NAN


def lags(results: Results, dataset: str, metric: str) -> list[Behind]:
    """The ranked models, the best first, then references: of the models that pages show."""
    ranked = statistics.ranking(results, dataset, metric).dropna(subset=["mean"])
    if ranked.empty:
        raise Missing(f"ranking.csv ranks no model by {results.metric(metric).label}.")
    best, first = ranked["model"].iloc[0], float(ranked["mean"].iloc[0])
    sign = -1 if results.metric(metric).lower else 1
    found = [Behind(0.0, model=best, mean=first)]
    found += [behind(results, dataset, metric, best, first, row.model, row.mean, sign) for row in ranked.iloc[1:].itertuples()]
    named = {one.model for one in found}
    means = statistics.compact(results, dataset, metric).dropna(subset=["mean"])
    return found + [Behind(sign * (row.mean - first), model=row.model, mean=row.mean) for row in means.itertuples() if row.model not in named]


def behind(results: Results, dataset: str, metric: str, best: str, of_best: float, model: str, mean: float, sign: int) -> Behind:
    try:
        pair = statistics.pair(results, dataset, metric, model, best)
    except Missing:
        return Behind(sign * (mean - of_best), model=model, mean=mean)
    distance = sign * pair["mean_difference"]
    return Behind(distance, *joint_interval(distance, pair["t"], pair["t_bound"]), model, mean)
