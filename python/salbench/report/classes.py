# SPDX-License-Identifier: GPL-3.0-or-later
"""Performance per class: the paper's table 2, and the same for every other metric."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

from salbench.pages.blocks import Block, Cell, Missing, Table, attempt, cell, signed, spread
from salbench.pages.columns import Column, sheet, text
from salbench.pages.names import spoken
from salbench.pages.reported import WORDS, value
from salbench.report import latex, reported, statistics
from salbench.report.metrics import Metric
from salbench.report.results import Row, Shown
from salbench.report.units import n_of
from salbench.report.report import Report

FEW = 5  # minimum units of a class for bold means: smaller samples are unreliable
CAPTION = (
    "{} per class on {}: mean, and from three meshes on half of its 95 % interval, or the ends where it"
    f" was cut at the range of the metric; best in bold in classes of at least {FEW} meshes{{}}."
)
# minimum units for intervals: with two, an interval is as wide as the range of the metric
FEWEST = 3
ALL = "Avg"  # the mean over the competitors, shown beside models


def are_known(report: Report) -> bool:
    return not report.results.has("results") or any(statistics.classes(report.results).values())


@dataclass
class Line:
    """A class under one metric."""

    dataset: str
    name: str
    metric: Metric
    rows: dict[str, Row]  # rows of per_class.csv, by model

    @cached_property
    def best(self) -> set[str]:
        return self.metric.best(
            {model: row["mean"] for model, row in self.rows.items() if model != ALL and row["n"] >= FEW}
        )

    @property
    def n(self) -> Row:
        """Row with units and shapes: of the model that has most."""
        known = [(row["n"], row["n_shapes"]) for model, row in self.rows.items() if model != ALL]
        n, n_shapes = max(known) if known else (float("nan"),) * 2
        return {"dataset": self.dataset, "n": n, "n_shapes": n_shapes}


def lines_of(results: Shown, dataset: str, metric: str) -> list[Line]:
    found: dict[str, dict[str, Row]] = {}
    for row in statistics.per_class(results, dataset, metric).to_dict("records"):
        found.setdefault(row["class"], {})[row["model"]] = row
    return [Line(dataset, name, results.metric(metric), rows) for name, rows in found.items()]


def columns_of(results: Shown, average: str, models: Sequence[str]) -> list[Column]:
    n = n_of(results, within_class=True)

    def of(model: str, head: str) -> Column:
        return Column(
            head,
            lambda line: class_cell(line.rows.get(model), of_paper(results, line, model), model in line.best),
        )

    return [
        Column(n.head, lambda line: n.show(line.n)),
        of(ALL, average),
        *(of(model, model) for model in models),
    ]


def of_paper(results: Shown, line: Line, model: str) -> str:
    """Text below a mean: the number that a paper reports for the model and class, and the difference:
    "reported 0.56 ± 0.01, +0.02"."""
    ours = line.rows.get(model)
    row = reported.beside(results, ours, line.name) if ours else None
    if ours is None or row is None:
        return ""
    shown = value(row)
    return (
        f"{reported.HEAD.lower()} {shown.text} {shown.after}, {signed(ours['mean'] - row['value'], 2).text}"
    )


def class_cell(row: Row | None, below: str, bold: bool) -> Cell:
    if row is None or row["mean"] != row["mean"]:
        return cell(None, tex="--")
    shown = row if row["n"] >= FEWEST else {**row, **dict.fromkeys(("half", "low", "high"), float("nan"))}
    return cell(row["mean"], bold=bold, after=spread(shown), below=below, tex=latex.number(shown, 2, bold))


def class_of(line: Line) -> Cell:
    return Cell(name := line.name or "(no class)", tex=rf"\emph{{{latex.escape(name)}}}")


def per_class(report: Report, dataset: str, metric: str) -> Table:
    """Table of classes by models, hardest class first; below each of our means a paper's number, and the
    difference."""
    of = report.results.metric(metric)
    lines = lines_of(report.results, dataset, metric)
    models = [model for model in report.models if any(model in line.rows for line in lines)]
    average: dict[str, float] = {line.name: line.rows[ALL]["mean"] for line in lines if ALL in line.rows}
    lines.sort(key=lambda line: average.get(line.name, 0.0), reverse=not of.lower)
    known = [
        row
        for line in lines
        for ours in line.rows.values()
        if line.name and (row := reported.beside(report.results, ours, line.name))
    ]
    columns = [
        Column("Class", class_of, numeric=False),
        *columns_of(report.results, f"{ALL}-{of.label}", models),
    ]
    identifier = f"classes-{dataset}-{report.metric_files[metric]}"
    sources = ", ".join(dict.fromkeys(row["source"] for row in known))
    remark = f"; below, {WORDS.lower()}: what papers say ({sources}), and the difference" if known else ""
    made = sheet(identifier, CAPTION.format(of.label, spoken(dataset), remark), columns, lines)
    return latex.beside(
        report,
        made,
        [f"{of.label} per class on {dataset}: mean and half of the 95 % interval, or its ends"],
        without=["n"],
    )


def tables(report: Report, dataset: str) -> list[Block]:
    return [
        block for metric in report.results.leading for block in attempt(per_class, report, dataset, metric)
    ]


def by_metric(report: Report, dataset: str, metrics: Sequence[str]) -> Table:
    """One table for many metrics, of which one is shown at a time."""
    lines: list[Line] = []
    for name in metrics:
        try:
            lines += lines_of(report.results, dataset, name)
        except Missing:
            continue
    if not lines:
        raise Missing(f"There are no scores of {spoken(dataset)} by class.")
    columns = [
        Column("Class", class_of, numeric=False),
        text("Metric", lambda line: line.metric.label),
        *columns_of(report.results, ALL, report.models),
    ]
    return sheet(
        f"classes-{dataset}-others",
        CAPTION.format("Mean", spoken(dataset), ""),
        columns,
        lines,
        ["Metric"],
        1,
    )
