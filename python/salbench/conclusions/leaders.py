# SPDX-License-Identifier: GPL-3.0-or-later
"""Leaders by each metric, with their certainty, from the ranks. leaders.csv. References are no candidates."""

from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas
from numpy.typing import NDArray

from salbench.conclusions.chance import ahead
from salbench.conclusions.metrics import leading_metrics
from salbench.conclusions.ranked import RankedMetric, cut
from salbench.conclusions.ranks import Ranking
from salbench.conclusions.resampling import FEWEST
from salbench.conclusions.samples import summarise
from salbench.conclusions.study import Study
from salbench.conclusions.tables import (
    CI95,
    DATASET,
    METRIC,
    SPLIT,
    Part,
    framed,
    number,
    optional_count,
    text,
)
from salbench.conclusions.units import Level
from salbench.conclusions.words import Leader, listed, of_split, sentence

COLUMNS = (
    DATASET,
    SPLIT,
    METRIC,
    text(
        "verdict",
        (
            '"leads": one model is ahead of every other. "not behind": no model is ahead of it, but it is not'
            ' ahead of all. "not told apart": several that no model is ahead of. "at chance": none of these'
            ' is shown to be ahead of chance (RS) and a constant map. "only model". "one unit", "too few'
            ' units": fewer than six show no leader. "no variation": the two best have the same scores on all'
            ' units. "no common shape": none that all competitors have a score for'
        ),
    ),
    text(
        "leaders",
        (
            "models that may be the first (`rank_low` 1 in `ranking.csv`), best mean first, with \", \""
            " between them"
        ),
    ),
    number("mean", "of the best model; its interval is that of `compact.csv`"),
    *CI95,
    text("second", "model with the next best mean"),
    number("lead", "how far the best mean is ahead of that, above 0 also where lower is better"),
    number(
        "lead_low",
        "95 % interval of the lead, joint for all pairs of competitors: beyond 0 only if the two differ",
    ),
    number("lead_high", "upper end"),
    optional_count("n", "units"),
    optional_count("n_shapes", "shapes in these"),
    optional_count("n_missing", "shapes left out, since a competitor has no score there"),
    text(
        "new_classes",
        "verdict if classes are the units, where six have several items: what new kinds of shapes would show",
    ),
    text("new_classes_leaders", "models that may then be the first"),
    text("sentence", "what may be said of the row"),
    text("not_ahead", "those of `leaders` that are not shown to be ahead of `baseline`"),
    text(
        "baseline",
        (
            '"chance" (RS, or what the metric gives to maps that know nothing), "a constant map", "chance or a'
            ' constant map", or "both chance and a constant map" (some are ahead of one of the two): what'
            ' `not_ahead`, or with "at chance" all models, are not shown to be ahead of'
        ),
    ),
)


@dataclass(frozen=True)
class LevelLeaders:
    """Leaders of a data set or split, for the metrics that have competitors."""

    dataset: str
    split: str
    unit: str
    of_split: str  # in words
    leaders: list[Leader]
    sentence: str  # about the leading metrics


def find_leaders(study: Study) -> list[LevelLeaders]:
    """Returns one per data set and split, each with the metrics that have competitors."""
    found, in_splits = [], {level.dataset for level in study.levels if level.split}
    for level, ranked in study.ranked:
        places = [place for place, of_metric in enumerate(ranked) if len(of_metric.competitors.models)]
        leaders = [leader_of(level, ranked[place], place) for place in places]
        if (level.dataset, level.split) in study.of_classes:
            classes, of_classes = study.of_classes[level.dataset, level.split]
            for leader, place in zip(leaders, places):
                leader.new_classes = leader_of(classes, of_classes[place], place)
        by_name = {leader.metric.name: leader for leader in leaders}
        chief = [by_name[name] for name in study.leading if name in by_name]
        chief = chief or [by_name[name] for name in leading_metrics(by_name)]
        of = of_split(level.split, level.dataset in in_splits)
        found.append(
            LevelLeaders(
                level.dataset,
                level.split,
                study.unit,
                of,
                leaders,
                sentence(level.dataset, of, study.unit, chief),
            )
        )
    return found


def leader_of(level: Level, ranked: RankedMetric, place: int) -> Leader:
    """Returns the leaders by one metric."""
    scores, ranking, metric = ranked.competitors, ranked.ranking, level.metrics[place]
    names, order = [level.models[model] for model in scores.models], ranking.order
    missing, shapes = level.n_missing(place)[scores.models], int(level.defined[:, :, place].any(axis=1).sum())
    leader = Leader(
        metric,
        "only model" if len(names) == 1 else "too few units",
        n=scores.n,
        n_shapes=scores.n_shapes,
        copies=level.copies,
        in_views=level.in_views,
        n_missing=shapes - scores.n_shapes,
        missing={
            names[column]: (int(missing[column]), float(ranked.at_chance[column]))
            for column in order
            if missing[column]
        },
    )
    if scores.n < 2:
        leader.verdict = "one unit" if scores.n else "no common shape"
    if scores.n == 0 or (scores.n < FEWEST and len(names) > 1):
        return leader
    of_best = summarise(scores.values[:, order[:1]])
    low, high = cut(of_best.low, of_best.mean, of_best.high, metric)
    leader.mean, leader.interval, leader.best = (
        float(of_best.mean[0]),
        (float(low[0]), float(high[0])),
        names[order[0]],
    )
    leader.models = [leader.best]
    if len(names) == 1:
        _measure_against_chance(leader, names, ranking, ahead(level, place))
        return leader
    # Lead over the next model, with half of its joint interval.
    lead = summarise(
        (1.0 if metric.higher_is_better else -1)
        * (scores.values[:, order[:1]] - scores.values[:, order[1:2]])
    )
    # no interval of width 0
    half = float(ranking.joint * lead.sd[0] / np.sqrt(scores.n)) if lead.sd[0] > 0 else np.nan
    leader.second, leader.lead = names[order[1]], float(lead.mean[0])
    leader.lead_interval = leader.lead - half, leader.lead + half
    first = [column for column in order if ranking.low[column] == 1]
    leader.models = [names[column] for column in first]
    others = [column for column in order if column not in first]
    leader.behind = [names[column] for column in others if ranking.better[first, column].any()]
    leader.near = (
        [names[column] for column in others if not ranking.better[first[0], column]]
        if len(first) == 1
        else []
    )
    leader.verdict = "not told apart" if len(first) > 1 else "not behind" if leader.near else "leads"
    if len(first) == 1 and np.isnan(half) and np.isnan(leader.interval).all():
        leader.verdict, leader.models, leader.near, leader.behind = "no variation", [], [], []
        return leader
    _measure_against_chance(leader, names, ranking, ahead(level, place))
    return leader


def _measure_against_chance(
    leader: Leader, names: list[str], ranking: Ranking, ahead_of: dict[str, NDArray[np.bool_]]
) -> None:
    """Lists models that are not significantly ahead of chance; if all are listed, nobody leads. A model ahead
    of one that is ahead of chance counts as ahead of chance."""
    for passed in ahead_of.values():
        for column in ranking.order[::-1]:
            if passed[column]:
                passed |= ranking.better[:, column]
    lacking = {
        name: [baseline for baseline, passed in ahead_of.items() if not passed[names.index(name)]]
        for name in names
    }
    leader.not_ahead = [name for name in leader.models if lacking[name]]
    if leader.not_ahead == leader.models:
        shared = [baseline for baseline, passed in ahead_of.items() if not passed.any()]
        leader.baseline, leader.verdict = (
            listed(shared, "or") if shared else f"both {listed(list(ahead_of))}"
        ), "at chance"
        leader.models, leader.not_ahead, leader.near, leader.behind = [], [], [], []
    elif leader.not_ahead:
        lacks = [lacking[name] for name in leader.not_ahead]
        leader.baseline = (
            listed(lacks[0], "or")
            if all(one == lacks[0] for one in lacks)
            else f"both {listed(list(ahead_of))}"
        )


def leaders(study: Study) -> pandas.DataFrame:
    """A row per data set with its sentence and an empty `metric`, then one per metric with competitors. The
    sentence gives the verdict by the protocol's metric and by AUC, NSS and LCC, filled up to three with other
    metrics of the run."""
    return framed_leaders(find_leaders(study), study.in_splits)


def framed_leaders(found: list[LevelLeaders], in_splits: bool) -> pandas.DataFrame:
    return framed(COLUMNS, (part for level in found for part in _parts(level)), in_splits)


def _parts(level: LevelLeaders) -> list[Part]:
    none: dict[str, Any] = {column.name: "" if column.type == "str" else np.nan for column in COLUMNS}
    label = {"dataset": level.dataset, "split": level.split}
    parts: list[Part] = [none | label | {"sentence": level.sentence}]
    for leader in level.leaders:
        classes = leader.new_classes
        parts.append(
            label
            | {
                "metric": leader.metric.name,
                "verdict": leader.verdict,
                "leaders": ", ".join(leader.models),
                "mean": leader.mean,
                "ci95_low": leader.interval[0],
                "ci95_high": leader.interval[1],
                "second": leader.second,
                "lead": leader.lead,
                "lead_low": leader.lead_interval[0],
                "lead_high": leader.lead_interval[1],
                "n": leader.n,
                "n_shapes": leader.n_shapes,
                "n_missing": leader.n_missing,
                "new_classes": classes.verdict if classes else "",
                "new_classes_leaders": ", ".join(classes.models) if classes else "",
                "sentence": sentence(level.dataset, level.of_split, level.unit, [leader]),
                "not_ahead": ", ".join(leader.not_ahead),
                "baseline": leader.baseline,
            }
        )
    return parts


def documents(found: list[LevelLeaders]) -> list[dict[str, Any]]:
    """Leaders for JSON, which has no NaN."""
    return [
        {
            "dataset": level.dataset,
            "split": level.split,
            "sentence": level.sentence,
            "metrics": [_document(leader) for leader in level.leaders],
        }
        for level in found
    ]


def _document(leader: Leader) -> dict[str, Any]:
    def known(value: float) -> float | None:
        return value if np.isfinite(value) else None

    return {
        "metric": leader.metric.name,
        "verdict": leader.verdict,
        "models": leader.models,
        "mean": known(leader.mean),
        "ci95": [*map(known, leader.interval)],
        "second": leader.second,
        "lead": known(leader.lead),
        "lead_ci95": [*map(known, leader.lead_interval)],
        "n": leader.n,
        "n_shapes": leader.n_shapes,
    }
