# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of the report as files, each painted once and named by what it shows."""

from report.exports import BROKEN
from report.names import KIND_NAMES
from report.painting import paint, visible, with_dots

QUALITY, SMALL_QUALITY = 88, 78  # of WebP: no visible blocks; about 5 kB at 400 x 400, 3 kB at half of it


class Painter:
    """Paints maps of one shape into pictures/ITEM/."""

    def __init__(self, shop, shape):
        self.shop = shop
        self.shape = shape
        self.folder = f"pictures/{shop.shape_files[shape.item]}"
        self.picture = shape.picture()
        self.faces = shape.faces
        self.maps = {("ground truth", "before"): shape.ground_truth, **shape.maps()}

    def has(self, what, when="before"):
        return self.picture is not None and self.maps.get((what, when)) is not None

    def paint(self, what, when="before", small=False):
        """Path within the report of a painted map, ("LS", "after") or ("ground truth", "before"); "" if it cannot be.
        Ground truth has the picks as dots. small: half the size."""
        if not self.has(what, when):
            return ""
        of = self.shape.view or KIND_NAMES[self.shape.dataset].replace(" ", "-")
        name = f"{self.folder}/{of}-{self.shop.model_files[what]}-{when}{'-small' if small else ''}.webp"
        if name in self.shop.painted:
            return name
        try:
            image = self.image(what, when)
        except (IndexError, *BROKEN):  # indices that do not belong to the shape: a damaged export
            return ""
        path = self.shop.file(name)
        self.shop.painted.add(name)
        if small:
            image.reduce(2).save(path, quality=SMALL_QUALITY, method=4)
        else:
            image.save(path, quality=QUALITY, method=4)
        return name

    def image(self, what, when="before"):
        """The painted map as an image."""
        image = paint(self.picture, self.maps[what, when], self.faces)
        if what == "ground truth":
            picks, points = self.shape.picks, self.shape.points
            if points is not None:
                return with_dots(image, visible(self.picture, picks, points))
        return image


def describe(shape):
    return f"scan {shape.view} of mesh {shape.item}" if shape.view else f"{KIND_NAMES[shape.dataset]} {shape.item}"

