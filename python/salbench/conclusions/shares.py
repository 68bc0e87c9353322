# SPDX-License-Identifier: GPL-3.0-or-later
"""Scores on the scale from chance (RS) to human performance (HS): human_share.csv."""

from typing import Any

import numpy as np
import pandas

from salbench.conclusions.pairs import compare
from salbench.conclusions.ranked import RankedMetric
from salbench.conclusions.resampling import FEWEST, percentile_interval
from salbench.conclusions.samples import LEVEL, means
from salbench.conclusions.study import Study
from salbench.conclusions.tables import (
    CI95,
    DATASET,
    METRIC,
    MODEL,
    N,
    N_SHAPES,
    SPLIT,
    Part,
    framed,
    number,
    text,
)
from salbench.conclusions.units import Floats, Level, UnitScores

COLUMNS = (
    DATASET,
    SPLIT,
    METRIC,
    MODEL,
    N,
    N_SHAPES,
    number("mean", "mean of the model, on the shapes that it, HS and RS have"),
    number("mean_rs", "mean of RS"),
    number("mean_hs", "mean of HS"),
    number(
        "share",
        (
            "(mean - mean_rs) / (mean_hs - mean_rs): 0 is chance, 1 human performance; empty where HS is not"
            " clearly better than RS"
        ),
    ),
    *CI95,
    text("remark", "why there is no share or no interval"),
)

_CHANCE, _PEOPLE = "RS", "HS"  # the ends of the scale


def human_share(study: Study) -> pandas.DataFrame:
    """A row per data set, metric and competitor, over the shapes that all competitors, HS and RS are scored
    on. Intervals are percentiles over resampled units; none for fewer than six."""
    parts = (
        _part(study, level, ranked[metric], metric)
        for level, ranked in study.ranked
        for metric in range(len(level.metrics))
    )
    return framed(COLUMNS, parts, study.in_splits)


def shares(models: Floats, chance: Floats, people: Floats, sign: float) -> Floats:
    """Shares of the distance from chance to people, from means. In resamples where people are no better than
    chance the share is infinite, with the sign of the model's lead over chance. sign: 1 if people are above
    chance, -1 if below."""
    span, ahead = sign * (people - chance), sign * (models - chance)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(span > 0, ahead / span, np.where(ahead == 0, 0, np.copysign(np.inf, ahead)))


def _part(study: Study, level: Level, ranked: RankedMetric, metric: int) -> Part:
    """Rows of one metric, one per competitor; NaN without scores."""
    models = np.flatnonzero(~level.is_reference)
    remark, scores = _scale_of(level, metric)
    cells: dict[str, Any] = {column.name: np.full(len(models), np.nan) for column in COLUMNS[4:-1]}
    cells |= {
        "n": np.zeros(len(models)),
        "n_shapes": np.zeros(len(models)),
        "remark": np.full(len(models), remark or "no scores", dtype=object),
    }
    if scores is not None:
        for name, values in _of_scale(study, ranked, remark, scores).items():
            cells[name][np.searchsorted(models, scores.models[:-2])] = values
    return {
        "dataset": level.dataset,
        "split": level.split,
        "metric": level.metrics[metric].name,
        "model": np.array(level.models)[models],
        **cells,
    }


def _scale_of(level: Level, metric: int) -> tuple[str, UnitScores | None]:
    """Competitors, chance and people under one metric, on the same units; or the reason why there are no
    shares."""
    ends = [level.find(name) for name in (_CHANCE, _PEOPLE)]
    for name, model in zip((_CHANCE, _PEOPLE), ends):
        if model is None or not level.is_scored[model, metric]:
            return f"no scores of {name}", None
    scores = level.compared(
        metric, [*level.competitors(metric), *(model for model in ends if model is not None)]
    )
    if scores.n == 0:
        return "no shape has scores of HS, RS and all models", None
    if scores.n < 2:
        return "one unit: it does not show that HS is better than RS", scores
    people = compare(scores.values[:, -1:] - scores.values[:, -2:-1])
    is_better = (
        people.mean_difference[0] > 0
        if level.metrics[metric].higher_is_better
        else people.mean_difference[0] < 0
    )
    return "" if people.p[0] < LEVEL and is_better else "HS is not clearly better than RS", scores


def _of_scale(study: Study, ranked: RankedMetric, remark: str, scores: UnitScores) -> dict[str, Any]:
    """Cells of the competitors."""
    average = means(scores.values)
    known = {
        "n": scores.n,
        "n_shapes": scores.n_shapes,
        "mean": average[:-2],
        "mean_rs": average[-2],
        "mean_hs": average[-1],
        "remark": remark,
    }
    if remark:
        return known
    sign, resampled = 1.0 if average[-1] > average[-2] else -1.0, _resampled(study, ranked, scores)
    each = shares(resampled[:, :-2], resampled[:, -2:-1], resampled[:, -1:], sign)
    ends = np.array([percentile_interval(values, scores.n) for values in each.T]).reshape(-1, 2)
    remarks = [_remark_on(low, high, scores.n) for low, high in ends]
    ends[[text != "" for text in remarks]] = np.nan
    return known | {
        "share": shares(average[:-2], average[-2], average[-1], sign),
        "ci95_low": ends[:, 0],
        "ci95_high": ends[:, 1],
        "remark": remarks,
    }


def _resampled(study: Study, ranked: RankedMetric, scores: UnitScores) -> Floats:
    """Resampled means of ranked models on the shapes that all of them are compared on; mostly known
    already."""
    known: dict[int, Floats] = {}
    for sample in ranked.samples:
        if sample.n_shapes == scores.n_shapes:
            known.update(zip(sample.models, sample.resampled.T))
    if all(model in known for model in scores.models):
        return np.stack([known[model] for model in scores.models], axis=1)
    return study.bootstrap.means(scores.values)


def _remark_on(low: float, high: float, n: int) -> str:
    if n < FEWEST:
        return f"no interval: fewer than {FEWEST} units"
    if np.isnan(low):
        return "no interval: the shares do not vary"
    return "" if np.isfinite(low) and np.isfinite(high) else "no interval: HS is too near RS in the resamples"
