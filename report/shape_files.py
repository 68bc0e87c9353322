# SPDX-License-Identifier: GPL-3.0-or-later
"""The files of one shape: its maps painted on its picture, and its script for the viewer. Drawn by several processes, and kept
while neither the shape nor what draws it changes."""

import sys
import zlib
from dataclasses import dataclass
from io import BytesIO

import h5py
import numpy
import PIL
from PIL import features

from report import crew, exports, kept, painting, viewer, viewer_parts
from report.exports import BROKEN, PLACES
from report.names import KIND_NAMES

QUALITY, SMALL_QUALITY = 88, 78  # of WebP: no visible blocks; about 5 kB at 400 x 400, 3 kB at half of it
METHOD = 2  # of WebP: half the time of the usual 4, and 5 % more bytes
TRUTH = ("ground truth", "before")
DIFFERENCE = "difference"  # of a map from the ground truth, beside "before" and "after"


@dataclass(frozen=True)
class Task:
    """A shape and the names that its files get."""

    shape: object
    title: str    # in the viewer
    folder: str   # of its pictures
    script: str
    models: dict  # model -> its part of file names

    def picture(self, what, when):
        of = self.shape.view or KIND_NAMES[self.shape.dataset].replace(" ", "-")
        return f"{self.folder}/{of}-{self.models[what]}-{when}{'-small' if self.shape.view else ''}.webp"


def draw_all(shop):
    """shape name -> what its pages need to know: `picture` (whether it has one), `maps` ([what, when, path of the painted map or ""
    where it cannot be painted]), `script` (its path in shapes/, or ""), `picks` (how many)."""
    tasks = {name: task_of(shop, shape) for name, shape in shop.shapes.shapes.items()}
    keys = {name: key_of(task) for name, task in tasks.items()}
    found = {name: shop.folder.find(key) for name, key in keys.items()}
    new = [(name, (task, shop.folder)) for name, task in tasks.items() if found[name] is None]
    for (name, _), (names, facts) in zip(new, crew.each(draw, new, shop.processes)):
        found[name] = shop.folder.add(keys[name], names, facts)
    return {name: one.facts for name, one in found.items()}


def task_of(shop, shape):
    title = f"Scan {shape.view}" if shape.view else KIND_NAMES[shape.dataset].capitalize()
    return Task(shape, title, f"pictures/{shop.shape_files[shape.item]}", f"{shop.shape_files[shape.name]}.js", shop.model_files)


# Of what draws: files that something else drew are drawn again.
CODE = kept.digest(kept.digest_of_code(exports, painting, viewer, viewer_parts, sys.modules[__name__]), painting.COLOURS.read_bytes(),
                   numpy.__version__, PIL.__version__, str(features.version("webp")), zlib.ZLIB_RUNTIME_VERSION)


def key_of(task):
    """Of the shape's content, of all names and titles in its files, and of what draws them."""
    shape, stages = task.shape, stages_of(task.shape)
    models = {TRUTH[0], *(stage.partition(".")[2] for stage in stages)} & set(task.models)
    parts = [CODE, shape.name, shape.dataset, shape.item, shape.view, task.title, task.folder, task.script]
    parts += [text for model in sorted(models) for text in (model, task.models[model])]
    return kept.digest(*parts, *(part for stage in stages for part in (stage, *content(shape.group, stage))))


def stages_of(shape):
    """The groups of a shape that its files show, in the order of their names."""
    places = PLACES[shape.dataset]
    own = {path.split("/")[0] for path in (places.points, places.ground_truth, places.faces, places.normals, places.eye) if path}
    return [stage for stage in sorted(shape.group) if stage in own or stage.partition(".")[0] in ("map", "matched", "picture")]


def content(group, stage):
    """The digest that the export has of an artefact, otherwise its arrays."""
    try:
        noted = group[stage].attrs.get("content")
        if noted is not None:
            return [exports.text(noted)]
        found = []

        def note(name, entry):
            if isinstance(entry, h5py.Dataset):
                values = numpy.asarray(entry[()])
                found.extend((name, f"{values.dtype.str} {values.shape}", values.tobytes()))
        group[stage].visititems(note)
        return found
    except BROKEN:
        return ["broken"]


def draw(work):
    """Writes the files of a shape: their names, and the facts of draw_all."""
    task, folder = work
    shape = task.shape
    picture, points, faces, maps = shape.picture(), shape.points, shape.faces, maps_of(shape)
    names, painted = [], []

    def write(name, data):
        kept.write(folder.file(name), data)
        names.append(name)
    canvas = canvas_of(picture, faces)
    for (what, when), values in {**maps, **(differences(maps) if not shape.view else {})}.items():
        image = paint(canvas, values, when) if picture is not None else None
        if image is not None:
            if (what, when) == TRUTH and points is not None:
                image = dotted(image, picture, shape.picks, points)
            write(task.picture(what, when), webp(image, small=bool(shape.view)))
        painted.append([what, when, task.picture(what, when) if image else ""])
    script = viewer.script(shape, {viewer.label_of(*key): values for key, values in maps.items()}, task.title, picture)
    if script is not None:
        write(f"shapes/{task.script}", script.encode())
    return names, {"picture": picture is not None, "maps": painted, "script": task.script if script else "",
                   "picks": len(shape.picks)}


def maps_of(shape):
    truth = shape.ground_truth
    return ({} if truth is None else {TRUTH: truth}) | shape.maps()


def differences(maps):
    """(model, DIFFERENCE) -> n in [-1, 1]: ranks of its map less those of the ground truth. Ranks, since of values those of a few
    peaks would be all that is seen, and since matching changes none."""
    truth = maps.get(TRUTH)
    found = {}
    for (model, when), values in maps.items():
        if (model, when) != TRUTH and truth is not None and len(values) == len(truth):
            found.setdefault((model, DIFFERENCE), ranks(values) - ranks(truth))
    return found


def ranks(values):
    """The share of the values that are lower, with 1 for the highest."""
    below = numpy.searchsorted(numpy.sort(values), values, side="left")
    return below / max(below.max(), 1)


def canvas_of(picture, faces):
    """None where the picture shows what the shape does not have: a damaged export."""
    try:
        return painting.Canvas(picture, faces) if picture is not None else None
    except (IndexError, *BROKEN):
        return None


def paint(canvas, values, when):
    try:
        return canvas.paint(values, "diverging" if when == DIFFERENCE else "palette") if canvas else None
    except (IndexError, *BROKEN):
        return None


def dotted(image, picture, picks, points):
    try:
        return painting.with_dots(image, painting.visible(picture, picks, points))
    except (IndexError, *BROKEN):
        return None


def webp(image, small):
    made = BytesIO()
    (image.reduce(2) if small else image).save(made, "WEBP", quality=SMALL_QUALITY if small else QUALITY, method=METHOD)
    return made.getvalue()
