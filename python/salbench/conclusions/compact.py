# SPDX-License-Identifier: GPL-3.0-or-later
"""The table of models and metrics that goes into a paper: mean, half interval, group, and who failed where. compact.csv."""

from typing import Any

import numpy as np
import pandas

from salbench.conclusions.metrics import Metric
from salbench.conclusions.samples import Summary, summarise
from salbench.conclusions.study import RankedMetric, Study
from salbench.conclusions.tables import DATASET, MEAN, METRIC, MODEL, N_SHAPES, SPLIT, N, Part, count, framed, number, optional_count, text
from salbench.conclusions.units import Floats, Level

COLUMNS = (
    DATASET, SPLIT, METRIC, text("better", '"higher" or "lower" values of the metric'), MODEL,
    text("kind", '"model", or "reference" for human performance (HS) and chance (RS)'), N, N_SHAPES,
    count("n_missing", "shapes that some model has a score for and this one has not"), MEAN,
    number("low", "95 % interval (Student), cut at the values that the metric can take"), number("high", "upper end"),
    number("half", "half of the interval; empty where it was cut, since its ends are not equally far from the mean"),
    optional_count("rank", "as in ranking.csv; empty for references"), text("group", "as in ranking.csv; empty for references"),
    count("best", "1: rank 1; else 0"))


def within_range(summary: Summary, metric: Metric) -> tuple[Floats, Floats]:
    """Student's interval, cut at the values that the metric can take."""
    return cut(summary.low, summary.mean, summary.high, metric)


def cut(low: Any, mean: Any, high: Any, metric: Metric) -> tuple[Any, Any]:
    """An interval of a mean, cut at the values that the metric can take; the mean itself always stays inside.

    The true mean lies within these values, so that the cut interval holds it as often as the whole one.
    """
    return (np.where(low < metric.low, np.minimum(metric.low, mean), low), np.where(high > metric.high, np.maximum(metric.high, mean), high))


def compact(study: Study) -> pandas.DataFrame:
    """A row per data set, metric and model with scores; competitors by their means, then references."""
    parts = (_part(level, metric, ranked) for level, of_level in study.ranked for metric, ranked in enumerate(of_level))
    return framed(COLUMNS, parts, study.in_splits)


def _part(level: Level, metric: int, ranked: RankedMetric) -> Part:
    k, of_metric = len(level.models), level.metrics[metric]
    cells: dict[str, Any] = {name: np.full(k, np.nan) for name in ("n", "n_shapes", "mean", "low", "high", "half", "rank")}
    for sample in ranked.samples:
        models, summary = sample.scores.models, summarise(sample.scores.values)
        low, high = within_range(summary, of_metric)
        was_cut = (low > summary.low) | (high < summary.high)
        found = {"n": summary.n, "n_shapes": sample.scores.n_shapes, "mean": summary.mean, "low": low, "high": high,
                 "half": np.where(was_cut, np.nan, (summary.high - summary.low) / 2)}
        for name, values in found.items():
            cells[name][models] = values
    cells["rank"][ranked.competitors.scores.models] = ranked.ranking.rank
    group = np.full(k, "", dtype=object)
    group[ranked.competitors.scores.models] = ranked.ranking.letters
    cells |= {"group": group, "best": (cells["rank"] == 1).astype(int), "n_missing": level.n_missing(metric),
              "model": np.array(level.models, dtype=object), "kind": np.where(level.is_reference, "reference", "model")}
    scored = level.scored(metric)
    place = np.zeros(k)
    place[ranked.competitors.scores.models[ranked.ranking.order]] = np.arange(len(ranked.ranking.order))
    order = scored[np.lexsort((place[scored], level.is_reference[scored]))]
    return {"dataset": level.dataset, "split": level.split, "metric": of_metric.name,
            "better": "higher" if of_metric.higher_is_better else "lower", **{name: values[order] for name, values in cells.items()}}
