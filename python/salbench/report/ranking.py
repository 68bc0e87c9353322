# SPDX-License-Identifier: GPL-3.0-or-later
"""The ranking of the models, its uncertainty, and sentences about it."""

from functools import partial

from salbench.pages.blocks import Block, Cell, Missing, Note, Table, attempt, cell
from salbench.pages.columns import Column, between, number, sheet, text
from salbench.pages.names import DATASETS, spoken
from salbench.report import people, statistics
from salbench.report.results import Row
from salbench.report.units import DATA_SET, OF_A_METRIC, n_of
from salbench.report.report import Report

CAPTION = (
    "Models by their mean. “May be best”: no model is shown to be better. Ranks have joint 95 % intervals:"
    " all pairs of models under one metric are compared at once. Below the rank: how often a model has the"
    " best mean when the units are resampled, which is no probability that it is the best; and its rank if"
    " scores that are missing were at chance. Group: two models without a letter in common differ; two with"
    " one do not differ significantly, which does not say that they are equal. Means have 95 % intervals of"
    " their own (Student). HS and RS, human performance and chance, are references: they have no rank."
    f" {people.SHARE}"
)
NAN = float("nan")


def tables(report: Report) -> list[Block]:
    """Returns a sentence per data set, and the table of the leading metrics."""
    report.results.table("ranking")
    leading = list(report.results.leading)
    return (
        attempt(sentences, report)
        + attempt(lacking, report)
        + attempt(table, report, "ranking", leading)
        + chance(report, leading)
    )


def sentences(report: Report) -> list[Block]:
    """The program's sentence on who leads, for each data set and each of its splits."""
    return [
        Note(text)
        for dataset in statistics.shown(report.results)
        for text in report.results.rows("leaders", dataset, "")["sentence"]
        if text
    ]


def lacking(report: Report) -> list[Block]:
    """Returns no blocks; raises Missing if the column "Of HS" has no file."""
    report.results.table("human_share")
    return []


def chance(report: Report, metrics: list[str]) -> list[Block]:
    """Remarks of chance.csv on metrics by which chance or a constant map is as good as a model."""
    try:
        remarks = report.results.table("chance").to_dict("records")
    except Missing:
        return []
    return [
        Note(
            f"By the means of {report.results.metric(remark['metric']).label} on {spoken(remark['dataset'])},"
            f" {remark['remark']}."
        )
        for remark in remarks
        if remark["metric"] in metrics and remark["dataset"] in DATASETS
    ]


def table(report: Report, identifier: str, metrics: list[str]) -> Table:
    rows: list[Row] = [
        row
        for dataset in statistics.shown(report.results)
        for metric in metrics
        for row in rows_of(report, dataset, metric)
    ]
    if not rows:
        raise Missing("ranking.csv ranks no model: none has scores.")
    columns = [
        Column(
            "Model",
            lambda row: Cell(
                row["model"], badge=("may be best", "holds") if row["rank_low"] == 1 else ("", "")
            ),
            numeric=False,
        ),
        DATA_SET,
        Column("Metric", partial(metric_cell, report), numeric=False),
        Column("Rank", lambda row: cell(row["rank"], 0, below=beside(row))),
        between("95 % ranks", "rank_low", "rank_high", 0),
        text("Group", lambda row: row["group"] or "–"),
        number("Mean", "mean"),
        between("95 % interval", "ci95_low", "ci95_high"),
        Column("Of HS", lambda row: people.share_cell(row["of_people"])),
        n_of(report.results),
    ]
    return sheet(identifier, CAPTION, columns, report.results.mine_first(rows), OF_A_METRIC, 2)


def metric_cell(report: Report, row: Row) -> Cell:
    of = report.results.metric(row["metric"])
    return Cell(of.label, below=of.below)


def rows_of(report: Report, dataset: str, metric: str) -> list[Row]:
    """Ranked models, then references: rows of ranking.csv, with the interval of summary.csv and the row of
    human_share.csv."""
    try:
        means = {
            row["model"]: row
            for row in statistics.summary(report.results, dataset, metric).to_dict("records")
        }
    except Missing:
        means = {}
    has_shares = report.results.has("human_share")
    shares = (
        {row["model"]: row for row in report.results.rows("human_share", dataset, metric).to_dict("records")}
        if has_shares
        else {}
    )
    rows: list[Row] = []
    for row in report.results.rows("ranking", dataset, metric).to_dict("records"):
        known = means.pop(row["model"], {})
        rows.append(
            {
                **row,
                **{name: known.get(name, NAN) for name in ("ci95_low", "ci95_high")},
                "of_people": shares.get(row["model"]),
            }
        )
    unranked = {
        "rank": NAN,
        "rank_low": NAN,
        "rank_high": NAN,
        "group": "reference",
        "first": 0,
        "rank_at_chance": NAN,
        "of_people": None,
    }
    return rows + [{**row, **unranked} for row in means.values() if row["n"] > 0]


def beside(row: Row) -> str:
    """Text below a rank: its conditions."""
    said, share = [], row["first"]
    if share > 0:
        rounded = f"{100 * share:.0f}"
        least = "less than 1" if rounded == "0" else "more than 99" if rounded == "100" and share < 1 else ""
        said.append(f"best in {least or rounded} % of resamples")
    if row["rank_at_chance"] == row["rank_at_chance"]:
        said.append(f"{row['rank_at_chance']:.0f} with missing scores at chance")
    return ", ".join(said)
