# SPDX-License-Identifier: GPL-3.0-or-later
"""Numbers from papers beside those measured here: published.csv. They are not ranked, and have no verdict if
the shapes differ."""

from collections.abc import Mapping
from typing import Any

import pandas

from salbench.conclusions import classes
from salbench.conclusions.metrics import label_of
from salbench.conclusions.study import Study, made_once
from salbench.conclusions.tables import (
    CI95,
    DATASET,
    MEAN,
    METRIC,
    MODEL,
    N_SHAPES,
    SPLIT,
    N,
    framed,
    number,
    optional_count,
    text,
)
from salbench.conclusions.words import several

INTERVAL, ROUNDING, NO, OTHERS = "within their interval", "within their rounding", "no", "other shapes"
COLUMNS = (
    DATASET,
    SPLIT,
    text("class", "of the items; empty for all of them"),
    METRIC,
    MODEL,
    N,
    N_SHAPES,
    MEAN,
    *CI95,
    number("reported", "what the paper reports"),
    number("reported_ci95", "half of its 95 % interval; empty if the paper has none"),
    number("rounding", "half a unit of its last digit"),
    optional_count("n_reported", "shapes that it is over; empty if the paper does not say"),
    number("difference", "mean - reported"),
    text(
        "agrees",
        (
            f'"{INTERVAL}", "{ROUNDING}", "{NO}"; "{OTHERS}": over others, or over shapes that the paper does'
            ' not count, so that there is no verdict'
        ),
    ),
    text("paper", "its key in the bibliography"),
    text("table", 'of the paper; "release": of the scores released with it'),
    text("page", "of the paper; empty if not known"),
    text("first_hand", '"yes", or "no" of a number that was read elsewhere'),
    text("remark", "on the number"),
)

_SLACK = 1e-9  # for differences as large as the interval
_OURS = ("n", "n_shapes", "mean", "ci95_low", "ci95_high")
_MEANS = ("mean", "means")
_KEY = ["dataset", "split", "class", "metric", "model"]


@made_once
def published(study: Study) -> pandas.DataFrame:
    """A row per number of `configs/published` for a model, metric and data set of this run, if its ground
    truth is the published one and its metrics preprocess maps like the paper's; none for the paper's other
    models."""
    assert study.published is not None
    found = study.published.merge(_ours(study), on=_KEY, suffixes=("", "_units"))
    found["agrees"] = [verdict(row["mean"], row["n_shapes"], row) for row in found.to_dict("records")]
    found["difference"] = found["mean"] - found["value"]
    found = found.rename(
        columns={"value": "reported", "ci95": "reported_ci95", "n": "n_reported", "n_units": "n"}
    )
    return framed(COLUMNS, [dict(found)], study.in_splits)


def verdict(mean: float, n_shapes: float, row: Mapping[str, Any]) -> str:
    """Verdict on our mean against a row of papers.reported()."""
    if n_shapes != row["n"]:
        return OTHERS
    difference = abs(mean - row["value"]) - _SLACK
    return INTERVAL if difference <= row["ci95"] else ROUNDING if difference <= row["rounding"] else NO


def _ours(study: Study) -> pandas.DataFrame:
    """Our means of all shapes, and of each class with scores."""
    whole = study.estimates.assign(**{"class": ""})
    known = (
        [whole, classes.per_class(study)]
        if study.published is not None and study.published["class"].any()
        else [whole]
    )
    frames = [(frame if "split" in frame else frame.assign(split=""))[[*_KEY, *_OURS]] for frame in known]
    return pandas.concat([frame[frame["n"] > 0] for frame in frames], ignore_index=True)


def beside(study: Study, dataset: str, split: str = "") -> list[dict[str, Any]]:
    """Selects reported numbers for a data set and split, for models with and without scores here, to be shown
    unranked."""
    if study.reported is None:
        return []
    rows = study.reported
    found: list[dict[str, Any]] = rows[
        (rows["dataset"] == dataset) & (rows["split"] == split) & (rows["class"] == "")
    ].to_dict("records")
    return found


def sentences(study: Study) -> list[str]:
    """Counts the means that agree with papers on the same shapes, and names the largest deviation."""
    if study.published is None or (found := published(study)).empty:
        return []
    judged = found[found["agrees"] != OTHERS]
    n_others = len(found) - len(judged)
    if judged.empty:
        return [
            f"Papers report {several(n_others, *_MEANS)} of these models, of other shapes, which cannot be"
            " compared: published.csv has both."
        ]
    counts = judged["agrees"].value_counts()
    farthest = judged.loc[judged["difference"].abs().idxmax()].to_dict()
    said = (
        f"Of {several(len(judged), *_MEANS)} that papers report of these shapes, {counts.get(INTERVAL, 0)} of"
        f" ours lie within their interval and {counts.get(ROUNDING, 0)} within their rounding; the largest"
        f" difference is {_farthest(farthest)}."
    )
    return [said + (f" {n_others} more are of other shapes, which cannot be compared." if n_others else "")]


def _farthest(row: Mapping[str, Any]) -> str:
    """Describes a deviation, such as "-0.061 (AUC of MS on meshes of class spring)"."""
    of = (
        f" of class {row['class']}"
        if row["class"]
        else f" of split {row['split']}"
        if row.get("split")
        else ""
    )
    return f"{row['difference']:+.3f} ({label_of(row['metric'])} of {row['model']} on {row['dataset']}{of})"
