# SPDX-License-Identifier: GPL-3.0-or-later
"""Inspects a data set in a folder and lists its faults. Reads every file of every item and computes nothing
from it."""

import math
import os
from typing import Any

import numpy as np

from salbench import _core
from salbench.datasets import sets
from salbench.datasets.files import kind_of, natural_order
from salbench.datasets.records import Arrays, Item, Listing, arrays_of
from salbench.datasets.samples import summed
from salbench.system.workers import ask_all

MOST = 100  # ratio of a diagonal to the median; shapes of one unit differ by less
SNAP = 1.0  # degrees: a fixation that misses the shape by no more than this counts as snapped
_UNKNOWN: dict[str, Any] = {
    "points": 0,
    "faces": 0,
    "diagonal": 0.0,
    "has_truth": False,
    "seen": 0,
    "low": math.nan,
    "high": math.nan,
    "participants": 0,
    "picks": 0,
    "people": [],
    "notes": [],
    "faults": [],
    "remark": "",
}

Facts = dict[str, Any]


def inspected(layout: str, root: str) -> dict[str, Any]:
    """The document of docs/json.md, with numbers as numbers, all unused files and all problems."""
    root = os.path.normpath(root)
    dataset, listing = sets.listed(layout, root)
    items: list[Facts] = [_of_listing(item) for item in listing.items]

    def take(number: int, facts: Facts | None, problem: str) -> None:
        items[number] |= {"problem": problem} if facts is None else facts

    if not ask_all(
        [dataset.question("salbench.datasets.inspecting:facts_of", [item], item) for item in listing.items],
        take,
    ):
        raise KeyboardInterrupt
    notes = [*listing.notes, *filter(None, [listing.no_splits]), *_odd_sizes(items), *_odd_truths(items)]
    problems = [f"{facts['name']}: {facts['problem']}" for facts in items if facts["problem"]] + notes
    problems += [f"{facts['name']}: {note}" for facts in items for note in facts.pop("notes")]
    problems += summed(fault for facts in items for fault in facts.pop("faults"))
    in_splits = b"".join(
        sorted(os.fsencode(f"{item.name},{item.split}\n") for item in listing.items if item.split)
    )
    return {
        "layout": dataset.name,
        "shapes": len({facts["shape"] for facts in items}),
        "splits_digest": _core.xxh128(in_splits) if in_splits else "",
        "items": items,
        "unused": _unused(root, listing),
        "problems": problems,
    }


def facts_of(layout: str, item: Item) -> Facts:
    """Reads an item and collects its facts. layout: as in `sets.find`, or one that C++ lists."""
    shape = sets.find(layout).read(item)
    place, arrays = os.fsencode(item.place), arrays_of(shape, item.view, item.place)
    points, faces, diagonal, remark = _core.shape_facts(arrays, os.fsencode(item.name), place)
    facts: Facts = _UNKNOWN | {"points": points, "faces": faces, "diagonal": diagonal, "remark": remark}
    viewers, picks = 0 if shape.viewers is None else len(shape.viewers), sum(map(len, shape.participants))
    if shape.ground_truth is not None or viewers or picks:
        facts |= {
            "has_truth": True,
            "participants": max(viewers, len(shape.participants)),
            "picks": picks,
            "seen": points,
        }
    elif item.truth:
        facts["problem"] = f"{item.place}: has no ground truth, and its Item says that it has: truth=False"
    if shape.ground_truth is not None:
        truth = np.asarray(shape.ground_truth, float)
        seen = truth[~np.isnan(truth)]
        facts |= {
            "seen": len(seen),
            "low": float(seen.min(initial=math.inf)),
            "high": float(seen.max(initial=-math.inf)),
        }
    if shape.recording is not None:
        people, remark = _core.gaze_facts(arrays, SNAP, place)
        said = [*shape.recording.problems, *filter(None, [remark]), *_mirrored(arrays, place, people)]
        if "problem" not in facts and (
            shape.recording.problems or any(person["fixations"] > person["hits"] == 0 for person in people)
        ):
            facts["problem"], *said = said
        facts |= {"people": people, "faults": shape.recording.faults, "notes": said}
    return facts


def _mirrored(arrays: Arrays, place: bytes, people: list[dict[str, Any]]) -> list[str]:
    """For recordings most of whose fixations miss: the axis to mirror so that they hit, if there is one."""
    hits, fixations = (sum(person[key] for person in people) for key in ("hits", "fixations"))
    if 2 * hits >= fixations:
        return []
    for k, axes in enumerate(("-x y z", "x -y z", "x y -z")):
        signs = np.where(np.arange(3) == k, -1.0, 1.0)
        others = {
            name: arrays[name] * signs
            for name in ("recording/origins", "recording/directions", "recording/points")
            if name in arrays
        }
        found = sum(person["hits"] for person in _core.gaze_facts(arrays | others, SNAP, place)[0])
        if found > max(2 * hits, fixations / 2):
            return [
                f"mirrored by axes={axes!r}, {found} of {fixations} fixations hit, and {hits} as they are:"
                " the frame is another one than the shape's"
            ]
    return []


def _of_listing(item: Item) -> Facts:
    kind = item.kind or kind_of(str(item.files[0]))
    return {
        "name": item.name,
        "shape": item.shape_name,
        "view": item.view,
        "split": item.split,
        "class": item.category,
        "kind": kind,
        **_UNKNOWN,
        "problem": "",
    }


def _odd_sizes(items: list[Facts]) -> list[str]:
    """Shapes much larger or smaller than the others: units may be mixed. The first view represents its
    shape."""
    usual = float(np.median([facts["diagonal"] for facts in items if facts["diagonal"] > 0] or [0.0]))
    lines: dict[str, str] = {}
    for facts in items:
        diagonal = facts["diagonal"]
        if diagonal > 0 and not usual / MOST <= diagonal <= usual * MOST:
            lines.setdefault(
                facts["shape"],
                (
                    f"{facts['shape']}: its diagonal, {diagonal:.4g}, is {diagonal / usual:.3g} times the"
                    f" median of the data set, {usual:.4g}: if it is in another unit, scale it"
                ),
            )
    return list(lines.values())


def _odd_truths(items: list[Facts]) -> list[str]:
    """Ground truths that a run scores, but hardly as they were meant: one line per kind for the whole set."""
    negative = [facts["name"] for facts in items if facts["low"] < 0]
    constant = [facts["name"] for facts in items if facts["low"] == facts["high"] and not facts["picks"]]
    return [
        f"{names[0]}: the ground truth is {what} ({len(names)} of {len(items)} items)"
        for names, what in (
            (
                negative,
                "negative: if such values mark what nobody saw, make them NaN, as with values(..., unseen=-1)",
            ),
            (constant, "the same everywhere: the correlation of any map with it counts as 0"),
        )
        if names
    ]


def _unused(root: str, listing: Listing) -> list[str]:
    """Files below the folder that belong to no item, in natural order. Links to folders are not followed."""
    used = {os.path.normpath(path) for path in listing.paths}
    found = []
    for folder, folders, names in os.walk(root):
        folders[:] = [name for name in folders if not name.startswith(".")]
        found += [os.path.join(folder, name) for name in names if not name.startswith(".")]
    return sorted((path for path in found if os.path.normpath(path) not in used), key=natural_order)
