# SPDX-License-Identifier: GPL-3.0-or-later
"""How many units an interval or a test is over, and how many shapes there are in them: "19 meshes, 228 scans"."""

from salbench.pages.blocks import Cell
from salbench.pages.names import KIND_NAMES, several
from salbench.report.results import Results

HEAD = "n"


def counted(unit: str, dataset: str, n: float, n_shapes: float) -> str:
    """unit: "mesh", "class", "shape", or empty where it is not known. NaN is a number that the table does not have."""
    if n != n:
        return "–"
    shape = KIND_NAMES.get(dataset, "shape")
    whole = "point cloud" if dataset == "clouds" else "mesh"
    name = {"mesh": whole, "class": "class", "shape": shape}.get(unit, shape if n == n_shapes else "unit")
    text = several(n, name)
    return text if n_shapes != n_shapes or name == shape else f"{text}, {several(n_shapes, shape)}"


def count_cell(results: Results, dataset: str, n: float, n_shapes: float, within_class: bool = False) -> Cell:
    """Cell of a column of numbers of units. Within a class the meshes are the units where else the classes are."""
    if n != n:
        return Cell("–", "")
    unit = "mesh" if within_class and results.unit == "class" else results.unit
    return Cell(counted(unit, dataset, n, n_shapes), int(n))
