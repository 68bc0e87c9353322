# SPDX-License-Identifier: GPL-3.0-or-later
"""Elements of pages. Templates know only these types, not the data behind them."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from salbench.pages.dots import Drawn


class Missing(Exception):
    """Data for an element is missing. The message is shown in place of the element."""


@dataclass
class Note:
    """A sentence that explains, or replaces something missing."""

    text: str
    missing: bool = False
    kind: str = "note"


@dataclass
class Plot:
    """A figure as FILE.svg and FILE.pdf, the plotted numbers as data/NAME.csv, and an alternative text."""

    name: str
    file: str  # path within the report, without extension
    alt: str
    width: int  # pixels at 100 %
    caption: str = ""
    kind: str = "plot"


@dataclass
class Cell:
    """One cell: its text, sort key and link."""

    text: str
    key: float | str | None = None  # for sorting; None: the text itself
    href: str = ""
    below: str = ""  # second, smaller line
    further: str = ""  # third line
    bold: bool = False
    style: str = ""  # CSS class
    badge: tuple[str, str] = ("", "")  # (verdict, CSS class) behind the text
    after: str = ""  # behind the text, lighter
    tex: str = ""  # for LaTeX; empty: the text
    drawn: Drawn | None = None  # below the text


@dataclass
class Table:
    """A table that sorts and filters; its first column stays in place while scrolling. numeric: per column,
    True aligns right and sorts as numbers."""

    id: str
    caption: str
    columns: list[str]
    rows: "list[list[Cell]]"
    numeric: list[bool]
    filters: list[int] = field(default_factory=list)  # indices of columns that get a menu
    # (label, path) of the same table in other formats
    files: list[tuple[str, str]] = field(default_factory=list)
    better: list[str] = field(default_factory=list)  # per column "higher", "lower" or empty, for its head
    # for filters: the initial value; without "all", which would mix rows
    opens: dict[int, str] = field(default_factory=dict)
    foot: "list[Cell]" = field(default_factory=list)  # a last row that neither sorts nor filters
    kind: str = "table"


@dataclass
class Tile:
    """A painted picture and the lines below it, as (text, bold) pieces."""

    picture: str  # path within the report; empty: none, with the reason in `title`
    title: str
    alt: str = ""
    pieces: list[tuple[str, bool]] = field(default_factory=list)
    href: str = ""


@dataclass
class Gallery:
    """Rows of tiles with one colour bar."""

    caption: str
    rows: list[tuple[str, list[Tile]]]
    files: list[tuple[str, str]] = field(default_factory=list)
    differences: bool = False  # True: differences from the ground truth
    kind: str = "gallery"


@dataclass
class Fold:
    """Blocks that readers can expand."""

    summary: str
    blocks: "list[Block]"
    kind: str = "fold"


@dataclass
class Fact:
    """A term and what is known about it, or why it is unknown."""

    term: str
    text: str
    is_link: bool = False  # the text is an address to link to
    missing: bool = False


@dataclass
class Facts:
    rows: list[Fact]
    kind: str = "facts"


Block = Note | Plot | Table | Gallery | Fold | Facts


def attempt(build: Callable[..., Any], *arguments: Any) -> list[Block]:
    """Returns the blocks of `build`, or a note in their place."""
    try:
        blocks = build(*arguments)
    except Missing as reason:
        return [Note(str(reason), missing=True)]
    return blocks if isinstance(blocks, list) else [blocks]


def cell(value: float | None, digits: int = 3, **more: Any) -> Cell:
    """A number, or a dash if undefined."""
    if value is None or value != value:
        return Cell("–", "", **more)
    return Cell(f"{value:.{digits}f}".replace("-", "−"), float(value), **more)


def signed(value: float, digits: int = 3, **more: Any) -> Cell:
    return (
        cell(value, digits, **more)
        if value != value
        else Cell(f"{value:+.{digits}f}".replace("-", "−"), float(value), **more)
    )


def count(value: float, **more: Any) -> Cell:
    return Cell("–", "", **more) if value != value else Cell(f"{int(value)}", int(value), **more)


def p_value(value: float | None, **more: Any) -> Cell:
    """Three digits, or a bound if they would be zeros."""
    if value is None or value != value:
        return Cell("–", "", **more)
    return Cell("< 0.001" if value < 0.001 else f"{value:.3f}", float(value), **more)


def interval(low: float, high: float, digits: int = 3) -> Cell:
    if low != low or high != high:
        return Cell("–", "")
    return Cell(f"{low:.{digits}f} to {high:.{digits}f}".replace("-", "−"), float(low))


def mean_cell(row: Mapping[str, Any] | None) -> Cell:
    """Cell of a row of compact.csv: the mean, half of its interval, and the letters of its groups."""
    if row is None or row["mean"] != row["mean"]:
        return cell(None)
    return cell(row["mean"], bold=row["best"] == 1, after=" ".join(filter(None, (spread(row), row["group"]))))


def spread(row: Mapping[str, Any], digits: int = 3) -> str:
    """Half of the interval, or both ends if it is asymmetric; empty if there is none."""
    if row["low"] != row["low"]:
        return ""
    if row["half"] == row["half"]:
        return f"± {row['half']:.{digits}f}"
    return f"({row['low']:.{digits}f} to {row['high']:.{digits}f})".replace("-", "−")
