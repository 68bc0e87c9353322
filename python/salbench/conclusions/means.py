# SPDX-License-Identifier: GPL-3.0-or-later
"""Models by metric: their means, intervals and ranks. summary.csv, ranking.csv, compact.csv, and the overview
for terminals."""

import pandas

from salbench.conclusions.study import Study
from salbench.conclusions.tables import (
    CI95,
    DATASET,
    MEAN,
    METRIC,
    MODEL,
    N_SHAPES,
    SPLIT,
    N,
    count,
    framed,
    number,
    optional_count,
    text,
)

SUMMARY = (
    DATASET,
    SPLIT,
    MODEL,
    METRIC,
    N,
    MEAN,
    number("sd", "standard deviation over the units, by n - 1"),
    *CI95,
    number("bca95_low", "95 % interval by the bootstrap over units (BCa), lower end"),
    number("bca95_high", "upper end"),
    N_SHAPES,
    count("n_own_shapes", "all shapes that the model has a score for"),
    number("own_mean", "mean over their units"),
)

OVERVIEW = (
    DATASET,
    SPLIT,
    MODEL,
    METRIC,
    N,
    MEAN,
    *CI95,
    optional_count("rank", "1: best mean; empty for references"),
    text("group", "letters; two models without one in common differ"),
)

RANKING = (
    DATASET,
    SPLIT,
    METRIC,
    MODEL,
    N,
    N_SHAPES,
    MEAN,
    optional_count(
        "rank",
        (
            "1: best mean in the direction of the metric; equal means share the best rank; empty, as the next"
            " four, for fewer than six units"
        ),
    ),
    optional_count("rank_low", "95 % interval, joint for all pairs of models"),
    optional_count("rank_high", "upper end"),
    number("first", "share of the resamples in which the model has the best mean"),
    text("group", "letters; two models without one in common differ; empty where it would take more than 26"),
    optional_count(
        "rank_at_chance",
        (
            "over all shapes, if every score that a model lacks and another has were at chance"
            " (`docs/statistics.md`); empty where none is missing"
        ),
    ),
)

COMPACT = (
    DATASET,
    SPLIT,
    METRIC,
    text("better", '"higher" or "lower" values of the metric'),
    MODEL,
    text("kind", '"model", or "reference" for human performance (HS) and chance (RS)'),
    N,
    N_SHAPES,
    count("n_missing", "shapes that some model has a score for and this one has not"),
    MEAN,
    number("low", "95 % interval (Student), cut at the values that the metric can take"),
    number("high", "upper end"),
    number(
        "half",
        "half of the interval; empty where it was cut, since its ends are not equally far from the mean",
    ),
    optional_count("rank", "as in ranking.csv; empty for references"),
    text("group", "as in ranking.csv; empty for references"),
    count("best", "1: rank 1; else 0"),
)


def summary(study: Study) -> pandas.DataFrame:
    """A row per data set, model and metric, over the shapes that all competitors are scored on."""
    return framed(SUMMARY, [dict(_by_model(study))], study.in_splits)


def overview(study: Study) -> pandas.DataFrame:
    """Same with ranks and groups, without columns that do not fit a terminal."""
    return framed(OVERVIEW, [dict(_by_model(study))], study.in_splits)


def _by_model(study: Study) -> pandas.DataFrame:
    return study.estimates.sort_values(["level", "of_model", "of_metric"])


def ranking(study: Study) -> pandas.DataFrame:
    """A row per data set, metric and competitor, best mean first; none for human performance (HS) and
    chance (RS)."""
    competitors = study.estimates.dropna(subset=["place"]).sort_values(["level", "of_metric", "place"])
    return framed(RANKING, [dict(competitors)], study.in_splits)


def compact(study: Study) -> pandas.DataFrame:
    """A row per data set, metric and model with scores: the cells of one table of models and metrics.
    Competitors by rank, then references; over the shapes that all competitors are scored on."""
    known = study.estimates[study.estimates["is_scored"]].sort_values(
        ["level", "of_metric", "kind", "place", "of_model"]
    )
    return framed(COMPACT, [dict(known) | {"best": known["rank"] == 1}], study.in_splits)
