# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the whole report: pages in their order, each from the workshop."""

from pathlib import Path

from report import comparison, gallery_page, metric_page, run_page, score_pages, shape_files, shape_pages
from report.blocks import attempt
from report.elements import elements_of
from report.exports import Shapes
from report.folder import Folder
from report.names import spoken
from report.pages import Pages, copy_static
from report.results import DATASETS, Missing, read_results
from report.workshop import Workshop


def write_report(options, protocols):
    """The path of index.html. Unusable if there is nothing to report of, or nowhere to write."""
    results = read_results(options.results)
    out = Path(options.to) if options.to else results.folder / "report"
    other = read_results(options.compare) if options.compare else None
    shapes = Shapes(exports(options, results))
    folder = Folder(out)
    copy_static(folder)
    shop = Workshop(results, folder, shapes, protocols, shape_pages.items(results, shapes),
                    tuple(options.examples.split(",")) if options.examples else (), other=other, processes=options.processes)
    shop.drawn = shape_files.draw_all(shop)
    comparing = [("comparison.html", "Comparison")] if other else []
    metrics = [("metrics.html", "Other metrics")] if metric_page.others(shop) else []
    gallery = [("gallery.html", "Gallery")] if gallery_page.pictured(shop) else []
    pages = Pages(shop, [("index.html", "Results"), *gallery, ("scores.html", "Scores and shapes"), *metrics, ("run.html", "Run"),
                         *comparing])
    scores = shop.scores = shape_pages.Scores(results)
    gallery_page.write_page(shop, pages)
    for item, category in shop.items.items():
        shape_pages.write_page(shop, pages, scores, item, category)
    score_pages.write_page(
        shop, pages, "scores.html", lambda: score_pages.all_scores(shop), title="Scores", heading="Scores of every shape",
        caption="Score of every shape under every model; mean: over the models shown. A dash: undefined or missing.",
        shapes={item: shop.page_of(item) for item in shop.items})
    if other:
        first, second = comparison.names(results, other)
        score_pages.write_page(
            shop, pages, "comparison.html", lambda: comparison.differences(shop, other), comparison.blocks(shop, other),
            title="Comparison", heading="Two runs side by side", shapes={},
            caption=f"Score in {first} less score in {second}. A dash: undefined or missing in one of them.")
    if metrics:
        pages.write("metrics.html", "metrics.html", title="Other metrics", sections=metric_page.blocks(shop),
                    leading=", ".join(of.label for of in results.leading.values()),
                    labels=[results.metric(name).label for name in metric_page.others(shop)])
    sections = [(element, attempt(element.build, shop)) for element in elements_of(results)]
    pages.write("run.html", "run.html", title="The run", sections=run_page.blocks(shop))
    shop.draw_figures()
    pages.write("index.html", "index.html", title="Results", sections=sections, lead=lead(shop))
    folder.finish()
    return out / "index.html"


def exports(options, results):
    """The exports named, or OUT/shapes.h5 where there is one."""
    default = results.folder / "shapes.h5"
    return options.export or ([default] if default.is_file() else [])


def lead(shop):
    """One sentence: how many shapes and models, by which protocol."""
    try:
        rows = shop.results.table("results.csv", "dataset", "item", "view")
    except Missing as reason:
        return str(reason)
    shapes = rows.drop_duplicates(["dataset", "item", "view"])["dataset"].value_counts()
    counted = " and ".join(f"{shapes[dataset]} {spoken(dataset)}" for dataset in DATASETS if dataset in shapes) or "no shape"
    protocol = shop.results.option("protocol")
    return (f"Scores of {counted} with ground truth, under {len(shop.models)} models: {', '.join(shop.models) or 'none'}."
            + (f" Protocol: {protocol}." if protocol else ""))
