# SPDX-License-Identifier: GPL-3.0-or-later
"""Paints saliency maps on pictures by a look-up per pixel, without rendering."""

import re
from functools import cache
from typing import Any

import numpy
from numpy.typing import NDArray
from PIL import Image

from salbench.conclusions.units import Floats
from salbench.pages import rendering
from salbench.report.exports import Faces, Picture

Bytes = NDArray[numpy.uint8]
COLOURS = rendering.HERE / "static/palette.js"  # shared by pages and pictures
DEPTH_MARGIN = 0.004  # fraction of the depth by which a pick may lie behind the surface at its pixels
# lowers the contrast of shading, because lightness encodes the map
LIGHTEST = 0.25


@cache
def colours(name: str) -> Bytes:
    """n x 3 uint8, a table of palette.js: "palette" for values 0 to 1, "diverging" for -1 to 1, or the single
    colour "pick"."""
    digits = re.findall(rf'salbench\.{name} = "([0-9a-f]+)";', COLOURS.read_text(encoding="utf-8"))[0]
    return numpy.frombuffer(bytes.fromhex(digits), numpy.uint8).reshape(-1, 3)


def palette() -> Bytes:
    """256 x 3 uint8: colours for values 0 to 1."""
    return colours("palette")


class Canvas:
    """A picture of a shape, with everything its maps have in common. faces: f x 3, None for separate
    points."""

    def __init__(self, picture: Picture, faces: Faces | None) -> None:
        self.size = picture.primitive.shape
        self.seen = numpy.flatnonzero(picture.primitive >= 0)
        primitive = picture.primitive.reshape(-1)[self.seen]
        self.corners = primitive[:, None] if faces is None else faces[primitive]
        self.weights = (
            None if faces is None else picture.weights.reshape(-1, 3)[self.seen].astype(numpy.float32)
        )
        shade = picture.shade.reshape(-1)[self.seen].astype(numpy.float32) / 255
        self.shade = (LIGHTEST + (1 - LIGHTEST) * shade)[:, None]
        self.alpha = picture.coverage.reshape(-1)[self.seen]

    def values(self, values: Floats) -> NDArray[numpy.floating[Any]]:
        """Values at the foreground pixels, from n values."""
        of_corners = numpy.asarray(values, numpy.float32)[self.corners]
        found: NDArray[numpy.floating[Any]] = (
            of_corners[:, 0] if self.weights is None else numpy.einsum("kc,kc->k", of_corners, self.weights)
        )
        return found

    def paint(self, values: Floats, name: str = "palette") -> Any:
        """Paints a map on the shape as an RGBA image: colours times shade, with a transparent background,
        since pages may be dark. values: n in [0, 1], or in [-1, 1] for "diverging"."""
        shown = self.values(values)
        if name == "diverging":
            shown = (shown + 1) / 2
        level = numpy.clip(shown * 255 + 0.5, 0, 255).astype(numpy.uint8)
        pixels = numpy.empty((len(self.seen), 4), numpy.uint8)
        pixels[:, :3] = colours(name).astype(numpy.float32)[level] * self.shade + 0.5  # + 0.5 to round
        pixels[:, 3] = self.alpha
        # one number per pixel takes a third of the time
        image = numpy.full(self.size[0] * self.size[1], 0xFFFFFF, "<u4")
        image[self.seen] = pixels.view("<u4")[:, 0]
        return Image.fromarray(image.view(numpy.uint8).reshape(*self.size, 4))


def project(points: Floats, view_projection: Floats, size: tuple[int, int]) -> tuple[Floats, Floats]:
    """Projects m x 3 points: m x 2 pixel coordinates (x to the right, y down) and m depths; NaN if the depth
    is 0. size: (width, height)."""
    clip = numpy.column_stack([points, numpy.ones(len(points))]) @ numpy.asarray(view_projection).T
    depth = clip[:, 3]
    x, y = (clip[:, :2] / numpy.where(depth == 0, numpy.nan, depth)[:, None]).T
    return numpy.column_stack([(x + 1) / 2 * size[0], (1 - y) / 2 * size[1]]), depth


def visible(picture: Picture, places: Floats) -> Floats:
    """Pixel coordinates, k x 2, of the visible ones among n x 3 positions: at least one of the surrounding
    pixels shows nothing nearer to the camera."""
    if len(places) == 0:
        return numpy.zeros((0, 2))
    height, width = picture.primitive.shape
    at, depth = project(places, picture.view_projection, (width, height))
    inside = ((at >= 0) & (at < (width, height))).all(axis=1)
    at, depth = at[inside], depth[inside]
    column, row = at.astype(int).T
    # over the 3 x 3 pixels around the position, so that positions on edges count
    farthest = numpy.full(len(at), -numpy.inf)
    for down in (-1, 0, 1):
        for right in (-1, 0, 1):
            near = picture.depth[(row + down).clip(0, height - 1), (column + right).clip(0, width - 1)]
            farthest = numpy.maximum(farthest, numpy.where(numpy.isfinite(near), near, -numpy.inf))
    return at[depth <= farthest * (1 + DEPTH_MARGIN)]


def with_dots(image: Any, dots: Floats) -> Any:
    """Draws an antialiased dot per row of m x 2 pixel coordinates on the RGBA image."""
    if len(dots) == 0:
        return image
    pixels = numpy.asarray(image).astype(numpy.float32)
    radius = max(2, image.width / 100)
    for x, y in dots:
        left, top = max(int(x - radius - 1), 0), max(int(y - radius - 1), 0)
        part = pixels[top : int(y + radius + 2), left : int(x + radius + 2)]
        rows, columns = numpy.ogrid[top : top + part.shape[0], left : left + part.shape[1]]
        distance = numpy.hypot(columns + 0.5 - x, rows + 0.5 - y)
        for r, colour in ((radius, (255, 255, 255)), (radius * 0.72, colours("pick")[0])):
            covered = numpy.clip(r + 0.5 - distance, 0, 1)[:, :, None]
            part += (numpy.array((*colour, 255), numpy.float32) - part) * covered
    return Image.fromarray((pixels + 0.5).astype(numpy.uint8))


def colour_bar(name: str) -> Any:
    """RGB image of a table, 256 x 16, first colour on the left."""
    return Image.fromarray(numpy.broadcast_to(colours(name), (16, 256, 3)).copy())
