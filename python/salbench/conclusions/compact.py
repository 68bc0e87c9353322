# SPDX-License-Identifier: GPL-3.0-or-later
"""The table of models and metrics that goes into a paper: mean, half interval, group, and who failed where. compact.csv."""

import pandas

from salbench.conclusions.study import Study
from salbench.conclusions.tables import DATASET, MEAN, METRIC, MODEL, N_SHAPES, SPLIT, N, count, framed, number, optional_count, text

COLUMNS = (
    DATASET, SPLIT, METRIC, text("better", '"higher" or "lower" values of the metric'), MODEL,
    text("kind", '"model", or "reference" for human performance (HS) and chance (RS)'), N, N_SHAPES,
    count("n_missing", "shapes that some model has a score for and this one has not"), MEAN,
    number("low", "95 % interval (Student), cut at the values that the metric can take"), number("high", "upper end"),
    number("half", "half of the interval; empty where it was cut, since its ends are not equally far from the mean"),
    optional_count("rank", "as in ranking.csv; empty for references"), text("group", "as in ranking.csv; empty for references"),
    count("best", "1: rank 1; else 0"))


def compact(study: Study) -> pandas.DataFrame:
    """A row per data set, metric and model with scores: what goes into one table of models and metrics. Competitors by rank, then references;
    over the shapes that all competitors have a score for."""
    known = study.estimates[study.estimates["is_scored"] == 1].sort_values(["level", "of_metric", "kind", "place", "of_model"])
    return framed(COLUMNS, [dict(known) | {"best": known["rank"] == 1}], study.in_splits)
