# SPDX-License-Identifier: GPL-3.0-or-later
"""Files of one shape: its maps painted on its picture, and its script for the viewer. File names contain a
digest of the content. Several processes draw them."""

from contextlib import suppress
from functools import partial
from io import BytesIO
from typing import Any

import h5py
import numpy

from salbench.conclusions.units import Floats
from salbench.pages.names import KIND_NAMES
from salbench.report import exports, painting, viewer
from salbench.report.drawing import code
from salbench.report.exports import BROKEN, Maps, Shape
from salbench.report.folder import digest
from salbench.report.report import Report

QUALITY, SMALL_QUALITY = 88, 78  # WebP without visible blocks; about 5 kB at 400 x 400, 3 kB at half of it
METHOD = 2  # WebP effort: half the time of the usual 4, and 5 % more bytes
TRUTH = ("ground truth", "before")
DIFFERENCE = "difference"  # map minus ground truth, beside "before" and "after"


def draw_all(report: Report) -> None:
    """Draws the missing files, and records the existing ones in the shapes: a map that does not fit its shape
    cannot be painted."""
    shapes = report.shapes.shapes.values()
    for shape in shapes:
        shape.painted, shape.script = names_of(report, shape)
        report.folder.add(paths_of(shape))
    report.draw_each(
        "shapes",
        partial(draw, report),
        [shape for shape in shapes if not all(map(report.folder.has, paths_of(shape)))],
    )
    for shape in shapes:
        shape.painted = {key: path for key, path in shape.painted.items() if report.folder.has(path)}
        shape.script = shape.script if report.folder.has(f"shapes/{shape.script}") else ""


def paths_of(shape: Shape) -> list[str]:
    return [*shape.painted.values(), *([f"shapes/{shape.script}"] if shape.script else [])]


def names_of(report: Report, shape: Shape) -> tuple[dict[tuple[str, str], str], str]:
    """(model, when) -> path of the painted map, for maps in the export; and the name of the script, "" for
    none."""
    places = shape.places
    points, truth = places.points.split("/")[0], places.ground_truth
    others = {path.split("/")[0] for path in (places.normals, places.eye) if path} | {"gaze_hits", "picture"}
    known = [
        stage for stage in (points, truth, *sorted(others), *shape.stages.values()) if stage in shape.group
    ]
    digests = {stage: digest(*content(shape.group, stage)) for stage in known}
    digests["left out"] = digest(*sorted(shape.left_out))
    shown = {TRUTH: [truth, "gaze_hits", "left out"]} if truth in known else {}
    shown |= {key: [stage] for key, stage in shape.stages.items()}
    if truth in known and not shape.view:
        for (model, _), stage in shape.stages.items():
            shown.setdefault((model, DIFFERENCE), [truth, stage])
    kind = shape.view or KIND_NAMES[shape.dataset].replace(" ", "-")

    def path(model: str, when: str, stages: list[str]) -> str:
        picks = str((model, when) == TRUTH and report.picks)
        key = digest(
            code(),
            shape.view,
            when,
            picks,
            *(digests.get(stage, "") for stage in ("picture", points, *stages)),
        )
        return f"pictures/{report.shape_files[shape.item]}/{kind}-{report.model_files[model]}-{when}{'-small' if shape.view else ''}-{key}.webp"

    painted = {key: path(*key, stages) for key, stages in shown.items()} if "picture" in known else {}
    key = digest(code(), shape.name, title_of(shape), *(text for pair in digests.items() for text in pair))
    return painted, f"{report.shape_files[shape.name]}-{key}.js" if report.viewer and shape.has_points else ""


def title_of(shape: Shape) -> str:
    """Title in the viewer."""
    return f"Scan {shape.view}" if shape.view else KIND_NAMES[shape.dataset].capitalize()


def content(group: Any, stage: str) -> list[str | bytes]:
    """Digest of an artefact from the export, otherwise its arrays."""
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


def draw(report: Report, shape: Shape) -> None:
    """Writes the missing files of a shape."""
    truth, picture = shape.ground_truth, shape.picture()
    canvas: painting.Canvas | None = None
    maps: Maps = ({} if truth is None else {TRUTH: truth}) | shape.maps()
    for key, values in {**maps, **({} if shape.view else differences(maps))}.items():
        path = shape.painted.get(key, "")
        if picture is None or not path or report.folder.has(path):
            continue
        image = None
        # damaged export: the page reports the missing picture
        with suppress(IndexError, *BROKEN):
            canvas = canvas or painting.Canvas(picture, shape.faces)
            image = paint(canvas, key, values)
            if key == TRUTH:
                dots = dots_of(shape) if report.picks else numpy.zeros((0, 3))
                image = painting.with_dots(image, painting.visible(picture, dots))
        if image is not None:
            report.folder.put(path, webp(image, small=bool(shape.view)))
    path = f"shapes/{shape.script}"
    if shape.script and not report.folder.has(path):
        script = viewer.script(
            shape, {viewer.label_of(*key): values for key, values in maps.items()}, title_of(shape), picture
        )
        if script is not None:
            report.folder.put(path, script.encode())


def paint(canvas: painting.Canvas, key: tuple[str, str], values: Floats) -> Any:
    """Paints square roots, since the ground truth has few high values, which would hide the others; maps use
    the same scale."""
    return canvas.paint(values, "diverging") if key[1] == DIFFERENCE else canvas.paint(numpy.sqrt(values))


def dots_of(shape: Shape) -> Floats:
    """Fixations, otherwise picks: k x 3."""
    fixations, points = shape.fixations, shape.points
    return points[shape.picks] if len(fixations) == 0 and points is not None else fixations


def differences(maps: Maps) -> Maps:
    """(model, DIFFERENCE) -> n in [-1, 1]: ranks in its map minus those in the ground truth. Values would
    show only a few peaks, and matching does not change ranks."""
    truth = maps.get(TRUTH)
    found: Maps = {}
    for (model, when), values in maps.items():
        if (model, when) != TRUTH and truth is not None and len(values) == len(truth):
            found.setdefault((model, DIFFERENCE), ranks(values) - ranks(truth))
    return found


def ranks(values: Floats) -> Floats:
    """Fraction of the values that are lower, scaled to 1 for the highest."""
    below = numpy.searchsorted(numpy.sort(values), values, side="left")
    shares: Floats = below / max(below.max(), 1)
    return shares


def webp(image: Any, small: bool) -> bytes:
    made = BytesIO()
    (image.reduce(2) if small else image).save(
        made, "WEBP", quality=SMALL_QUALITY if small else QUALITY, method=METHOD
    )
    return made.getvalue()
