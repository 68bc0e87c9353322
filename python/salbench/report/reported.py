# SPDX-License-Identifier: GPL-3.0-or-later
"""What papers report beside what this run measured: in grey, with its source, and never ranked. conclusions/papers.py has the numbers."""

import math
from collections.abc import Iterable, Sequence

from salbench.conclusions import papers
from salbench.conclusions.published import INTERVAL, NO, OTHERS, ROUNDING, verdict
from salbench.pages.blocks import Cell, Table, cell, signed
from salbench.pages.columns import Column
from salbench.pages.names import several
from salbench.report.results import Results, Row

WORDS = "Reported, not measured"  # how every page calls them
HEAD = "Reported"
CAPTION = (f" {WORDS}, in grey: what papers say of the same model, data set and metric; below it the difference of ours, whether that is within "
           "their interval or rounding (over other shapes nothing is said), and the source.")


def rows(results: Results, dataset: str, metric: str, of_class: str = "") -> list[Row]:
    """Of all shapes that the tables are over, or of a class of them."""
    return results.reported.get((dataset, results.split_of(dataset), of_class, metric), []) if results.reported else []


def value(row: Row, below: str = "", further: str = "") -> Cell:
    """Digits as the paper prints them. No key: a column of these numbers does not sort."""
    digits = max(0, round(-math.log10(2 * row["rounding"])))
    after = f"± {row['ci95']:.{digits}f}" if row["ci95"] == row["ci95"] else ""
    return Cell(f"{row['value']:.{digits}f}".replace("-", "−"), "", style="reported", after=after, below=below, further=further)


def beside(results: Results, ours: Row, of_class: str = "") -> Row | None:
    """What a paper reports of the model of a row; None if none does."""
    return next((row for row in rows(results, ours["dataset"], ours["metric"], of_class) if row["model"] == ours["model"]), None)


def column(results: Results) -> Column:
    """Beside a column of our means."""
    def show(ours: Row) -> Cell:
        row = beside(results, ours)
        if row is None:
            return cell(None)
        agrees = verdict(ours["mean"], ours["n_shapes"], row)
        return value(row, f"{signed(ours['mean'] - row['value']).text}, {'outside' if agrees == NO else agrees}", papers.source(row))
    return Column(HEAD, show)


def add_others(table: Table, known: Iterable[Row], metrics: Sequence[str]) -> None:
    """Below a table of a model per row and a metric per further column, models that it has not: in grey, and out of what sorts. known: what
    papers report of its data set and split."""
    there = {str(row[0].key or row[0].text) for row in table.rows}
    rest = {(row["model"], row["paper"], row["metric"]): row for row in known if row["model"] not in there and row["metric"] in metrics}
    table.below = [[Cell(model, style="reported", after=paper),
                    *(value(rest[model, paper, metric]) if (model, paper, metric) in rest else cell(None) for metric in metrics)]
                   for model, paper in dict.fromkeys(key[:2] for key in rest)]
    if rest:
        table.caption += f" Below, in grey: {WORDS.lower()} ({'; '.join(dict.fromkeys(map(papers.source, rest.values())))})."


def said(results: Results) -> str:
    """How many of our means agree, in a sentence; empty if there are none."""
    if not results.has("published"):
        return ""
    counts = results.table("published")["agrees"].value_counts()
    agree, n_others = sum(counts.get(word, 0) for word in (INTERVAL, ROUNDING)), counts.get(OTHERS, 0)
    judged = counts.sum() - n_others
    parts = [f"{agree} of {several(judged, 'mean')} over the same shapes lie within the interval or rounding of papers"] if judged else []
    parts += [f"{several(n_others, 'mean')} of papers are over other shapes, without a verdict"] if n_others else []
    return "; ".join(parts) + "."
