# SPDX-License-Identifier: GPL-3.0-or-later
"""The checklist: every figure and table of the paper, and what the report adds, with the function that makes it and its page."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

from salbench.pages.blocks import Block, attempt
from salbench.report import (
    classes, compact, figures, gallery, mine, parameters, people, ranking, recording, run_page, statistics, tables,
)
from salbench.report.pages import Page, Pages
from salbench.report.results import Shown
from salbench.report.workshop import Workshop


@dataclass(frozen=True)
class Element:
    page: str        # that it stands on
    id: str          # anchor there
    title: str
    build: Callable[[Workshop], Any]  # Workshop -> blocks
    paper: str = ""    # "Figure 4", as numbered there; empty: not in the paper
    dataset: str = ""  # stands only in reports of runs that have it
    table: str = ""    # likewise
    of_mine: bool = False  # stands only in reports about one model


def has_elements(shop: Workshop, path: str) -> bool:
    return any(element.page == path for element in elements_of(shop.results))


def write_page(pages: Pages, page: Page) -> None:
    """A page of elements; that of the figures names the paper's own, wherever they stand, in the order of the paper's numbers."""
    shop = pages.shop
    every = elements_of(shop.results)
    shown = [(element, attempt(element.build, shop)) for element in every if element.page == page.path]
    there = {of.path for of in pages.present if page.path == "paper.html"}
    contents = sorted((element for element in every if element.paper and element.page in there), key=lambda element: element.paper)
    contents += [element for element, _ in shown if element not in contents]
    pages.write(page.path, "page.html", title=page.label, page=page, sections=shown, contents=contents)


def elements_of(results: Shown) -> list[Element]:
    """Those that a report of these results has."""
    return [element for element in ELEMENTS if (not element.dataset or element.dataset in statistics.shown(results))
            and (not element.table or results.has(element.table)) and (results.mine or not element.of_mine)]


def distributions(shop: Workshop) -> list[Block]:
    return [block for dataset in statistics.shown(shop.results) for block in attempt(figures.cumulative, shop, dataset)]


def performance(shop: Workshop) -> list[Block]:
    blocks = []
    for metric in shop.results.leading:
        blocks += attempt(figures.performance, shop, "meshes", metric)
        blocks += attempt(gallery.difficult, shop, "meshes", metric)
    return blocks


def scans(shop: Workshop) -> list[Block]:
    return attempt(figures.rankings, shop, "scans")


def scan_panels(shop: Workshop) -> list[Block]:
    return [block for metric in shop.results.leading for block in attempt(figures.performance, shop, "scans", metric)]


def clouds(shop: Workshop) -> list[Block]:
    blocks = attempt(figures.rankings, shop, "clouds") + attempt(gallery.clouds, shop)
    for metric in shop.results.leading:
        blocks += attempt(figures.performance, shop, "clouds", metric) + attempt(gallery.difficult, shop, "clouds", metric)
    return blocks


def participants(shop: Workshop) -> list[Block]:
    return attempt(figures.human_curves, shop) + people.tables(shop)


ELEMENTS = (
    Element("ranking.html", "mine", "One model against every other", mine.tables, of_mine=True),
    Element("ranking.html", "compact", "Models and metrics", compact.tables),
    Element("ranking.html", "ranking", "Ranking", ranking.tables),
    Element("statistics.html", "means", "Means", tables.means),
    Element("paper.html", "figure-1", "Examples of saliency maps", gallery.meshes, paper="Figure 1", dataset="meshes"),
    Element("paper.html", "figure-2", "Distributions of saliency", distributions, paper="Figure 2"),
    Element("paper.html", "figure-3", "Before and after histogram matching", gallery.matching, paper="Figure 3", dataset="meshes"),
    Element("paper.html", "table-1", "Parameters", parameters.parameters, paper="Table 1"),
    Element("paper.html", "figure-4", "Performance on meshes", performance, paper="Figure 4", dataset="meshes"),
    Element("paper.html", "figure-5", "Human performance", participants, paper="Figure 5"),
    Element("classes.html", "table-2", "Performance per class", partial(classes.tables, dataset="meshes"), paper="Table 2", dataset="meshes"),
    Element("paper.html", "figure-6", "Performance on scans", scans, paper="Figure 6", dataset="scans"),
    Element("paper.html", "figure-7", "Saliency maps on scans", gallery.scans, paper="Figure 7", dataset="scans"),
    Element("statistics.html", "pairs", "Pairwise tests", tables.pairwise),
    Element("paper.html", "scan-panels", "Scan by scan", scan_panels, dataset="scans"),
    Element("classes.html", "scan-classes", "Performance per class on scans", partial(classes.tables, dataset="scans"), dataset="scans"),
    Element("paper.html", "clouds", "Performance on point clouds", clouds, dataset="clouds"),
    Element("recording.html", "recording", "Recordings of gaze", recording.tables, table="gaze"),
    Element("run.html", "the-facts", "Facts", run_page.facts),
    Element("run.html", "the-failed", "Failed items", run_page.failures),
    Element("run.html", "the-reasons", "What was computed, and why", run_page.stages),
    Element("run.html", "the-time", "Time per stage", run_page.nodes),
    Element("run.html", "the-costs", "What maps cost", run_page.costs, table="costs"),
    Element("run.html", "the-cache", "Size of the cache", run_page.cache),
    Element("run.html", "the-configuration", "Configuration", run_page.configuration),
)
