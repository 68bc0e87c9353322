# SPDX-License-Identifier: GPL-3.0-or-later
"""Plot of models' distances from the best mean: a dot with an interval per model on a common axis, for
templates/dots.html. Positions are percentages of the axis."""

from collections.abc import Container, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from salbench.pages.looks import Look

LINES = {"RS": "chance", "HS": "people"}  # references, which are not ranked, drawn as lines
# Outlines of Matplotlib's markers around 0, 0.
MARKS = {
    "o": "M-4.5 0a4.5 4.5 0 1 0 9 0a4.5 4.5 0 1 0 -9 0z",
    "s": "M-4 -4h8v8h-8z",
    "D": "M0 -5.5L5.5 0L0 5.5L-5.5 0z",
    "^": "M0 -5L5 4H-5z",
    "v": "M0 5L5 -4H-5z",
    "<": "M-5 0L4 -5V5z",
    ">": "M5 0L-4 -5V5z",
    "d": "M0 -5.5L3.5 0L0 5.5L-3.5 0z",
    "p": "M0 -5L4.8 -1.5L3 4H-3L-4.8 -1.5z",
    "h": "M0 -5L4.3 -2.5V2.5L0 5L-4.3 2.5V-2.5z",
}
BESIDE = 58  # percent of the axis between names on one line
ROOM = 25  # percent of the axis that the text at its end takes beside that at 0
_ROUNDING = 1e-9  # distances below are none
AXIS = ""  # key of the axis among the drawn models
Rows = Iterable[Mapping[str, Any]]


@dataclass(frozen=True)
class Behind:
    """A model compared with the best. Distances are negative behind the best, for either direction of the
    metric; NaN: no interval."""

    model: str
    mean: float
    distance: float
    low: float = float("nan")
    high: float = float("nan")


@dataclass
class Axis:
    best: float  # position of the best mean
    # (name, position, line of the name) of references, the last one of the plot first
    lines: list[tuple[str, float, int]]
    low: str  # text at the end of the axis

    @property
    def has_room(self) -> bool:
        """True if that text fits beside the one at 0."""
        return self.best >= ROOM


@dataclass
class Dot:
    behind: Behind
    between: str  # distance and interval in words
    first: bool  # may be the best
    at: float
    low: float
    high: float
    look: Look


@dataclass
class Drawn:
    """Drawing in a cell of a table."""

    dot: Dot | None  # None: the axis itself, in the foot of its column
    axis: Axis


def behind(ranking: Rows, significance: Rows, compact: Rows, lower: bool) -> list[Behind]:
    """Ranked models, the best first, then references, which have no interval. Intervals are joint over all
    pairs: one excludes 0 only if the two differ significantly in the ranking. Rows are those of one data set,
    split and metric; lower: lower values are better."""
    means = {row["model"]: row["mean"] for row in ranking if row["mean"] == row["mean"]}
    if not means:
        return []
    sign, best = -1 if lower else 1, next(iter(means))
    pairs = {row["model_b"]: (-sign, row) for row in significance if row["model_a"] == best}
    pairs |= {row["model_a"]: (sign, row) for row in significance if row["model_b"] == best}

    def beside_best(model: str, mean: float) -> Behind:
        if model not in pairs:
            return Behind(model, mean, sign * (mean - means[best]))
        side, pair = pairs[model]
        return Behind(
            model,
            mean,
            side * pair["mean_difference"],
            *sorted((side * pair["joint95_low"], side * pair["joint95_high"])),
        )

    references = (
        (row["model"], row["mean"]) for row in compact if row["model"] in LINES and row["mean"] == row["mean"]
    )
    return [
        *(beside_best(*one) for one in means.items()),
        *(Behind(model, mean, sign * (mean - means[best])) for model, mean in references),
    ]


def drawn(
    models: Sequence[Behind], first: Container[str], looks: Mapping[str, Look], these: str = ""
) -> dict[str, Drawn]:
    """Drawings per ranked model, and the axis under AXIS. first: models that may be the best; looks: per
    model; these: the models among which the best is chosen."""
    ends = [value for one in models for value in (one.distance, one.low, one.high) if value == value]
    margin = 0.04 * (max(ends) - min(ends)) or 0.05
    low, high = min(ends) - margin, max(ends) + margin

    def place(value: float, otherwise: float = 0.0) -> float:
        return round(100 * ((value if value == value else otherwise) - low) / (high - low), 2)

    lines = sorted(
        ((LINES[one.model], place(one.distance)) for one in models if one.model in LINES),
        key=lambda line: -line[1],
    )
    near = len(lines) == 2 and lines[0][1] - lines[1][1] < BESIDE
    axis = Axis(
        place(0), [(name, at, line if near else 0) for line, (name, at) in enumerate(lines)], number(low, 2)
    )
    ranked = [one for one in models if one.model not in LINES]
    return {AXIS: Drawn(None, axis)} | {
        one.model: Drawn(
            Dot(
                one,
                in_words(one, these),
                one.model in first,
                place(one.distance),
                place(one.low, one.distance),
                place(one.high, one.distance),
                looks[one.model],
            ),
            axis,
        )
        for one in ranked
    }


def in_words(one: Behind, these: str = "") -> str:
    if abs(one.distance) < _ROUNDING:
        return f"best mean{these}"
    between = f", {number(-one.high)} to {number(-one.low)}" if one.low == one.low else ""
    distance = number(-one.distance)
    return f"{'less than 0.001' if distance == '0.000' else distance} behind{between}"


def number(value: float, digits: int = 3) -> str:
    text = f"{value:.{digits}f}"
    return (text.lstrip("-") if float(text) == 0 else text).replace("-", "−")
