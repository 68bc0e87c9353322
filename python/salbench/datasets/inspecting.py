# SPDX-License-Identifier: GPL-3.0-or-later
"""`salbench inspect`: every file of every item is read, and nothing is computed from it."""

from __future__ import annotations

import argparse
import math
import os
from collections import Counter
from typing import Any

from salbench import _core, _wire
from salbench._console import ALL_DONE, SOME_FAILED, aligned, report
from salbench._workers import ask_all
from salbench.datasets import copies, described, sets
from salbench.datasets._facts import UNKNOWN, Facts
from salbench.datasets._layout import number_text
from salbench.datasets._patterns import natural_order
from salbench.datasets._sizes import odd_sizes
from salbench.datasets.records import InputError, Item, Listing

_MOST_NAMED = 10  # problems, and unused files
RECORDED = ("samples", "lost", "fixations", "hits", "snapped", "missed")  # of each person


def inspected(layout: str, root: str) -> dict[str, Any]:
    """The document of docs/json.md, with numbers as numbers, all unused files and all problems."""
    root = os.path.normpath(root)
    name, listing = sets.listed(layout, root)
    archive = layout if layout != sets.AUTOMATIC else name
    items: list[Facts] = [_of_listing(item) for item in listing.items]

    def take(number: int, made: bytes | None, problems: list[str]) -> None:
        items[number] |= {"problem": problems[0]} if made is None else _wire.loads(made)

    requests = [{"do": "facts", "layout": archive, "root": root, "item": item.to_json()} for item in listing.items]
    if not ask_all(requests, take):
        raise KeyboardInterrupt
    notes = [*listing.notes, *([listing.no_splits] if listing.no_splits else [])]
    if not listing.unit_where:
        notes += _odd_sizes(items)
    for facts in items:
        facts["diagonal"] *= listing.scale
    problems = [f"{facts['name']}: {facts['problem']}" for facts in items if facts["problem"]] + notes
    problems += [f"{facts['name']}: {note}" for facts in items for note in facts.pop("notes")]
    in_splits = b"".join(sorted(os.fsencode(f"{item.name},{item.split}\n") for item in listing.items if item.split))
    return {"layout": name, "shapes": len({facts["shape"] for facts in items}),
            "splits_digest": _core.xxh128(in_splits) if in_splits else "", "positives": listing.positives, "scale": listing.scale,
            "items": items, "unused": _unused(root, listing), "problems": problems}


def _of_listing(item: Item) -> Facts:
    kind = item.kind or described.kind_of(sets.shape_file(item))
    return {"name": item.name, "shape": item.shape_name, "view": item.view, "split": item.split, "class": item.category, "kind": kind,
            **UNKNOWN, "problem": ""}


def _odd_sizes(items: list[Facts]) -> list[str]:
    """A unit that no description names may be mixed all the same. Of the views of a shape the first tells."""
    lines: dict[str, str] = {}
    for facts, odd in zip(items, odd_sizes([facts["diagonal"] for facts in items])):
        if odd:
            lines.setdefault(facts["shape"], f"{facts['shape']}: {odd}: if it is in another unit, scale it; `units:` in a description makes it fail")
    return list(lines.values())


def _unused(root: str, listing: Listing) -> list[str]:
    """Files below the folder that belong to no item, in natural order. Links to folders are not followed."""
    used = {os.path.normpath(path) for path in listing.files()}
    found = []
    for folder, folders, names in os.walk(root):
        folders[:] = [name for name in folders if not name.startswith(".")]
        found += [os.path.join(folder, name) for name in names if not name.startswith(".")]
    return sorted((path for path in found if os.path.normpath(path) not in used), key=natural_order)


def command(given: argparse.Namespace) -> int:
    """given: the arguments of the command. Returns the status."""
    layout, root = sets.given_data("inspect", given)
    if given.against_data and not given.against:
        raise InputError("inspect: --against-data names a folder without a layout: give --against LAYOUT2")
    other = sets.given_data("inspect", argparse.Namespace(layout=given.against, data=given.against_data or root)) if given.against else None
    found = inspected(layout, root)
    compared = copies.compared((layout, root), other) if other else None
    text = _text(found) + (copies.text(given.against, compared) if compared else "")
    report(given, "inspect", _document(found) | copies.document(given.against, compared), text)
    failed = any(facts["problem"] for facts in found["items"]) or (compared and compared.problems)
    return SOME_FAILED if failed else ALL_DONE


def _counts(found: dict[str, Any], key: str) -> list[tuple[str, int]]:
    """How many items have each value, by name; items without one do not count."""
    return sorted(Counter(facts[key] for facts in found["items"] if facts[key]).items(), key=lambda count: os.fsencode(count[0]))


def _number(value: float) -> str:
    """As the program writes numbers: the fewest digits that tell them from others."""
    return "" if math.isnan(value) else number_text(value)


def _document(found: dict[str, Any]) -> dict[str, Any]:
    items = [{key: _number(value) if isinstance(value, float) else value for key, value in facts.items()} for facts in found["items"]]
    order = ("name", "shape", "view", "split", "class", "kind", "points", "faces", "diagonal", "has_truth", "seen", "low", "high",
             "participants", "picks", "people", "remark", "problem")
    counts = {key: [{"name": name, "items": count} for name, count in _counts(found, key[:-1])] for key in ("splits", "views")}
    return {"layout": found["layout"], "shapes": found["shapes"], "splits_digest": found["splits_digest"], "positives": found["positives"], "scale": _number(found["scale"]),
            "items": [{key: facts[key] for key in order} for facts in items], **counts, "unused_files": len(found["unused"]),
            "unused": found["unused"][:_MOST_NAMED], "n_problems": len(found["problems"]), "problems": found["problems"][:_MOST_NAMED]}


def _text(found: dict[str, Any]) -> str:
    items = found["items"]
    lines = [("layout", found["layout"]), ("items", f"{len(items)} of {found['shapes']} shapes")]
    for topic, key in (("splits", "split"), ("views", "view")):
        lines.append((topic, ", ".join(f"{name} {count}" for name, count in _counts(found, key)) or "none"))
    if found["splits_digest"]:
        lines.append(("digest", f"{found['splits_digest']}, of the splits"))
    if found["positives"] != "picks":
        lines.append(("picks", found["positives"]))
    if found["scale"] != 1:
        lines.append(("scale", f"{_number(found['scale'])}, of diagonals"))
    columns = {"item": "name", "split": "split", "points": "points", "faces": "faces", "diagonal": "diagonal", "seen": "seen", "low": "low",
               "high": "high", "participants": "participants", "picks": "picks"}
    rows = [{**facts, "seen": facts["seen"] / facts["points"] if facts["points"] and facts["has_truth"] else math.nan} for facts in items]
    table = aligned(list(columns), [[row[key] for key in columns.values()] for row in rows])
    if recorded := [[facts["name"], *person.values()] for facts in items for person in facts["people"]]:
        table += "\n" + aligned(["item", "person", *RECORDED], recorded)
    return ("".join(f"{topic:<8} {text}\n" for topic, text in lines) + "\n" + table + "\n"
            + _listing_of(f"{len(found['unused'])} unused files", found["unused"]) + _listing_of(f"{len(found['problems'])} problems", found["problems"]))


def _listing_of(head: str, lines: list[str]) -> str:
    more = f", the first {_MOST_NAMED}:" if len(lines) > _MOST_NAMED else ":" if lines else ""
    return f"{head}{more}\n" + "".join(f"  {line}\n" for line in lines[:_MOST_NAMED])
