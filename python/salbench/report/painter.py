# SPDX-License-Identifier: GPL-3.0-or-later
"""The painted maps of a shape, as pages ask for them."""

from collections.abc import Mapping

from salbench.pages.names import KIND_NAMES
from salbench.report.exports import Shape


class Painter:
    """The maps of one shape that are pictures in the report. maps: (model, when) -> path within the report. picks: are painted on the ground
    truth."""

    def __init__(self, shape: Shape, maps: Mapping[tuple[str, str], str], picks: bool) -> None:
        self.shape, self.maps, self.picks = shape, maps, picks

    def has(self, what: str, when: str = "before") -> bool:
        return (what, when) in self.maps

    def paint(self, what: str, when: str = "before") -> str:
        """Path within the report of a painted map, ("LS", "after") or ("ground truth", "before"); "" if there is none."""
        return self.maps.get((what, when), "")

    def alt(self, what: str, when: str, label: str) -> str:
        """What a reader who cannot see the picture is told."""
        dots = ""
        if what == "ground truth" and self.shape.has_gaze:
            dots = "; dots: where people looked"
        elif what == "ground truth" and self.picks and self.shape.has_picks:
            dots = "; dots: what participants picked"
        return f"{label}: {describe(self.shape)}{dots}"


def describe(shape: Shape) -> str:
    return f"scan {shape.view} of mesh {shape.item}" if shape.view else f"{KIND_NAMES[shape.dataset]} {shape.item}"
