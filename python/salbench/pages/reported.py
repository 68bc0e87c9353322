# SPDX-License-Identifier: GPL-3.0-or-later
"""Numbers from papers, beside measured means over the same shapes, or in a separate table; in grey, with
source, and not sorted. Rows have the columns of conclusions.papers."""

import math
from collections.abc import Iterable, Mapping
from typing import Any

from salbench.conclusions.metrics import label_of
from salbench.pages.blocks import Cell, Table, count
from salbench.pages.columns import Column, sheet, text
from salbench.pages.names import DATASETS

WORDS = "Reported, not measured"  # heading on every page
WHY = (
    f"{WORDS}: means that papers report over other shapes, or of models that were not run here. Scores differ"
    " from shape to shape, so that these cannot be compared with the means that were measured here, and have"
    " no verdict."
)


def value(row: Mapping[str, Any], below: str = "", further: str = "") -> Cell:
    """Cell with the digits as printed in the paper. Without a key, since these columns do not sort."""
    digits = max(0, round(-math.log10(2 * row["rounding"])))
    after = f"± {row['ci95']:.{digits}f}" if row["ci95"] == row["ci95"] else ""
    return Cell(
        f"{row['value']:.{digits}f}".replace("-", "−"),
        "",
        style="reported",
        after=after,
        below=below,
        further=further,
    )


def apart(identifier: str, rows: Iterable[Mapping[str, Any]]) -> Table:
    """Table of numbers without a mean beside them. rows: of one or several data sets and metrics."""
    shown = sorted(rows, key=lambda row: (row["class"], row["paper"]))
    columns = [
        text("Model", "model"),
        text("Data set", lambda row: DATASETS[row["dataset"]]),
        text("Class", lambda row: row["class"] or "all"),
        text("Metric", lambda row: label_of(row["metric"])),
        Column("Reported", value),
        Column("Shapes", lambda row: Cell("not said", 0) if row["n"] != row["n"] else count(row["n"])),
        text("Source", "source"),
    ]
    return sheet(identifier, WHY, columns, shown, ("Class", "Data set", "Metric"), 1)
