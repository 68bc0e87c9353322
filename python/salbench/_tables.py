# SPDX-License-Identifier: GPL-3.0-or-later
"""The program's tables as data frames: the same doubles, and names as texts whatever they look like."""

import html
import os
from collections.abc import Callable
from functools import cached_property, partial
from pathlib import Path
from typing import TYPE_CHECKING

from salbench._csv import REMARKS, parted
from salbench._errors import InputError

if TYPE_CHECKING:
    import pandas


def remarks_of(path: str | os.PathLike[str]) -> list[str]:
    """The lines of '#' that run.yaml begins with, and tables of 1.0 did, without the '#'."""
    remarks = []
    with open(path, encoding="utf-8", errors="replace") as file:
        for line in file:
            if not line.startswith("#"):
                break
            remarks.append(line[1:].strip())
    return remarks


def read(path: str | os.PathLike[str], type_of: Callable[[str], str | None] | None = None, errors: str = "surrogateescape") -> "pandas.DataFrame":
    """The one reader of tables that the program or this package has written; conclusions.csv_file reads those of anybody, strictly.

    Texts are as they stand in the file, "" where it has none; numbers are the same doubles, NaN where it has none. type_of: of a column
    by its name, whatever is in it, as conclusions.type_of declares it by default; None: what pandas makes of it. errors: for bytes that
    are not UTF-8. `attrs` has its `remarks`, of which a column is none of the frame's. Throws InputError for what is no such table.
    """
    try:
        import pandas
    except ModuleNotFoundError as error:
        raise ModuleNotFoundError(f"{error}; pip install 'salbench[run]' brings what tables need", name=error.name) from None

    from salbench import conclusions

    type_of = type_of or partial(conclusions.type_of, Path(path).stem)
    heads = remarks_of(path)
    above = len(heads)
    try:
        types = {name: "str" if name == REMARKS else type_of(name) for name in pandas.read_csv(path, skiprows=above, nrows=0, encoding_errors=errors)}
        frame = pandas.read_csv(path, skiprows=above, dtype={name: type for name, type in types.items() if type}, keep_default_na=False,
                                na_values=[""], float_precision="round_trip", encoding_errors=errors)
    except (TypeError, ValueError) as error:  # as pandas raises them
        raise InputError(f"{os.fspath(path)}: {' '.join(str(error).split())}") from None
    frame = frame.fillna(dict.fromkeys((name for name, type in types.items() if type == "str"), ""))
    frame.attrs[REMARKS] = list(dict.fromkeys([*heads, *parted(frame.pop(REMARKS) if REMARKS in frame else ())]))
    return frame


def _named(name: str, meaning: str) -> "cached_property[pandas.DataFrame]":
    made: cached_property[pandas.DataFrame] = cached_property(lambda tables: tables._table(name))
    made.__doc__ = f"{meaning} ({name}.csv)."
    return made


class Tables:
    """The tables that conclusions have, by the names of their files. One that scores give nothing for has its columns and no rows."""

    def _table(self, name: str) -> "pandas.DataFrame":
        raise NotImplementedError

    leaders = _named("leaders", "Who leads by each metric and how sure, and in sentences")
    compact = _named("compact", "Mean, half interval, rank and group of each model by each metric, as a paper has them")
    summary = _named("summary", "Mean of each model by each metric, with its 95 % intervals: Student's, and of the bootstrap by unit [efron1987]")
    ranking = _named("ranking", "Ranks with their intervals, and letters of groups: models without one in common differ [mogstad2024]")
    significance = _named("significance", "Every pair of models: paired differences, signed-rank tests [wilcoxon1945], corrected for all pairs "
                          "[holm1979]")
    agreement = _named("ranking_agreement", "How far the rankings by two metrics agree [kendall1945]")
    per_class = _named("per_class", "Means and intervals by class of the items")
    human_share = _named("human_share", "Scores as a share of what people reach; with the model HS")
    power = _named("power", "Which differences the scores could have shown [cohen1988]")
    chance = _named("chance", "Metrics that do not tell models from chance, or from a constant map")
    human_curve = _named("human_curve", "How well so many participants predict as many others")
    human_curve_by_mesh = _named("human_curve_by_mesh", "The same mesh by mesh")
    human_curve_differences = _named("human_curve_differences", "What more participants add")
    human_equivalents = _named("human_equivalents", "How many participants a model is worth [tasse2016]")
    human_reliability = _named("human_reliability", "How reliable the ground truth of all participants is")
    smoothing = _named("smoothing", "Scores of maps that were smoothed, beside those of the maps as they are")
    published = _named("published", "What papers report of the same models on the same data set, beside these means")


def shown(tables: Tables, head: str) -> str:
    """For a notebook: a head, and the ranking."""
    columns = ["dataset", "metric", "model", "mean", "rank", "group"]
    return f"<pre>{html.escape(head)}</pre>" + str(tables.ranking[columns].to_html(index=False, max_rows=60))
