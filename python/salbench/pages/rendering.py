# SPDX-License-Identifier: GPL-3.0-or-later
"""Templates, and the files that pages load."""

import re
from collections.abc import Mapping
from pathlib import Path

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup, escape

from salbench.pages.dots import MARKS

HERE = Path(__file__).parent
# <meta name="generator"> of every page: what has it may be written again, or removed
MARK = "salbench report"
# a folder that has it is the site of a leaderboard, whose pages have MARK, too
OF_LEADERBOARD = "data/submissions.csv"
SIMULATED = (
    "Simulated participants: the program made the ground truth. These scores say nothing about people."
)


def environment(package: Path, titles: Mapping[str, str], mine: str = "") -> Environment:
    """Templates of a package's own folder, which extend those that all share; everything is escaped. titles:
    what stands in tables -> what it means, which the filter `abbr` writes beside it. mine: what rows of
    tables are marked by, as a text or a key.
    """
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
        parts = known.split(text) if known else [text]  # every second one is known
        return Markup("").join(
            Markup('<abbr title="{}">{}</abbr>').format(titles[part], part) if at % 2 else escape(part)
            for at, part in enumerate(parts)
        )

    made.filters["abbr"] = abbr
    return made


def is_ours(page: Path) -> bool:
    """True if a page was made here."""
    if not page.is_file():
        return False
    with open(page, "rb") as file:
        return MARK.encode() in file.read(600)
