# SPDX-License-Identifier: GPL-3.0-or-later
"""What changed, as a JSON Feed (https://www.jsonfeed.org/version/1.1/): who joined, had the best mean until then, was refused, or left. It follows
from the tables, and has the dates of cards and of withdrawn.csv: nothing is of the moment at which it is made."""

import json
from collections import Counter
from typing import Any
from urllib.parse import quote

from salbench.conclusions.metrics import label_of
from salbench.leaderboard.board import Board
from salbench.pages.names import spoken

Item = dict[str, Any]


def feed(board: Board) -> bytes:
    """In ASCII; the newest items first, those without a date last."""
    items = sorted([*joined(board), *firsts(board), *refused(board), *left(board)], key=lambda item: str(item.get("date_published", "")), reverse=True)
    times = Counter[str]()
    for item in items:  # files may differ in what is no text alone
        times[item["id"]] += 1
        item["id"] += f"/{times[item['id']]}" if times[item["id"]] > 1 else ""
    document = {"version": "https://jsonfeed.org/version/1.1", "title": f"salbench leaderboard: {board.facts['Data set']}", "items": items}
    return (json.dumps(document, indent=1) + "\n").encode("ascii")


def item(kind: str, parts: tuple[str, ...], title: str, text: str, date: str) -> Item:
    """parts: what tells it from others of its kind."""
    return {"id": "/".join([kind, *(quote(part, "") for part in parts)]), "title": title, "content_text": text,
            **({"date_published": f"{date}T00:00:00Z"} if date else {}), "tags": [kind]}


def joined(board: Board) -> list[Item]:
    return [item("joined", (entry.name, entry.card.name), f"{entry.card.name} joined" + (", beside the ranking" if entry.beside else ""),
                 "; ".join(filter(None, (f"{entry.name}: {entry.card.citation}", entry.measured, entry.beside, entry.remark))), entry.card.date)
            for entry in board.of_status("ranked", "beside")]


def firsts(board: Board) -> list[Item]:
    """Of a metric on a data set and split."""
    found = []
    for row in board.tables["history"].to_dict("records"):
        if row["best"] == "yes":
            split, metric = row.get("split", ""), label_of(row["metric"])
            where = spoken(row["dataset"]) + (f", split {split}" if split else "")
            found.append(item("first", (row["dataset"], split, row["metric"], row["file"], row["model"]), f"{row['model']} is first by {metric} on {where}",
                              f"Its mean of {row['mean']:.3f} was the best of all until then, which does not say that it differs from them.", row["date"]))
    return found


def refused(board: Board) -> list[Item]:
    return [item("refused", (entry.name,), f"{entry.name} was refused", entry.refused, entry.card.date) for entry in board.of_status("refused")]


def left(board: Board) -> list[Item]:
    return [item("left", (one.file, one.model), f"{one.model or one.file} left", f"{one.file}: {one.why}", one.date) for one in board.left]
