# SPDX-License-Identifier: GPL-3.0-or-later
"""One table of models and metrics per data set, ready for a paper, as HTML, LaTeX and CSV."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial

from salbench.pages.blocks import Block, Cell, Missing, Note, attempt, mean_cell
from salbench.pages.columns import Column, sheet
from salbench.pages.names import DATASETS, KIND_NAMES, several, spoken
from salbench.report import latex, statistics
from salbench.report.results import Frame, Row, Shown
from salbench.report.units import counted
from salbench.report.report import Report

MOST = 12  # metrics in the table; the page of other metrics has the rest
CAPTION = (
    "{}, {}: mean ± half of its 95 % interval, or its ends where it was cut at the range of the metric{}. HS"
    " and RS, human performance and chance, are references.{}"
)
RANKED = "; best of each metric in bold; letters: two models without one in common differ"


def tables(report: Report) -> list[Block]:
    return [
        block for dataset in statistics.shown(report.results) for block in attempt(table, report, dataset)
    ]


def metrics_of(results: Shown, dataset: str) -> list[str]:
    """The requested metrics, or all if they fit, otherwise the leading ones."""
    known = results.table("compact")
    present = set(known.loc[known["dataset"] == dataset, "metric"])
    if results.wanted_metrics:
        return [name for name in results.leading if name in present]
    found = [name for name in results.metrics if name in present]
    return found if len(found) <= MOST else [name for name in found if name in results.leading]


def table(report: Report, dataset: str) -> list[Block]:
    results = report.results
    metrics = metrics_of(results, dataset)
    if not metrics:
        raise Missing(f"compact.csv has no scores of {spoken(dataset)}.")
    parts = {metric: statistics.compact(results, dataset, metric) for metric in metrics}
    by_cell = {
        (row["model"], metric): row for metric, part in parts.items() for row in part.to_dict("records")
    }
    models = list(
        dict.fromkeys(
            model for part in parts.values() for model in part.loc[part["kind"] == "model", "model"]
        )
    )
    models += [
        model
        for model in report.models
        if model not in models and any((model, metric) in by_cell for metric in metrics)
    ]
    models.sort(key=lambda model: bool(model != results.mine))
    failed = {model: most for model in models if (most := missing(model, metrics, by_cell))}

    def named(model: str) -> Cell:
        mark, tex = (" †", r"\textsuperscript{\dag}") if model in failed else ("", "")
        return Cell(model + mark, key=model, tex=latex.escape(model) + tex)

    def mean(model: str, metric: str) -> Cell:
        row = by_cell.get((model, metric))
        return replace(
            mean_cell(row),
            tex=latex.number(row, 3, row is not None and row["best"] == 1, row["group"] if row else ""),
        )

    columns = [Column("Model", named, numeric=False)]
    columns += [
        Column(of.label, partial(mean, metric=of.name), better="lower" if of.lower else "higher")
        for of in map(results.metric, metrics)
    ]
    over = counted_of(results, dataset, parts)
    are_ranked = any((part["group"] != "").any() for part in parts.values())
    made = sheet(
        f"compact-{dataset}",
        CAPTION.format(DATASETS[dataset], over, RANKED if are_ranked else "", remark(dataset, failed)),
        columns,
        models,
    )
    latex.beside(
        report,
        made,
        [
            (
                f"{spoken(dataset)}, {over}: mean and half of the 95 % interval, or its ends"
                + ("; best in bold; models without a letter in common differ" if are_ranked else "")
            ),
            *(
                rf"\dag: {latex.escape(model)} has no score on {n} shapes; all models are compared on those"
                r" that every one has"
                for model, n in failed.items()
            ),
        ],
    )
    report.folder.write(
        f"data/{made.id}.csv",
        results.table("compact").query("dataset == @dataset").to_csv(index=False, lineterminator="\n"),
    )
    made.files.append(("CSV", f"data/{made.id}.csv"))
    left = [name for name in results.metrics if name not in metrics]
    more = (
        [Note(f"{several(len(left), 'metric')} more: see Other metrics.")]
        if left and len(results.metrics) > MOST
        else []
    )
    return [made, *more]


def counted_of(results: Shown, dataset: str, parts: dict[str, Frame]) -> str:
    """Number of units, per metric if they differ."""
    labels: dict[str, list[str]] = {}
    for metric, rows in parts.items():
        labels.setdefault(
            counted(results.unit, dataset, rows["n"].iloc[0], rows["n_shapes"].iloc[0]), []
        ).append(results.metric(metric).label)
    return (
        next(iter(labels))
        if len(labels) == 1
        else ", ".join(f"{over} ({', '.join(of)})" for over, of in labels.items())
    )


def missing(model: str, metrics: Sequence[str], by_cell: Mapping[tuple[str, str], Row]) -> int:
    """Number of shapes that others have a score for and a competitor has not, maximum over the metrics."""
    rows = [by_cell[model, metric] for metric in metrics if (model, metric) in by_cell]
    return int(
        max(
            (
                row["n_missing"]
                for row in rows
                if row["kind"] == "model" and row["n_missing"] == row["n_missing"]
            ),
            default=0,
        )
    )


def remark(dataset: str, failed: dict[str, int]) -> str:
    if not failed:
        return ""
    kind = KIND_NAMES[dataset]
    each = ", ".join(f"{model} {several(n, kind)}" for model, n in failed.items())
    return f" † has no score on some shapes ({each}): all models are compared on those that every one has."
