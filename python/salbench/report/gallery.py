# SPDX-License-Identifier: GPL-3.0-or-later
"""Painted pictures side by side: the paper's examples, before and after matching, difficult shapes, scans.
Also the page of all pictures, sortable by class, score and disagreement of the models, with each model's
hardest shapes."""

from collections.abc import Mapping, Sequence
from io import BytesIO
from typing import Any

import pandas
from PIL import Image

from salbench.conclusions.units import REFERENCES
from salbench.pages.blocks import Gallery, Missing, Tile
from salbench.pages.names import spoken
from salbench.report import statistics, style
from salbench.report.drawing import Drawing
from salbench.report.exports import Shape
from salbench.report.metrics import Metric, labels_with_maps
from salbench.report.names import natural, short
from salbench.report.painting import palette
from salbench.report.report import Page, Report
from salbench.report.score_pages import rounded, script_of
from salbench.report.shape_pages import models_of
from salbench.report.viewer import label_of

CHANCE = "RS"  # has a map, but the paper's figures do not show it: only by request
ON = {"meshes": "", "scans": " on simulated range scans", "clouds": " on point clouds"}  # in captions
HOW = (
    "No export with pictures of {} was given. salbench export CONFIG --items LIST --pictures --to"
    " OUT/shapes.h5 puts them where the report looks; {}"
)


def scored_pictures(report: Report, dataset: str) -> list[Shape]:
    """Shapes with a picture of their ground truth: first those with a mean score by the first metric, best
    first."""
    try:
        first = next(iter(report.results.leading))
        place = {
            key: at for at, key in enumerate(statistics.mean_per_shape(report.results, dataset, first).index)
        }
    except Missing:
        place = {}

    def order(shape: Shape) -> tuple[int, list[tuple[int, int, str]]]:
        return -place.get((shape.item, shape.view), -1), natural(shape.name)

    return sorted(
        (
            shape
            for shape in report.shapes.shapes.values()
            if shape.dataset == dataset and shape.has("ground truth")
        ),
        key=order,
    )


def leading_labels(report: Report) -> str:
    return labels_with_maps(report.results.leading.values())


def map_tile(report: Report, shape: Shape, what: str, when: str, title: str, scored: bool = True) -> Tile:
    picture = shape.painted.get((what, when), "")
    return Tile(
        picture,
        title,
        report.alt(shape, what, label_of(what, when)) if picture else "Not in the export.",
        report.scores.pieces(shape, what) if scored and what != "ground truth" else [],
        report.page_of(shape.item),
    )


def row_of_maps(report: Report, shape: Shape) -> tuple[str, list[Tile]]:
    """The ground truth and every model's map, with scores below: before matching, unless it came matched."""
    models = [
        model
        for model in models_of(report, shape.painted)
        if model != CHANCE or model in report.results.wanted_models
    ]
    name = str(shape)
    return name[0].upper() + name[1:], [
        map_tile(report, shape, "ground truth", "before", "Ground truth"),
        *(
            map_tile(report, shape, model, "before", model)
            if shape.has(model)
            else map_tile(report, shape, model, "after", label_of(model, "after"))
            for model in models
        ),
    ]


def chosen(report: Report, dataset: str, count: int) -> list[Shape]:
    """Shapes named with --examples, otherwise a few evenly spread from the best to the median by mean AUC."""
    shapes = scored_pictures(report, dataset)
    if not shapes:
        raise Missing(HOW.format(spoken(dataset), "see docs/results.md."))
    if named := [shape for shape in shapes if shape.item in report.examples]:
        return named[:count]
    last = (len(shapes) - 1) / 2
    return [shapes[at] for at in dict.fromkeys(round(i * last / max(count - 1, 1)) for i in range(count))]


def examples(report: Report, dataset: str, count: int) -> Gallery:
    """Every model's map of a few shapes."""
    gallery = Gallery(
        f"Saliency maps before histogram matching{ON[dataset]}, with {leading_labels(report)}; best in bold.",
        [row_of_maps(report, shape) for shape in chosen(report, dataset, count)],
    )
    return printed(report, f"examples-{dataset}", gallery)


def matching(report: Report) -> Gallery:
    """One shape under every model, before and after matching."""
    shape = chosen(report, "meshes", 1)[0]
    models = [
        model for model in models_of(report, shape.painted) if shape.has(model) and shape.has(model, "after")
    ]
    truth = map_tile(report, shape, "ground truth", "before", "Ground truth")
    rows = [
        (
            when.capitalize(),
            [truth, *(map_tile(report, shape, model, when, model, scored=False) for model in models)],
        )
        for when in ("before", "after")
    ]
    gallery = Gallery(
        (
            f"Saliency maps of {shape} before and after their histograms were matched to that of the ground"
            " truth."
        ),
        rows,
    )
    return printed(report, "matching", gallery)


def difficult(report: Report, dataset: str, metric: str, count: int = 3) -> Gallery:
    """Shapes with the worst mean score: ground truth beside the best model's map."""
    of = report.results.metric(metric)
    lowest_scoring = f"{'highest' if of.lower else 'lowest'}-scoring {spoken(dataset)} by {of.label}"
    mean = statistics.mean_per_shape(report.results, dataset, metric)
    if mean.empty:
        raise Missing(f"No shape of the {spoken(dataset)} has a {of.label}.")
    wide = statistics.scores(report.results, dataset, metric)
    pictured = {(shape.item, shape.view): shape for shape in scored_pictures(report, dataset)}
    lowest = list(mean.index[:count])
    absent = [item for item, view in lowest if (item, view) not in pictured]
    if len(absent) == len(lowest):
        names = ", ".join(f"{item} ({mean[item, view]:.3f})" for item, view in lowest)
        raise Missing(
            f"The {lowest_scoring} are {names}. " + HOW.format("them", f"LIST is {','.join(absent)}.")
        )
    tiles = []
    for item, view in lowest:
        label = f"{item}, mean {mean[item, view]:.3f}"
        if (item, view) not in pictured:
            tiles.append(
                Tile("", label, f"Not in the exports: add {item} to --items.", href=report.page_of(item))
            )
            continue
        shape = pictured[item, view]
        with_maps = [model for model in wide if shape.has(model) and model not in REFERENCES]
        best = of.best(wide.loc[(item, view), with_maps].astype(float).to_dict())
        tiles.append(map_tile(report, shape, "ground truth", "before", label))
        if best:
            name = next(model for model in with_maps if model in best)
            tiles.append(map_tile(report, shape, name, of.pictured, f"best: {name}"))
    gallery = Gallery(
        (
            f"The {lowest_scoring}: ground truth, and the map of the model that scores best there,"
            f" {of.pictured} matching; below: {leading_labels(report)}."
        ),
        [("", tiles)],
    )
    return printed(report, f"difficult-{dataset}-{report.metric_files[metric]}", gallery)


def pixels(data: bytes) -> Any:
    """Blends with white, for print."""
    picture = Image.open(BytesIO(data)).convert("RGBA")
    return Image.alpha_composite(Image.new("RGBA", picture.size, "white"), picture).convert("RGB")


Printed = tuple[str, bytes, list[tuple[str, bool]]]  # a tile: title, picture, one score per metric
WIDTH, LINE = 1.7, 0.17  # inches: a picture with the gap behind it, a line of text


def printed(report: Report, name: str, gallery: Gallery, svg_dpi: int = style.SCREEN_DPI) -> Gallery:
    """The gallery, also as one figure for print."""
    labels = short(label for label, _ in gallery.rows)
    rows: list[tuple[str, list[Printed]]] = [
        (
            labels[label],
            [
                (
                    tile.title,
                    (report.folder.path / tile.picture).read_bytes() if tile.picture else b"",
                    tile.pieces,
                )
                for tile in tiles
            ],
        )
        for label, tiles in gallery.rows
    ]
    metrics = (
        [of.label for of in report.scores.metrics.values()]
        if any(pieces for _, tiles in rows for _, _, pieces in tiles)
        else []
    )
    file = report.draw(
        name,
        Drawing(
            draw_gallery, (rows, metrics, palette()), placed(rows, metrics)[2], layout=None, svg_dpi=svg_dpi
        ),
    )
    gallery.files = [("SVG", f"{file}.svg"), ("PDF", f"{file}.pdf")]
    return gallery


def placed(
    rows: Sequence[tuple[str, list[Printed]]], metrics: Sequence[str]
) -> tuple[float, list[tuple[float, bool]], tuple[float, float]]:
    """Layout in inches: left edges of the pictures; per row, distance of its upper edge from the top, and
    True if it has titles (left out if equal to those above); and the size of the figure."""
    left, height = 0.2 + 0.08 * max(map(len, [*metrics, *(label for label, _ in rows)]), default=0), 0.05
    tops: list[tuple[float, bool]] = []
    titles: list[str] = []
    for _, tiles in rows:
        has_titles = titles != (titles := [title for title, _, _ in tiles])
        height += 1.5 * LINE * has_titles
        tops.append((height, has_titles))
        height += WIDTH + LINE * len(metrics)
    return left, tops, (left + WIDTH * max(len(tiles) for _, tiles in rows) + 0.9, height)


def draw_gallery(
    figure: Any, rows: Sequence[tuple[str, list[Printed]]], metrics: Sequence[str], colours: Any
) -> None:
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import ListedColormap, PowerNorm

    start, tops, (width, height) = placed(rows, metrics)
    axes = figure.add_axes([0, 0, 1, 1])  # one for all tiles, in inches: one each takes twice the time
    axes.axis("off")
    # white behind all pictures, which are stored as one: between them it would be transparent black, and
    # viewers would show its edges
    axes.imshow(Image.new("RGB", (1, 1), "white"), extent=(0, width, 0, height), aspect="auto")
    for (label, tiles), (down, has_titles) in zip(rows, tops):
        top = height - down
        below = [top - WIDTH - LINE * at for at in range(len(metrics))]
        for y, text in ((top - WIDTH / 2, label), *zip(below, metrics)):
            axes.text(start - 0.1, y, text, ha="right", va="center", fontsize=9, parse_math=False)
        titles = short(title for title, _, _ in tiles)
        for at, (title, picture, pieces) in enumerate(tiles):
            left = start + WIDTH * at
            if has_titles:
                axes.text(
                    left + 0.8,
                    top + 0.05,
                    titles[title],
                    ha="center",
                    va="bottom",
                    fontsize=9,
                    parse_math=False,
                )
            if picture:
                axes.imshow(pixels(picture), extent=(left, left + 1.6, top - 1.6, top), aspect="auto")
            for y, (text, bold) in zip(below, pieces):
                axes.text(
                    left + 0.8,
                    y,
                    text,
                    ha="center",
                    va="center",
                    fontsize=9,
                    weight="bold" if bold else "normal",
                    parse_math=False,
                )
    axes.set(xlim=(0, width), ylim=(0, height))
    bar = figure.add_axes([1 - 0.75 / width, 0.2, 0.12 / width, 0.6])
    figure.colorbar(
        ScalarMappable(PowerNorm(0.5, 0, 1), ListedColormap(colours / 255)),
        cax=bar,
        ticks=[0, 0.1, 0.25, 0.5, 1],
        format="%g",
    )
    bar.set_title("Value", fontsize=9)
    bar.tick_params(labelsize=9)
    bar.grid(visible=False)


# --- the page -----------------------------------------------------------------------------------------------

WORST = 3  # per model


def pictured(report: Report) -> list[Shape]:
    """All shapes of the gallery, in the order of their names."""
    found = scored_pictures(report, "meshes") + scored_pictures(report, "clouds")
    return sorted(
        (shape for shape in found if shape.item in report.items), key=lambda shape: natural(shape.name)
    )


def write_page(report: Report, page: Page) -> None:
    """Writes gallery.html, and its data as data/gallery.js."""
    data = gallery_data(report)
    report.folder.write("data/gallery.js", script_of("salbench.gallery", data))
    report.write_page(
        page.path,
        "gallery.html",
        title=page.label,
        data=data,
        worst=worst(report),
        classes=sorted({shape["class"] for shape in data["shapes"]}),
        tiles=[(shape, report.page_of(shape["item"])) for shape in data["shapes"]],
    )


def gallery_data(report: Report) -> dict[str, Any]:
    """Dict {models, metrics, lower, maps: labels of the menu, shapes: [{item, class, pictures: {label: path},
    scores: {metric: [per model]}}]}; models: those with scores, without references."""
    leading = report.results.leading
    models = [model for model in report.models if model not in REFERENCES]
    shapes = [
        {
            "item": shape.item,
            "class": report.items[shape.item],
            "pictures": {label_of(*key): path for key, path in shape.painted.items()},
            "scores": {metric: scores_of(report, shape, metric, models) for metric in leading},
        }
        for shape in pictured(report)
    ]
    order = [
        label_of("ground truth", "before"),
        *(
            label_of(model, when)
            for when in ("before", "after", "difference")
            for model in models_of(report, [(name, "") for name in report.model_files])
        ),
    ]
    return {
        "models": models,
        "metrics": {metric: of.label for metric, of in leading.items()},
        "lower": [metric for metric, of in leading.items() if of.lower],
        "maps": [label for label in order if any(label in shape["pictures"] for shape in shapes)],
        "shapes": shapes,
    }


def scores_of(report: Report, shape: Shape, metric: str, models: Sequence[str]) -> list[float | None]:
    """Score of each model; null if missing."""
    scores = report.scores.of(metric, shape.dataset, shape.item, shape.view)
    return [rounded(scores[model][0]) if model in scores else None for model in models]


def worst(report: Report) -> list[Gallery]:
    """Returns a gallery per data set: for each model its worst shapes by the first metric."""
    found = []
    of = next(iter(report.results.leading.values()))
    for dataset in ("meshes", "clouds"):
        shapes = {(shape.item, shape.view): shape for shape in scored_pictures(report, dataset)}
        try:
            wide = statistics.scores(report.results, dataset, of.name)
        except Missing:
            continue
        rows = [
            (model, tiles)
            for model in wide
            if model not in REFERENCES
            if (tiles := worst_tiles(report, shapes, wide[model].dropna(), model, of))
        ]
        if rows:
            found.append(
                Gallery(
                    (
                        f"The {spoken(dataset)} with a picture on which each model has its worst {of.label}:"
                        " ground truth, and the model's map before matching. Below:"
                        f" {leading_labels(report)}."
                    ),
                    rows,
                )
            )
    return found


def worst_tiles(
    report: Report, shapes: Mapping[tuple[str, str], Shape], column: pandas.Series, model: str, of: Metric
) -> list[Tile]:
    column = column[[key in shapes and shapes[key].has(model) for key in column.index]]
    tiles = []
    for key, score in column.sort_values(ascending=not of.lower, kind="stable").iloc[:WORST].items():
        title = f"{key[0]}, {of.label} " + f"{score:.3f}".replace("-", "−")
        tiles += [
            map_tile(report, shapes[key], "ground truth", "before", title),
            map_tile(report, shapes[key], model, "before", model),
        ]
    return tiles
