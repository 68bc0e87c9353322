# SPDX-License-Identifier: GPL-3.0-or-later
"""What the page of a model says of it beside its scores: its card with what that leaves out, what a map costs, and its further trainings."""

from collections.abc import Iterator
from typing import Any

import pandas

from salbench.leaderboard.board import Board
from salbench.leaderboard.card import is_web
from salbench.leaderboard.entry import Entry
from salbench.pages.blocks import Fact, Facts, Note
from salbench.pages.columns import Column, counted, number, sheet

COST = "Measured by the authors, on their machine. It is shown, and no ranking has it: seconds of two machines say nothing of two models."
SPREAD = ("Mean of the means of the trainings that came with the submission ({}), their standard deviation, the lowest and the highest: the spread over "
          "trainings, not the interval over shapes that the scores have.")


def card(entry: Entry) -> list[Any]:
    """What the authors declare, with why readers ask for what they do not."""
    of, manifest = entry.card, entry.manifest
    written = f"salbench {manifest.program}" if manifest.program else ""
    made = {"files": "from files", "command": "by a command", "function": "by a function of Python", "built-in": "by a model of the program"}
    rows = [("File", entry.name), ("Date", of.date), ("Version", of.version), ("Citation", of.citation), ("Licence", of.licence), ("Page", of.url),
            ("Code", of.code), ("Weights", of.weights), ("Parameters", of.parameters), ("Training data", of.training_data),
            ("Training set", of.training_set), ("Trained on", ", ".join(of.trained_on)), ("Overlap with the test items", of.overlap),
            ("How it learned", manifest.learned), ("Container", of.container), ("Maps made", made.get(manifest.made_by, manifest.made_by)),
            ("Function or command", manifest.function), *(("File of code or weights", file) for file in manifest.files),
            ("Digest of the maps", manifest.map_digest), ("Ground truth", manifest.ground_truth), ("Written by, as it says", written),
            ("Contact", of.contact), ("Remark", entry.remark), *(("Reproduced, as it says", text) for text in of.reproduced_by)]
    asked = {"Version": "version", "Code": "code", "Weights": "weights", "Parameters": "parameters", "Training set": "training_set", "Contact": "contact"}
    return [Facts(list(_told(entry, rows, asked))), *([Note("Nobody has said yet that they reproduced it.")] if not of.reproduced_by else [])]


def cost(entry: Entry) -> list[Any]:
    of, manifest = entry.card, entry.manifest
    seconds = dict(zip(("median", "95th percentile"), manifest.seconds))
    rows = [("Seconds per shape", ", ".join(f"{what} {value}" for what, value in seconds.items())),
            ("What was timed", entry.timed), ("Device", of.device), ("Peak memory", of.memory)]
    facts = [*_told(entry, rows, {"Device": "device", "Peak memory": "memory"})]
    if not seconds:
        facts.insert(0, Fact("Seconds per shape", "not said: salbench submit writes them where the program made the maps", missing=True))
    return [Facts(facts), Note(COST)]


def _told(entry: Entry, rows: list[tuple[str, str]], asked: dict[str, str]) -> Iterator[Fact]:
    unsaid = entry.card.unsaid
    for label, text in rows:
        if text:
            yield Fact(label, text, is_link=is_web(text))
        elif why := unsaid.get(asked.get(label, "")):
            yield Fact(label, f"not said: {why}", missing=True)


def trainings(board: Board, model: str, columns: list[Column]) -> list[Any]:
    """Of scores per seed, where the submission came with some. columns: of a row's data set and metric."""
    frame = board.tables.get("seeds")
    frame = frame[frame["model"] == model] if frame is not None else pandas.DataFrame()
    if frame.empty:
        return []
    by = [name for name in ("dataset", "split", "metric") if name in frame]
    rows = [{**dict(zip(by, key)), **part.agg(["size", "mean", "std", "min", "max"])} for key, part in frame.groupby(by, sort=False)["mean"]]
    seeds = ", ".join(str(seed) or "the one that is ranked" for seed in dict.fromkeys(frame["seed"]))
    columns = [*columns, counted("Trainings", "size"), number("Mean over trainings", "mean"), number("Standard deviation over trainings", "std"),
               number("Lowest", "min"), number("Highest", "max")]
    return [sheet("trainings", SPREAD.format(seeds), columns, rows)]
