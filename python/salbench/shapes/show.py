# SPDX-License-Identifier: GPL-3.0-or-later
"""A shape in the report's viewer, as one self-contained page."""

import html
import pathlib
from collections.abc import Mapping
from typing import Any

import numpy as np

from salbench.pages import viewer_parts
from salbench.system.types import ArrayLike, NDArray

STATIC = pathlib.Path(viewer_parts.__file__).parent / "static"
NEIGHBOURS = 500  # sample for the width of separate points

# The page may load nothing, whatever it contains.
POLICY = "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:"


class View:
    """A page with a shape: notebooks display it, and `str()` is its HTML."""

    def __init__(self, page: str, title: str) -> None:
        self._page, self._title = page, title

    def __str__(self) -> str:
        return self._page

    def __repr__(self) -> str:
        return f"View({self._title!r}, {len(self._page)} characters of HTML)"

    def _repr_html_(self) -> str:
        return (
            f'<iframe title="{html.escape(self._title)}" srcdoc="{html.escape(self._page)}" '
            'style="width: 100%; height: 640px; border: 0"></iframe>'
        )


def show(shape: Any, values: ArrayLike | Mapping[str, ArrayLike] | None = None) -> View:
    """Page of a `Shape` with its ground truth, and further maps."""
    if len(shape.points) == 0:
        raise ValueError(f"{shape.id} has no points to show")
    maps = {name: viewer_parts.unit_range(known) for name, known in _maps(shape, values).items()}
    faces = np.zeros((0, 3), np.int32) if shape.faces is None else shape.faces
    first, second = [*maps, "", ""][:2]
    call = viewer_parts.call(
        shape.id,
        shape.id,
        shape.points,
        faces,
        maps,
        picks=np.unique(shape.picks),
        shade=None,
        on_surface=len(faces) > 0,
        step=_spacing(shape.points),
    )
    entries = [{"name": shape.id, "title": shape.id, "path": ""}]
    section = viewer_parts.section(
        entries, second or first, ("Left view", "Right view") if second else ("View",)
    )
    return View(_page(shape.id, section, call), shape.id)


def _maps(shape: Any, values: ArrayLike | Mapping[str, ArrayLike] | None) -> dict[str, NDArray[np.float64]]:
    maps: dict[str, NDArray[np.float64]] = {}
    if shape.ground_truth is not None and not np.isnan(shape.ground_truth).all():
        maps["Ground truth"] = np.where(shape.mask, shape.ground_truth, np.nanmin(shape.ground_truth))
    given: Mapping[str, ArrayLike] = (
        {} if values is None else values if isinstance(values, Mapping) else {"Values": values}
    )
    for name, map_values in given.items():
        try:
            numbers = np.asarray(map_values, np.float64)
        except (TypeError, ValueError) as error:
            raise ValueError(f"values must be an array of numbers: {error}") from None
        if numbers.shape != (len(shape.points),):
            raise ValueError(f"values must have shape ({len(shape.points)},), not {numbers.shape}")
        maps[str(name)] = numbers
    return maps


def _spacing(points: NDArray[np.float64]) -> float:
    """Approximate step of a grid of the same density: median distance of some points to their fourth nearest
    other one."""
    step = max(1, len(points) // NEIGHBOURS)
    at = min(4, len(points) - 1)
    nearest = [
        np.partition(np.linalg.norm(points - point, axis=1), at)[at] for point in points[::step][:NEIGHBOURS]
    ]
    return float(np.median(nearest))


def _page(title: str, section: str, call: str) -> str:
    scripts = [file.read_text(encoding="utf-8") for file in viewer_parts.three_js()]
    scripts += [
        "const salbench = {};",
        *((STATIC / name).read_text(encoding="utf-8") for name in ("viewer.js", "palette.js")),
    ]
    scripts.append(call.replace("<", "\\u003c"))  # all of its text is JSON
    style = (STATIC / "report.css").read_text(encoding="utf-8")
    return "\n".join(
        [
            "<!DOCTYPE html>",
            '<html lang="en-GB"><head><meta charset="utf-8">',
            f'<meta http-equiv="Content-Security-Policy" content="{POLICY}">',
            f"<title>{html.escape(title)}</title>",
            f"<style>{style}</style>",
            *(f"<script>{_inline(script)}</script>" for script in scripts),
            "</head><body><main>",
            section,
            "</main></body></html>",
        ]
    )


def _inline(script: str) -> str:
    return script.replace("</script", "<\\/script").replace("<!--", "<\\!--")
