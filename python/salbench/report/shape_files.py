# SPDX-License-Identifier: GPL-3.0-or-later
"""The files of one shape: its maps painted on its picture, and its script for the viewer. Drawn by several processes, and kept
while neither the shape nor what draws it changes."""

import sys
import zlib
from dataclasses import dataclass
from io import BytesIO
from typing import Any

import PIL
import h5py
import numpy
from PIL import features

from salbench.conclusions.units import Floats
from salbench.pages import viewer_parts
from salbench.pages.names import KIND_NAMES
from salbench.report import crew, exports, painting, viewer
from salbench.report.drawing import code_of
from salbench.report.exports import BROKEN, PLACES, Faces, Maps, Picture, Shape
from salbench.report.folder import Facts, Folder, digest
from salbench.report.workshop import Workshop

QUALITY, SMALL_QUALITY = 88, 78  # of WebP: no visible blocks; about 5 kB at 400 x 400, 3 kB at half of it
METHOD = 2  # of WebP: half the time of the usual 4, and 5 % more bytes
TRUTH = ("ground truth", "before")
DIFFERENCE = "difference"  # of a map from the ground truth, beside "before" and "after"


@dataclass(frozen=True)
class Task:
    """A shape and the names that its files get."""

    shape: Shape
    title: str    # in the viewer
    folder: str   # of its pictures
    script: str   # empty: without the viewer
    models: dict[str, str]  # model -> its part of file names
    picks: bool   # as dots on the ground truth

    def picture(self, what: str, when: str) -> str:
        of = self.shape.view or KIND_NAMES[self.shape.dataset].replace(" ", "-")
        return f"{self.folder}/{of}-{self.models[what]}-{when}{'-small' if self.shape.view else ''}.webp"


def draw_all(shop: Workshop) -> dict[str, Facts]:
    """shape name -> what its pages need to know: `picture` (whether it has one), `maps` ([what, when, path of the painted map or ""
    where it cannot be painted]), `script` (its path in shapes/, or ""), `picks` and
    `fixations` (how many of them are painted)."""
    tasks = {name: task_of(shop, shape) for name, shape in shop.shapes.shapes.items()}
    keys = {name: key_of(task) for name, task in tasks.items()}
    found = {name: one.facts for name, key in keys.items() if (one := shop.folder.find(key))}
    new = [(name, (task, shop.folder)) for name, task in tasks.items() if name not in found]
    for (name, _), (names, facts) in zip(new, crew.each(draw, new, shop.processes)):
        found[name] = shop.folder.add(keys[name], names, facts)
    return {name: found[name] for name in tasks}


def task_of(shop: Workshop, shape: Shape) -> Task:
    title = f"Scan {shape.view}" if shape.view else KIND_NAMES[shape.dataset].capitalize()
    script = f"{shop.shape_files[shape.name]}.js" if shop.viewer else ""
    return Task(shape, title, f"pictures/{shop.shape_files[shape.item]}", script, shop.model_files, shop.picks)


# Of what draws: files that something else drew are drawn again.
CODE = digest(code_of(exports, painting, viewer, viewer_parts, sys.modules[__name__]), painting.COLOURS.read_bytes(),
                   numpy.__version__, PIL.__version__, str(features.version("webp")), zlib.ZLIB_RUNTIME_VERSION)


def key_of(task: Task) -> str:
    """Of the shape's content, of all names and titles in its files, and of what draws them."""
    shape, stages = task.shape, stages_of(task.shape)
    models = {TRUTH[0], *(stage.partition(".")[2] for stage in stages)} & set(task.models)
    parts = [CODE, shape.name, shape.dataset, shape.item, shape.view, task.title, task.folder, task.script, str(task.picks)]
    parts += [text for model in sorted(models) for text in (model, task.models[model])]
    return digest(*parts, *(part for stage in stages for part in (stage, *content(shape.group, stage))))


def stages_of(shape: Shape) -> list[str]:
    """The groups of a shape that its files show, in the order of their names."""
    places = PLACES[shape.dataset]
    own = {path.split("/")[0] for path in (places.points, places.ground_truth, places.faces, places.normals, places.eye) if path}
    return [stage for stage in sorted(shape.group) if stage in own or stage.partition(".")[0] in ("gaze_hits", "map", "matched", "picture")]


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


def draw(work: tuple[Task, Folder]) -> tuple[list[str], Facts]:
    """Writes the files of a shape: their names, and the facts of draw_all."""
    task, folder = work
    shape = task.shape
    picture, points, faces, maps = shape.picture(), shape.points, shape.faces, maps_of(shape)
    names, painted = [], []
    fixations = shape.fixations
    picks = shape.picks[:0] if len(fixations) or not task.picks else shape.picks
    places = points[picks] if points is not None and len(picks) else fixations

    def write(name: str, data: bytes) -> None:
        folder.write(name, data)
        names.append(name)
    canvas = canvas_of(picture, faces)
    for (what, when), values in {**maps, **(differences(maps) if not shape.view else {})}.items():
        image = paint(canvas, values, when, when == "after" or (what, when) == TRUTH) if picture is not None else None
        if image is not None:
            if (what, when) == TRUTH and picture is not None:
                image = dotted(image, picture, places)
            write(task.picture(what, when), webp(image, small=bool(shape.view)))
        painted.append([what, when, task.picture(what, when) if image else ""])
    shown = {viewer.label_of(*key): values for key, values in maps.items()}
    script = viewer.script(shape, shown, task.title, picture) if task.script else None
    if script is not None:
        write(f"shapes/{task.script}", script.encode())
    return names, {"picture": picture is not None, "maps": painted, "script": task.script if script else "",
                   "picks": len(picks), "fixations": len(fixations)}


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
