# SPDX-License-Identifier: GPL-3.0-or-later
"""The checklist: every figure and table of the paper, and what the report adds, with the function that makes it."""

from dataclasses import dataclass
from typing import Callable

from report import claims, examples, figures, people, ranking, sensitivity, statements, statistics, tables
from report.blocks import attempt


@dataclass(frozen=True)
class Element:
    id: str          # anchor in index.html
    paper: str       # "Figure 4", as numbered there; empty: not in the paper
    label: str       # the paper's LaTeX label
    title: str
    build: Callable  # Workshop -> blocks
    dataset: str = ""  # stands only in reports of runs that have it


def elements_of(results):
    """Those that a report of these results has."""
    return [element for element in ELEMENTS if not element.dataset or element.dataset in statistics.shown(results)]


def distributions(shop):
    return [block for dataset in statistics.shown(shop.results) for block in attempt(figures.cumulative, shop, dataset)]


def performance(shop):
    blocks = []
    for metric in shop.results.leading:
        blocks += attempt(figures.performance, shop, "meshes", metric)
        blocks += attempt(examples.difficult, shop, "meshes", metric)
    return blocks


def classes(shop):
    return [block for metric in shop.results.leading for block in attempt(tables.per_class, shop, "meshes", metric)]


def classes_of_scans(shop):
    return [block for metric in shop.results.leading for block in attempt(tables.per_class, shop, "scans", metric)]


def scans(shop):
    return attempt(figures.rankings, shop, "scans")


def scan_panels(shop):
    return [block for metric in shop.results.leading for block in attempt(figures.performance, shop, "scans", metric)]


def clouds(shop):
    blocks = attempt(figures.rankings, shop, "clouds") + attempt(examples.clouds, shop)
    for metric in shop.results.leading:
        blocks += attempt(figures.performance, shop, "clouds", metric) + attempt(examples.difficult, shop, "clouds", metric)
    return blocks


def participants(shop):
    return attempt(figures.human_curves, shop) + people.tables(shop)


ELEMENTS = (
    Element("ranking", "", "", "Ranking", ranking.tables),
    Element("statements", "", "", "What the paper says of significance, on its own scores", statements.table),
    Element("means", "", "", "Means", tables.means),
    Element("claims", "", "", "What the paper says, checked", claims.table),
    Element("figure-1", "Figure 1", "fig:teaser", "Examples of saliency maps", examples.meshes),
    Element("figure-2", "Figure 2", "fig:saliency_maps_avg_distribution", "Distributions of saliency", distributions),
    Element("figure-3", "Figure 3", "fig:maps_after_matching_hist", "Before and after histogram matching",
            examples.matching),
    Element("table-1", "Table 1", "table:params_per_method", "Parameters", tables.parameters),
    Element("figure-4", "Figure 4", "fig:saliency_performance", "Performance on meshes", performance),
    Element("figure-5", "Figure 5", "fig:human_performance", "Human performance", participants),
    Element("table-2", "Table 2", "auc_per-class", "Performance per class", classes),
    Element("figure-6", "Figure 6", "fig:scans_saliency_performance", "Performance on scans", scans),
    Element("figure-7", "Figure 7", "fig:scans_saliency", "Saliency maps on scans", examples.scans),
    Element("pairs", "", "", "Pairwise tests", tables.pairwise),
    Element("sensitivity", "", "", "Where the ranking depends on the convention", sensitivity.tables),
    Element("scan-panels", "", "", "Scan by scan", scan_panels),
    Element("scan-classes", "", "", "Performance per class on scans", classes_of_scans),
    Element("clouds", "", "", "Performance on point clouds", clouds, dataset="clouds"),
)
