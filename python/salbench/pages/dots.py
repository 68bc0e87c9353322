# SPDX-License-Identifier: GPL-3.0-or-later
"""How far models are behind the one with the best mean, drawn: a dot and its interval per model on a common axis, for templates/dots.html.
Places are percentages of the width of the axis."""

from collections.abc import Sequence
from dataclasses import dataclass

LINES = {"RS": "chance", "HS": "people"}  # references, drawn as lines
# Outlines around 0, 0: neighbours differ in form too.
MARKS = {"circle": "M-4.5 0a4.5 4.5 0 1 0 9 0a4.5 4.5 0 1 0 -9 0z", "square": "M-4 -4h8v8h-8z", "diamond": "M0 -5.5L5.5 0L0 5.5L-5.5 0z",
         "triangle": "M0 -5L5 4H-5z"}
SHAPES = tuple(MARKS)


@dataclass(frozen=True)
class Behind:
    """Distances are negative behind the best, whichever way the metric is better; NaN: no interval."""
    distance: float
    low: float = float("nan")
    high: float = float("nan")


@dataclass
class Axis:
    best: float      # place of the best mean
    lines: list[tuple[str, float]]  # (name, place) of references, the last one of the plot first
    low: str         # end of the axis


@dataclass
class Dot:
    between: str     # the distance and its interval in words
    first: bool      # may be the best
    at: float
    low: float
    high: float
    marker: str


@dataclass
class Drawn:
    """In a cell of a table."""
    dot: Dot | None  # None: the axis itself, for the foot of its column
    axis: Axis


def drawn(models: Sequence[Behind], first: Sequence[bool], references: Sequence[tuple[str, float]], these: str = "") -> tuple[list[Dot], Axis]:
    """A dot per model, and their axis. first: which may be the best; references: (name of the line, distance); these: of which the best is."""
    distances = [one.distance for one in models] + [distance for _, distance in references]
    ends = [value for value in (*distances, *(end for one in models for end in (one.low, one.high))) if value == value]
    margin = 0.04 * (max(ends) - min(ends)) or 0.05
    low, high = min(ends) - margin, max(ends) + margin

    def place(value: float, otherwise: float = 0.0) -> float:
        return round(100 * ((value if value == value else otherwise) - low) / (high - low), 2)
    dots = [Dot(in_words(one, these), is_first, place(one.distance), place(one.low, one.distance), place(one.high, one.distance), SHAPES[at % len(SHAPES)])
            for at, (one, is_first) in enumerate(zip(models, first, strict=True))]
    lines = sorted(((name, place(distance)) for name, distance in references), key=lambda line: -line[1])
    return dots, Axis(place(0), lines, number(low, 2))


def in_words(one: Behind, these: str = "") -> str:
    if one.distance == 0:
        return f"best mean{these}"
    between = f", {number(-one.high)} to {number(-one.low)}" if one.low == one.low else ""
    return f"{number(-one.distance)} behind{between}"


def number(value: float, digits: int = 3) -> str:
    text = f"{value:.{digits}f}"
    return (text.lstrip("-") if float(text) == 0 else text).replace("-", "−")
