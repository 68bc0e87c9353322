# SPDX-License-Identifier: GPL-3.0-or-later
"""Templates, and static files that pages load."""

import re
from collections.abc import Mapping
from pathlib import Path

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup, escape

from salbench.pages.dots import MARKS

HERE = Path(__file__).parent
# <meta name="generator"> of every page; files with it may be overwritten or removed
MARK = "salbench report"
# file that marks the site of a leaderboard, whose pages have MARK, too
OF_LEADERBOARD = "data/submissions.csv"
SIMULATED = (
    "Simulated participants: the program made the ground truth. These scores say nothing about people."
)


def environment(package: Path, titles: Mapping[str, str], mine: str = "") -> Environment:
    """Environment of a package's own templates, which extend the shared ones; everything is escaped. titles:
    abbreviations in tables -> meaning, for the filter `abbr`. mine: text or key of the rows to highlight."""
    made = Environment(
        loader=FileSystemLoader([package / "templates", HERE / "templates"]),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    made.globals.update(MARK=MARK, titles=titles, mine=mine, marks=MARKS)
    longest_first = sorted(titles, key=len, reverse=True)
    known = re.compile(rf"(?<![\w-])({'|'.join(map(re.escape, longest_first))})(?![\w-])") if titles else None

    def abbr(text: str) -> Markup:
        parts = known.split(text) if known else [text]  # every second part is an abbreviation
        return Markup("").join(
            Markup('<abbr title="{}">{}</abbr>').format(titles[part], part) if at % 2 else escape(part)
            for at, part in enumerate(parts)
        )

    made.filters["abbr"] = abbr
    return made


def is_ours(page: Path) -> bool:
    """True if a page was written by this program."""
    if not page.is_file():
        return False
    with open(page, "rb") as file:
        return MARK.encode() in file.read(600)
