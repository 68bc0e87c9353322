#!/usr/bin/python3 -B
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the columns of conclusions into data_dictionary.md, as python/salbench/conclusions declares them."""

import re
from pathlib import Path

from salbench.conclusions import TABLES
from salbench.conclusions.tables import SHARED

PAGE = Path(__file__).resolve().with_suffix(".md")
BEGIN, END = "<!-- made by docs/data_dictionary.py -->\n", "<!-- end -->\n"


def rows(columns):
    return "".join(f"| `{column.name}` | {column.meaning.replace(chr(124), chr(92) + chr(124))} |\n" for column in columns)


def made():
    """A section per table: what a row is, and the columns that are its own."""
    yield f"Columns of several conclusions:\n\n| column | meaning |\n|---|---|\n{rows(SHARED)}"
    for table in TABLES:
        what = re.sub(r" \[\w+\]", "", " ".join(table.make.__doc__.split()))
        own = [column for column in table.columns if column not in SHARED]
        yield f"`{table.name}.csv`: {what[0].lower()}{what[1:]}\n" + (f"\n| column | meaning |\n|---|---|\n{rows(own)}" if own else "")


def page(text):
    before, _, rest = text.partition(BEGIN)
    return before + BEGIN + "\n" + "\n".join(made()) + "\n" + END + rest.partition(END)[2]


if __name__ == "__main__":
    PAGE.write_text(page(PAGE.read_text(encoding="utf-8")), encoding="utf-8")
