# SPDX-License-Identifier: GPL-3.0-or-later
"""Scores as a share of the way from chance (RS) to human performance (HS): human_share.csv."""

from dataclasses import dataclass, field

import numpy as np
import pandas

from salbench.conclusions.pairs import compare
from salbench.conclusions.ranked import RankedMetric
from salbench.conclusions.resampling import FEWEST, percentile_interval
from salbench.conclusions.samples import LEVEL, means
from salbench.conclusions.study import Study
from salbench.conclusions.tables import CI95, DATASET, METRIC, MODEL, N, N_SHAPES, SPLIT, Part, framed, number, text
from salbench.conclusions.units import Floats, Level, UnitScores

COLUMNS = (
    DATASET, SPLIT, METRIC, MODEL, N, N_SHAPES, number("mean", "mean of the model, on the shapes that it, HS and RS have"),
    number("mean_rs", "mean of RS"), number("mean_hs", "mean of HS"), number("share", "(mean - mean_rs) / (mean_hs - mean_rs): 0 is chance, 1 human performance; empty where HS is not clearly better than RS"), *CI95,
    text("remark", "why there is no share or no interval"))

_CHANCE, _PEOPLE = "RS", "HS"  # the ends of the scale


@dataclass(frozen=True)
class _Scale:
    """The competitors, chance and people under one metric, on the same units."""

    remark: str = ""  # why there are no shares
    scores: UnitScores | None = None
    means: Floats = field(default_factory=lambda: np.empty(0))
    shares: Floats = field(default_factory=lambda: np.empty(0))  # of the competitors
    resampled: Floats = field(default_factory=lambda: np.empty((0, 0)))  # resamples x competitors


def human_share(study: Study) -> pandas.DataFrame:
    """A row per data set, metric and competitor, over the shapes that all competitors, HS and RS have a score for. Intervals are percentiles
    over resampled units, none for fewer than six."""
    parts = (_part(study, level, ranked[metric], metric) for level, ranked in study.ranked for metric in range(len(level.metrics)))
    return framed(COLUMNS, parts, study.in_splits)


def shares(models: Floats, chance: Floats, people: Floats, sign: float) -> Floats:
    """Of means. Where people are no better than chance, however the sample is drawn, every share is as likely: the sign of what the
    model is ahead of chance decides. sign: 1 where people are above chance, -1 where they are below."""
    span, ahead = sign * (people - chance), sign * (models - chance)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(span > 0, ahead / span, np.where(ahead == 0, 0, np.copysign(np.inf, ahead)))


def _part(study: Study, level: Level, ranked: RankedMetric, metric: int) -> Part:
    scale = _scale_of(study, level, ranked, metric)
    models = np.flatnonzero(~level.is_reference)
    rows = [_row(scale, model) for model in models]
    names = [column.name for column in COLUMNS[4:]]
    return {"dataset": level.dataset, "split": level.split, "metric": level.metrics[metric].name,
            "model": [level.models[model] for model in models],
            **{name: [row[place] for row in rows] for place, name in enumerate(names)}}


def _scale_of(study: Study, level: Level, ranked: RankedMetric, metric: int) -> _Scale:
    ends = []
    for name in (_CHANCE, _PEOPLE):
        model = level.find(name)
        if model is None or not level.is_scored[model, metric]:
            return _Scale(f"no scores of {name}")
        ends.append(model)
    scores = level.compared(metric, [*level.competitors(metric), *ends])
    if scores.n == 0:
        return _Scale("no shape has scores of HS, RS and all models")
    average = means(scores.values)
    if scores.n < 2:
        return _Scale("one unit: it does not show that HS is better than RS", scores, average)
    if not _is_better(scores.values[:, -1] - scores.values[:, -2], level.metrics[metric].higher_is_better):
        return _Scale("HS is not clearly better than RS", scores, average)
    sign = 1.0 if average[-1] > average[-2] else -1.0
    resampled = ranked.resampled(scores, study.bootstrap)
    return _Scale("", scores, average, shares(average[:-2], average[-2], average[-1], sign),
                  shares(resampled[:, :-2], resampled[:, -2:-1], resampled[:, -1:], sign))


def _is_better(differences: Floats, higher_is_better: bool) -> bool:
    found = compare(differences[:, None])
    mean = found.mean_difference[0]
    return bool(found.t_p[0] < LEVEL and (mean > 0 if higher_is_better else mean < 0))


def _row(scale: _Scale, model: int) -> tuple[object, ...]:
    """The cells from n on."""
    column = None if scale.scores is None else np.flatnonzero(scale.scores.models[:-2] == model)
    if scale.scores is None or column is None or not len(column):
        return 0, 0, *(np.nan,) * 6, scale.remark or "no scores"
    place = column[0]
    known = scale.scores.n, scale.scores.n_shapes, scale.means[place], *scale.means[-2:]
    if scale.remark:
        return *known, *(np.nan,) * 3, scale.remark
    low, high = percentile_interval(scale.resampled[:, place], scale.scores.n)
    remark = _remark_on(low, high, scale.scores.n)
    return *known, scale.shares[place], *((np.nan, np.nan) if remark else (low, high)), remark


def _remark_on(low: float, high: float, n: int) -> str:
    if n < FEWEST:
        return f"no interval: fewer than {FEWEST} units"
    if np.isnan(low):
        return "no interval: the shares do not vary"
    return "" if np.isfinite(low) and np.isfinite(high) else "no interval: HS is too near RS in the resamples"
