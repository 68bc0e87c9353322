# SPDX-License-Identifier: GPL-3.0-or-later
"""The ranking of the models, how sure it is, and what may be said of it in a sentence."""

from salbench.pages.blocks import Block, Cell, Missing, Note, Table, attempt, cell, first_of, interval
from salbench.pages.names import DATASETS, spoken
from salbench.report import people, statistics
from salbench.report.results import Row
from salbench.report.units import HEAD, count_cell
from salbench.report.workshop import Workshop

CAPTION = ("Models by their mean. “May be best”: no model is shown to be better. Ranks have joint 95 % intervals: all pairs of models under one "
           "metric are compared at once. Below the "
           "rank: how often a model has the best mean when the units are resampled, which is no probability that it is the best; and its rank "
           "if scores that are missing were at chance. Group: two models without a letter in common differ; two with one are not shown to "
           "differ, which does not say that they are equal. Means have 95 % intervals of their own "
           f"(Student). HS and RS, human performance and chance, are references: they have no rank. {people.SHARE}")
HEADS = ["Model", "Data set", "Metric", "Rank", "95 % ranks", "Group", "Mean", "95 % interval", "Of HS", HEAD]


def tables(shop: Workshop) -> list[Block]:
    """A sentence per data set, and the table of the leading metrics."""
    shop.results.table("ranking.csv", *statistics.RANKING)
    leading = list(shop.results.leading)
    return (attempt(sentences, shop) + attempt(lacking, shop) + attempt(table, shop, "ranking", leading) + chance(shop, leading))


def sentences(shop: Workshop) -> list[Block]:
    """Who leads, as the program says it, on each data set and each of its splits."""
    return [Note(text) for dataset in statistics.shown(shop.results)
            for text in statistics.leaders(shop.results, dataset)["sentence"] if text]


def lacking(shop: Workshop) -> list[Block]:
    """No blocks, but Missing where the column "Of HS" has no file."""
    shop.results.table("human_share.csv", *statistics.SHARES)
    return []


def chance(shop: Workshop, metrics: list[str]) -> list[Block]:
    """The remarks of chance.csv on metrics by which chance or a constant map is as good as a model."""
    try:
        remarks = shop.results.table("chance.csv", "dataset", "metric", "remark").to_dict("records")
    except Missing:
        return []
    return [Note(f"By the means of {shop.results.metric(remark['metric']).label} on {spoken(remark['dataset'])}, {remark['remark']}.")
            for remark in remarks if remark["metric"] in metrics and remark["dataset"] in DATASETS]


def table(shop: Workshop, identifier: str, metrics: list[str]) -> Table:
    rows = [row for dataset in statistics.shown(shop.results) for metric in metrics for row in rows_of(shop, dataset, metric)]
    if not rows:
        raise Missing("ranking.csv ranks no model: none has scores.")
    return Table(identifier, CAPTION, HEADS, rows, [False] * 3 + [True] * 2 + [False] + [True] * 4, filters=[1, 2], opens=first_of(rows, 1, 2))


def rows_of(shop: Workshop, dataset: str, metric: str) -> list[list[Cell]]:
    """The ranked models, below them the references."""
    of = shop.results.metric(metric)
    head = [Cell(DATASETS[dataset]), Cell(of.label, below=of.below)]
    try:
        means = {row["model"]: row for row in statistics.summary(shop.results, dataset, metric).to_dict("records")}
    except Missing:
        means = {}
    shares = statistics.human_shares(shop.results, dataset, metric)
    rows = []
    for row in statistics.ranking(shop.results, dataset, metric).to_dict("records"):
        known = means.pop(row["model"], {})
        ranks = [cell(row["rank"], 0, below=beside(row)), interval(row["rank_low"], row["rank_high"], 0), Cell(row["group"] or "–")]
        may_be_best = ("may be best", "holds") if row["rank_low"] == 1 else ("", "")
        rows.append([Cell(row["model"], badge=may_be_best), *head, *ranks] + mean_cells(shop, dataset, row, known, shares.get(row["model"])))
    for model, row in means.items():
        if row["n"] > 0:
            rows.append([Cell(model), *head, cell(None), cell(None), Cell("reference")] + mean_cells(shop, dataset, row, row))
    return rows


def beside(row: Row) -> str:
    """Below a rank: what it hangs on."""
    said = [f"best in {100 * row['first']:.0f} % of resamples"] if row["first"] > 0 else []
    return ", ".join(said + ([f"{row['rank_at_chance']:.0f} with missing scores at chance"] if row["rank_at_chance"] == row["rank_at_chance"] else []))


def mean_cells(shop: Workshop, dataset: str, row: Row, known: Row, share: Row | None = None) -> list[Cell]:
    """known: the row of summary.csv, which has the interval; empty if there is none. share: that of human_share.csv."""
    return [cell(row["mean"]), interval(known.get("ci95_low", float("nan")), known.get("ci95_high", float("nan"))),
            people.share_cell(share), count_cell(shop.results, dataset, row["n"], row["n_shapes"])]
