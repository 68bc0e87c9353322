# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the whole report: pages in their order, each from the workshop."""

import sys
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any

import yaml

from salbench.report import comparison, front, gallery_page, metric_page, run_page, score_pages, shape_files, shape_pages
from salbench.report.elements import numbered, pages_of, sections
from salbench.report.exports import Shapes
from salbench.report.folder import Folder
from salbench.report.pages import Pages, copy_static, unsettled
from salbench.report.results import Results, read_results
from salbench.report.workshop import Workshop


def write_report(out: Path, scratch: Path, *, to: Path | None = None, exports: Sequence[str | Path] = (), compare: Path | None = None,
                 examples: Sequence[str] = (), processes: int = 1, viewer: bool = True) -> Path:
    """The path of index.html. InputError if there is nothing to report of, StorageError if there is nowhere to write. scratch: an empty
    folder. exports: OUT/shapes.h5, where there is one, unless some are named. viewer: of shapes, which writes their coordinates and values."""
    results = read_results(out)
    other = read_results(compare) if compare else None
    default = out / "shapes.h5"
    shapes = Shapes(exports or ([default] if default.is_file() else []))
    with Folder(to or out / "report", named=to is not None) as folder:
        return _write(results, folder, shapes, scratch, other, examples, processes, viewer)


def _write(results: Results, folder: Folder, shapes: Shapes, scratch: Path, other: Results | None, examples: Sequence[str], processes: int,
           viewer: bool) -> Path:
    copy_static(folder, viewer)
    shop = Workshop(results, folder, shapes, scratch, protocols(), shape_pages.items(results, shapes), tuple(examples), other=other,
                    processes=processes, viewer=viewer)
    shop.drawn = shape_files.draw_all(shop)
    metrics = bool(metric_page.others(shop))
    present = pages_of(shop, {"index.html", "scores.html", "run.html", "metrics.html" if metrics else "",
                              "gallery.html" if gallery_page.pictured(shop) else "", "comparison.html" if other else ""})
    pages = Pages(shop, [(page.path, page.label) for page in present])
    gallery_page.write_page(shop, pages)
    for item, category in shop.items.items():
        shape_pages.write_page(shop, pages, item, category)
    score_pages.write_page(
        shop, pages, "scores.html", lambda: score_pages.all_scores(shop), title="Scores", heading="Scores of every shape",
        caption="Score of every shape under every model; mean: over the models shown. A dash: undefined or missing.",
        shapes={item: shop.page_of(item) for item in shop.items})
    if other:
        first, second = comparison.names(results, other)
        score_pages.write_page(
            shop, pages, "comparison.html", partial(comparison.differences, shop, other), comparison.blocks(shop, other),
            title="Comparison", heading="Two runs side by side", shapes={},
            caption=f"Score in {first} less score in {second}. A dash: undefined or missing in one of them.")
    if metrics:
        pages.write("metrics.html", "metrics.html", title="Other metrics", sections=metric_page.blocks(shop),
                    leading=", ".join(of.label for of in results.leading.values()),
                    labels=[results.metric(name).label for name in metric_page.others(shop)])
    pages.write("run.html", "run.html", title="The run", sections=run_page.blocks(shop))
    for page in present:
        if found := sections(shop, page.path):
            contents = numbered(shop) if page.path == "paper.html" else []
            contents += [element for element, _ in found if element not in contents]
            pages.write(page.path, "page.html", title=page.label, page=page, sections=found, contents=contents)
    pages.write("index.html", "index.html", title="Results", front=front.front(shop), marks=front.MARKS, doors=present[1:])
    shop.draw_figures()
    folder.finish()
    for read in filter(None, (results, other)):
        if read.changing:
            print(f"warning: {read.folder}: {unsettled(read)}", file=sys.stderr, flush=True)
    return folder.path / "index.html"


def protocols() -> dict[str, dict[str, Any]]:
    """protocol -> its complete configuration, scalars as text."""
    from salbench import _core

    loader = getattr(yaml, "CBaseLoader", yaml.BaseLoader)
    return {protocol: yaml.load(_core.protocol_configuration(protocol), loader) for protocol in ("published", "text")}
