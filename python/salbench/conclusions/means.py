# SPDX-License-Identifier: GPL-3.0-or-later
"""Means of models over units, with their intervals: summary.csv, and the overview that a terminal shows."""

import pandas

from salbench.conclusions.study import Study
from salbench.conclusions.tables import (
    CI95, DATASET, MEAN, METRIC, MODEL, N_SHAPES, SPLIT, N, count, framed, number, optional_count, text,
)

COLUMNS = (
    DATASET, SPLIT, MODEL, METRIC, N, MEAN, number("sd", "standard deviation over the units, by n - 1"), *CI95,
    number("bca95_low", "95 % interval by the bootstrap over units (BCa), lower end"), number("bca95_high", "upper end"), N_SHAPES,
    count("n_own_shapes", "all shapes that the model has a score for"), number("own_mean", "mean over their units"))

OVERVIEW_COLUMNS = (
    DATASET, SPLIT, MODEL, METRIC, N, MEAN, *CI95, optional_count("rank", "1: best mean; empty for references"),
    text("group", "letters; two models without one in common differ"))


def summary(study: Study) -> pandas.DataFrame:
    """A row per data set, model and metric, over the shapes that all competitors have a score for."""
    return framed(COLUMNS, [dict(_by_model(study))], study.in_splits)


def overview(study: Study) -> pandas.DataFrame:
    """The same with ranks and groups, and without what a terminal is too narrow for."""
    return framed(OVERVIEW_COLUMNS, [dict(_by_model(study))], study.in_splits)


def _by_model(study: Study) -> pandas.DataFrame:
    return study.estimates.sort_values(["level", "of_model", "of_metric"])
