# SPDX-License-Identifier: GPL-3.0-or-later
"""The table of all shapes. Its thousands of rows are in a script, and the page renders some at a time."""

import json
from typing import Any

from salbench.conclusions.words import NO_SCORES
from salbench.pages.blocks import Missing
from salbench.pages.names import DATASETS
from salbench.report import shape_pages, statistics
from salbench.report.report import Page, Report


def rounded(value: float) -> float | None:
    """Rounds to five digits, which suffice for readers and keep the file small; undefined becomes null."""
    return round(float(value), 5) if value == value else None


def script_of(name: str, value: Any) -> str:
    """JSON as a script, which a page opened from disk may load."""
    return f"{name} = {json.dumps(value, separators=(',', ':'), ensure_ascii=True)};\n"


def all_scores(report: Report) -> dict[str, Any]:
    """Dict {models, metrics, lower, shapes: [[data set, item, class, view, page]], scores: {metric: [[a value
    per model] per shape]}}."""
    results, class_of = report.results, statistics.classes(report.results)
    metrics = [name for name in results.metrics if name in results.table("results")]
    shapes: list[list[str]] = []
    scores: dict[str, list[list[float | None]]] = {metric: [] for metric in metrics}
    for dataset in statistics.datasets(results) if metrics else ():
        for metric in metrics:
            wide = statistics.scores(results, dataset, metric).reindex(columns=report.models)
            scores[metric] += [[rounded(value) for value in row] for row in wide.to_numpy()]
        shapes += [
            [DATASETS[dataset], item, class_of.get(item, ""), view, report.page_of(item)]
            for item, view in wide.index
        ]
    if not shapes:
        raise Missing(NO_SCORES)
    return {
        "models": report.models,
        "metrics": {metric: results.metric(metric).label for metric in metrics},
        "lower": [metric for metric in metrics if results.metric(metric).lower],
        "shapes": shapes,
        "scores": scores,
    }


def write_page(report: Report, page: Page) -> None:
    """Writes the page of all scores, with its data as data/scores.js and further scripts. Without scores the
    page says so."""
    for item, category in report.items.items():
        shape_pages.write_page(report, item, category)
    try:
        table, missing = all_scores(report), ""
    except Missing as reason:
        table, missing = {}, str(reason)
    if table:
        table["titles"] = {model: report.titles[model] for model in table["models"] if model in report.titles}
        write_scripts(report, table)
    rows = table.get("shapes", [])
    report.write_page(
        page.path,
        "scores.html",
        title="Scores",
        missing=missing,
        table=table,
        classes=sorted({row[2] for row in rows}),
        sets=list(dict.fromkeys(row[0] for row in rows)),
        shapes={item: report.page_of(item) for item in report.items},
    )


def write_scripts(report: Report, table: dict[str, Any]) -> None:
    """Writes the leading metrics into the main script, and each other one into its own, which the page loads
    on demand."""
    later = [metric for metric in table["scores"] if metric not in report.results.leading]
    table["files"] = {metric: f"data/scores-{report.metric_files[metric]}.js" for metric in later}
    for metric, path in table["files"].items():
        report.folder.write(
            path, script_of(f"salbench.scores.scores[{json.dumps(metric)}]", table["scores"].pop(metric))
        )
    report.folder.write("data/scores.js", script_of("salbench.scores", table))
