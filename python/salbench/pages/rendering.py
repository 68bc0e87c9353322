# SPDX-License-Identifier: GPL-3.0-or-later
"""Templates, and the files that pages load."""

from functools import cache
from pathlib import Path

from jinja2 import Environment, FileSystemLoader, StrictUndefined

HERE = Path(__file__).parent
MARK = "salbench report"  # <meta name="generator"> of every page: what has it may be written again, or removed
SIMULATED = "Simulated participants: the program made the ground truth. These scores say nothing about people."


@cache
def environment(package: Path) -> Environment:
    """Templates of a package's own folder, which extend those that all share; everything is escaped."""
    made = Environment(loader=FileSystemLoader([package / "templates", HERE / "templates"]), autoescape=True, undefined=StrictUndefined,
                       trim_blocks=True, lstrip_blocks=True)
    made.globals.update(MARK=MARK)
    return made


def is_ours(page: Path) -> bool:
    """True if it is a page that was made here."""
    try:
        return MARK in page.read_text(encoding="utf-8", errors="replace")[:600]
    except FileNotFoundError:
        return False
