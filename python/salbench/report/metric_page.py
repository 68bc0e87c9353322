# SPDX-License-Identifier: GPL-3.0-or-later
"""The page of all metrics of a run: their descriptions, and the tables that the other pages leave out, for
one metric of the reader's choice."""

from salbench.pages.blocks import Block, Table, attempt
from salbench.pages.columns import sheet, text
from salbench.pages.names import spoken
from salbench.report import classes, people, ranking, statistics, tables
from salbench.report.report import Page, Report


def others(report: Report) -> list[str]:
    return [name for name in report.results.metrics if name not in report.results.leading]


def write_page(report: Report, page: Page) -> None:
    results = report.results
    report.write_page(
        page.path,
        "metrics.html",
        title=page.label,
        sections=blocks(report),
        leading=", ".join(of.label for of in results.leading.values()),
        labels=[results.metric(name).label for name in others(report)],
    )


def blocks(report: Report) -> list[tuple[str, list[Block]]]:
    """Pairs (title, blocks), one per section."""
    left = others(report)
    return [
        ("Ranking", attempt(ranking.table, report, "ranking-others", left) + ranking.chance(report, left)),
        ("Means", attempt(means, report)),
        *(
            (f"Performance per class on {spoken(dataset)}", attempt(classes.by_metric, report, dataset, left))
            for dataset in statistics.shown(report.results)
        ),
        ("How many participants a model is worth", attempt(people.worth, report, "worth-others", left)),
        ("Pairwise tests", attempt(pairs, report)),
        ("Every metric of the run", [listing(report)]),
    ]


def listing(report: Report) -> Table:
    columns = [
        text("Metric", lambda of: of.label),
        text("Column", lambda of: of.name),
        text("Unit", lambda of: of.unit),
        text("Better", lambda of: "lower" if of.lower else "higher"),
        text("Maps", lambda of: of.maps or "–"),
    ]
    return sheet(
        "metrics",
        (
            "Metrics of the run, as run.yaml lists them: unit, whether higher or lower is better, and whether"
            " they read maps matched to the histogram of the ground truth or as the models made them."
        ),
        columns,
        report.results.metrics.values(),
    )


def means(report: Report) -> Table:
    return tables.means_table(
        report, "means-others", tables.by_metrics(report.results.table("summary"), others(report))
    )


def pairs(report: Report) -> Table:
    return tables.pairs_table(
        report, "pairs-others", tables.by_metrics(tables.significance(report), others(report))
    )
