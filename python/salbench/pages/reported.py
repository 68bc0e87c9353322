# SPDX-License-Identifier: GPL-3.0-or-later
"""Numbers that papers report, beside and below those that were measured: in grey, in words, and out of what sorts. Rows have the columns of
conclusions.papers."""

import math
from collections.abc import Container, Iterable, Mapping, Sequence
from typing import Any

from salbench.pages.blocks import Cell, Table, cell

WORDS = "Reported, not measured"  # how every page calls them


def value(row: Mapping[str, Any], below: str = "", further: str = "") -> Cell:
    """Digits as the paper prints them. No key: a column of these numbers does not sort."""
    digits = max(0, round(-math.log10(2 * row["rounding"])))
    after = f"± {row['ci95']:.{digits}f}" if row["ci95"] == row["ci95"] else ""
    return Cell(f"{row['value']:.{digits}f}".replace("-", "−"), "", style="reported", after=after, below=below, further=further)


def add_below(table: Table, known: Iterable[Mapping[str, Any]], metrics: Sequence[str], without: Container[str] = (),
              lead: Sequence[Cell] = (), tail: Sequence[Cell] = ()) -> None:
    """Rows below a table of a model per row and a metric per further column, in the order of the models' names. known: of the data set and
    split of the table. without: models that are left out. lead, tail: cells of columns before and behind those of metrics."""
    rows = {(row["model"], row["paper"], row["metric"]): row for row in sorted(known, key=lambda row: (row["paper"], row["model"]))
            if row["model"] not in without and row["metric"] in metrics}
    over: dict[tuple[str, str], dict[int, None]] = {}  # numbers of shapes, by model and paper
    for (model, paper, _), row in rows.items():
        over.setdefault((model, paper), {}).update({int(row["n"]): None} if row["n"] == row["n"] else {})
    table.below = [[Cell(model, style="reported", after=paper, below=f"over {' or '.join(map(str, of))} shapes" if of else ""), *lead,
                    *(value(rows[model, paper, metric]) if (model, paper, metric) in rows else cell(None) for metric in metrics), *tail]
                   for (model, paper), of in over.items()]
    if rows:
        table.below_head = f"{WORDS}: {'; '.join(dict.fromkeys(row['source'] for row in rows.values()))}"
