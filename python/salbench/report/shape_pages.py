# SPDX-License-Identifier: GPL-3.0-or-later
"""A page per mesh or point cloud: its scores and ranks, its pictures, the scans of a mesh, and the viewer."""

from collections.abc import Iterable
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
from salbench.report.report import Report
from salbench.report.results import Shown
from salbench.report.shape_files import DIFFERENCE, title_of
from salbench.report.viewer import label_of


def items(results: Shown, shapes: Shapes) -> dict[str, str]:
    """item -> class, for every mesh and point cloud that has scores or is in an export."""
    found = {item: (shapes.itself(item) or shapes.scans(item)[0]).category for item in shapes.items}
    try:
        found |= statistics.classes(results)
    except Missing:
        pass
    return {item: found[item] for item in sorted(found, key=natural)}


MODEL_OF = text("Model", lambda row: row[3])  # row: (data set, item, view, model)


def score_columns(report: Report) -> list[Column]:
    """Columns with the score per metric, and its rank below it; best of the shape in bold."""

    def show(row: tuple[str, str, str, str], metric: str) -> Cell:
        *shape, model = row
        value, rank, of = report.scores.of(metric, *shape).get(model, (numpy.nan, numpy.nan, 0))
        return cell(
            value,
            bold=model in report.scores.best(metric, *shape),
            below=f"{int(rank)} of {of}" if rank == rank else "",
        )

    return [Column(of.label, partial(show, metric=metric)) for metric, of in report.results.leading.items()]


def scored(report: Report, dataset: str, item: str, view: str = "") -> list[tuple[str, str, str, str]]:
    """Rows of the models that have a score of the shape."""
    return [
        (dataset, item, view, model)
        for model in report.models
        if any(model in report.scores.of(metric, dataset, item, view) for metric in report.results.leading)
    ]


def score_table(report: Report, dataset: str, item: str) -> Table:
    rows, kind = scored(report, dataset, item), KIND_NAMES[dataset]
    if not rows:
        left_out = (
            ", its jobs failed, or the run left meshes out" if dataset == "meshes" else " or its jobs failed"
        )
        raise Missing(f"The {kind} has no scores: it has no ground truth{left_out}.")
    return sheet(
        "mesh-scores",
        (
            f"Scores of the {kind}, best in bold; below, its place among all {spoken(dataset)} under the same"
            " model (1: best score)."
        ),
        [MODEL_OF, *score_columns(report)],
        rows,
    )


def scan_table(report: Report, item: str) -> Table:
    rows = [row for view in report.scores.views(item) for row in scored(report, "scans", item, view)]
    if not rows:
        raise Missing("The scans of the mesh have no scores.")
    scan = Column("Scan", lambda row: Cell(row[2], int(row[2]) if row[2].isdigit() else None))
    return sheet(
        "scan-scores",
        "Scores of the scans, best of each scan in bold; below, their place among all scans.",
        [scan, MODEL_OF, *score_columns(report)],
        rows,
        ["Scan", "Model"],
    )


def tile(report: Report, shape: Shape, what: str, when: str) -> Tile:
    """A painted map with its scores below."""
    title = label_of(what, when)
    pieces = report.scores.pieces(shape, what, when) if what != "ground truth" else []
    return Tile(shape.painted[what, when], title, report.alt(shape, what, title), pieces)


def models_of(report: Report, maps: Iterable[tuple[str, str]]) -> list[str]:
    """Models in the order of the report; those only in the export come last, unless the pages are restricted
    to some models."""
    found = {model for model, _ in maps if model != "ground truth"}
    others = set() if report.results.wanted_models else found - set(report.models)
    return [model for model in report.models if model in found] + sorted(others)


def pictures(report: Report, shape: Shape) -> list[Block]:
    """Maps before and after matching, and each model's differences from the ground truth."""
    if not shape.painted:
        raise Missing(f"The export holds no picture of {shape}: salbench export --pictures makes it.")
    models = models_of(report, shape.painted)
    tiles = {
        when: [tile(report, shape, model, when) for model in models if shape.has(model, when)]
        for when in ("before", "after", DIFFERENCE)
    }
    if shape.has("ground truth"):
        tiles["before"].insert(0, tile(report, shape, "ground truth", "before"))
    rows = [
        (f"{when.capitalize()} histogram matching", tiles[when])
        for when in ("before", "after")
        if tiles[when]
    ]
    blocks: list[Block] = [
        Gallery(
            f"Saliency on {shape}. Below: {labels_with_maps(report.results.leading.values())}; best in"
            " bold, references aside.",
            rows,
        )
    ]
    if tiles[DIFFERENCE]:
        blocks.append(
            Gallery(
                (
                    f"Errors on {shape}: ranks of the points on each model's map less those on the ground"
                    " truth; a point's rank is the share of points with lower values."
                ),
                [("Difference to the ground truth", tiles[DIFFERENCE])],
                differences=True,
            )
        )
    return blocks


def notes(report: Report, item: str, exported: bool) -> list[Note]:
    """Notes for the top of the page: failures, and reasons for missing pictures."""
    made = []
    for entry in report.results.failed_jobs:
        if entry["item"] == item or entry["item"].rpartition("_")[0] == item:
            made.append(Note(f"{entry['stage']} failed on {entry['item']}: {entry['cause']}", missing=True))
    if not exported:
        why = f", and none could be made from the cache ({report.lacking})" if report.lacking else ""
        made.append(
            Note(
                (
                    "No export given to the report holds this shape, so that its pictures and the viewer are"
                    f" missing{why}: salbench export OUT/run.yaml --items {item} --for-report --to"
                    " OUT/shapes.h5, then make the report again."
                ),
                missing=True,
            )
        )
    return made


def write_page(report: Report, item: str, category: str) -> None:
    """Writes shapes/ITEM.html with its pictures and the viewer's data."""
    itself, views = report.shapes.itself(item), report.shapes.scans(item)
    dataset = itself.dataset if itself else report.scores.dataset_of(item)
    kind = KIND_NAMES[dataset]
    shapes = ([itself] if itself else []) + views
    shown = [
        {"name": shape.name, "title": title_of(shape), "path": shape.script}
        for shape in shapes
        if shape.script
    ]
    own_blocks = attempt(pictures, report, itself) if itself else []
    scans = [(f"Scan {shape.view}", attempt(pictures, report, shape)) for shape in views if shape.painted]
    scan_blocks = attempt(scan_table, report, item) if dataset == "meshes" else []
    if views and not scans:
        scan_blocks += attempt(pictures, report, views[0])
    if report.results.has("gaze"):
        own_blocks += attempt(recording.of_shape, report, item)
    first = models_of(report, shapes[0].stages)[:1] if shapes else []
    report.write_page(
        report.page_of(item),
        "shape.html",
        title=f"{kind.capitalize()} {item}",
        kind=kind,
        item=item,
        category=category,
        viewer=Markup(section(shown, label_of(first[0], "before") if first else "")) if shown else "",
        score_blocks=attempt(score_table, report, dataset, item),
        own_blocks=own_blocks,
        scan_blocks=scan_blocks,
        scans=scans,
        notes=notes(report, item, bool(shapes)),
        steps=steps(report, item),
    )


def steps(report: Report, item: str) -> list[tuple[str, str, str]]:
    """Tuples (relation, item, page) for the previous and next shape."""
    order = list(report.items)
    at = order.index(item)
    beside = [("prev", order[at - 1])] if at else []
    beside += [("next", order[at + 1])] if at + 1 < len(order) else []
    return [(relation, name, report.page_of(name)) for relation, name in beside]
