# SPDX-License-Identifier: GPL-3.0-or-later
"""The files of one shape: its maps painted on its picture, and its script for the viewer. Each has a name with a digest of what it shows.
They are drawn by several processes."""

from io import BytesIO
from typing import Any

import h5py
import numpy

from salbench.conclusions.units import Floats
from salbench.pages.names import KIND_NAMES
from salbench.report import crew, exports, painting, viewer
from salbench.report.drawing import code
from salbench.report.exports import BROKEN, Faces, Maps, Picture, Shape
from salbench.report.folder import digest
from salbench.report.workshop import Workshop

QUALITY, SMALL_QUALITY = 88, 78  # of WebP: no visible blocks; about 5 kB at 400 x 400, 3 kB at half of it
METHOD = 2  # of WebP: half the time of the usual 4, and 5 % more bytes
TRUTH = ("ground truth", "before")
DIFFERENCE = "difference"  # of a map from the ground truth, beside "before" and "after"


def draw_all(shop: Workshop) -> None:
    """Draws the files that are not there, and notes in the workshop those that are: a map that does not fit its shape cannot be painted."""
    shapes = shop.shapes.shapes.values()
    for shape in shapes:
        shop.pictures[shape.name], shop.scripts[shape.name] = names_of(shop, shape)
    shop.folder.add(path for shape in shapes for path in paths_of(shop, shape))
    crew.each(lambda shape: draw(shop, shape), [shape for shape in shapes if not all(map(shop.folder.has, paths_of(shop, shape)))], shop.processes)
    for shape in shapes:
        shop.pictures[shape.name] = {key: path for key, path in shop.pictures[shape.name].items() if shop.folder.has(path)}
        if not shop.folder.has(f"shapes/{shop.scripts[shape.name]}"):
            shop.scripts[shape.name] = ""


def paths_of(shop: Workshop, shape: Shape) -> list[str]:
    script = shop.scripts[shape.name]
    return [*shop.pictures[shape.name].values(), *([f"shapes/{script}"] if script else [])]


def names_of(shop: Workshop, shape: Shape) -> tuple[dict[tuple[str, str], str], str]:
    """(model, when) -> path of the painted map, as far as the export has what it shows; and the name of the script, "" for none."""
    places = shape.places
    points, truth = places.points.split("/")[0], places.ground_truth
    others = {path.split("/")[0] for path in (places.normals, places.eye) if path} | {"gaze_hits", "picture"}
    models = {(model, when): stage for kind, when in (("map", "before"), ("matched", "after")) for stage, model in parted(shape, kind)}
    stages = {stage: digest(*content(shape.group, stage)) for stage in (points, truth, *sorted(others), *models.values()) if stage in shape.group}
    script = f"{shop.shape_files[shape.name]}-{digest(code(), shape.name, title_of(shape), *(text for pair in stages.items() for text in pair))}.js"
    shown = {TRUTH: [truth, "gaze_hits"]} if truth in stages else {}
    shown |= {key: [stage] for key, stage in models.items()}
    if truth in stages and not shape.view:
        for (model, _), stage in models.items():
            shown.setdefault((model, DIFFERENCE), [truth, stage])

    def path(model: str, when: str, of: list[str]) -> str:
        key = digest(code(), shape.view, when, str((model, when) == TRUTH and shop.picks), *(stages.get(stage, "") for stage in ("picture", points, *of)))
        kind = shape.view or KIND_NAMES[shape.dataset].replace(" ", "-")
        return f"pictures/{shop.shape_files[shape.item]}/{kind}-{shop.model_files[model]}-{when}{'-small' if shape.view else ''}-{key}.webp"
    pictures = {key: path(*key, of) for key, of in shown.items()} if "picture" in stages else {}
    return pictures, script if shop.viewer and shape.has_points else ""


def parted(shape: Shape, kind: str) -> list[tuple[str, str]]:
    """(stage, model) of the stages "map.LS" or "matched.LS" of a shape, in the order of their names."""
    return [(stage, stage.partition(".")[2]) for stage in sorted(shape.group) if stage.startswith(f"{kind}.") and stage != f"{kind}."]


def title_of(shape: Shape) -> str:
    """In the viewer."""
    return f"Scan {shape.view}" if shape.view else KIND_NAMES[shape.dataset].capitalize()


def content(group: Any, stage: str) -> list[str | bytes]:
    """The digest that the export has of an artefact, otherwise its arrays."""
    try:
        noted = group[stage].attrs.get("content")
        if noted is not None:
            return [exports.text(noted)]
        found: list[str | bytes] = []

        def note(name: str, entry: Any) -> None:
            if isinstance(entry, h5py.Dataset):
                values = numpy.asarray(entry[()])
                found.extend((name, f"{values.dtype.str} {values.shape}", values.tobytes()))
        group[stage].visititems(note)
        return found
    except BROKEN:
        return ["broken"]


def draw(shop: Workshop, shape: Shape) -> None:
    """Writes the files of a shape that are not there."""
    picture, points, faces, maps = shape.picture(), shape.points, shape.faces, maps_of(shape)
    fixations = shape.fixations
    picks = shape.picks[:0] if len(fixations) or not shop.picks else shape.picks
    places = points[picks] if points is not None and len(picks) else fixations
    canvas = canvas_of(picture, faces)
    for (what, when), values in {**maps, **(differences(maps) if not shape.view else {})}.items():
        path = shop.pictures[shape.name].get((what, when), "")
        if picture is None or not path or shop.folder.has(path):
            continue
        image = paint(canvas, values, when, when == "after" or (what, when) == TRUTH)
        if image is not None and (what, when) == TRUTH:
            image = dotted(image, picture, places)
        if image is not None:
            shop.write(path, webp(image, small=bool(shape.view)))
    path = f"shapes/{shop.scripts[shape.name]}"
    if shop.scripts[shape.name] and not shop.folder.has(path):
        script = viewer.script(shape, {viewer.label_of(*key): values for key, values in maps.items()}, title_of(shape), picture)
        if script is not None:
            shop.write(path, script)


def maps_of(shape: Shape) -> Maps:
    truth = shape.ground_truth
    return ({} if truth is None else {TRUTH: truth}) | shape.maps()


def differences(maps: Maps) -> Maps:
    """(model, DIFFERENCE) -> n in [-1, 1]: ranks of its map less those of the ground truth. Ranks, since of values those of a few
    peaks would be all that is seen, and since matching changes none."""
    truth = maps.get(TRUTH)
    found: Maps = {}
    for (model, when), values in maps.items():
        if (model, when) != TRUTH and truth is not None and len(values) == len(truth):
            found.setdefault((model, DIFFERENCE), ranks(values) - ranks(truth))
    return found


def ranks(values: Floats) -> Floats:
    """The share of the values that are lower, with 1 for the highest."""
    below = numpy.searchsorted(numpy.sort(values), values, side="left")
    shares: Floats = below / max(below.max(), 1)
    return shares


def canvas_of(picture: Picture | None, faces: Faces | None) -> painting.Canvas | None:
    """None where the picture shows what the shape does not have: a damaged export."""
    try:
        return painting.Canvas(picture, faces) if picture is not None else None
    except (IndexError, *BROKEN):
        return None


def paint(canvas: painting.Canvas | None, values: Floats, when: str, of_truth: bool = False) -> Any:
    """The ground truth and maps matched to it have few high values: their square roots are painted, so that the others show."""
    shown = numpy.sqrt(values) if of_truth else values
    try:
        return canvas.paint(shown, "diverging" if when == DIFFERENCE else "palette") if canvas else None
    except (IndexError, *BROKEN):
        return None


def dotted(image: Any, picture: Picture, places: Floats) -> Any:
    try:
        return painting.with_dots(image, painting.visible(picture, places))
    except (IndexError, *BROKEN):
        return None


def webp(image: Any, small: bool) -> bytes:
    made = BytesIO()
    (image.reduce(2) if small else image).save(made, "WEBP", quality=SMALL_QUALITY if small else QUALITY, method=METHOD)
    return made.getvalue()
