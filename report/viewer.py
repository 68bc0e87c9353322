# SPDX-License-Identifier: GPL-3.0-or-later
"""What the viewer of a shape's page reads: points, faces and maps, quantised and deflated, as scripts that a page opened
from disk may load."""

import base64
import json
import zlib

import numpy
from scipy.spatial import cKDTree

from report.painting import palette


def quantised(points, steps):
    """3 x n uint16 of n x 3 positions in their bounding cube, whose edge is so many steps; the cube's corner and edge."""
    low = points.min(axis=0)
    edge = float((points.max(axis=0) - low).max()) or 1.0
    return numpy.rint((points - low).T / edge * steps).astype("<u2"), low.tolist(), edge


# Levels of a map and steps of a position. On a surface fewer would show as bands; on separate points nobody sees them.
MESH_LEVELS, MESH_STEPS = 255, 65535
SCAN_LEVELS, SCAN_STEPS = 63, 16383


def deltas(values):
    """Differences of neighbours in memory, modulo the type's range: the same information, easier to compress."""
    flat = values.reshape(-1)
    return numpy.diff(flat, prepend=flat.dtype.type(0)).astype(values.dtype)


def spacing(points):
    """Median distance of points that follow each other in memory: of a scan, which is stored row by row, its grid's step."""
    return float(numpy.median(numpy.linalg.norm(numpy.diff(points, axis=0), axis=1))) if len(points) > 1 else 0.0


def spacing_in_any_order(points):
    """Median distance to the fourth nearest other point: what a grid of the same density has as its step, or little more."""
    at = min(5, len(points))
    return float(numpy.median(cKDTree(points).query(points, k=[at])[0])) if len(points) > 1 else 0.0


def script(shape, maps, title):
    """The script of one shape: a call of salbench.give with a description and one text of binary data, which holds x, y, z
    (uint16 each), the corners of the faces (int32), the shade of separate points, then each map (uint8 each, `levels` is 1). All
    but the shade and the maps are stored as differences of neighbours. None for a shape without points."""
    points = shape.points
    if points is None or len(points) == 0:
        return None
    levels, steps = (MESH_LEVELS, MESH_STEPS) if shape.dataset == "meshes" else (SCAN_LEVELS, SCAN_STEPS)
    positions, corner, edge = quantised(points, steps)
    faces = shape.faces if shape.faces is not None else numpy.zeros((0, 3), numpy.int32)
    shade = None if shape.dataset == "meshes" else shape.shade()
    known = {label: values for label, values in maps.items() if values is not None and len(values) == len(points)}
    parts = [deltas(row).tobytes() for row in positions] + [deltas(faces.astype("<i4")).tobytes()]
    fields = ([] if shade is None else [shade]) + list(known.values())
    parts += [(values * levels).round().astype(numpy.uint8).tobytes() for values in fields]
    eye, up = shape.eye()
    step = spacing_in_any_order(points) if shape.dataset == "clouds" else spacing(points)
    description = {
        "title": title, "points": len(points), "faces": len(faces), "corner": corner, "edge": edge, "steps": steps,
        "levels": levels, "shaded": shade is not None, "maps": list(known), "picks": shape.picks.tolist(),
        "spacing": step, "camera": None if eye is None else eye.tolist(), "up": up,
    }
    data = base64.b64encode(zlib.compress(b"".join(parts), 9)).decode()
    return f"salbench.give({json.dumps(shape.name)}, {json.dumps(description)}, {json.dumps(data)});\n"


def label_of(model, when):
    if model == "ground truth":
        return "Ground truth"
    return f"{model}, {'before' if when == 'before' else 'after'} matching"


def write_scripts(shop, shapes, titles, maps):
    """Writes shapes/NAME.js for each shape; entries (name, title, path relative to the page, labels of maps)."""
    entries = []
    for shape in shapes:
        labelled = {label_of(*key): values for key, values in maps[shape.name].items() if values is not None}
        text = script(shape, labelled, titles[shape.name])
        if text is None:
            continue
        path = f"{shop.shape_files[shape.name]}.js"
        shop.file(f"shapes/{path}").write_text(text, encoding="utf-8")
        entries.append({"name": shape.name, "title": titles[shape.name], "path": path})
    return entries


def palette_script():
    """The palette as a script: 256 colours as 6 hex digits each."""
    return "salbench.palette = " + json.dumps("".join(f"{r:02x}{g:02x}{b:02x}" for r, g, b in palette())) + ";\n"
