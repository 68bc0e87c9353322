# SPDX-License-Identifier: GPL-3.0-or-later
"""The pages of a leaderboard. Nothing is computed here, and nothing that a submission says is more than text: templates escape it."""

import re
import shutil
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from operator import itemgetter
from pathlib import Path
from typing import Any

import pandas

from salbench.conclusions import glossary, published, tables, words
from salbench.conclusions.ranked import cut
from salbench.conclusions.floors import role
from salbench.conclusions.metrics import Metric, label_of, leading_metrics, of_program
from salbench.conclusions.significance import joint_interval
from salbench.leaderboard.board import Board, Entry
from salbench.leaderboard.card import is_web
from salbench.pages.blocks import Cell, Note, cell, interval, mean_cell
from salbench.pages.columns import Column, number, sheet, text
from salbench.pages.names import DATASETS
from salbench.pages.rendering import HERE as SHARED
from salbench.pages.rendering import SIMULATED, environment
from salbench.pages.reported import add_below

HERE = Path(__file__).parent
NAVIGATION = (("index.html", "Ranking"), ("metrics.html", "Metrics"), ("classes.html", "Classes"),
              ("history.html", "History"), ("submissions.html", "Submissions"))
Row = dict[str, Any]


def write_pages(board: Board, site: Path) -> None:
    own, metrics = models_of_the_program(board), list(board.tables["metrics"]["metric"])
    template = environment(HERE, glossary.titles(own, metrics)).get_template("leaderboard.html")
    banners = [SIMULATED if remark.startswith("SIMULATED") else remark for remark in tables.of_truth(board.remarks)]

    def write(path: str, title: str, sections: Sequence[tuple[str, list[Any]]], **values: Any) -> None:
        text = template.render(path=path, root="../" * path.count("/"), navigation=NAVIGATION, banners=banners, board=board, title=title, web=is_web,
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
    sections.append(("What the letters mean", letters(own, metrics)))
    write("index.html", "Leaderboard", sections, facts=board.facts, protocol=board.protocol, briefs=briefs(board))


def models_of_the_program(board: Board) -> list[str]:
    submitted = {entry.card.name for entry in board.of_status("ranked", "beside")}
    return [model for model in board.tables["compact"]["model"].unique() if model not in submitted]


def briefs(board: Board) -> list[str]:
    """Who leads on each data set and split, without figures; why nobody does, where that is so."""
    found = []
    for level in board.leaders:
        rows = board.tables["ranking"]
        rows = rows[(rows["dataset"] == level.dataset) & ((rows["split"] == level.split) if "split" in rows else True)]
        known = {leader.metric.name: leader for leader in level.leaders}
        said = [words.brief_of(known[name], label_of(name), list(rows.loc[rows["metric"] == name, "model"])) for name in leading_metrics(known)]
        found.append(f"{heading({'dataset': level.dataset, 'split': level.split})}: {words.brief(said)}" if said else level.sentence)
    return found


def letters(models: Sequence[str], metrics: Sequence[str]) -> list[Any]:
    known = [(name, glossary.MODELS[name]) for name in models if name in glossary.MODELS]
    rows = [(name, model.name, model.source) for name, model in known]
    rows += [(label_of(name), glossary.compares(name), f"{glossary.range_of(name)}, {glossary.better(name)}") for name in metrics]
    columns = [text(head, itemgetter(at)) for at, head in enumerate(("Letters", "Meaning", "Source, or range"))]
    return [sheet("letters", "Models of the program, and metrics.", columns, rows)]


def heading(row: Row) -> str:
    return DATASETS[row["dataset"]] + (f", split {row['split']}" if row.get("split") else "")


def named(board: Board, model: str) -> Cell:
    """A model in a table: a link where it was submitted, and what there is to say of it."""
    entry = next((entry for entry in board.of_status("ranked", "beside") if entry.card.name == model), None)
    if entry is None:
        return Cell(model, after=role(model))
    n = len(entry.seen)
    seen = f"beside: {entry.beside}" if entry.beside else f"it has seen {n} item{'s' * (n > 1)}, left out for all" if n else ""
    said = [seen, entry.remark]
    return Cell(model, href=f"models/{model}.html", below="; ".join(filter(None, said)))


def rows_of(frame: pandas.DataFrame) -> list[Row]:
    rows: list[Row] = frame.to_dict("records")
    return rows


def ranking(board: Board) -> list[Any]:
    """A table per data set and split: models x metrics, the best by the first metric first, then references, then those that stand beside; in grey
    below all what papers report."""
    frame = pandas.concat([board.tables["compact"], board.beside], ignore_index=True)
    splits = frame["split"] if "split" in frame else frame["dataset"].map(lambda name: "")
    blocks: list[Any] = []
    for dataset, split in dict.fromkeys(zip(frame["dataset"], splits)):
        part = frame[(frame["dataset"] == dataset) & (splits == split)]
        by_cell = {(row["model"], row["metric"]): row for row in rows_of(part)}
        better = dict(zip(part["metric"], part["better"]))
        columns = [Column("Model", partial(named, board), numeric=False)]
        columns += [Column(label_of(metric), partial(mean_of, by_cell, metric), better=direction) for metric, direction in better.items()]
        caption = (f"{heading(next(iter(by_cell.values())))}: mean ± half of its 95 % interval, or its ends where it was cut at the range of the metric; best in bold. Models "
                   "that share a letter cannot be told apart. Models without a letter are people, chance, a constant map, or stand beside the ranking. "
                   "A floor uses nothing that a model should be praised for.")
        identifier = "ranking-" + re.sub(r"\W+", "-", heading(next(iter(by_cell.values()))))
        made = sheet(identifier, caption, columns, part["model"].unique())
        add_below(made, published.beside(board.study, dataset, split), list(better))
        blocks.append(made)
    return blocks or [Note("No submission could be ranked.", missing=True)]


def mean_of(by_cell: Mapping[tuple[str, str], Row], metric: str, model: str) -> Cell:
    return mean_cell(by_cell.get((model, metric)))


DATA_SET, METRIC = text("Data set", heading), text("Metric", lambda row: label_of(row["metric"]))
OF_A_METRIC = ("Data set", "Metric")  # menus of which one value each is shown


def model_of(board: Board) -> Column:
    return Column("Model", lambda row: named(board, row["model"]), numeric=False)


def by_metric(board: Board) -> list[Any]:
    first = {(level.dataset, level.split, leader.metric.name): leader.models for level in board.leaders for leader in level.leaders}
    pairs: Mapping[tuple[str, ...], Row] = {(*level_of(row), row["model_a"], row["model_b"]): row for row in rows_of(board.tables["significance"])}
    rows = rows_of(board.tables["ranking"])
    best: dict[tuple[str, str, str], str] = {}
    for row in rows:
        best.setdefault(level_of(row), row["model"])

    def model(row: Row) -> Cell:
        may_be_best = row["model"] in first.get(level_of(row), ())
        return replace(named(board, row["model"]), badge=("may be best", "holds") if may_be_best else ("", ""))
    columns = [Column("Model", model, numeric=False), DATA_SET, METRIC, number("Mean", "mean"),
               Column("From the best", lambda row: behind(pairs, level_of(row), best[level_of(row)], row["model"])),
               Column("Rank", lambda row: Cell(str(row["rank"]))), Column("95 % of ranks", lambda row: Cell(f"{row['rank_low']} to {row['rank_high']}")),
               number("Share first", "first", 2), text("Group", "group")]
    caption = ("“May be best”: no model is shown to be better. From the best: difference from the best mean, with its 95 % interval; it and "
               "those of ranks are joint for all pairs of models. Share first: of the resamples.")
    return [sheet("ranks", caption, columns, rows, OF_A_METRIC, 2)]


def level_of(row: Row) -> tuple[str, str, str]:
    return row["dataset"], row.get("split", ""), row["metric"]


def behind(pairs: Mapping[tuple[str, ...], Row], key: tuple[str, str, str], best: str, model: str) -> Cell:
    """The difference of a model from the one with the best mean."""
    sign, row = (1, pairs[*key, model, best]) if (*key, model, best) in pairs else (-1, pairs.get((*key, best, model)))
    if row is None:
        return cell(None)
    low, high = joint_interval(sign * row["mean_difference"], sign * row["t"], row["t_bound"])
    return cell(sign * row["mean_difference"], below=interval(low, high).text)


def by_class(board: Board, model: str | None = None) -> list[Any]:
    rows = [row for row in rows_of(board.tables["per_class"]) if model in (None, row["model"])]
    if not rows:
        return [Note("There are no scores by class.")]
    columns = [text("Class", "class"), DATA_SET, METRIC, model_of(board), number("Mean", "mean"), Column("95 %", within_range),
               Column("n", lambda row: Cell(str(row["n"])))]
    return [sheet("classes", "Means by class of shapes, with 95 % intervals; Avg is the mean over the competitors.", columns, rows,
                  (*OF_A_METRIC, "Class", "Model"), 2)]


def within_range(row: Row) -> Cell:
    low, high = cut(row["ci95_low"], row["mean"], row["ci95_high"], of_program().get(row["metric"], Metric(row["metric"])))
    return interval(float(low), float(high))


def history(board: Board) -> list[Any]:
    columns = [model_of(board), DATA_SET, METRIC, text("Date", lambda row: row["date"] or "–"),
               Column("Mean", lambda row: cell(row["mean"], bold=row["best"] == "yes"))]
    return [sheet("history", "Submissions by date, then by file; in bold those that were the best of all until then.", columns,
                  rows_of(board.tables["history"]), OF_A_METRIC, 2)]


def submissions(board: Board, entries: list[Entry]) -> list[Any]:
    def model(entry: Entry) -> Cell:
        return Cell(entry.card.name) if entry.refused else named(board, entry.card.name)
    columns = [text("File", lambda entry: entry.name), Column("Model", model, numeric=False), text("Status", lambda entry: entry.status),
               text("Reason or remark", lambda entry: "; ".join(filter(None, (entry.refused or entry.beside, entry.remark))))]
    return [sheet("submissions", "Submissions, and why some were refused.", columns, entries)]


def card_rows(entry: Entry) -> dict[str, str]:
    card = entry.card
    rows = {"File": entry.name, "Date": card.date, "Citation": card.citation, "Licence": card.licence, "Training data": card.training_data,
            "Trained on": ", ".join(card.trained_on), "Overlap with the test items": card.overlap, "Page": card.url, "Written by, as it says": f"salbench {entry.program}" if entry.program else "", "Remark": entry.remark}
    return {label: text for label, text in rows.items() if text}


def scores(board: Board, model: str) -> list[Any]:
    rows = [row for row in rows_of(pandas.concat([board.tables["compact"], board.beside])) if row["model"] == model]
    columns = [METRIC, DATA_SET, Column("Mean", mean_cell), Column("Rank", lambda row: Cell("" if pandas.isna(row["rank"]) else str(row["rank"]))),
               Column("n", lambda row: Cell(str(row["n"])))]
    return [sheet("scores", "Means with half of their 95 % intervals, and ranks.", columns, rows)]
