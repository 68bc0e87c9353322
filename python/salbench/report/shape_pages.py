# SPDX-License-Identifier: GPL-3.0-or-later
"""A page per mesh or point cloud: its scores and ranks, its pictures, the scans of a mesh, and the viewer."""

from collections.abc import Iterable, Sequence
from functools import partial

import numpy
from markupsafe import Markup

from salbench.pages.blocks import Block, Cell, Gallery, Missing, Note, Table, Tile, attempt, cell
from salbench.pages.columns import Column, sheet, text
from salbench.pages.names import KIND_NAMES, spoken
from salbench.pages.viewer_parts import section
from salbench.report import recording, statistics
from salbench.report.exports import Shape, Shapes
from salbench.report.metrics import labels_with_maps
from salbench.report.names import natural
from salbench.report.pages import Pages
from salbench.report.painter import Painter, describe
from salbench.report.results import Shown
from salbench.report.shape_files import DIFFERENCE
from salbench.report.shape_scores import Scores
from salbench.report.viewer import entries, label_of
from salbench.report.workshop import Workshop


def items(results: Shown, shapes: Shapes) -> dict[str, str]:
    """item -> class of every mesh and point cloud that has scores or is in an export."""
    found = {item: (shapes.itself(item) or shapes.scans(item)[0]).category for item in shapes.items}
    try:
        found |= statistics.classes(results)
    except Missing:
        pass
    return {item: found[item] for item in sorted(found, key=natural)}


def score_columns(scores: Scores) -> list[Column]:
    """Per metric the score of a row (data set, item, view, model), and its rank below it; best of the shape in bold."""
    def show(row: tuple[str, str, str, str], metric: str) -> Cell:
        *shape, model = row
        value, rank, of = scores.of(shape[0], metric, *shape[1:]).get(model, (numpy.nan, numpy.nan, 0))
        return cell(value, bold=model in scores.best(shape[0], metric, *shape[1:]), below=f"{int(rank)} of {of}" if rank == rank else "")
    return [Column(of.label, partial(show, metric=metric)) for metric, of in scores.metrics.items()]


def score_table(shop: Workshop, scores: Scores, dataset: str, item: str) -> Table:
    models = [model for model in shop.models if any(model in scores.of(dataset, metric, item) for metric in scores.metrics)]
    kind = KIND_NAMES[dataset]
    if not models:
        left_out = ", its jobs failed, or the run left meshes out" if dataset == "meshes" else " or its jobs failed"
        raise Missing(f"The {kind} has no scores: it has no ground truth{left_out}.")
    return sheet("mesh-scores", f"Scores of the {kind}, best in bold; below, its place among all {spoken(dataset)} under the same model "
                 "(1: best score).", [MODEL_OF, *score_columns(scores)], [(dataset, item, "", model) for model in models])


MODEL_OF = text("Model", lambda row: row[3])


def scan_table(shop: Workshop, scores: Scores, item: str) -> Table:
    rows = [("scans", item, view, model) for view in scores.views(item) for model in shop.models
            if any(model in scores.of("scans", metric, item, view) for metric in scores.metrics)]
    if not rows:
        raise Missing("The scans of the mesh have no scores.")
    scan = Column("Scan", lambda row: Cell(row[2], int(row[2]) if row[2].isdigit() else None))
    return sheet("scan-scores", "Scores of the scans, best of each scan in bold; below, their place among all scans.",
                 [scan, MODEL_OF, *score_columns(scores)], rows, ["Scan", "Model"])


def tile(painter: Painter, scores: Scores, what: str, when: str) -> Tile:
    """One painted map with the scores of what it shows below."""
    title = label_of(what, when)
    if not painter.has(what, when):
        return Tile("", title, "Not in the export.")
    pieces = scores.pieces(painter.shape, what, when) if what != "ground truth" else []
    return Tile(painter.paint(what, when), title, painter.alt(what, when, title), pieces)


def gallery(painter: Painter, scores: Scores, models: Sequence[str], caption: str) -> Gallery:
    rows = []
    for when, label in (("before", "Before histogram matching"), ("after", "After histogram matching")):
        tiles = [tile(painter, scores, model, when) for model in models if painter.has(model, when)]
        if when == "before" and painter.has("ground truth"):
            tiles.insert(0, tile(painter, scores, "ground truth", "before"))
        rows.append((label, tiles))
    return Gallery(caption, [row for row in rows if row[1]])


def difference_gallery(painter: Painter, scores: Scores, models: Sequence[str]) -> list[Block]:
    """Where each model is wrong; none where no map can be compared."""
    tiles = [tile(painter, scores, model, DIFFERENCE) for model in models if painter.has(model, DIFFERENCE)]
    return [Gallery(f"Errors on {describe(painter.shape)}: ranks of the points on each model's map less those on the ground truth; "
                    "a point's rank is the share of points with lower values.", [("Difference to the ground truth", tiles)], differences=True)] if tiles else []


def models_of(shop: Workshop, maps: Iterable[tuple[str, str]]) -> list[str]:
    """Models in the order of the report; those that only the export knows come last."""
    found = {model for model, _ in maps if model != "ground truth"}
    return [model for model in shop.models if model in found] + sorted(found - set(shop.models))


def pictures(shop: Workshop, shape: Shape, painter: Painter, scores: Scores) -> list[Block]:
    if not painter.maps:
        raise Missing(f"The export holds no picture of {describe(shape)}: salbench export --pictures makes it.")
    score_text = f"Below: {labels_with_maps(scores.metrics.values())}; best in bold."
    models = models_of(shop, painter.maps)
    return [gallery(painter, scores, models, f"Saliency on {describe(shape)}. {score_text}"),
            *difference_gallery(painter, scores, models)]


def notes(shop: Workshop, item: str, exported: bool) -> list[Note]:
    """What a reader has to know first: what failed, and why there may be no pictures."""
    made = []
    for entry in shop.results.failed:
        if entry["item"] == item or entry["item"].rpartition("_")[0] == item:
            made.append(Note(f"{entry['stage']} failed on {entry['item']}: {entry['cause']}", missing=True))
    if not exported:
        made.append(Note(f"No export given to the report holds this shape, so that its pictures and the viewer are missing{why(shop)}: "
                         f"salbench export OUT/run.yaml --items {item} --for-report --to OUT/shapes.h5, then make the report again.",
                         missing=True))
    return made


def why(shop: Workshop) -> str:
    return f", and none could be made of the cache ({shop.lacking})" if shop.lacking else ""


def write_page(shop: Workshop, pages: Pages, item: str, category: str) -> None:
    """shapes/ITEM.html with its pictures and the viewer's data."""
    scores = shop.scores
    itself, views = shop.shapes.itself(item), shop.shapes.scans(item)
    dataset = itself.dataset if itself else scores.dataset_of(item)
    kind = KIND_NAMES[dataset]
    shapes = ([itself] if itself else []) + views
    painters = {shape.name: shop.painter(shape) for shape in shapes}
    titles = {shape.name: f"Scan {shape.view}" if shape.view else kind.capitalize() for shape in shapes}
    shown = entries(shapes, titles, shop.scripts)
    own_blocks = attempt(pictures, shop, itself, painters[itself.name], scores) if itself else []
    scans = [(f"Scan {shape.view}", attempt(pictures, shop, shape, painters[shape.name], scores)) for shape in views
             if painters[shape.name].maps]
    scan_blocks = attempt(scan_table, shop, scores, item) if dataset == "meshes" else []
    if views and not scans:
        scan_blocks += attempt(pictures, shop, views[0], painters[views[0].name], scores)
    if shop.results.has("gaze"):
        own_blocks += attempt(recording.of_shape, shop, item)
    first = models_of(shop, ((model, "") for model in shapes[0].models))[:1] if shapes else []
    pages.write(shop.page_of(item), "shape.html", title=f"{kind.capitalize()} {item}", kind=kind, item=item, category=category,
                viewer=Markup(section(shown, label_of(first[0], "before") if first else "")) if shown else "",
                score_blocks=attempt(score_table, shop, scores, dataset, item), own_blocks=own_blocks, scan_blocks=scan_blocks, scans=scans,
                notes=notes(shop, item, bool(shapes)), steps=steps(shop, item))


def steps(shop: Workshop, item: str) -> list[tuple[str, str, str]]:
    """(relation, item, page) of the shapes before and after this one."""
    order = list(shop.items)
    at = order.index(item)
    beside = [("prev", order[at - 1])] if at else []
    beside += [("next", order[at + 1])] if at + 1 < len(order) else []
    return [(relation, name, shop.page_of(name)) for relation, name in beside]
