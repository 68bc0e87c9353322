# SPDX-License-Identifier: GPL-3.0-or-later
"""The painted maps of a shape, as pages ask for them."""

from salbench.pages.names import KIND_NAMES
from salbench.report.exports import Shape
from salbench.report.folder import Facts


class Painter:
    """The maps of one shape that are pictures in the report. facts: of its files (shape_files.draw_all)."""

    def __init__(self, shape: Shape, facts: Facts) -> None:
        self.shape, self.facts = shape, facts
        self.maps = {(what, when): path for what, when, path in self.facts["maps"]}
        self.has_picture = self.facts["picture"]

    def has(self, what: str, when: str = "before") -> bool:
        return self.has_picture and (what, when) in self.maps

    def paint(self, what: str, when: str = "before") -> str:
        """Path within the report of a painted map, ("LS", "after") or ("ground truth", "before"); "" if it cannot be."""
        return self.maps.get((what, when), "") if self.has_picture else ""

    def alt(self, what: str, when: str, label: str) -> str:
        """What a reader who cannot see the picture is told."""
        marked = "; dots: what participants picked" if self.facts["picks"] else "; dots: where people looked" if self.facts["fixations"] else ""
        dots = marked if what == "ground truth" else ""
        return f"{label}: {describe(self.shape)}{dots}"


def describe(shape: Shape) -> str:
    return f"scan {shape.view} of mesh {shape.item}" if shape.view else f"{KIND_NAMES[shape.dataset]} {shape.item}"
