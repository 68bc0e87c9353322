# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables of all shapes: thousands of rows, so that they stand in a script and the page renders some at a time."""

import json
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from salbench.pages.blocks import Block, Missing
from salbench.pages.names import DATASETS
from salbench.report import shape_pages, statistics
from salbench.report.pages import Page, Pages
from salbench.report.results import Frame
from salbench.report.workshop import Workshop


def rounded(value: float) -> float | None:
    """Five digits are more than a reader tells apart, and keep the file small; undefined becomes null."""
    return round(float(value), 5) if value == value else None


def page_data(shop: Workshop, tables: Mapping[tuple[str, str], Frame]) -> dict[str, Any]:
    """{models, metrics, lower, shapes: [[data set, item, class, view, page]], scores: {metric: [[a value per model] per shape]}}.
    tables: (data set, metric) -> shapes by models."""
    class_of = statistics.classes(shop.results)
    known = shop.results.metrics
    metrics = [metric for metric in known if any(metric == key[1] for key in tables)]
    shapes: list[list[str]] = []
    scores: dict[str, list[list[float | None]]] = {metric: [] for metric in metrics}
    for dataset in DATASETS:
        found = {metric: tables[dataset, metric] for metric in metrics if (dataset, metric) in tables}
        if not found:
            continue
        index = next(iter(found.values())).index
        shapes += [[DATASETS[dataset], item, class_of.get(item, ""), view, shop.page_of(item)] for item, view in index]
        for metric in metrics:
            wide = found.get(metric, next(iter(found.values())) * float("nan")).reindex(index=index, columns=shop.models)
            scores[metric].extend([rounded(value) for value in row] for row in wide.to_numpy())
    if not shapes:
        raise Missing("There are no scores: no shape has ground truth, or none was finished.")
    return {"models": shop.models, "metrics": {metric: known[metric].label for metric in metrics},
            "lower": [metric for metric in metrics if known[metric].lower], "shapes": shapes, "scores": scores}


def all_scores(shop: Workshop) -> dict[str, Any]:
    columns = shop.results.table("results")
    return page_data(shop, {(dataset, metric): statistics.scores(shop.results, dataset, metric)
                            for dataset in statistics.datasets(shop.results) for metric in shop.results.metrics
                            if metric in columns})


def write_scripts(shop: Workshop, script: str, table: dict[str, Any]) -> None:
    """The leading metrics stand in the script itself, each other one in its own, which the page loads when it is chosen."""
    def write(path: str, name: str, value: Any) -> None:
        text = json.dumps(value, separators=(",", ":"), ensure_ascii=True)
        shop.write(path, f"{name} = {text};\n")
    later = [metric for metric in table["scores"] if metric not in shop.results.leading]
    table["files"] = {metric: f"{script.removesuffix('.js')}-{shop.metric_files[metric]}.js" for metric in later}
    for metric, path in table["files"].items():
        write(path, f"salbench.scores.scores[{json.dumps(metric)}]", table["scores"].pop(metric))
    write(script, "salbench.scores", table)


def write_page(pages: Pages, page: Page) -> None:
    """Scores of every shape, and the pages of these."""
    shop = pages.shop
    for item, category in shop.items.items():
        shape_pages.write_page(shop, pages, item, category)
    write(pages, page, lambda: all_scores(shop), heading="Scores of every shape", title="Scores",
          caption="Score of every shape under every model; mean: over the models shown. A dash: undefined or missing.",
          shapes={item: shop.page_of(item) for item in shop.items})


def write(pages: Pages, page: Page, build: Callable[[], dict[str, Any]], sections: Sequence[tuple[str, list[Block]]] = (), **values: Any) -> None:
    """A page with the table of what `build` gives, and its data as data/NAME.js; where there is none the page says so."""
    try:
        table, missing = build(), ""
    except Missing as reason:
        table, missing = None, str(reason)
    script = f"data/{page.path.removesuffix('.html')}.js"
    if table:
        table["titles"] = {model: pages.titles[model] for model in table["models"] if model in pages.titles}
        write_scripts(pages.shop, script, table)
    classes = sorted({row[2] for row in table["shapes"]}) if table else []
    sets = list(dict.fromkeys(row[0] for row in table["shapes"])) if table else []
    pages.write(page.path, "scores.html", missing=missing, table=table, classes=classes, sets=sets, script=script, sections=sections, **values)
