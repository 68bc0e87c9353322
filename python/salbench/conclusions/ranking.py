# SPDX-License-Identifier: GPL-3.0-or-later
"""The competitors by rank: ranking.csv."""

import pandas

from salbench.conclusions.study import RankedMetric, Study
from salbench.conclusions.tables import DATASET, MEAN, METRIC, MODEL, N_SHAPES, SPLIT, N, Part, framed, number, optional_count, text
from salbench.conclusions.units import Level

COLUMNS = (
    DATASET, SPLIT, METRIC, MODEL, N, N_SHAPES, MEAN,
    optional_count("rank", "1: best mean in the direction of the metric; equal means share the best rank; empty for fewer than six units"),
    optional_count("rank_low", "95 % interval, joint for all pairs of models"), optional_count("rank_high", "upper end"),
    number("first", "share of the resamples in which the model has the best mean"),
    text("group", "letters; two models without one in common differ; empty beyond 26 of them"),
    optional_count("rank_at_chance", "if every score that a model lacks and another has were at chance; empty where none is missing"))


def ranking(study: Study) -> pandas.DataFrame:
    """A row per data set, metric and competitor, best mean first; none for references."""
    parts = (_part(level, metric, ranked) for level, of_level in study.ranked for metric, ranked in enumerate(of_level))
    return framed(COLUMNS, parts, study.in_splits)


def _part(level: Level, metric: int, ranked: RankedMetric) -> Part:
    scores, ranks, order = ranked.competitors.scores, ranked.ranking, ranked.ranking.order
    return {"dataset": level.dataset, "split": level.split, "metric": level.metrics[metric].name,
            "model": [level.models[model] for model in scores.models[order]], "n": scores.n, "n_shapes": scores.n_shapes,
            "mean": ranks.mean[order], "rank": ranks.rank[order], "rank_low": ranks.low[order], "rank_high": ranks.high[order],
            "first": ranks.first[order], "group": [ranks.letters[column] for column in order],
            "rank_at_chance": ranked.at_chance[order]}
