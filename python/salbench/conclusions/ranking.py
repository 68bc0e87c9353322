# SPDX-License-Identifier: GPL-3.0-or-later
"""The competitors by rank: ranking.csv."""

import pandas

from salbench.conclusions.study import Study
from salbench.conclusions.tables import DATASET, MEAN, METRIC, MODEL, N_SHAPES, SPLIT, N, framed, number, optional_count, text

COLUMNS = (
    DATASET, SPLIT, METRIC, MODEL, N, N_SHAPES, MEAN,
    optional_count("rank", "1: best mean in the direction of the metric; equal means share the best rank; empty, as the next four, for fewer than six units"),
    optional_count("rank_low", "95 % interval, joint for all pairs of models"), optional_count("rank_high", "upper end"),
    number("first", "share of the resamples in which the model has the best mean"),
    text("group", "letters; two models without one in common differ; empty where it would take more than 26"),
    optional_count("rank_at_chance", "over all shapes, if every score that a model lacks and another has were at chance (`docs/statistics.md`); "
                   "empty where none is missing"))


def ranking(study: Study) -> pandas.DataFrame:
    """A row per data set, metric and competitor, best mean first; none for human performance (HS) and chance (RS)."""
    competitors = study.estimates.dropna(subset=["place"]).sort_values(["level", "of_metric", "place"])
    return framed(COLUMNS, [dict(competitors)], study.in_splits)
