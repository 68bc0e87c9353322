# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables: a record per column, frames with these columns and types for any rows, and their text."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas

from salbench.system import console
from salbench.system.csv import REMARKS, joined

DIGITS = 10  # significant, in every file


@dataclass(frozen=True)
class Column:
    """A column of a table. `type` is the frame's; "Int64" allows empty cells, "int64" does not."""

    name: str
    type: str  # "str", "int64", "Int64" or "float64"
    meaning: str


def text(name: str, meaning: str) -> Column:
    return Column(name, "str", meaning)


def count(name: str, meaning: str) -> Column:
    return Column(name, "int64", meaning)


def optional_count(name: str, meaning: str) -> Column:
    return Column(name, "Int64", meaning)


def number(name: str, meaning: str) -> Column:
    return Column(name, "float64", meaning)


DATASET = text("dataset", '"meshes", "scans" or "clouds"')
# only in tables of items that have splits
SPLIT = text("split", "of the data set; empty for all of them together")
METRIC = text("metric", "name of the metric")
MODEL = text("model", "name of the model")
N = count("n", "units that the row is over")
N_SHAPES = count("n_shapes", "shapes in these units")
MEAN = number("mean", "mean over the units")
CI95 = (number("ci95_low", "95 % interval, lower end"), number("ci95_high", "95 % interval, upper end"))

SHARED = (DATASET, SPLIT, METRIC, MODEL, N, N_SHAPES, MEAN, *CI95)

Part = Mapping[str, Any]  # some rows: a list or array per column, or one value for all rows


def framed(columns: Sequence[Column], parts: Iterable[Part], in_splits: bool = True) -> pandas.DataFrame:
    """Concatenates the rows of all parts. Without splits the column `split` is left out."""
    return stacked({column.name: column.type for column in columns if in_splits or column != SPLIT}, parts)


def stacked(types: Mapping[str, str], parts: Iterable[Part]) -> pandas.DataFrame:
    """Concatenates the rows of all parts, in columns of these names and types."""
    pieces: dict[str, list[Any]] = {name: [] for name in types}
    for part in parts:
        n = max((len(values) for values in part.values() if _is_list(values)), default=1)
        for name in types:
            pieces[name].append(part[name] if _is_list(part[name]) else [part[name]] * n)
    return pandas.DataFrame({name: _typed(pieces[name], type) for name, type in types.items()})


def _is_list(values: Any) -> bool:
    return isinstance(values, (list, tuple, np.ndarray, pandas.Series))


def _typed(pieces: list[Any], type: str) -> Any:
    if type == "str":
        return pandas.Series([str(value) for piece in pieces for value in piece], dtype=object)
    values = np.concatenate([np.asarray(piece, dtype=float) for piece in pieces]) if pieces else np.empty(0)
    return pandas.Series(values).astype(type)  # NaN is an empty cell of "Int64", and an error in "int64"


def of_all(frame: pandas.DataFrame) -> pandas.DataFrame:
    """Rows over all items of each data set: several splits have rows of their own, too."""
    if "split" not in frame:
        return frame
    of_set = frame.groupby(frame["dataset"]) if "dataset" in frame else frame.groupby(lambda _: "")
    is_only = of_set["split"].transform("nunique") == 1
    return frame[is_only | (frame["split"] == "")]


def texts(frame: pandas.DataFrame) -> pandas.DataFrame:
    """Cells as in a file: empty if unknown."""

    def of(values: pandas.Series) -> list[str]:
        if values.dtype == np.float64:
            return ["" if value != value else f"{value:.{DIGITS}g}" for value in values.to_list()]
        return ["" if value is pandas.NA else str(value) for value in values.to_list()]

    return pandas.DataFrame({name: of(frame[name]) for name in frame}, columns=frame.columns)


def of_truth(remarks: Iterable[str]) -> list[str]:
    """Selects the remarks on the kind of ground truth, which readers must see."""
    return [remark for remark in remarks if remark.startswith(("SIMULATED", "TRUTH"))]


def csv(frame: pandas.DataFrame, remarks: Sequence[str] = ()) -> str:
    """Text by RFC 4180, with the remarks in a last column of each row."""
    if remarks:
        frame = frame.assign(**{REMARKS: joined(remarks)})
    text: str = frame.to_csv(index=False, float_format=f"%.{DIGITS}g", lineterminator="\n")
    return text


def records(frame: pandas.DataFrame) -> list[dict[str, str]]:
    """Rows for JSON documents: every cell as text."""
    rows: list[dict[str, str]] = texts(frame).to_dict("records")
    return rows


def aligned(frame: pandas.DataFrame) -> str:
    """Table for the console; empty cells stay empty."""
    rows = [["" if value is pandas.NA else value for value in row] for row in frame.itertuples(index=False)]
    return console.aligned(list(frame), rows)
