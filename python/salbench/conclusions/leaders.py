# SPDX-License-Identifier: GPL-3.0-or-later
"""Who leads, and how sure that is: what the ranks of a metric allow to say of the first. leaders.csv. References are no candidates."""

from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas

from salbench.conclusions.compact import within_range
from salbench.conclusions.metrics import Metric, leading_metrics
from salbench.conclusions.samples import summarise
from salbench.conclusions.study import RankedMetric, Study
from salbench.conclusions.tables import CI95, DATASET, METRIC, SPLIT, Part, framed, number, optional_count, text
from salbench.conclusions.units import Level
from salbench.conclusions.words import Leader, sentence

COLUMNS = (
    DATASET, SPLIT, METRIC, text("verdict", "of the joint intervals of the ranks; empty in the row of a whole data set"),
    text("leaders", "models that may be the first, best mean first"), number("mean", "of the best model"), *CI95,
    text("second", "model with the next best mean"), number("lead", "how far the best mean is ahead of that, above 0 also where lower is better"),
    number("lead_low", "its 95 % interval, joint for all pairs of models"), number("lead_high", "upper end"),
    optional_count("n", "units"), optional_count("n_shapes", "shapes in these"), text("sentence", "what may be said of the row"))


@dataclass(frozen=True)
class LevelLeaders:
    """Of a data set or split, by the metrics that have competitors."""

    dataset: str
    split: str
    unit: str
    leaders: list[Leader]
    sentence: str  # of the leading metrics


def find_leaders(study: Study) -> list[LevelLeaders]:
    """One per data set and split, each with the metrics that have competitors."""
    spoken_of = leading_metrics(metric.name for metric in study.scores.metrics)
    found = []
    for level, ranked in study.ranked:
        leaders = [leader_of(level, of_metric, metric) for metric, of_metric in zip(level.metrics, ranked)
                   if len(of_metric.competitors.scores.models)]
        leading = [leader for name in spoken_of for leader in leaders if leader.metric.name == name]
        found.append(LevelLeaders(level.dataset, level.split, study.unit, leaders, sentence(level.dataset, level.split, study.unit, leading)))
    return found


def leader_of(level: Level, ranked: RankedMetric, metric: Metric) -> Leader:
    """The competitors at the top by one metric."""
    scores, ranking, order = ranked.competitors.scores, ranked.ranking, ranked.ranking.order()
    names = [level.models[model] for model in scores.models]
    may_be_first = [names[column] for column in order if not ranking.low[column] > 1]
    best = order[0]
    of_best = summarise(scores.values[:, [best]])
    low, high = within_range(of_best, metric)
    leader = Leader(metric, "one unit", may_be_first, float(of_best.mean[0]), (float(low[0]), float(high[0])), scores.n, scores.n_shapes)
    if scores.n == 0:
        leader.verdict = "no common shape"
    if scores.n < 2:
        return leader
    if len(names) == 1:
        leader.verdict = "only model"
        return leader
    # How far the best is ahead of each other one, in the order of the ranks, and the half of the interval that ranks are made of.
    sign = 1.0 if metric.higher_is_better else -1
    ahead = summarise(sign * (scores.values[:, [best]] - scores.values[:, order[1:]]))
    half = ranking.critical * ahead.sd / np.sqrt(scores.n)
    leader.second, leader.lead = names[order[1]], float(ahead.mean[0])
    leader.lead_interval = float(ahead.mean[0] - half[0]), float(ahead.mean[0] + half[0])
    if len(may_be_first) > 1:
        leader.verdict = "not told apart"
        return leader
    leader.near = [names[column] for column, mean, bound in zip(order[1:], ahead.mean, half) if not abs(mean) > bound]
    leader.verdict = "not behind" if leader.near else "leads"
    return leader


def leaders(study: Study) -> pandas.DataFrame:
    """A row per data set with its sentence, then one per metric with competitors."""
    return framed(COLUMNS, (part for level in find_leaders(study) for part in _parts(level)), study.in_splits)


def _parts(level: LevelLeaders) -> list[Part]:
    none: dict[str, Any] = {column.name: "" if column.type == "str" else np.nan for column in COLUMNS}
    label = {"dataset": level.dataset, "split": level.split}
    parts: list[Part] = [none | label | {"sentence": level.sentence}]
    for leader in level.leaders:
        parts.append(label | {
            "metric": leader.metric.name, "verdict": leader.verdict, "leaders": ", ".join(leader.models), "mean": leader.mean,
            "ci95_low": leader.interval[0], "ci95_high": leader.interval[1], "second": leader.second, "lead": leader.lead,
            "lead_low": leader.lead_interval[0], "lead_high": leader.lead_interval[1], "n": leader.n, "n_shapes": leader.n_shapes,
            "sentence": sentence(level.dataset, level.split, level.unit, [leader])})
    return parts


def documents(found: list[LevelLeaders]) -> list[dict[str, Any]]:
    """As JSON has them, which knows no NaN."""
    return [{"dataset": level.dataset, "split": level.split, "sentence": level.sentence,
             "metrics": [_document(leader) for leader in level.leaders]} for level in found]


def _document(leader: Leader) -> dict[str, Any]:
    def known(value: float) -> float | None:
        return value if np.isfinite(value) else None

    return {"metric": leader.metric.name, "verdict": leader.verdict, "models": leader.models, "mean": known(leader.mean),
            "ci95": [*map(known, leader.interval)], "second": leader.second, "lead": known(leader.lead),
            "lead_ci95": [*map(known, leader.lead_interval)], "n": leader.n, "n_shapes": leader.n_shapes}
