# SPDX-License-Identifier: GPL-3.0-or-later
"""The page of all metrics of a run: what they are, and the tables of those that the other pages leave out, one at a time."""

from salbench.pages.blocks import Block, Cell, Missing, Table, attempt, cell, first_of
from salbench.pages.names import spoken
from salbench.report import people, ranking, statistics, tables, units
from salbench.report.results import Frame
from salbench.report.workshop import Workshop


def others(shop: Workshop) -> list[str]:
    return [name for name in shop.results.metrics if name not in shop.results.leading]


def blocks(shop: Workshop) -> list[tuple[str, list[Block]]]:
    """(title, blocks) of each section."""
    return [("Ranking", attempt(ranking.table, shop, "ranking-others", others(shop)) + ranking.chance(shop, others(shop))), ("Means", attempt(means, shop)),
            *((f"Performance per class on {spoken(dataset)}", attempt(classes, shop, dataset))
              for dataset in statistics.shown(shop.results)),
            ("How many participants a model is worth", attempt(people.worth, shop, "worth-others", others(shop))),
            ("Pairwise tests", attempt(pairs, shop)), ("Every metric of the run", [listing(shop)])]


def listing(shop: Workshop) -> Table:
    rows = [[Cell(of.label), Cell(of.name), Cell(of.unit), Cell("lower" if of.lower else "higher"), Cell(of.maps or "–")]
            for of in shop.results.metrics.values()]
    return Table("metrics", "Metrics of the run, as run.yaml lists them: unit, whether higher or lower is better, and whether they "
                 "read maps matched to the histogram of the ground truth or as the models made them.",
                 ["Metric", "Column", "Unit", "Better", "Maps"], rows, [False] * 5)


def means(shop: Workshop) -> Table:
    table = shop.results.table("summary.csv", *statistics.SUMMARY)
    return tables.means_table(shop, "means-others", tables.MEANS, table[table["metric"].isin(others(shop))])


def pairs(shop: Workshop) -> Table:
    table = tables.significance(shop)
    return tables.pairs_table(shop, "pairs-others", table[table["metric"].isin(others(shop))])


def classes(shop: Workshop, dataset: str) -> Table:
    rows = []
    for name in others(shop):
        try:
            table = statistics.per_class(shop.results, dataset, name)
        except Missing:
            continue
        rows += class_rows(shop, dataset, name, table)
    if not rows:
        raise Missing(f"There are no scores of {spoken(dataset)} by class.")
    models = shop.models
    return Table(f"classes-{dataset}-others", tables.CLASSES.format("Mean", spoken(dataset), ""),
                 ["Class", "Metric", units.HEAD, "Avg", *models], rows, [False] * 2 + [True] * (len(models) + 2), filters=[1],
                 opens=first_of(rows, 1))


def class_rows(shop: Workshop, dataset: str, name: str, table: Frame) -> list[list[Cell]]:
    of = shop.results.metric(name)
    by_cell = {(row["class"], row["model"]): row for row in table.to_dict("records")}
    best = tables.best_per_class(of, by_cell)
    rows = []
    for category in dict.fromkeys(table["class"]):
        found = [by_cell.get((category, model)) for model in shop.models]
        line = [Cell(category or "(no class)"), Cell(of.label), tables.class_count(shop, dataset, found)]
        for row in [by_cell.get((category, "Avg")), *found]:
            line.append(tables.class_cell(row, None, row["model"] in best[category]) if row else cell(None))
        rows.append(line)
    return rows
