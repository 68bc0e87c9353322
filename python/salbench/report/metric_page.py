# SPDX-License-Identifier: GPL-3.0-or-later
"""The page of all metrics of a run: what they are, and the tables of those that the other pages leave out, one at a time."""

from salbench.pages.blocks import Block, Table, attempt
from salbench.pages.columns import sheet, text
from salbench.pages.names import spoken
from salbench.report import classes, people, ranking, statistics, tables
from salbench.report.pages import Page, Pages
from salbench.report.workshop import Workshop


def others(shop: Workshop) -> list[str]:
    return [name for name in shop.results.metrics if name not in shop.results.leading]


def write_page(pages: Pages, page: Page) -> None:
    results = pages.shop.results
    pages.write(page.path, "metrics.html", title=page.label, sections=blocks(pages.shop),
                leading=", ".join(of.label for of in results.leading.values()),
                labels=[results.metric(name).label for name in others(pages.shop)])


def blocks(shop: Workshop) -> list[tuple[str, list[Block]]]:
    """(title, blocks) of each section."""
    left = others(shop)
    return [("Ranking", attempt(ranking.table, shop, "ranking-others", left) + ranking.chance(shop, left)), ("Means", attempt(means, shop)),
            *((f"Performance per class on {spoken(dataset)}", attempt(classes.by_metric, shop, dataset, left))
              for dataset in statistics.shown(shop.results)),
            ("How many participants a model is worth", attempt(people.worth, shop, "worth-others", left)),
            ("Pairwise tests", attempt(pairs, shop)), ("Every metric of the run", [listing(shop)])]


def listing(shop: Workshop) -> Table:
    columns = [text("Metric", lambda of: of.label), text("Column", lambda of: of.name), text("Unit", lambda of: of.unit),
               text("Better", lambda of: "lower" if of.lower else "higher"), text("Maps", lambda of: of.maps or "–")]
    return sheet("metrics", "Metrics of the run, as run.yaml lists them: unit, whether higher or lower is better, and whether they "
                 "read maps matched to the histogram of the ground truth or as the models made them.", columns, shop.results.metrics.values())


def means(shop: Workshop) -> Table:
    return tables.means_table(shop, "means-others", tables.by_metrics(shop.results.table("summary"), others(shop)))


def pairs(shop: Workshop) -> Table:
    return tables.pairs_table(shop, "pairs-others", tables.by_metrics(tables.significance(shop), others(shop)))
