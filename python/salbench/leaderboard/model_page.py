# SPDX-License-Identifier: GPL-3.0-or-later
"""Parts of a model's page beside its scores: its card with missing entries, the cost of a map, and further
trainings."""

from collections.abc import Iterator, Mapping
from typing import Any

import pandas

from salbench.leaderboard.board import Board, row_of
from salbench.leaderboard.card import is_web
from salbench.leaderboard.entry import Entry
from salbench.pages.blocks import Fact, Facts, Note
from salbench.pages.columns import Column, counted, number, sheet

CARD = {
    "file": "File",
    "date": "Date",
    "version": "Version",
    "citation": "Citation",
    "licence": "Licence",
    "url": "Page",
    "code": "Code",
    "weights": "Weights",
    "parameters": "Parameters",
    "training_data": "Training data",
    "training_set": "Training set",
    "trained_on": "Trained on",
    "test_overlap": "Overlap with the test items",
    "learned": "How it learned",
    "container": "Container",
    "made_by": "Maps made",
    "function": "Function or command",
    "files": "File of code or weights",
    "map_digest": "Digest of the maps",
    "ground_truth": "Ground truth",
    "program": "Written by, as it says",
    "contact": "Contact",
    "remark": "Remark",
    "reproduced_by": "Reproduced, as it says",
}
COST = {"timed": "What was timed", "device": "Device", "memory": "Peak memory"}
MADE_BY = {
    "files": "from files",
    "command": "by a command",
    "function": "by a function of Python",
    "built-in": "by a model of the program",
}
OF_COST = (
    "Measured by the authors, on their machine. It is shown, and no ranking has it: seconds of two machines"
    " say nothing of two models."
)
SPREAD = (
    "Mean of the means of the trainings that came with the submission ({}), their standard deviation, the"
    " lowest and the highest: the spread over trainings, not the interval over shapes that the scores have."
)


def card(entry: Entry) -> list[Any]:
    """The authors' statements, with the reasons why readers ask for missing ones."""
    unreproduced = [] if entry.card.reproduced_by else [Note("Nobody has said yet that they reproduced it.")]
    return [Facts(list(_facts(entry, CARD))), *unreproduced]


def cost(entry: Entry) -> list[Any]:
    seconds = ", ".join(
        f"{what} {value}" for what, value in zip(("median", "95th percentile"), entry.manifest.seconds)
    )
    first = Fact(
        "Seconds per shape",
        seconds or "not said: salbench submit writes them where the program made the maps",
        missing=not seconds,
    )
    return [Facts([first, *_facts(entry, COST)]), Note(OF_COST)]


def _facts(entry: Entry, labels: Mapping[str, str]) -> Iterator[Fact]:
    """labels: by column of submissions.csv."""
    row, unsaid, manifest = row_of(entry), entry.card.unsaid, entry.manifest
    further = {
        "made_by": [MADE_BY.get(manifest.made_by, manifest.made_by)],
        "program": [f"salbench {manifest.program}"] if manifest.program else [],
        "files": manifest.files,
        "reproduced_by": entry.card.reproduced_by,
    }
    for column, label in labels.items():
        texts = [text for text in further.get(column, [row[column]]) if text]
        yield from (Fact(label, text, is_link=is_web(text)) for text in texts)
        if not texts and column in unsaid:
            yield Fact(label, f"not said: {unsaid[column]}", missing=True)


def trainings(board: Board, model: str, columns: list[Column]) -> list[Any]:
    """Scores per seed, if the submission has several. columns: data set and metric of a row."""
    frame = board.tables.get("seeds")
    frame = frame[frame["model"] == model] if frame is not None else pandas.DataFrame()
    if frame.empty:
        return []
    by = [name for name in ("dataset", "split", "metric") if name in frame]
    rows = [
        {**dict(zip(by, key)), **part.agg(["size", "mean", "std", "min", "max"])}
        for key, part in frame.groupby(by, sort=False)["mean"]
    ]
    seeds = ", ".join(str(seed) or "the one that is ranked" for seed in dict.fromkeys(frame["seed"]))
    columns = [
        *columns,
        counted("Trainings", "size"),
        number("Mean over trainings", "mean"),
        number("Standard deviation over trainings", "std"),
        number("Lowest", "min"),
        number("Highest", "max"),
    ]
    return [sheet("trainings", SPREAD.format(seeds), columns, rows)]
