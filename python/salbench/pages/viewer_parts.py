# SPDX-License-Identifier: GPL-3.0-or-later
"""Data of viewer.js, and its section of a page, for the report and `Shape.show`. Needs only NumPy."""

import base64
import html
import json
import os
import zlib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy
from numpy.typing import NDArray

from salbench.system.types import ArrayLike

Floats = NDArray[numpy.float64]
Array = NDArray[Any]
THREE = ("three.min.js", "examples/js/controls/OrbitControls.js")


def three_js() -> list[Path]:
    """Scripts of three.js: the wheel's own, or Debian's package libjs-three, below a data folder of the
    system."""
    shares = os.environ.get("XDG_DATA_DIRS") or "/usr/local/share:/usr/share"
    folders = [
        Path(__file__).parents[1] / "three",
        *(Path(share) / "javascript/three" for share in shares.split(":")),
    ]
    for folder in folders:
        if all((folder / name).is_file() for name in THREE):
            return [folder / name for name in THREE]
    raise FileNotFoundError(
        "the viewer needs three.js, Debian's package libjs-three: it is not in"
        f" {', '.join(map(str, folders))}"
    )


def quantised(points: Floats, steps: int) -> tuple[NDArray[numpy.uint16], list[float], float]:
    """Quantises n x 3 positions to 3 x n uint16 in their bounding cube, whose edge has this many steps;
    returns the cube's corner and edge, too."""
    low = points.min(axis=0)
    edge = float((points.max(axis=0) - low).max()) or 1.0
    return numpy.rint((points - low).T / edge * steps).astype("<u2"), low.tolist(), edge


# Levels of a map and steps of a position. Fewer would show as bands on surfaces; separate points hide them.
MESH_LEVELS, MESH_STEPS = 255, 65535
SCAN_LEVELS, SCAN_STEPS = 63, 16383


def deltas(values: Array) -> Array:
    """Differences of neighbours in memory, modulo the type's range: lossless, and easier to compress."""
    flat = values.reshape(-1)
    return numpy.diff(flat, prepend=flat.dtype.type(0)).astype(values.dtype)


def spacing(points: Floats) -> float:
    """Median distance of consecutive points in memory: the grid's step for a scan, which is stored row by
    row."""
    return (
        float(numpy.median(numpy.linalg.norm(numpy.diff(points, axis=0), axis=1))) if len(points) > 1 else 0.0
    )


def unit_range(values: ArrayLike) -> Floats:
    """Maps the minimum to 0, the maximum to 1, NaN to 0, and constant maps to 0."""
    values = numpy.nan_to_num(numpy.asarray(values, dtype=float), nan=0.0, posinf=0.0, neginf=0.0)
    halves = values / 2  # so that differences do not overflow
    low, high = halves.min(), halves.max()
    scaled: Floats = (halves - low) / (high - low) if high > low else numpy.zeros_like(values)
    return scaled


def call(
    name: str,
    title: str,
    points: Floats,
    faces: NDArray[numpy.int32],
    maps: Mapping[str, Floats],
    *,
    picks: NDArray[Any],
    shade: Floats | None,
    on_surface: bool,
    step: float,
    eye: Floats | None = None,
    up: str = "y",
) -> str:
    """Script of one shape: a call of salbench.give with a description and one text of binary data: x, y, z
    (uint16 each), the corners of the faces (int32), the shade of separate points, then each map (uint8 each,
    `levels` is 1). All except shade and maps are stored as differences of neighbours. `step`: width of
    separate points."""
    levels, steps = (MESH_LEVELS, MESH_STEPS) if on_surface else (SCAN_LEVELS, SCAN_STEPS)
    positions, corner, edge = quantised(points, steps)
    parts = [deltas(row).tobytes() for row in positions] + [deltas(faces.astype("<i4")).tobytes()]
    fields = ([] if shade is None else [shade]) + list(maps.values())
    parts += [(values * levels).round().astype(numpy.uint8).tobytes() for values in fields]
    description = {
        "title": title,
        "points": len(points),
        "faces": len(faces),
        "corner": corner,
        "edge": edge,
        "steps": steps,
        "levels": levels,
        "shaded": shade is not None,
        "maps": list(maps),
        "picks": picks.tolist(),
        "spacing": step,
        "camera": None if eye is None else eye.tolist(),
        "up": up,
    }
    data = base64.b64encode(zlib.compress(b"".join(parts), 6)).decode()
    return f"salbench.give({json.dumps(name)}, {json.dumps(description)}, {json.dumps(data)});\n"


VIEW = """<div class="view" role="group" aria-label="{side}">
<div class="filters">
<label>Shape <select data-part="shape" aria-label="{side}: shape">{options}</select></label>
<label>Map <select data-part="map" aria-label="{side}: map"></select></label>
</div>
<div class="canvas"><canvas tabindex="0" role="img" aria-label="{side} of the shape; arrow keys turn it"></canvas></div>
<p class="colourbar"><span data-part="end"></span>\
<span data-part="legend" aria-hidden="true" style="flex: 0 0 6rem; height: .75rem"></span><span data-part="end"></span></p>
<p class="turns">
<button type="button" data-turn="-1,0" aria-label="{side}: turn left">&#8592;</button>
<button type="button" data-turn="1,0" aria-label="{side}: turn right">&#8594;</button>
<button type="button" data-turn="0,-1" aria-label="{side}: turn up">&#8593;</button>
<button type="button" data-turn="0,1" aria-label="{side}: turn down">&#8595;</button>
<span data-part="status" role="status"></span><span data-part="side"></span></p>
</div>
"""
COUPLED = '<label><input type="checkbox" data-part="coupled" checked{hidden}>{label}</label>'


def section(
    entries: list[dict[str, str]], second: str, sides: Sequence[str] = ("Left view", "Right view")
) -> str:
    """Section of a page: one or two views of the shapes in `entries` (name, title, path of the script).
    `second`: initial map of the second view."""
    options = "".join(f"<option>{html.escape(entry['title'])}</option>" for entry in entries)
    views = "".join(VIEW.format(side=side, options=options) for side in sides)
    coupled = (
        COUPLED.format(hidden="", label=" turn both together")
        if len(sides) > 1
        else COUPLED.format(hidden=" hidden", label="")
    )
    return f"""<section class="viewer" aria-labelledby="viewer-title" data-shapes="{html.escape(json.dumps(entries))}" \
data-second="{html.escape(second)}" hidden>
<h2 id="viewer-title">Viewer</h2>
<p class="note" data-part="message">Drag to turn, scroll to come nearer; with the keyboard, arrow keys or the buttons.</p>
<div class="filters">
<label>Colours show <select data-part="scale">
<option value="value">value</option><option value="rank">rank</option><option value="percentile">percentile</option>
</select></label>
{coupled}
<label><input type="checkbox" data-part="picks"> show where participants picked or looked</label>
<button type="button" data-part="home">First view</button>
</div>
<div class="views">
{views}</div>
</section>
"""
