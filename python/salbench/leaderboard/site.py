# SPDX-License-Identifier: GPL-3.0-or-later
"""The pages of a leaderboard. Nothing is computed here, and nothing that a submission says is more than text: templates escape it."""

import re
import shutil
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pandas

from salbench.conclusions.metrics import label_of
from salbench.leaderboard.board import Board, Entry
from salbench.pages.blocks import Cell, Note, Table, cell, interval, mean_cell
from salbench.pages.names import DATASETS
from salbench.pages.rendering import HERE as SHARED
from salbench.pages.rendering import SIMULATED, environment

HERE = Path(__file__).parent
NAVIGATION = (("index.html", "Ranking"), ("metrics.html", "Metrics"), ("classes.html", "Classes"),
              ("history.html", "History"), ("submissions.html", "Submissions"))
Row = dict[str, Any]


def write_pages(board: Board, site: Path) -> None:
    def write(path: str, title: str, sections: Sequence[tuple[str, list[Any]]], **values: Any) -> None:
        template = environment(HERE).get_template("leaderboard.html")
        text = template.render(path=path, root="../" * path.count("/"), navigation=NAVIGATION, banners=banners(board), board=board, title=title, web=is_web,
                               sections=sections, **{"facts": {}, "card": {}, "protocol": "", **values})
        (site / path).parent.mkdir(exist_ok=True)
        (site / path).write_bytes(text.encode("utf-8", "replace"))

    (site / "static").mkdir()
    for name in ("report.css", "tables.js"):
        shutil.copyfile(SHARED / "static" / name, site / "static" / name)
    for path, title, blocks in (("metrics.html", "Metrics", by_metric(board)), ("classes.html", "Classes", by_class(board)),
                                ("history.html", "History", history(board)), ("submissions.html", "Submissions", submissions(board, board.entries))):
        write(path, title, [(title, blocks)])
    for entry in board.of_status("ranked", "beside"):
        model = entry.card.name
        write(f"models/{model}.html", model, [("Scores", scores(board, model)), ("Classes", by_class(board, model))], card=card_rows(entry))
    sections = [("Ranking", ranking(board))]
    if refused := board.of_status("refused"):
        sections.append(("Refused", submissions(board, refused)))
    write("index.html", "Leaderboard", sections, facts=board.facts, protocol=board.protocol)


def is_web(address: str) -> bool:
    """True for what a link may lead to: no `javascript:` and the like."""
    return re.fullmatch(r"https?://\S+", address) is not None


def banners(board: Board) -> list[str]:
    return [SIMULATED] if any(remark.startswith("SIMULATED") for remark in board.remarks) else []


def heading(row: Row) -> str:
    return DATASETS[row["dataset"]] + (f", split {row['split']}" if row.get("split") else "")


def named(board: Board, model: str) -> Cell:
    """A model in a table: a link where it was submitted, and what there is to say of it."""
    entry = next((entry for entry in board.of_status("ranked", "beside") if entry.card.name == model), None)
    if entry is None:
        return Cell(model)
    seen = len(set(entry.card.test_overlap))
    said = [f"beside: it has seen {seen} items" if seen else "", entry.remark]
    return Cell(model, href=f"models/{model}.html", below="; ".join(filter(None, said)))


def rows_of(frame: pandas.DataFrame) -> list[Row]:
    rows: list[Row] = frame.to_dict("records")
    return rows


def ranking(board: Board) -> list[Any]:
    """A table per data set and split: models x metrics, the best by the first metric first, then references, then those that stand beside."""
    frame = pandas.concat([board.tables["compact"], board.beside], ignore_index=True)
    splits = frame["split"] if "split" in frame else frame["dataset"].map(lambda name: "")
    blocks: list[Any] = []
    for dataset, split in dict.fromkeys(zip(frame["dataset"], splits)):
        part = frame[(frame["dataset"] == dataset) & (splits == split)]
        by_cell = {(row["model"], row["metric"]): row for row in rows_of(part)}
        better = dict(zip(part["metric"], part["better"]))
        rows = [[named(board, model), *(mean_cell(by_cell.get((model, metric))) for metric in better)] for model in part["model"].unique()]
        caption = (f"{heading(next(iter(by_cell.values())))}: mean ± half of its 95 % interval, or its ends where it was cut at the range of the metric; best in bold. Models "
                   "that share a letter cannot be told apart. Models without a letter are people, chance, or stand beside the ranking.")
        blocks.append(Table("ranking-" + re.sub(r"\W+", "-", heading(next(iter(by_cell.values())))), caption, ["Model", *map(label_of, better)], rows,
                            [False] + [True] * len(better), better=["", *better.values()]))
    return blocks or [Note("No submission could be ranked.", missing=True)]


def by_metric(board: Board) -> list[Any]:
    rows = [[Cell(heading(row)), Cell(row["metric"]), named(board, row["model"]), cell(row["mean"]), Cell(str(row["rank"])),
             Cell(f"{row['rank_low']} to {row['rank_high']}"), cell(row["first"], 2), Cell(row["group"])] for row in rows_of(board.tables["ranking"])]
    heads = ["Data set", "Metric", "Model", "Mean", "Rank", "95 % of ranks", "Share first", "Group"]
    return [Table("ranks", "Ranks, with the ranks that 95 % of the resamples give, and the share of them in which a model is first.",
                  heads, rows, [False] * 3 + [True] * 4 + [False], filters=[0, 1])]


def by_class(board: Board, model: str | None = None) -> list[Any]:
    rows = [[Cell(heading(row)), Cell(row["class"]), Cell(row["metric"]), named(board, row["model"]), cell(row["mean"]),
             interval(row["ci95_low"], row["ci95_high"]), Cell(str(row["n"]))]
            for row in rows_of(board.tables["per_class"]) if model in (None, row["model"])]
    if not rows:
        return [Note("There are no scores by class.")]
    return [Table("classes", "Means by class of shapes, with 95 % intervals; Avg is the mean over the competitors.",
                  ["Data set", "Class", "Metric", "Model", "Mean", "95 %", "n"], rows, [False] * 4 + [True] * 3, filters=[0, 1, 2])]


def history(board: Board) -> list[Any]:
    rows = [[Cell(heading(row)), Cell(row["metric"]), Cell(row["date"] or "–"), named(board, row["model"]),
             cell(row["mean"], bold=row["best"] == "yes")] for row in rows_of(board.tables["history"])]
    return [Table("history", "Submissions by date, then by file; in bold those that were the best of all until then.",
                  ["Data set", "Metric", "Date", "Model", "Mean"], rows, [False] * 4 + [True], filters=[0, 1])]


def submissions(board: Board, entries: list[Entry]) -> list[Any]:
    rows = [[Cell(entry.file.name), Cell(entry.card.name) if entry.refused else named(board, entry.card.name), Cell(entry.status),
             Cell(entry.refused or entry.remark)] for entry in entries]
    return [Table("submissions", "Submissions, and why some were refused.", ["File", "Model", "Status", "Reason or remark"], rows, [False] * 4)]


def card_rows(entry: Entry) -> dict[str, str]:
    card = entry.card
    rows = {"File": entry.file.name, "Date": card.date, "Citation": card.citation, "Licence": card.licence, "Training data": card.training_data,
            "Overlap with the test items": card.overlap, "Page": card.url, "Checked before by salbench": entry.program, "Remark": entry.remark}
    return {label: text for label, text in rows.items() if text}


def scores(board: Board, model: str) -> list[Any]:
    rows = [[Cell(heading(row)), Cell(row["metric"]), mean_cell(row), Cell("" if pandas.isna(row["rank"]) else str(row["rank"])),
             Cell(str(row["n"]))]
            for row in rows_of(pandas.concat([board.tables["compact"], board.beside])) if row["model"] == model]
    return [Table("scores", "Means with half of their 95 % intervals, and ranks.", ["Data set", "Metric", "Mean", "Rank", "n"], rows,
                  [False] * 2 + [True] * 3)]
