# SPDX-License-Identifier: GPL-3.0-or-later
"""Statements of a text about pairs of models, beside what scores say: statements.csv.

Each pair is judged twice: by the paper's rank-sum test over shapes, where what is not significant is no difference, and by intervals
over units, where sameness has to be shown: two models are the same if the 90 % interval lies within a margin [schuirmann1987]
[lakens2017].
"""

import os
from collections.abc import Iterator
from itertools import product

import numpy as np
import pandas

from salbench.conclusions.csv_file import fail, read_csv, require
from salbench.conclusions.samples import LEVEL
from salbench.conclusions.study import Study
from salbench.conclusions.tables import CI95, DATASET, METRIC, N, N_SHAPES, Part, framed, number, text
from salbench.conclusions.units import DATASETS

RELATIONS = ("above", "same", "differ")  # a is better than b; the two do not differ; they differ

COLUMNS = (
    text("section", "of the text"), text("claim", "what it says"), text("word", "how it puts it"), DATASET, METRIC,
    text("check", "above: a is better than b; same: the two do not differ; differ: they differ"), text("model_a", "first model"),
    text("model_b", "second model"), N_SHAPES, number("rank_sum_z", "the paper's rank-sum test, over all shapes of each model"),
    number("rank_sum_p", "two-sided p"), text("by_shapes", "whether the rank-sum test over shapes, at 0.05, says what the text does: holds, does not hold. \"same\" is what it does not reject"), N,
    number("mean_difference", "mean over the units of a - b"), *CI95, number("ci90_low", "90 % interval, lower end"),
    number("ci90_high", "upper end"), number("margin", "differences below it count as none; empty: none is given"),
    text("by_units", "whether the paired intervals do: holds, does not hold, undecided (`docs/statistics.md`, verdicts)"),
    number("signed_rank_p_holm", "signed-rank test, after Holm's correction over all pairs of the data set and metric"))

_CELLS = ("n", "n_shapes", "mean_difference", "ci95_low", "ci95_high", "ci90_low", "ci90_high", "rank_sum_z", "rank_sum_p", "signed_rank_p_holm")
_REVERSED = {"ci95_low": "ci95_high", "ci95_high": "ci95_low", "ci90_low": "ci90_high", "ci90_high": "ci90_low"}
_HOLDS, _DOES_NOT, _UNDECIDED = "holds", "does not hold", "undecided"


def read_statements(path: str | os.PathLike[str]) -> pandas.DataFrame:
    """The statements about pairs in a CSV file like configs/paper/claims.csv: columns section, claim, word, dataset, metric, check, a, b,
    margin; rows with another check, and those without a word, are left out.

    Throws InputError with the line of a data set that there is none of, or of a margin that is not above 0.
    """
    table = read_csv(path, {"margin"})
    columns = ["section", "claim", "word", "dataset", "metric", "check", "a", "b", "margin"]
    require(table, *columns)
    said = table["check"].isin(RELATIONS) & (table["word"] != "")
    for row in np.flatnonzero(said & (~table["dataset"].isin(DATASETS) | (table["margin"] <= 0)))[:1]:
        dataset, margin = table[["dataset", "margin"]].iloc[row]
        fail(table, row, f"margin {margin:g}, expected above 0" if dataset in DATASETS else f"data set '{dataset}', expected one of {', '.join(DATASETS)}")
    return table.loc[said, columns].reset_index(drop=True)


def statements(study: Study) -> pandas.DataFrame:
    """A row per statement and pair of models that it compares, of `salbench conclude --statements`; empty cells where a model has no scores.
    `section`, `claim`, `word`, `check` and `margin` are those of the file of statements."""
    if study.claims is None:
        raise LookupError("no statements")
    return framed(COLUMNS, _rows(study, study.claims))


def _rows(study: Study, claims: pandas.DataFrame) -> Iterator[Part]:
    whole = study.pairs[study.pairs["level"].isin({level.dataset: number for number, level in reversed([*enumerate(study.levels)])}.values())]
    metrics = {metric.name: metric for metric in study.scores.metrics}
    datasets = {level.dataset for level in study.levels}
    for said in claims.to_dict("records"):
        if said["dataset"] not in datasets or said["metric"] not in metrics:
            continue
        pairs = whole[(whole["dataset"] == said["dataset"]) & (whole["metric"] == said["metric"])].set_index(["model_a", "model_b"])
        for a, b in product(said["a"].split(), said["b"].split()):
            found = _pair(pairs, a, b)
            told = {name: said[name] for name in ("section", "claim", "word", "dataset", "metric", "check", "margin")}
            yield {**told, "model_a": a, "model_b": b, **found,
                   **_verdicts(said["check"], said["margin"], found, metrics[said["metric"]].higher_is_better)}


def _pair(pairs: pandas.DataFrame, a: str, b: str) -> dict[str, float]:
    """What the scores say of a - b; the pair may be known as b - a."""
    if (a, b) in pairs.index:
        return dict(pairs.loc[a, b][list(_CELLS)])
    if (b, a) not in pairs.index:
        return dict.fromkeys(_CELLS, np.nan) | {"n": 0, "n_shapes": 0}
    found = dict(pairs.loc[b, a][list(_CELLS)])
    return found | {name: -found[_REVERSED.get(name, name)] for name in ("mean_difference", "rank_sum_z", *_REVERSED)}


def _verdicts(relation: str, margin: float, found: dict[str, float], higher_is_better: bool) -> dict[str, str]:
    return {"by_shapes": _by_shapes(relation, found["rank_sum_z"], found["rank_sum_p"], higher_is_better),
            "by_units": _by_units(relation, margin, found, higher_is_better)}


def _by_shapes(relation: str, z: float, p: float, higher_is_better: bool) -> str:
    """As the paper reads its test: what is not significant is no difference."""
    if np.isnan(p):
        return ""
    significant, better = p < LEVEL, z > 0 if higher_is_better else z < 0
    holds = {"above": significant and better, "same": not significant, "differ": significant}[relation]
    return _HOLDS if holds else _DOES_NOT


def _by_units(relation: str, margin: float, found: dict[str, float], higher_is_better: bool) -> str:
    if found["n"] < 2:
        return ""
    above, below = found["ci95_low"] > 0, found["ci95_high"] < 0
    if relation == "above":
        return _UNDECIDED if not (above or below) else _HOLDS if above == higher_is_better else _DOES_NOT
    equivalent = -margin < found["ci90_low"] and found["ci90_high"] < margin
    if not (equivalent or above or below):
        return _UNDECIDED
    holds = equivalent if relation == "same" else above or below
    return _HOLDS if holds else _DOES_NOT
