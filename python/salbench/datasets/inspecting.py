# SPDX-License-Identifier: GPL-3.0-or-later
"""`salbench inspect`: every file of every item is read, and nothing is computed from it."""

from __future__ import annotations

import argparse
import math
import os
from collections import Counter
from typing import Any

import numpy as np

from salbench import _core
from salbench.datasets import copies, sets
from salbench.datasets.files import kind_of, natural_order
from salbench.datasets.records import InputError, Item, Listing, Shape
from salbench.system.console import ALL_DONE, SOME_FAILED, aligned, report
from salbench.system.workers import Question, ask_all

MOST = 100  # between a diagonal and the median: shapes of one unit are nearer
SNAP = 1.0  # degrees: how near to the shape a fixation that misses it counts as snapped
RECORDED = ("samples", "lost", "fixations", "hits", "snapped", "missed")  # of each person
_MOST_NAMED = 10  # problems, and unused files
_UNKNOWN: dict[str, Any] = {"points": 0, "faces": 0, "diagonal": 0.0, "has_truth": False, "seen": 0, "low": math.nan, "high": math.nan,
                            "participants": 0, "picks": 0, "people": [], "notes": [], "remark": ""}

Facts = dict[str, Any]


def inspected(layout: str, root: str) -> dict[str, Any]:
    """The document of docs/json.md, with numbers as numbers, all unused files and all problems."""
    root = os.path.normpath(root)
    dataset, listing = sets.listed(layout, root)
    items: list[Facts] = [_of_listing(item) for item in listing.items]

    def take(number: int, facts: Facts | None, problem: str) -> None:
        items[number] |= {"problem": problem} if facts is None else facts

    if not ask_all([Question("salbench.datasets.inspecting:facts_of", (dataset.layout or dataset.name, item), sets.place_of(item), tuple(item.files))
                    for item in listing.items], take):
        raise KeyboardInterrupt
    notes = [*listing.notes, *([listing.no_splits] if listing.no_splits else []), *_odd_sizes(items)]
    problems = [f"{facts['name']}: {facts['problem']}" for facts in items if facts["problem"]] + notes
    problems += [f"{facts['name']}: {note}" for facts in items for note in facts.pop("notes")]
    in_splits = b"".join(sorted(os.fsencode(f"{item.name},{item.split}\n") for item in listing.items if item.split))
    return {"layout": dataset.name, "shapes": len({facts["shape"] for facts in items}),
            "splits_digest": _core.xxh128(in_splits) if in_splits else "", "items": items, "unused": _unused(root, listing), "problems": problems}


def facts_of(layout: str, item: Item) -> Facts:
    """What is read of an item; `layout`: as `sets.find` knows it, or one that C++ lists."""
    shape = sets.find(layout).read(item)
    points, faces, diagonal, remark = _core.shape_facts(shape, os.fsencode(item.name), os.fsencode(sets.place_of(item)))
    facts: Facts = _UNKNOWN | {"points": points, "faces": faces, "diagonal": diagonal, "remark": remark, "notes": shape.problems[1:] + shape.remarks}
    if shape.problems:
        facts["problem"] = shape.problems[0]
    viewers, picks = 0 if shape.viewers is None else len(shape.viewers), sum(map(len, shape.picks))
    if shape.truth is not None or viewers or picks:
        facts |= {"has_truth": True, "participants": max(viewers, len(shape.picks)), "picks": picks, "seen": points}
    elif item.truth:
        facts["problem"] = facts.get("problem") or f"{sets.place_of(item)}: has no ground truth, and its Item says that it has: truth=False"
    if shape.truth is not None:
        truth = np.asarray(shape.truth)
        seen = truth[~np.isnan(truth)]
        facts |= {"seen": len(seen), "low": float(seen.min(initial=math.inf)), "high": float(seen.max(initial=-math.inf))}
    if shape.recording is not None:
        people, missed = _gaze_facts(shape)
        facts |= {"people": people, "notes": [*facts["notes"], *missed]}
    return facts


def _gaze_facts(shape: Shape) -> tuple[list[Facts], list[str]]:
    """Counts by person, and a line on those whose gaze is nowhere on the shape."""
    if shape.faces is None:
        from salbench.shapes.stages import estimate_normals, partial_mesh

        normals = estimate_normals(shape.points, viewpoint=shape.viewpoint) if shape.normals is None else shape.normals
        shape = Shape(shape.points, partial_mesh(shape.points, normals), recording=shape.recording)
    people, remark = _core.gaze_facts(shape, SNAP)
    return people, [remark] if remark else []


def _of_listing(item: Item) -> Facts:
    kind = item.kind or kind_of(str(item.files[0]))
    return {"name": item.name, "shape": item.shape_name, "view": item.view, "split": item.split, "class": item.category, "kind": kind,
            **_UNKNOWN, "problem": ""}


def _odd_sizes(items: list[Facts]) -> list[str]:
    """Shapes that are much larger or smaller than the others: units may be mixed. Of the views of a shape the first tells."""
    usual = float(np.median([facts["diagonal"] for facts in items if facts["diagonal"] > 0] or [0.0]))
    lines: dict[str, str] = {}
    for facts in items:
        diagonal = facts["diagonal"]
        if diagonal > 0 and not usual / MOST <= diagonal <= usual * MOST:
            lines.setdefault(facts["shape"], f"{facts['shape']}: its diagonal, {diagonal:.4g}, is {diagonal / usual:.3g} times the median of the data "
                                             f"set, {usual:.4g}: if it is in another unit, scale it")
    return list(lines.values())


def _unused(root: str, listing: Listing) -> list[str]:
    """Files below the folder that belong to no item, in natural order. Links to folders are not followed."""
    used = {os.path.normpath(path) for path in sets.files_of(listing)}
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
    return "" if math.isnan(value) else repr(float(value)).removesuffix(".0")


def _document(found: dict[str, Any]) -> dict[str, Any]:
    items = [{key: _number(value) if isinstance(value, float) else value for key, value in facts.items()} for facts in found["items"]]
    order = ("name", "shape", "view", "split", "class", "kind", "points", "faces", "diagonal", "has_truth", "seen", "low", "high",
             "participants", "picks", "people", "remark", "problem")
    counts = {key: [{"name": name, "items": count} for name, count in _counts(found, key[:-1])] for key in ("splits", "views")}
    return {"layout": found["layout"], "shapes": found["shapes"], "splits_digest": found["splits_digest"],
            "items": [{key: facts[key] for key in order} for facts in items], **counts, "unused_files": len(found["unused"]),
            "unused": found["unused"][:_MOST_NAMED], "n_problems": len(found["problems"]), "problems": found["problems"][:_MOST_NAMED]}


def _text(found: dict[str, Any]) -> str:
    items = found["items"]
    lines = [("layout", found["layout"]), ("items", f"{len(items)} of {found['shapes']} shapes")]
    for topic, key in (("splits", "split"), ("views", "view")):
        lines.append((topic, ", ".join(f"{name} {count}" for name, count in _counts(found, key)) or "none"))
    if found["splits_digest"]:
        lines.append(("digest", f"{found['splits_digest']}, of the splits"))
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
