# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables of the program as data frames, and their names."""

import html
import os
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

from salbench.system.csv import fail, read_csv

if TYPE_CHECKING:
    import pandas


def read(path: str | os.PathLike[str]) -> "pandas.DataFrame":
    """Reads a table of the program or this package, with the types that conclusions declare; `attrs` has its
    `remarks`. Throws InputError for other files."""

    def type_of(column: str) -> str:
        from salbench import conclusions  # imports pandas

        return conclusions.type_of(Path(path).stem, column)

    frame = read_csv(path, lambda column: type_of(column) != "str")
    whole = {column: type for column in frame if "nt64" in (type := type_of(column))}
    for column, type in whole.items():
        for row, value in enumerate(frame[column]):
            if value % 1 != 0 and (type == "int64" or value == value):
                fail(frame, row, f"{column} is {value:g}, not a whole number")
    return frame.reset_index(drop=True).astype(whole)


def _named(name: str, meaning: str) -> "cached_property[pandas.DataFrame]":
    made: cached_property[pandas.DataFrame] = cached_property(lambda tables: tables._table(name))
    made.__doc__ = f"{meaning} ({name}.csv)."
    return made


class Tables:
    """Tables of conclusions, by file name. Tables without content have their columns and no rows."""

    def _table(self, name: str) -> "pandas.DataFrame":
        raise NotImplementedError

    leaders = _named("leaders", "Leaders by each metric with their uncertainty, and in sentences")
    compact = _named(
        "compact", "Mean, half interval, rank and group of each model by each metric, for papers"
    )
    summary = _named(
        "summary",
        (
            "Mean of each model by each metric, with its 95 % intervals: Student's, and bootstrap by unit"
            " [efron1987]"
        ),
    )
    ranking = _named(
        "ranking",
        (
            "Ranks with their intervals, and letters of groups: models without a common letter differ"
            " [mogstad2024]"
        ),
    )
    significance = _named(
        "significance",
        (
            "Every pair of models: paired differences, signed-rank tests [wilcoxon1945], corrected for all"
            " pairs [holm1979]"
        ),
    )
    agreement = _named("ranking_agreement", "Agreement of the rankings by two metrics [kendall1945]")
    per_class = _named("per_class", "Means and intervals by class of the items")
    human_share = _named("human_share", "Scores on the scale from chance to human performance; requires HS")
    power = _named("power", "Detectable differences, and units to detect the observed ones [cohen1988]")
    chance = _named("chance", "Metrics by which chance or a constant map reaches a model")
    human_curve = _named("human_curve", "Prediction of n participants by n others")
    human_curve_by_mesh = _named("human_curve_by_mesh", "Same as human_curve, for each mesh")
    human_curve_differences = _named("human_curve_differences", "Gain from more participants")
    human_equivalents = _named(
        "human_equivalents", "Number of participants that a model is worth [tasse2016]"
    )
    human_reliability = _named("human_reliability", "Reliability of the ground truth of all participants")
    smoothing = _named("smoothing", "Scores of smoothed and unsmoothed maps")
    published = _named(
        "published", "Numbers from papers for the same models and data set, beside these means"
    )


def shown(tables: Tables, head: str) -> str:
    """Heading and ranking, for a notebook."""
    columns = [
        column
        for column in ("dataset", "split", "metric", "model", "mean", "rank", "group")
        if column in tables.ranking
    ]
    return f"<pre>{html.escape(head)}</pre>" + str(tables.ranking[columns].to_html(index=False, max_rows=60))
