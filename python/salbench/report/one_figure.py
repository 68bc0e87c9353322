# SPDX-License-Identifier: GPL-3.0-or-later
"""A single figure: a row per chosen shape with ground truth, maps and scores, from a chosen side."""

import re
import shutil
from collections.abc import Iterator, Mapping, Sequence
from math import ceil
from pathlib import Path

from salbench.pages.blocks import Gallery, Missing, Tile
from salbench.report import gallery, own_export, shape_files, shape_pages, style
from salbench.report.exports import Shape, Shapes
from salbench.report.folder import Folder
from salbench.report.mine import require
from salbench.report.report import Report
from salbench.report.results import Shown
from salbench.system.errors import InputError, arguments_refused
from salbench.system.progress import Told, nothing

View = tuple[float, float]  # azimuth and elevation of the camera, degrees; options of `picture`
NAME = "figure"
_TILES = 6  # in a line, the most


def write_figure(
    out: Path,
    scratch: Path,
    to: Path,
    *,
    shapes: Sequence[str],
    models: Sequence[str] = (),
    metrics: Sequence[str] = (),
    views: Mapping[str, View] | None = None,
    picks: bool = False,
    processes: int = 1,
    told: Told = nothing,
) -> Path:
    """Writes figure.pdf and figure.svg in the folder `to`, and returns the path of the first. InputError for
    a shape without a picture. scratch: an empty folder. shapes: names, such as "52", or "52_3" for a scan;
    one row each. models, metrics: default: all, and the leading ones. picks: as of `write_report`.
    views: not of scans, nor of point clouds with a viewpoint, which are shown from there."""
    with arguments_refused():
        results = Shown(out, metrics=metrics, models=models)
    require(results)
    exported = _exported(results, scratch, shapes, views or {}, told)
    with Folder(scratch / "report") as folder:
        report = Report(
            results,
            folder,
            exported,
            shape_pages.items(results, exported),
            processes=processes,
            picks=picks,
            told=told,
        )
        report.models = list(dict.fromkeys(models)) or report.models
        shape_files.draw_all(report)
        drawn_shapes = [_named(exported, name) for name in shapes]
        for model in models:
            if not any(shape.has(model, when) for shape in drawn_shapes for when in ("before", "after")):
                raise InputError(f"figure: {model} has no map of {', '.join(shapes)}")
        rows = [gallery.row_of_maps(report, shape) for shape in drawn_shapes]
        drawn = gallery.printed(report, NAME, Gallery("", list(wrapped(rows))), style.PRINT_DPI)
        report.draw_figures()
        to.mkdir(parents=True, exist_ok=True)
        for _, path in drawn.files:
            shutil.copyfile(folder.path / path, to / f"{NAME}{Path(path).suffix}")
        folder.finish()
    return to / f"{NAME}.pdf"


def wrapped(rows: Sequence[tuple[str, list[Tile]]]) -> Iterator[tuple[str, list[Tile]]]:
    """Breaks rows that are too wide for a page into lines of about equal length."""
    for label, tiles in rows:
        each = ceil(len(tiles) / ceil(len(tiles) / _TILES))
        for at in range(0, len(tiles), each):
            yield label if at == 0 else "", tiles[at : at + each]


def _exported(
    results: Shown, scratch: Path, shapes: Sequence[str], views: Mapping[str, View], told: Told
) -> Shapes:
    """The shapes of the figure; those with a view from an export of their own, on the axis that is upright in
    their usual picture."""
    if unknown := [name for name in views if name not in shapes]:
        raise InputError(f"view of {unknown[0]}: is not among the shapes of the figure")
    if lacking := own_export.made_in_python(results):
        raise InputError(lacking)
    try:
        items = set(results.table("results")["item"])
    except Missing as missing:
        raise InputError(f"{results.folder}: {missing}") from None

    def export(config: Path, names: Sequence[str], to: str) -> Shapes:
        found, lacking = own_export.export(config, names, scratch / to, told)
        if lacking:
            raise InputError(lacking)
        return Shapes(found)

    config = results.folder / "run.yaml"
    exported = export(
        config, [name if name in items else name.rpartition("_")[0] or name for name in shapes], "usual.h5"
    )
    exported.shapes = {name: shape for name, shape in exported.shapes.items() if name in shapes}
    record = config.read_text(encoding="utf-8", errors="surrogateescape")
    for number, (name, view) in enumerate(views.items()):
        shape = exported.shapes.get(name)
        picture = shape.picture() if shape else None
        if shape is None or picture is None:
            continue  # `_named` reports it
        eye, points = shape.seen_from(), shape.points
        if eye is not None and points is not None and ((eye < points.min(0)) | (eye > points.max(0))).any():
            raise InputError(f"view of {name}: it is shown from where it was scanned")
        turned = scratch / f"{number}.yaml"
        turned.write_text(
            with_view(record, view, picture.camera()[1]), encoding="utf-8", errors="surrogateescape"
        )
        of_view = export(turned, [name], f"{number}.h5")
        exported.files += of_view.files
        exported.shapes[name] = of_view.shapes[name]
    return exported


def with_view(record: str, view: View, up: str) -> str:
    """A run.yaml with the camera on this side, and the axis `up` upright unless it names one."""
    options = {"azimuth": f"{view[0]:g}", "elevation": f"{view[1]:g}"}
    above, section, picture = record.partition("\n  picture:\n")
    if not section:
        made = f"  picture: {{up: {up}, {', '.join(map(': '.join, options.items()))}}}"
        return record.replace("\nconfiguration:\n", f"\nconfiguration:\n{made}\n", 1)
    for key, value in options.items():
        picture = re.sub(rf"(?m)^    {key}: .*$", f"    {key}: {value}", picture, count=1)
    return above + section + picture.replace("    up: automatic\n", f"    up: {up}\n", 1)


def _named(shapes: Shapes, name: str) -> Shape:
    shape = shapes.shapes.get(name)
    if shape is None or not shape.painted:
        raise InputError(f"figure: {name} has no picture; is it a shape of the run?")
    return shape
