# SPDX-License-Identifier: GPL-3.0-or-later
"""Paints saliency maps on pictures: a look-up per pixel, with no rendering."""

import numpy
from matplotlib import colormaps
from PIL import Image, ImageDraw

from report.style import MAP

PICK = (213, 94, 0)  # vermillion, with a white rim: seen on all of viridis
SUPERSAMPLING = 3    # of the dots
DEPTH_MARGIN = 0.004  # share of the depth by which a pick may lie behind what its pixels show


def palette(name=MAP):
    """256 x 3 uint8: the colours of the values 0 to 1."""
    return (colormaps[name](numpy.arange(256))[:, :3] * 255).round().astype(numpy.uint8)


def pixel_values(picture, values, faces):
    """H x W: the map where something is seen, NaN elsewhere. values: n in [0, 1]; faces: f x 3, None for separate points."""
    seen = picture.primitive >= 0
    primitive = picture.primitive[seen]
    shown = numpy.full(picture.primitive.shape, numpy.nan)
    if faces is None:
        shown[seen] = values[primitive]
    else:
        shown[seen] = (values[faces[primitive]] * picture.weights[seen]).sum(axis=1)
    return shown


def paint(picture, values, faces):
    """An RGB image of the map on the shape: its colours times the shade, on white."""
    shown = pixel_values(picture, values, faces)
    seen = ~numpy.isnan(shown)
    image = numpy.full((*shown.shape, 3), 255, dtype=numpy.uint8)
    colours = palette()[numpy.clip(shown[seen] * 255, 0, 255).round().astype(int)] * (picture.shade[seen, None] / 255.0)
    covered = 1.0 if picture.coverage is None else picture.coverage[seen, None] / 255.0
    image[seen] = (255 + (colours - 255) * covered).round()
    return Image.fromarray(image)


def project(points, view_projection, size):
    """m x 2 pixel coordinates (x to the right, y down) and m depths of m x 3 points; NaN where the depth is 0; size: (width,
    height)."""
    clip = numpy.column_stack([points, numpy.ones(len(points))]) @ numpy.asarray(view_projection).T
    depth = clip[:, 3]
    x, y = (clip[:, :2] / numpy.where(depth == 0, numpy.nan, depth)[:, None]).T
    return numpy.column_stack([(x + 1) / 2 * size[0], (1 - y) / 2 * size[1]]), depth


def visible(picture, picks, points):
    """Pixel coordinates, k x 2, of the picks that the camera sees: at least one of the pixels about a pick shows nothing
    that is nearer to the camera."""
    if picture.view_projection is None or picture.depth is None or len(picks) == 0:
        return numpy.zeros((0, 2))
    height, width = picture.primitive.shape
    at, depth = project(points[picks], picture.view_projection, (width, height))
    inside = ((at >= 0) & (at < (width, height))).all(axis=1)
    at, depth = at[inside], depth[inside]
    column, row = at.astype(int).T
    farthest = numpy.full(len(at), -numpy.inf)  # of the 3 x 3 pixels about the pick, so that picks on edges count
    for down in (-1, 0, 1):
        for right in (-1, 0, 1):
            near = picture.depth[(row + down).clip(0, height - 1), (column + right).clip(0, width - 1)]
            farthest = numpy.maximum(farthest, numpy.where(numpy.isfinite(near), near, -numpy.inf))
    return at[depth <= farthest * (1 + DEPTH_MARGIN)]


def with_dots(image, dots):
    """The image with a dot per row of m x 2 pixel coordinates, smooth at the rim."""
    if len(dots) == 0:
        return image
    k = SUPERSAMPLING
    radius = max(2, image.width / 100)
    large = image.resize((image.width * k, image.height * k), Image.Resampling.NEAREST)
    draw = ImageDraw.Draw(large)
    for x, y in dots * k:
        for r, colour in ((radius * k, (255, 255, 255)), (radius * k * 0.72, PICK)):
            draw.ellipse((x - r, y - r, x + r, y + r), fill=colour)
    return large.reduce(k)


def colour_bar(width=256, height=16):
    """An RGB image of the palette from 0 on the left to 1 on the right."""
    return Image.fromarray(numpy.broadcast_to(palette(), (height, 256, 3)).copy()).resize((width, height))
