# SPDX-License-Identifier: GPL-3.0-or-later
"""Painted pictures side by side: the paper's examples, before and after matching, difficult shapes, scans; and the page of all of them, to be
sorted by class, score and disagreement of the models, with the shapes that each model finds hardest."""

import json
from collections.abc import Mapping, Sequence
from io import BytesIO
from typing import Any

import pandas
from PIL import Image

from salbench.conclusions.units import REFERENCES
from salbench.pages.blocks import Gallery, Missing, Tile
from salbench.pages.names import spoken
from salbench.report import statistics
from salbench.report.drawing import Drawing
from salbench.report.exports import Shape
from salbench.report.metrics import Metric, labels_with_maps
from salbench.report.names import cut, natural
from salbench.report.pages import Page, Pages
from salbench.report.painter import Painter, describe
from salbench.report.painting import palette
from salbench.report.score_pages import rounded
from salbench.report.shape_pages import models_of
from salbench.report.viewer import label_of
from salbench.report.workshop import Workshop

CHANCE = "RS"  # has a map, but shows nothing that the paper's figures show
HOW = ("No export with pictures of {} was given. salbench export CONFIG --items LIST --pictures --to OUT/shapes.h5 "
       "puts them where the report looks; {}")


def scored_pictures(shop: Workshop, dataset: str) -> list[Painter]:
    """Painters of the shapes that have a picture and a mean score by the first metric, best first."""
    try:
        first = next(iter(shop.results.leading))
        place = {key: at for at, key in enumerate(statistics.mean_per_shape(shop.results, dataset, first).index)}
    except Missing:
        place = {}

    def order(painter: Painter) -> tuple[int, list[tuple[int, int, str]]]:
        return -place.get((painter.shape.item, painter.shape.view), -1), natural(painter.shape.name)
    return sorted((painter for painter in shop.painters if painter.shape.dataset == dataset), key=order)


def leading_labels(shop: Workshop) -> str:
    return labels_with_maps(shop.results.leading.values())


def map_tile(shop: Workshop, painter: Painter, what: str, when: str, title: str, scored: bool = True) -> Tile:
    shape = painter.shape
    picture = painter.paint(what, when)
    return Tile(picture, title, painter.alt(what, when, label_of(what, when)) if picture else "Not in the export.",
                shop.scores.pieces(shape, what) if scored and what != "ground truth" else [], shop.page_of(shape.item))


def rows_of_maps(shop: Workshop, painters: list[Painter]) -> list[tuple[str, list[Tile]]]:
    """Per shape the ground truth and every model's map before matching, scores below."""
    rows = []
    for painter in painters:
        models = [model for model in models_of(shop, painter.maps) if model != CHANCE and painter.has(model)]
        tiles = [map_tile(shop, painter, "ground truth", "before", "Ground truth")]
        tiles += [map_tile(shop, painter, model, "before", model) for model in models]
        rows.append((describe(painter.shape).capitalize(), tiles))
    return rows


def spread(painters: list[Painter], count: int) -> list[Painter]:
    """Some of the painters, evenly spread from the first to the one in the middle."""
    last = (len(painters) - 1) / 2
    at = dict.fromkeys(round(i * last / max(count - 1, 1)) for i in range(count))
    return [painters[i] for i in at]


def chosen(shop: Workshop, dataset: str, count: int) -> list[Painter]:
    """The shapes named with --examples, else from the best to the median by mean AUC."""
    painters = scored_pictures(shop, dataset)
    named = [painter for painter in painters if painter.shape.item in shop.examples]
    if not painters:
        raise Missing(HOW.format(spoken(dataset), "see docs/results.md."))
    return named[:count] if named else spread(painters, count)


def meshes(shop: Workshop) -> Gallery:
    gallery = Gallery(f"Saliency maps before histogram matching, with {leading_labels(shop)}; best in bold.",
                      rows_of_maps(shop, chosen(shop, "meshes", 2)))
    return printed(shop, "examples-meshes", gallery)


def scans(shop: Workshop) -> Gallery:
    gallery = Gallery(f"Saliency maps before histogram matching on simulated range scans, with {leading_labels(shop)}; best in bold.",
                      rows_of_maps(shop, chosen(shop, "scans", 4)))
    return printed(shop, "examples-scans", gallery)


def clouds(shop: Workshop) -> Gallery:
    gallery = Gallery(f"Saliency maps before histogram matching on point clouds, with {leading_labels(shop)}; best in bold.",
                      rows_of_maps(shop, chosen(shop, "clouds", 2)))
    return printed(shop, "examples-clouds", gallery)


def matching(shop: Workshop) -> Gallery:
    """One shape under every model, before and after."""
    painter = chosen(shop, "meshes", 1)[0]
    models = [model for model in models_of(shop, painter.maps) if painter.has(model) and painter.has(model, "after")]
    truth = map_tile(shop, painter, "ground truth", "before", "Ground truth")
    rows = [(label, ([truth] if when == "before" else []) + [map_tile(shop, painter, model, when, model, scored=False)
             for model in models]) for when, label in (("before", "Before"), ("after", "After"))]
    gallery = Gallery(f"Saliency maps of {describe(painter.shape)} before and after their histograms were matched to that "
                      "of the ground truth.", rows)
    return printed(shop, "matching", gallery)


def difficult(shop: Workshop, dataset: str, metric: str, count: int = 3) -> Gallery:
    """The shapes with the worst mean score: ground truth beside the best model's map."""
    of = shop.results.metric(metric)
    lowest_scoring = f"{'highest' if of.lower else 'lowest'}-scoring {spoken(dataset)} by {of.label}"
    mean = statistics.mean_per_shape(shop.results, dataset, metric)
    if mean.empty:
        raise Missing(f"No shape of the {spoken(dataset)} has a {of.label}.")
    wide = statistics.scores(shop.results, dataset, metric)
    painters = {(painter.shape.item, painter.shape.view): painter for painter in scored_pictures(shop, dataset)}
    lowest = list(mean.index[:count])
    absent = [item for item, view in lowest if (item, view) not in painters]
    if len(absent) == len(lowest):
        names = ", ".join(f"{item} ({mean[item, view]:.3f})" for item, view in lowest)
        raise Missing(f"The {lowest_scoring} are {names}. "
                      + HOW.format("them", f"LIST is {','.join(absent)}."))
    tiles = []
    for item, view in lowest:
        label = f"{item}, mean {mean[item, view]:.3f}"
        if (item, view) not in painters:
            tiles.append(Tile("", label, f"Not in the exports: add {item} to --items.", href=shop.page_of(item)))
            continue
        painter = painters[item, view]
        with_maps = [model for model in wide if painter.has(model) and model not in REFERENCES]
        best = of.best(wide.loc[(item, view), with_maps].astype(float).to_dict())
        tiles.append(map_tile(shop, painter, "ground truth", "before", label))
        if best:
            name = next(model for model in with_maps if model in best)
            tiles.append(map_tile(shop, painter, name, of.pictured, f"best: {name}"))
    gallery = Gallery(f"The {lowest_scoring}: ground truth, and the map of the model that scores best there, {of.pictured} "
                      f"matching; below: {leading_labels(shop)}.", [("", tiles)])
    return printed(shop, f"difficult-{dataset}-{shop.metric_files[metric]}", gallery)


def pixels(data: bytes) -> Any:
    """On white: it is for print."""
    picture = Image.open(BytesIO(data)).convert("RGBA")
    return Image.alpha_composite(Image.new("RGBA", picture.size, "white"), picture).convert("RGB")


Printed = tuple[str, bytes, list[tuple[str, bool]]]  # of a tile: title, picture, what stands below


def printed(shop: Workshop, name: str, gallery: Gallery) -> Gallery:
    """The gallery, with the same pictures as one figure for print."""
    rows: list[list[Printed]] = [[(tile.title, shop.folder.read(tile.picture) if tile.picture else b"", tile.pieces)
                                  for tile in tiles] for _, tiles in gallery.rows]
    size = 1.7 * max(map(len, rows)) + 0.9, 2.3 * len(rows) + 0.2
    file = shop.draw(name, Drawing(draw_gallery, (rows, palette(), size), size, layout=None))
    gallery.files = [("SVG", f"{file}.svg"), ("PDF", f"{file}.pdf")]
    return gallery


def draw_gallery(figure: Any, rows: list[list[Printed]], colours: Any, size: tuple[float, float]) -> None:
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import ListedColormap, Normalize

    width, height = size
    axes = figure.add_axes([0, 0, 1, 1])  # one for all tiles, in inches: one each would take half of the time
    axes.axis("off")
    for line, tiles in enumerate(rows):
        for at, (title, picture, pieces) in enumerate(tiles):
            left, top = 0.1 + 1.7 * at, height - 0.35 - 2.3 * line
            axes.text(left + 0.8, top + 0.05, cut(title), ha="center", va="bottom", fontsize=9, parse_math=False)
            if picture:
                axes.imshow(pixels(picture), extent=(left, left + 1.6, top - 1.6, top), aspect="auto")
                axes.text(left + 0.8, top - 1.65, ", ".join(rf"$\mathbf{{{text}}}$" if bold else text for text, bold in pieces),
                          ha="center", va="top", fontsize=9)
    axes.set(xlim=(0, width), ylim=(0, height))
    bar = figure.add_axes([1 - 0.65 / width, 0.2, 0.12 / width, 0.6])
    figure.colorbar(ScalarMappable(Normalize(0, 1), ListedColormap(colours / 255)), cax=bar)
    bar.grid(visible=False)


# --- the page ---------------------------------------------------------------------------------------------------------

WORST = 3  # shapes per model


def pictured(shop: Workshop) -> list[Painter]:
    """Painters of all shapes that the gallery shows, in the order of their names."""
    found = scored_pictures(shop, "meshes") + scored_pictures(shop, "clouds")
    shown = [painter for painter in found if painter.shape.item in shop.items]
    return sorted(shown, key=lambda painter: natural(painter.shape.name))


def write_page(pages: Pages, page: Page) -> None:
    shop = pages.shop
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
        pictures = {label_of(*key): path for key, path in painter.maps.items()}
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
                                 f"the model's map before matching. Below: {leading_labels(shop)}.", rows))
    return found


def worst_tiles(shop: Workshop, painters: Mapping[tuple[str, str], Painter], column: pandas.Series, model: str, of: Metric) -> list[Tile]:
    column = column[[key in painters and painters[key].has(model) for key in column.index]]
    tiles = []
    for key, score in column.sort_values(ascending=not of.lower, kind="stable").iloc[:WORST].items():
        title = f"{key[0]}, {of.label} " + f"{score:.3f}".replace("-", "−")
        tiles += [map_tile(shop, painters[key], "ground truth", "before", title), map_tile(shop, painters[key], model, "before", model)]
    return tiles
