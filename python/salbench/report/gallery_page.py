# SPDX-License-Identifier: GPL-3.0-or-later
"""The gallery: every mesh and point cloud with a picture, to be sorted by class, score and disagreement of the models, and the
shapes that each model finds hardest."""

import json
from collections.abc import Mapping, Sequence
from typing import Any

import pandas

from salbench.conclusions.units import REFERENCES
from salbench.pages.blocks import Gallery, Missing, Tile
from salbench.pages.names import spoken
from salbench.report import statistics
from salbench.report.examples import leading_labels, map_tile, scored_pictures
from salbench.report.exports import Shape
from salbench.report.gallery import Painter
from salbench.report.metrics import Metric
from salbench.report.names import natural
from salbench.report.pages import Pages
from salbench.report.score_pages import rounded
from salbench.report.shape_pages import models_of
from salbench.report.viewer import label_of
from salbench.report.workshop import Workshop

WORST = 3  # shapes per model


def pictured(shop: Workshop) -> list[Painter]:
    """Painters of all shapes that the gallery shows, in the order of their names."""
    found = scored_pictures(shop, "meshes") + scored_pictures(shop, "clouds")
    shown = [painter for painter in found if painter.shape.item in shop.items and painter.paint("ground truth")]
    return sorted(shown, key=lambda painter: natural(painter.shape.name))


def write_page(shop: Workshop, pages: Pages) -> None:
    painters = pictured(shop)
    if painters:
        data = page_data(shop, painters)
        text = json.dumps(data, separators=(",", ":"), ensure_ascii=True)
        shop.write("data/gallery.js", f"salbench.gallery = {text};\n")
        tiles = [(shape, shop.page_of(shape["item"])) for shape in data["shapes"]]
        classes = sorted({shape["class"] for shape in data["shapes"]})
        pages.write("gallery.html", "gallery.html", title="Gallery", data=data, tiles=tiles, classes=classes, worst=worst(shop))


def page_data(shop: Workshop, painters: list[Painter]) -> dict[str, Any]:
    """{models, metrics, lower, maps: labels of the menu, shapes: [{item, class, pictures: {label: path}, scores: {metric: [per
    model]}}]}; models are those that have scores, without references."""
    leading = shop.results.leading
    models = [model for model in shop.models if model not in REFERENCES]
    shapes: list[dict[str, Any]] = []
    labels: dict[str, None] = {}
    for painter in painters:
        shape = painter.shape
        pictures = {label_of(*key): path for key, path in painter.maps.items() if path}
        labels |= dict.fromkeys(pictures)
        shapes.append({"item": shape.item, "class": shop.items[shape.item], "pictures": pictures,
                       "scores": {metric: scores_of(shop, shape, metric, models) for metric in leading}})
    order = [label_of("ground truth", "before"), *(label_of(model, when) for when in ("before", "after", "difference")
                                                   for model in models_of(shop, [(name, "") for name in shop.model_files]))]
    return {"models": models, "metrics": {metric: of.label for metric, of in leading.items()},
            "lower": [metric for metric, of in leading.items() if of.lower], "maps": [label for label in order if label in labels],
            "shapes": shapes}


def scores_of(shop: Workshop, shape: Shape, metric: str, models: Sequence[str]) -> list[float | None]:
    """Of each model; null where it has none."""
    try:
        row = statistics.scores(shop.results, shape.dataset, metric).loc[(shape.item, shape.view)]
    except (KeyError, Missing):
        return [None] * len(models)
    return [rounded(row.get(model, float("nan"))) for model in models]


def worst(shop: Workshop) -> list[Gallery]:
    """A gallery per data set: for each model the shapes with its worst scores by the first metric."""
    found = []
    of = next(iter(shop.results.leading.values()))
    for dataset in ("meshes", "clouds"):
        painters = {(painter.shape.item, painter.shape.view): painter for painter in scored_pictures(shop, dataset)}
        try:
            wide = statistics.scores(shop.results, dataset, of.name)
        except Missing:
            continue
        rows = [(model, tiles) for model in wide if model not in REFERENCES
                if (tiles := worst_tiles(shop, painters, wide[model].dropna(), model, of))]
        if rows:
            found.append(Gallery(f"The {spoken(dataset)} with a picture on which each model has its worst {of.label}: ground truth, and "
                                 f"the model's map before matching. Below: {leading_labels(shop)} of the matched map.", rows))
    return found


def worst_tiles(shop: Workshop, painters: Mapping[tuple[str, str], Painter], column: pandas.Series, model: str, of: Metric) -> list[Tile]:
    column = column[[key in painters and painters[key].has(model) for key in column.index]]
    tiles = []
    for key, score in column.sort_values(ascending=not of.lower, kind="stable").iloc[:WORST].items():
        title = f"{key[0]}, {of.label} " + f"{score:.3f}".replace("-", "−")
        tiles += [map_tile(shop, painters[key], "ground truth", "before", title), map_tile(shop, painters[key], model, "before", model)]
    return tiles
