# SPDX-License-Identifier: GPL-3.0-or-later
"""Means of models over units, with their intervals: summary.csv, and the overview that a terminal shows."""

from typing import Any

import numpy as np
import pandas

from salbench.conclusions.resampling import bca_interval
from salbench.conclusions.samples import summarise
from salbench.conclusions.study import RankedMetric, Study
from salbench.conclusions.tables import (
    CI95, DATASET, MEAN, METRIC, MODEL, N_SHAPES, SPLIT, N, Part, count, framed, number, optional_count, text,
)
from salbench.conclusions.units import Level

COLUMNS = (
    DATASET, SPLIT, MODEL, METRIC, N, MEAN, number("sd", "standard deviation over the units, by n - 1"), *CI95,
    number("bca95_low", "95 % interval by the bootstrap over units (BCa), lower end"), number("bca95_high", "upper end"), N_SHAPES,
    count("n_own_shapes", "all shapes that the model has a score for"), number("own_mean", "mean over their units"))

OVERVIEW_COLUMNS = (
    DATASET, SPLIT, MODEL, METRIC, N, MEAN, *CI95, optional_count("rank", "1: best mean; empty for references"),
    text("group", "letters; two models without one in common differ"))


def summary(study: Study) -> pandas.DataFrame:
    """A row per data set, model and metric, over the shapes that all competitors have a score for."""
    return framed(COLUMNS, (_part(level, ranked) for level, ranked in study.ranked), study.in_splits)


def overview(study: Study) -> pandas.DataFrame:
    """The same with ranks and groups, and without what a terminal is too narrow for."""
    return framed(OVERVIEW_COLUMNS, (_part(level, ranked) for level, ranked in study.ranked), study.in_splits)


def _part(level: Level, ranked: list[RankedMetric]) -> Part:
    """By model, then metric."""
    shape = (len(level.models), len(level.metrics))
    cells: dict[str, Any] = {column.name: np.full(shape, np.nan) for column in COLUMNS if column.type == "float64"}
    cells |= {name: np.zeros(shape) for name in ("n", "n_shapes", "n_own_shapes")}
    cells |= {"rank": np.full(shape, np.nan), "group": np.full(shape, "", dtype=object)}
    for metric, of_metric in enumerate(ranked):
        _fill(cells, level, metric, of_metric)
    names = np.array([metric.name for metric in level.metrics], dtype=object)
    return {"dataset": level.dataset, "split": level.split, "model": np.repeat(np.array(level.models, dtype=object), shape[1]),
            "metric": np.tile(names, shape[0]), **{name: values.ravel() for name, values in cells.items()}}


def _fill(cells: dict[str, Any], level: Level, metric: int, ranked: RankedMetric) -> None:
    """The cells of one metric."""
    for sample in ranked.samples:
        scores, at = sample.scores, (sample.scores.models, metric)
        found = summarise(scores.values)
        cells["n"][at], cells["n_shapes"][at] = found.n, scores.n_shapes
        for name, values in {"mean": found.mean, "sd": found.sd, "ci95_low": found.low, "ci95_high": found.high}.items():
            cells[name][at] = values
        for column, model in enumerate(scores.model_of_column):
            cells["bca95_low"][model, metric], cells["bca95_high"][model, metric] = bca_interval(
                scores.values[:, column], sample.means[:, column])
            own = scores if level.n_defined(metric, model) == scores.n_shapes else level.averaged(metric, [model])
            cells["n_own_shapes"][model, metric] = own.n_shapes
            cells["own_mean"][model, metric] = summarise(own.values).mean[own.model_of_column.index(model)]
    at = (ranked.competitors.scores.models, metric)
    cells["rank"][at], cells["group"][at] = ranked.ranking.rank, ranked.ranking.letters
