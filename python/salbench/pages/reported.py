# SPDX-License-Identifier: GPL-3.0-or-later
"""Numbers that papers report, beside those that were measured over the same shapes, all others in a table
of their own: in grey, in words, and out of what sorts. Rows have the columns of conclusions.papers."""

import math
from collections.abc import Iterable, Mapping
from typing import Any

from salbench.conclusions.metrics import label_of
from salbench.pages.blocks import Cell, Table, count
from salbench.pages.columns import Column, sheet, text
from salbench.pages.names import DATASETS

WORDS = "Reported, not measured"  # how every page calls them
WHY = (
    f"{WORDS}: means that papers report over other shapes, or of models that were not run here. Scores differ"
    " from shape to shape, so that these cannot be compared with the means that were measured here, and have"
    " no verdict."
)


def value(row: Mapping[str, Any], below: str = "", further: str = "") -> Cell:
    """Digits as the paper prints them. No key: a column of these numbers does not sort."""
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
    """A table of numbers that stand beside no mean. rows: of one or several data sets and metrics."""
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
