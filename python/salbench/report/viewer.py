# SPDX-License-Identifier: GPL-3.0-or-later
"""Data for the viewer of a shape's page: points, faces and maps, quantised and deflated, as scripts that a
page opened from disk may load."""

from collections.abc import Mapping

import numpy

from salbench.conclusions.units import Floats
from salbench.pages.viewer_parts import call, spacing
from salbench.report.exports import Picture, Shape


def spacing_in_any_order(points: Floats) -> float:
    """Median distance to the fourth nearest other point: at least the step of a grid of the same density, and
    close to it."""
    from scipy.spatial import cKDTree

    at = min(5, len(points))
    return float(numpy.median(cKDTree(points).query(points, k=[at])[0])) if len(points) > 1 else 0.0


def script(shape: Shape, maps: Mapping[str, Floats], title: str, picture: Picture | None) -> str | None:
    """Script of one shape (viewer_parts.call). None for a shape without points."""
    points = shape.points
    if points is None or len(points) == 0:
        return None
    on_surface = shape.dataset == "meshes"
    faces = shape.faces if shape.faces is not None else numpy.zeros((0, 3), numpy.int32)
    known = {
        label: values for label, values in maps.items() if values is not None and len(values) == len(points)
    }
    eye, up = shape.eye(picture)
    step = spacing_in_any_order(points) if shape.dataset == "clouds" else spacing(points)
    return call(
        shape.name,
        title,
        points,
        faces,
        known,
        picks=shape.marked,
        shade=None if on_surface else shape.shade(eye),
        on_surface=on_surface,
        step=step,
        eye=eye,
        up=up,
    )


def label_of(model: str, when: str) -> str:
    if model == "ground truth":
        return "Ground truth"
    return f"{model}, {'difference to the ground truth' if when == 'difference' else f'{when} matching'}"
