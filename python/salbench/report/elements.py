# SPDX-License-Identifier: GPL-3.0-or-later
"""The checklist: every figure and table of the paper, and what the report adds, with the function that makes it and its page."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

from salbench.pages.blocks import Block, attempt
from salbench.report import claims, classes, compact, examples, figures, fitted, lag, parameters, people, ranking, sensitivity, statements, statistics, tables
from salbench.report.results import Results
from salbench.report.workshop import Workshop


@dataclass(frozen=True)
class Element:
    page: str        # that it stands on
    id: str          # anchor there
    paper: str       # "Figure 4", as numbered there; empty: not in the paper
    label: str       # the paper's LaTeX label
    title: str
    build: Callable[[Workshop], Any]  # Workshop -> blocks
    dataset: str = ""  # stands only in reports of runs that have it
    file: str = ""     # likewise


@dataclass(frozen=True)
class Page:
    path: str
    label: str   # in the navigation
    title: str
    lead: str    # what a reader finds there


# In the order in which readers ask; those without elements are written by modules of their own.
PAGES = (
    Page("index.html", "Results", "Which saliency models predict what people find important?", ""),
    Page("ranking.html", "Ranking", "How the models rank, and how sure that is",
         "One table to paste into a paper; how far each model is behind; ranks with their intervals."),
    Page("scores.html", "Shapes", "", "Every shape under every model."),
    Page("gallery.html", "Gallery", "", "Pictures; where each model is worst."),
    Page("claims.html", "Claims", "What the paper says, checked", "Each claim of the paper beside these scores."),
    Page("classes.html", "Classes", "Performance per class", "Which kinds of shapes are easy, for which model."),
    Page("statistics.html", "Statistics", "Means, tests and conventions",
         "Means, every pair of models, and how conventions change the ranking."),
    Page("metrics.html", "Other metrics", "", "What the other pages leave out."),
    Page("run.html", "Run", "", "What was computed, what failed, the configuration."),
    Page("paper.html", "Figures", "The paper's figures and tables", "The paper's figures and tables, made from this run."),
    Page("comparison.html", "Comparison", "", "This run beside another one."),
)


def pages_of(shop: Workshop, present: set[str]) -> list[Page]:
    """Pages of a report: those of elements, and those among `present`."""
    of_elements = {element.page for element in elements_of(shop.results)}
    return [page for page in PAGES if page.path in of_elements or page.path in present]


def sections(shop: Workshop, path: str) -> list[tuple[Element, list[Block]]]:
    """(element, blocks) of a page, in their order."""
    return [(element, attempt(element.build, shop)) for element in elements_of(shop.results) if element.page == path]


def numbered(shop: Workshop) -> list[Element]:
    """The paper's figures and tables wherever they stand, in the paper's order of its numbers."""
    return sorted((element for element in elements_of(shop.results) if element.paper), key=lambda element: element.paper)


def elements_of(results: Results) -> list[Element]:
    """Those that a report of these results has."""
    return [element for element in ELEMENTS if (not element.dataset or element.dataset in statistics.shown(results))
            and (not element.file or results.has(element.file))]


def distributions(shop: Workshop) -> list[Block]:
    return [block for dataset in statistics.shown(shop.results) for block in attempt(figures.cumulative, shop, dataset)]


def performance(shop: Workshop) -> list[Block]:
    blocks = []
    for metric in shop.results.leading:
        blocks += attempt(figures.performance, shop, "meshes", metric)
        blocks += attempt(examples.difficult, shop, "meshes", metric)
    return blocks


def scans(shop: Workshop) -> list[Block]:
    return attempt(figures.rankings, shop, "scans")


def scan_panels(shop: Workshop) -> list[Block]:
    return [block for metric in shop.results.leading for block in attempt(figures.performance, shop, "scans", metric)]


def clouds(shop: Workshop) -> list[Block]:
    blocks = attempt(figures.rankings, shop, "clouds") + attempt(examples.clouds, shop)
    for metric in shop.results.leading:
        blocks += attempt(figures.performance, shop, "clouds", metric) + attempt(examples.difficult, shop, "clouds", metric)
    return blocks


def participants(shop: Workshop) -> list[Block]:
    return attempt(figures.human_curves, shop) + people.tables(shop)


ELEMENTS = (
    Element("ranking.html", "compact", "", "", "Models and metrics", compact.tables),
    Element("ranking.html", "lag", "", "", "How far behind the best", lag.tables),
    Element("ranking.html", "ranking", "", "", "Ranking", ranking.tables),
    Element("statistics.html", "means", "", "", "Means", tables.means),
    Element("claims.html", "claims", "", "", "What the paper says, checked", claims.table),
    Element("claims.html", "statements", "", "", "What the paper says of significance, on its own scores", statements.table),
    Element("paper.html", "figure-1", "Figure 1", "fig:teaser", "Examples of saliency maps", examples.meshes),
    Element("paper.html", "figure-2", "Figure 2", "fig:saliency_maps_avg_distribution", "Distributions of saliency", distributions),
    Element("paper.html", "figure-3", "Figure 3", "fig:maps_after_matching_hist", "Before and after histogram matching",
            examples.matching),
    Element("paper.html", "table-1", "Table 1", "table:params_per_method", "Parameters", parameters.parameters),
    Element("paper.html", "figure-4", "Figure 4", "fig:saliency_performance", "Performance on meshes", performance),
    Element("paper.html", "figure-5", "Figure 5", "fig:human_performance", "Human performance", participants),
    Element("classes.html", "table-2", "Table 2", "auc_per-class", "Performance per class", partial(classes.tables, dataset="meshes")),
    Element("paper.html", "figure-6", "Figure 6", "fig:scans_saliency_performance", "Performance on scans", scans),
    Element("paper.html", "figure-7", "Figure 7", "fig:scans_saliency", "Saliency maps on scans", examples.scans),
    Element("statistics.html", "pairs", "", "", "Pairwise tests", tables.pairwise),
    Element("statistics.html", "sensitivity", "", "", "Where the ranking depends on the convention", sensitivity.tables),
    Element("statistics.html", "fitted", "", "", "Fitted densities", fitted.figures, file="fitted"),
    Element("paper.html", "scan-panels", "", "", "Scan by scan", scan_panels),
    Element("classes.html", "scan-classes", "", "", "Performance per class on scans", partial(classes.tables, dataset="scans")),
    Element("paper.html", "clouds", "", "", "Performance on point clouds", clouds, dataset="clouds"),
)
