# SPDX-License-Identifier: GPL-3.0-or-later
"""A single figure: a row per chosen shape with ground truth, maps and scores, from a chosen side."""

import re
import shutil
from collections.abc import Iterator, Mapping, Sequence
from math import ceil
from pathlib import Path

from salbench.pages.blocks import Gallery, Missing, Tile
from salbench.report import gallery, own_export, shape_files, shape_pages
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
    processes: int = 1,
    told: Told = nothing,
) -> Path:
    """Writes figure.pdf and figure.svg in the folder `to`, and returns the path of the first. InputError for
    a shape without a picture. scratch: an empty folder. shapes: names, such as "52", or "52_3" for a scan;
    one row each. models, metrics: default: all, and the leading ones."""
    with arguments_refused():
        results = Shown(out, metrics=metrics, models=models)
    require(results)
    exported = Shapes(list(_exports(results, scratch, shapes, views or {}, told)))
    with Folder(scratch / "report") as folder:
        report = Report(
            results, folder, exported, shape_pages.items(results, exported), processes=processes, told=told
        )
        report.models = list(dict.fromkeys(models)) or report.models
        shape_files.draw_all(report)
        rows = [gallery.row_of_maps(report, _named(exported, name)) for name in shapes]
        drawn = gallery.printed(report, NAME, Gallery("", list(wrapped(rows))))
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


def _exports(
    results: Shown, scratch: Path, shapes: Sequence[str], views: Mapping[str, View], told: Told
) -> Iterator[Path]:
    """One export per view."""
    if unknown := [name for name in views if name not in shapes]:
        raise InputError(f"view of {unknown[0]}: is not among the shapes of the figure")
    if lacking := own_export.made_in_python(results):
        raise InputError(lacking)
    try:
        items = set(results.table("results")["item"])
    except Missing as missing:
        raise InputError(f"{results.folder}: {missing}") from None
    seen_from: dict[View | None, list[str]] = {}
    for name in shapes:
        seen_from.setdefault(views.get(name), []).append(
            name if name in items else name.rpartition("_")[0] or name
        )
    for number, (view, names) in enumerate(seen_from.items()):
        config = results.folder / "run.yaml"
        if view:
            text = config.read_text(encoding="utf-8", errors="surrogateescape")
            config = scratch / f"{number}.yaml"
            config.write_text(with_view(text, view), encoding="utf-8", errors="surrogateescape")
        found, lacking = own_export.export(config, names, scratch / f"{number}.h5", told)
        if lacking:
            raise InputError(lacking)
        yield from found


def with_view(record: str, view: View) -> str:
    """A run.yaml with the camera on this side."""
    options = {"azimuth": f"{view[0]:g}", "elevation": f"{view[1]:g}"}
    head, begin, configuration = record.partition("\nconfiguration:\n")
    if "\n  picture:\n" not in configuration:
        configuration = f"  picture: {{{', '.join(map(': '.join, options.items()))}}}\n{configuration}"
    for key, value in options.items():
        configuration = re.sub(rf"(?m)^    {key}: .*$", f"    {key}: {value}", configuration, count=1)
    return head + begin + configuration


def _named(shapes: Shapes, name: str) -> Shape:
    shape = shapes.shapes.get(name)
    if shape is None or not shape.painted:
        raise InputError(f"figure: {name} has no picture; is it a shape of the run?")
    return shape
