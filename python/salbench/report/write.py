# SPDX-License-Identifier: GPL-3.0-or-later
"""The whole report: a row per page, and the function that writes them."""

import logging
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from salbench.report import (
    classes,
    elements,
    front,
    gallery,
    metric_page,
    own_export,
    score_pages,
    shape_files,
    shape_pages,
)
from salbench.report.exports import Shapes
from salbench.report.folder import Folder
from salbench.report.mine import require
from salbench.report.report import Page, Report
from salbench.report.results import Shown
from salbench.system.errors import arguments_refused
from salbench.system.progress import Told, nothing


def of_elements(
    path: str, label: str, title: str, lead: str, is_there: Callable[[Report], Any] | None = None
) -> Page:
    return Page(
        path, label, title, lead, elements.write_page, is_there or partial(elements.has_elements, path=path)
    )


# In the order of readers' questions.
PAGES = (
    Page(
        "index.html",
        "Results",
        "Which saliency models predict what people find important?",
        "",
        front.write_page,
    ),
    of_elements(
        "ranking.html",
        "Ranking",
        "How the models rank, and how sure that is",
        "One table to paste into a paper; ranks with their intervals.",
    ),
    Page("scores.html", "Shapes", "", "Every shape under every model.", score_pages.write_page),
    Page(
        "gallery.html",
        "Gallery",
        "",
        "Pictures; where each model is worst.",
        gallery.write_page,
        gallery.pictured,
    ),
    of_elements(
        "classes.html",
        "Classes",
        "Performance per class",
        "Which kinds of shapes are easy, for which model.",
        classes.are_known,
    ),
    of_elements("statistics.html", "Statistics", "Means and tests", "Means, and every pair of models."),
    Page(
        "metrics.html",
        "Other metrics",
        "",
        "What the other pages leave out.",
        metric_page.write_page,
        metric_page.others,
    ),
    of_elements(
        "recording.html",
        "Recordings",
        "Recordings of gaze",
        "Who looked, what was lost, how well people agree.",
    ),
    of_elements(
        "folds.html",
        "Folds",
        "Folds of the cross-validation",
        "Who was trained on what, scores per fold, what training took.",
    ),
    of_elements("run.html", "Run", "The run itself", "What was computed, what failed, the configuration."),
    of_elements(
        "paper.html",
        "Figures",
        "The paper's figures and tables",
        "The paper's figures and tables, made from this run.",
    ),
)


def write_report(
    out: Path,
    scratch: Path,
    *,
    to: Path | None = None,
    exports: Sequence[str | Path] = (),
    examples: Sequence[str] = (),
    processes: int = 1,
    viewer: bool = True,
    picks: bool = False,
    mine: str = "",
    metrics: Sequence[str] = (),
    models: Sequence[str] = (),
    told: Told = nothing,
) -> Path:
    """Writes the report and returns the path of index.html. InputError without results, StorageError if the
    folder cannot be written. scratch: an empty folder. exports: default OUT/shapes.h5 if it exists, else made
    from the cache. viewer: writes coordinates and values of shapes. picks: drawn, or
    fixations, as dots on pictures of the ground truth. mine: the model that the report is about. metrics, models: on the pages; default: all. told:
    receives the progress."""
    with arguments_refused():
        results = Shown(out, mine, metrics, models)
    require(results)
    default, lacking = out / "shapes.h5", ""
    found = exports or ([default] if default.is_file() else [])
    if not found:
        found, lacking = own_export.make(results, scratch, examples, told)
        if lacking:
            logging.getLogger("salbench").warning("no shapes in the report: %s", lacking)
    shapes = Shapes(found)
    with Folder(to or out / "report") as folder:
        report = Report(
            results,
            folder,
            shapes,
            shape_pages.items(results, shapes),
            tuple(examples),
            processes=processes,
            viewer=viewer,
            picks=picks,
            lacking=lacking,
            told=told,
        )
        report.copy_static()
        shape_files.draw_all(report)
        report.pages = [page for page in PAGES if page.is_there(report)]
        for page in report.pages:
            page.write(report, page)
        report.draw_figures()
        folder.finish()
    return folder.path / "index.html"
