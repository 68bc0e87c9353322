# SPDX-License-Identifier: GPL-3.0-or-later
"""First columns of statistics tables: the number of units behind an interval or a test, and of shapes in
them: "19 meshes, 228 scans"."""

from salbench.pages.blocks import Cell
from salbench.pages.columns import Column, text
from salbench.pages.names import DATASETS, KIND_NAMES, several
from salbench.report.results import Shown

MODEL = text("Model", "model")
DATA_SET = text("Data set", lambda row: DATASETS.get(row["dataset"], row["dataset"]))
OF_A_METRIC = ("Data set", "Metric")  # menus with one selected value each


def metric_of(results: Shown) -> Column:
    return text("Metric", lambda row: results.metric(row["metric"]).label)


def n_of(results: Shown, within_class: bool = False) -> Column:
    """Column for rows with data set, n and n_shapes. Within a class, meshes are the units even if classes are
    otherwise."""
    unit = "mesh" if within_class and results.unit == "class" else results.unit
    return Column(
        "n",
        lambda row: (
            Cell("–", "")
            if row["n"] != row["n"]
            else Cell(counted(unit, row["dataset"], row["n"], row["n_shapes"]), int(row["n"]))
        ),
    )


def counted(unit: str, dataset: str, n: float, n_shapes: float) -> str:
    """Text for a number of units. unit: "mesh", "class", "shape", or empty if unknown. NaN: not in the
    table."""
    if n != n:
        return "–"
    shape = KIND_NAMES.get(dataset, "shape")
    whole = "point cloud" if dataset == "clouds" else "mesh"
    name = {"mesh": whole, "class": "class", "shape": shape}.get(unit, shape if n == n_shapes else "unit")
    text = several(n, name)
    return text if n_shapes != n_shapes or name == shape else f"{text}, {several(n_shapes, shape)}"
