# SPDX-License-Identifier: GPL-3.0-or-later
"""Numbers from papers, typed into configs/published/*.csv with their sources; none of them was measured here.

Each file is a paper, named by its key in docs/bibliography.bib. A row describes the protocol of a number in
terms of run.yaml: `layout` and `score_on` are options of the data set, `metric` is a column of results.csv,
`matching` and `weighting` say how maps are preprocessed. Numbers with other protocols have no row.
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
LAYOUTS = {"princeton": "schelling", "gs": "schelling"}  # other layouts of a data set -> layout in the rows
# columns that identify a number
WHERE = ["model", "layout", "dataset", "split", "class", "metric", "matching", "weighting", "score_on"]
COLUMNS = ("paper", "table", "page", *WHERE, "n", "value", "ci95", "first_hand", "remark")


@cache
def reported() -> pandas.DataFrame:
    """All rows of all papers: COLUMNS as texts, except n, value and ci95 (half of the 95 % interval), NaN if
    the paper has none; `rounding`, half a unit of the last printed digit; and `source`, the location in
    words."""
    return pandas.concat([read(path) for path in sorted(FOLDER.glob("*.csv"))], ignore_index=True)


def read(path: str | os.PathLike[str]) -> pandas.DataFrame:
    """Reads the rows of a file. tests/conclusions/papers_test.py checks the files."""
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
    """Selects the numbers for a run's data set, ground truth and metrics with the same preprocessing of maps.
    record: run.yaml. remarks: of its tables; simulated participants, and ground truth that is not the
    published one, match no paper. rows: candidates, reported() by default."""
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
    """True if a metric preprocesses maps this way. metric: its entry in run.yaml. Raw maps that can be scored
    have no value below 0, which equals `shifted`."""
    if not metric:
        return False
    readings = ("raw", "shifted") if matching == "raw" else (matching,)
    return metric.get("matching") in readings and (metric.get("weighting") or "equal") == weighting


def _source(row: Mapping[str, Any]) -> str:
    """Location of a number, such as "tasse2016, table 2"."""
    place = f"table {row['table']}" if row["table"].isdigit() else row["table"]
    if place == "release":
        place = f"its release of {row['n']:.0f} {row['dataset']}"
    page = f", p. {row['page']}" if row["page"] else ""
    return f"{row['paper']}, {place}{page}{'' if row['first_hand'] == 'yes' else ', second-hand'}"
