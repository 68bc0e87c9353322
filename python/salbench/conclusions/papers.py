# SPDX-License-Identifier: GPL-3.0-or-later
"""What papers report, typed into configs/published/*.csv: numbers that nobody measured here, each with the
place where it stands.

A file per paper, named by its key in docs/bibliography.bib. A row says in the words of run.yaml what a number
is of: `layout` and `score_on` are options of the data set, `metric` is a column of results.csv, `matching`
and `weighting` are how it reads maps. A number whose protocol these words do not name has no row.
"""

import os
from collections.abc import Iterable, Mapping
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pandas

from salbench.conclusions.tables import of_truth
from salbench.system.csv import read_csv

FOLDER = Path(__file__).parent.parent / "configs/published"
LAYOUTS = {"princeton": "schelling", "gs": "schelling"}  # other forms of a data set -> how rows name it
# what a number is of
WHERE = ["model", "layout", "dataset", "split", "class", "metric", "matching", "weighting", "score_on"]
COLUMNS = ("paper", "table", "page", *WHERE, "n", "value", "ci95", "first_hand", "remark")


@cache
def reported() -> pandas.DataFrame:
    """All rows of all papers: COLUMNS as texts, but for n, value and ci95 (half of the 95 % interval), NaN
    where the paper has none; and `rounding`, half a unit of the last digit that is printed, and `source`,
    where the number stands in words.
    """
    return pandas.concat([read(path) for path in sorted(FOLDER.glob("*.csv"))], ignore_index=True)


def read(path: str | os.PathLike[str]) -> pandas.DataFrame:
    """The rows of a file. tests/conclusions/papers_test.py says what is wrong with one."""
    table = read_csv(path, {"n", "ci95"}.__contains__)
    digits = table["value"].str.partition(".")[2].str.len()
    return table[list(COLUMNS)].assign(
        value=table["value"].astype(float),
        rounding=0.5 * 10.0**-digits,
        source=[_source(row) for row in table.to_dict("records")],
    )


def of_run(
    record: Mapping[str, Any], remarks: Iterable[str] = (), rows: pandas.DataFrame | None = None
) -> pandas.DataFrame:
    """Selects the numbers that are of the data set, the ground truth and the metrics of a run, as these
    read maps. record: run.yaml. remarks: of its tables; participants that are simulated, or a ground truth
    that is not the published one, have no number in a paper. rows: all of them, reported() by default."""
    rows = reported() if rows is None else rows
    dataset = record.get("configuration", {}).get("dataset", {})
    if of_truth(remarks) or dataset.get("participants") == "simulated":
        return rows[:0]
    layout = record.get("data_set", {}).get("layout", "")
    metrics = record.get("metrics", {})
    fit = (rows["layout"] == LAYOUTS.get(layout, layout)) & (
        rows["score_on"] == (dataset.get("score_on") or "vertices")
    )
    reads = [
        _reads(metrics.get(row["metric"]), row["matching"], row["weighting"])
        for row in rows.to_dict("records")
    ]
    return rows[fit & np.array(reads, bool)].reset_index(drop=True)


def _reads(metric: Mapping[str, str] | None, matching: str, weighting: str) -> bool:
    """metric: its entry in run.yaml. Where raw maps have a score at all, they have no value below 0, and
    are what `shifted` reads, too."""
    if not metric:
        return False
    readings = ("raw", "shifted") if matching == "raw" else (matching,)
    return metric.get("matching") in readings and (metric.get("weighting") or "equal") == weighting


def _source(row: Mapping[str, Any]) -> str:
    """ "tasse2016, table 2" """
    place = f"table {row['table']}" if row["table"].isdigit() else row["table"]
    if place == "release":
        place = f"its release of {row['n']:.0f} {row['dataset']}"
    page = f", p. {row['page']}" if row["page"] else ""
    return f"{row['paper']}, {place}{page}{'' if row['first_hand'] == 'yes' else ', second-hand'}"
