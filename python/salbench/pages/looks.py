# SPDX-License-Identifier: GPL-3.0-or-later
"""Colour, line and marker of each model, the same in figures and on all pages."""

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import cycle
from typing import Any


@dataclass(frozen=True)
class Look:
    """Style of a model. Line style and marker distinguish models without colour, in print and in grey."""

    colour: str
    dash: Any
    marker: str  # as in Matplotlib


# Okabe and Ito's colours, safe for colour-blind readers, darkened if their contrast with white is below 3:1.
# Ground truth is black.
_LOOKS = {
    "GS": Look("#000000", "-", "*"),
    "LS": Look("#0072B2", "-", "o"),
    "CS": Look("#D55E00", (0, (6, 2)), "s"),
    "PS": Look("#009E73", (0, (2, 1.5)), "^"),
    "MS": Look("#BF5F96", (0, (6, 2, 1, 2)), "D"),
    "HS": Look("#A87400", (0, (1, 1.5)), "P"),
    "RS": Look("#767676", (0, (8, 2, 1, 2, 1, 2)), "X"),
}
# Cycled by other models. The lengths of the three lists are coprime, so that 300 models look different.
_COLOURS = ("#00828C", "#8B4513", "#5B8A1F", "#5E3C99", "#6B6BD6", "#B03060", "#8A7A00")
_DASHES = ((0, (4, 1)), (0, (3, 2, 1, 2)), (0, (1, 1)), (0, (5, 2, 1, 2, 1, 2)), (0, (9, 3)))
_MARKERS = ("v", "h", "<", "p", ">", "d", "s", "D", "o")


def looks_of(models: Iterable[str]) -> dict[str, Look]:
    """Looks by model. Built-in ones are the same in every figure; others take the remaining ones in order."""
    others = map(Look, cycle(_COLOURS), cycle(_DASHES), cycle(_MARKERS))
    return {model: _LOOKS.get(model) or next(others) for model in dict.fromkeys(models)}
