# SPDX-License-Identifier: GPL-3.0-or-later
"""The checklist: every figure and table of the paper and of the report, with the function that makes it and
its page."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

from salbench.pages.blocks import Block, attempt
from salbench.report import (
    classes,
    compact,
    figures,
    folds,
    gallery,
    mine,
    parameters,
    people,
    ranking,
    recording,
    reported,
    run_page,
    statistics,
    tables,
)
from salbench.report.report import Page, Report
from salbench.report.results import Shown


@dataclass(frozen=True)
class Element:
    page: str  # page that contains it
    id: str  # anchor on the page
    title: str
    build: Callable[[Report], Any]  # returns its blocks
    paper: str = ""  # number in the paper, "Figure 4"; empty: not in the paper
    dataset: str = ""  # only in reports of runs with this data set
    table: str = ""  # only in reports of runs with this table
    of_mine: bool = False  # only in reports about one model
    of_ended: bool = False  # only in reports of runs that have ended


def has_elements(report: Report, path: str) -> bool:
    return any(element.page == path for element in elements_of(report.results))


def write_page(report: Report, page: Page) -> None:
    """Writes a page of elements. The page of figures lists the paper's own, wherever they are, in the paper's
    order."""
    every = elements_of(report.results)
    shown = [(element, attempt(element.build, report)) for element in every if element.page == page.path]
    there = {of.path for of in report.pages if page.path == "paper.html"}
    contents = sorted(
        (element for element in every if element.paper and element.page in there),
        key=lambda element: element.paper,
    )
    contents += [element for element, _ in shown if element not in contents]
    report.write_page(page.path, "page.html", title=page.label, page=page, sections=shown, contents=contents)


def elements_of(results: Shown) -> list[Element]:
    """Elements that a report of these results has."""
    return [
        element
        for element in ELEMENTS
        if (not element.dataset or element.dataset in statistics.shown(results))
        and (not element.table or results.has(element.table))
        and (results.mine or not element.of_mine)
        and (results.record.get("results") or not element.of_ended)
    ]


def distributions(report: Report) -> list[Block]:
    return [
        block
        for dataset in statistics.shown(report.results)
        for block in attempt(figures.cumulative, report, dataset)
    ]


def performance(report: Report, dataset: str) -> list[Block]:
    """Panels of each leading metric, and for meshes and point clouds its hardest shapes."""
    builds: list[Callable[..., Any]] = (
        [figures.performance] if dataset == "scans" else [figures.performance, gallery.difficult]
    )
    return [
        block
        for metric in report.results.leading
        for build in builds
        for block in attempt(build, report, dataset, metric)
    ]


def clouds(report: Report) -> list[Block]:
    return (
        attempt(figures.rankings, report, "clouds")
        + attempt(gallery.examples, report, "clouds", 2)
        + performance(report, "clouds")
    )


def participants(report: Report) -> list[Block]:
    return attempt(figures.human_curves, report) + people.tables(report)


ELEMENTS = (
    Element("ranking.html", "mine", "One model against every other", mine.tables, of_mine=True),
    Element("ranking.html", "compact", "Models and metrics", compact.tables),
    Element("ranking.html", "ranking", "Ranking", ranking.tables),
    Element("statistics.html", "means", "Means", tables.means),
    Element("statistics.html", "reported", "What papers report", reported.others, table="published"),
    Element(
        "paper.html",
        "figure-1",
        "Examples of saliency maps",
        partial(gallery.examples, dataset="meshes", count=2),
        paper="Figure 1",
        dataset="meshes",
    ),
    Element("paper.html", "figure-2", "Distributions of saliency", distributions, paper="Figure 2"),
    Element(
        "paper.html",
        "figure-3",
        "Before and after histogram matching",
        gallery.matching,
        paper="Figure 3",
        dataset="meshes",
    ),
    Element("paper.html", "table-1", "Parameters", parameters.parameters, paper="Table 1"),
    Element(
        "paper.html",
        "figure-4",
        "Performance on meshes",
        partial(performance, dataset="meshes"),
        paper="Figure 4",
        dataset="meshes",
    ),
    Element("paper.html", "figure-5", "Human performance", participants, paper="Figure 5"),
    Element(
        "classes.html",
        "table-2",
        "Performance per class",
        partial(classes.tables, dataset="meshes"),
        paper="Table 2",
        dataset="meshes",
    ),
    Element(
        "paper.html",
        "figure-6",
        "Performance on scans",
        partial(figures.rankings, dataset="scans"),
        paper="Figure 6",
        dataset="scans",
    ),
    Element(
        "paper.html",
        "figure-7",
        "Saliency maps on scans",
        partial(gallery.examples, dataset="scans", count=4),
        paper="Figure 7",
        dataset="scans",
    ),
    Element("statistics.html", "pairs", "Pairwise tests", tables.pairwise),
    Element(
        "paper.html", "scan-panels", "Scan by scan", partial(performance, dataset="scans"), dataset="scans"
    ),
    Element(
        "classes.html",
        "scan-classes",
        "Performance per class on scans",
        partial(classes.tables, dataset="scans"),
        dataset="scans",
    ),
    Element("paper.html", "clouds", "Performance on point clouds", clouds, dataset="clouds"),
    Element("recording.html", "recording", "Recordings of gaze", recording.tables, table="gaze"),
    Element("folds.html", "the-folds", "Folds", folds.listing, table="folds"),
    Element("folds.html", "fold-scores", "Scores per fold", folds.scores, table="folds"),
    Element("folds.html", "training-costs", "What training took", folds.costs, table="folds"),
    Element("run.html", "the-facts", "Facts", run_page.facts, of_ended=True),
    Element("run.html", "the-failed", "Failed items", run_page.failures, of_ended=True),
    Element("run.html", "the-reasons", "What was computed, and why", run_page.stages, of_ended=True),
    Element("run.html", "the-time", "Time per stage", run_page.nodes, of_ended=True),
    Element("run.html", "the-costs", "What maps cost", run_page.costs, table="costs"),
    Element("run.html", "the-cache", "Size of the cache", run_page.cache, of_ended=True),
    Element("run.html", "the-configuration", "Configuration", run_page.configuration),
)
