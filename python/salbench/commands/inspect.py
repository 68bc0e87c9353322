# SPDX-License-Identifier: GPL-3.0-or-later
"""`salbench inspect`: content and faults of a data set."""

import argparse
import math
import os
from collections import Counter
from typing import TYPE_CHECKING, Any

from salbench.commands.parsing import Parser
from salbench.commands.running import require_data_set
from salbench.system.console import ALL_DONE, SOME_FAILED, aligned, report
from salbench.system.errors import InputError

if TYPE_CHECKING:
    from salbench.datasets.copies import Compared, Pair

_MOST_NAMED = 10  # problems, and unused files
_RECORDED = ("samples", "lost", "fixations", "hits", "snapped", "missed")  # per person


def add_arguments(parser: Parser) -> None:
    parser.add_layout()
    parser.add_argument(
        "--against",
        metavar="LAYOUT2",
        help=(
            "also list near copies of shapes of this data set (in --against-data), or of the same one, "
            "independent of name, scale, pose and meshing"
        ),
    )
    parser.add_argument("--against-data", metavar="DIR", help="folder of that data set (default: --data)")
    parser.add_report()


def carry_out(given: argparse.Namespace) -> int:
    from salbench.datasets import copies, inspecting

    require_data_set(given.layout, given.data)
    if given.against:
        require_data_set(given.against, given.data)
    elif given.against_data:
        raise InputError("--against-data names a folder without a layout: give --against LAYOUT2")
    found = inspecting.inspected(given.layout, given.data)
    compared = (
        copies.compared((given.layout, given.data), (given.against, given.against_data or given.data))
        if given.against
        else None
    )
    text = _text(found) + (_text_of_copies(given.against, compared) if compared else "")
    report(given, "inspect", _document(found) | _document_of_copies(given.against, compared), text)
    failed = any(facts["problem"] for facts in found["items"]) or (compared and compared.problems)
    return SOME_FAILED if failed else ALL_DONE


def _counts(found: dict[str, Any], key: str) -> list[tuple[str, int]]:
    """Number of items per value, by name; items without one do not count."""
    return sorted(
        Counter(facts[key] for facts in found["items"] if facts[key]).items(),
        key=lambda count: os.fsencode(count[0]),
    )


def _number(value: float) -> str:
    """Shortest decimal form that identifies the number, as in the program."""
    return "" if math.isnan(value) else repr(float(value)).removesuffix(".0")


def _document(found: dict[str, Any]) -> dict[str, Any]:
    items = [
        {key: _number(value) if isinstance(value, float) else value for key, value in facts.items()}
        for facts in found["items"]
    ]
    order = (
        "name",
        "shape",
        "view",
        "split",
        "class",
        "kind",
        "points",
        "faces",
        "diagonal",
        "has_truth",
        "seen",
        "low",
        "high",
        "participants",
        "picks",
        "people",
        "remark",
        "problem",
    )
    counts = {
        key: [{"name": name, "items": count} for name, count in _counts(found, key[:-1])]
        for key in ("splits", "views")
    }
    return {
        "layout": found["layout"],
        "shapes": found["shapes"],
        "splits_digest": found["splits_digest"],
        "items": [{key: facts[key] for key in order} for facts in items],
        **counts,
        "unused_files": len(found["unused"]),
        "unused": found["unused"][:_MOST_NAMED],
        "n_problems": len(found["problems"]),
        "problems": found["problems"][:_MOST_NAMED],
    }


def _text(found: dict[str, Any]) -> str:
    items = found["items"]
    lines = [("layout", found["layout"]), ("items", f"{len(items)} of {found['shapes']} shapes")]
    for topic, key in (("splits", "split"), ("views", "view")):
        lines.append((topic, ", ".join(f"{name} {count}" for name, count in _counts(found, key)) or "none"))
    if found["splits_digest"]:
        lines.append(("digest", f"{found['splits_digest']}, of the splits"))
    columns = {
        "item": "name",
        "split": "split",
        "points": "points",
        "faces": "faces",
        "diagonal": "diagonal",
        "seen": "seen",
        "low": "low",
        "high": "high",
        "participants": "participants",
        "picks": "picks",
    }
    rows = [
        {
            **facts,
            "seen": facts["seen"] / facts["points"] if facts["points"] and facts["has_truth"] else math.nan,
        }
        for facts in items
    ]
    table = aligned(list(columns), [[row[key] for key in columns.values()] for row in rows])
    if recorded := [[facts["name"], *person.values()] for facts in items for person in facts["people"]]:
        table += "\n" + aligned(["item", "person", *_RECORDED], recorded)
    return (
        "".join(f"{topic:<8} {text}\n" for topic, text in lines)
        + "\n"
        + table
        + "\n"
        + _listing_of("unused file", found["unused"])
        + _listing_of("problem", found["problems"])
    )


def _listing_of(what: str, lines: list[str]) -> str:
    head = f"{len(lines)} {what}{'' if len(lines) == 1 else 's'}"
    more = f", the first {_MOST_NAMED}:" if len(lines) > _MOST_NAMED else ":" if lines else ""
    return f"{head}{more}\n" + "".join(f"  {line}\n" for line in lines[:_MOST_NAMED])


def _document_of_copies(layout: str, found: "Compared | None") -> dict[str, Any]:
    """found: None if not requested."""
    from salbench.datasets.copies import WITHIN

    def pairs(some: "list[Pair]") -> list[dict[str, str]]:
        return [pair._asdict() | {"distance": f"{pair.distance:.4f}"} for pair in some]

    near, others = (found.near, [found.next] if found.next else []) if found else ([], [])
    return {
        "against": layout if found else "",
        "against_shapes": found.shapes if found else 0,
        "within": str(WITHIN),
        "near_copies": pairs(near),
        "next": pairs(others),
        "not_compared": found.problems if found else [],
    }


def _text_of_copies(layout: str, found: "Compared") -> str:
    from salbench.datasets.copies import WITHIN

    n = len(found.near)
    lines = [
        (
            f"{n} near cop{'y' if n == 1 else 'ies'} among the {found.shapes} shapes of {layout}, by"
            f" distances of points, at most {WITHIN} apart{':' * bool(n)}"
        ),
        *(f"  {own} is {other}, {distance:.4f}" for own, other, distance in found.near),
    ]
    if found.next:
        lines.append("nearest of all others: {} and {}, {:.4f}".format(*found.next))
    if found.problems:
        lines += [f"{len(found.problems)} not compared:", *(f"  {problem}" for problem in found.problems)]
    return "\n".join(lines) + "\n"
