# SPDX-License-Identifier: GPL-3.0-or-later
"""Numbers from papers: beside our means if the shapes are the same, otherwise in a separate table; in grey,
with source, and never ranked. conclusions/papers.py has the numbers."""

from salbench.conclusions.published import INTERVAL, NO, OTHERS, ROUNDING, verdict
from salbench.pages.blocks import Block, Cell, Note, cell, signed
from salbench.pages.columns import Column
from salbench.pages.names import several
from salbench.pages.reported import WORDS, apart, value
from salbench.report import statistics
from salbench.report.report import Report
from salbench.report.results import Row, Shown

HEAD = "Reported"
KEY = ["paper", "dataset", "class", "metric", "model"]  # identifies a number
CAPTION = (
    f" {WORDS}, in grey ({{}}): what papers say of the same model, data set and metric; below it the"
    " difference of ours, and whether that is within their interval or rounding."
)


def rows(results: Shown, dataset: str, metric: str, of_class: str = "") -> list[Row]:
    """Rows over all shapes of the tables, or over one class."""
    return (
        results.reported.get((dataset, results.split_of(dataset), of_class, metric), [])
        if results.reported
        else []
    )


def beside(results: Shown, ours: Row, of_class: str = "") -> Row | None:
    """Row of a paper for the same model and shapes as one of ours; None if there is none."""
    return next(
        (
            row
            for row in rows(results, ours["dataset"], ours["metric"], of_class)
            if row["model"] == ours["model"] and verdict(ours["mean"], ours["n_shapes"], row) != OTHERS
        ),
        None,
    )


def others(report: Report) -> list[Block]:
    """Tables of numbers without a mean beside them: other shapes, or models that were not run."""
    results = report.results
    table = results.table("published")
    judged = set(table.loc[table["agrees"] != OTHERS, KEY].itertuples(index=False, name=None))
    found = [
        row
        for dataset in statistics.shown(results)
        for (of, split, _, metric), known in results.reported.items()
        if of == dataset and split == results.split_of(dataset) and metric in results.metrics
        for row in known
        if tuple(map(row.get, KEY)) not in judged
        and row["model"] in (results.wanted_models or [row["model"]])
    ]
    return [
        (
            apart("reported", found)
            if found
            else Note("All numbers that papers report of this data set stand beside the means.")
        )
    ]


def column(results: Shown) -> Column:
    """Column beside our means."""

    def show(ours: Row) -> Cell:
        row = beside(results, ours)
        if row is None:
            return cell(None)
        agrees = verdict(ours["mean"], ours["n_shapes"], row)
        return value(
            row,
            f"{signed(ours['mean'] - row['value']).text}, {'outside' if agrees == NO else agrees}",
            row["paper"],
        )

    return Column(HEAD, show)


def said(results: Shown) -> str:
    """Sentence that counts our agreeing means; empty without any."""
    if not results.has("published"):
        return ""
    counts = results.table("published")["agrees"].value_counts()
    agree, n_others = sum(counts.get(word, 0) for word in (INTERVAL, ROUNDING)), counts.get(OTHERS, 0)
    judged = counts.sum() - n_others
    parts = (
        [
            f"{agree} of {several(judged, 'mean')} over the same shapes lie within the interval or rounding"
            " of papers"
        ]
        if judged
        else []
    )
    parts += (
        [f"papers report {several(n_others, 'mean')} over other shapes, which cannot be compared"]
        if n_others
        else []
    )
    text = "; ".join(parts)
    return f"{text[:1].upper()}{text[1:]}."
