# SPDX-License-Identifier: GPL-3.0-or-later
"""The pages of a leaderboard, except parts about single models, which are in model_page.py. Computes nothing,
and treats content of submissions as text: templates escape it."""

import re
import shutil
from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from operator import itemgetter
from pathlib import Path
from typing import Any

import pandas

from salbench._core import models_about
from salbench.conclusions import glossary, published, tables, words
from salbench.conclusions.floors import role
from salbench.conclusions.metrics import Metric, label_of, leading_metrics, of_program
from salbench.conclusions.ranked import cut
from salbench.leaderboard import model_page
from salbench.leaderboard.board import Board, is_of
from salbench.leaderboard.entry import Entry, HERE as MEASURED_HERE
from salbench.pages.blocks import Cell, Fact, Facts, Fold, Note, cell, interval, mean_cell
from salbench.pages.columns import Column, number, sheet, text
from salbench.pages.dots import AXIS, Drawn, behind, drawn
from salbench.pages.looks import looks_of
from salbench.pages.names import DATASETS
from salbench.pages.rendering import SIMULATED, HERE as SHARED, environment
from salbench.pages.reported import apart, value

HERE = Path(__file__).parent
NAVIGATION = (
    ("index.html", "Ranking"),
    ("metrics.html", "Metrics"),
    ("classes.html", "Classes"),
    ("submissions.html", "Submissions"),
)
Row = dict[str, Any]
Level = tuple[str, str, str]  # data set, split, metric


def write_pages(board: Board, site: Path) -> None:
    # models of the program
    own = [model for model in board.tables["compact"]["model"].unique() if model not in board.shown]
    metrics = list(board.tables["metrics"]["metric"])
    template = environment(HERE, glossary.titles(own, metrics)).get_template("leaderboard.html")
    banners = [
        SIMULATED if remark.startswith("SIMULATED") else remark for remark in tables.of_truth(board.remarks)
    ]

    def write(path: str, title: str, sections: Sequence[tuple[str, list[Any]]], **values: Any) -> None:
        text = template.render(
            path=path,
            root="../" * path.count("/"),
            navigation=NAVIGATION,
            banners=banners,
            board=board,
            title=title,
            sections=sections,
            **{"protocol": "", **values},
        )
        (site / path).parent.mkdir(exist_ok=True)
        (site / path).write_bytes(text.encode("utf-8", "replace"))

    (site / "static").mkdir()
    for name in ("report.css", "tables.js"):
        shutil.copyfile(SHARED / "static" / name, site / "static" / name)
    (site / "data").mkdir(exist_ok=True)
    for path, title, blocks in (
        ("metrics.html", "Metrics", by_metric(board)),
        ("classes.html", "Classes", by_class(board)),
        ("submissions.html", "Submissions", submissions(board, board.entries)),
    ):
        write(path, title, [(title, blocks)])
    for model, entry in board.shown.items():
        write(f"models/{model}.html", model, of_model(board, entry))
    sections = [("Ranking", ranking(board))]
    if board.refused:
        sections.append(("Refused", submissions(board, board.refused)))
    sections += [
        ("What the letters mean", letters(own, metrics)),
        ("What the ranking is of", [Facts([Fact(label, text) for label, text in board.facts.items()])]),
    ]
    write("index.html", "Leaderboard", sections, protocol=board.protocol, briefs=briefs(board))


def of_model(board: Board, entry: Entry) -> list[tuple[str, list[Any]]]:
    """Sections of a model's page."""
    model = entry.card.name
    trainings = model_page.trainings(board, model, [METRIC, DATA_SET])
    return [
        ("Scores", [Note(f"Scores: {entry.measured}."), *scores(board, model)]),
        *([("Trainings", trainings)] if trainings else []),
        ("Card", model_page.card(entry)),
        ("What a map costs", model_page.cost(entry)),
        ("Classes", by_class(board, model)),
    ]


def briefs(board: Board) -> list[str]:
    """Short sentence on who leads, or why nobody does, for each data set and split."""
    found = []
    for level in board.leaders:
        ranked, leaders = (
            frame[is_of(frame, level)] for frame in (board.tables["ranking"], board.tables["leaders"])
        )
        known = {row["metric"]: row for row in rows_of(leaders) if row["metric"]}
        said = [
            words.brief_of(known[name], label_of(name), list(ranked.loc[ranked["metric"] == name, "model"]))
            for name in leading_metrics(known, board.study.chief)
        ]
        found.append(
            f"{DATASETS[level.dataset]}{level.of_split}: {words.brief(said)}" if said else level.sentence
        )
    return found


def letters(models: Sequence[str], metrics: Sequence[str]) -> list[Any]:
    known = [(name, models_about[name]) for name in models if name in models_about]
    rows = [(name, about.name, about.source) for name, about in known]
    rows += [
        (label_of(name), glossary.compares(name), f"{glossary.range_of(name)}, {glossary.better(name)}")
        for name in metrics
    ]
    columns = [
        text(head, itemgetter(at)) for at, head in enumerate(("Letters", "Meaning", "Source, or range"))
    ]
    return [sheet("letters", "Models of the program, and metrics.", columns, rows)]


def heading(row: Row) -> str:
    return DATASETS[row["dataset"]] + words.of_split(row.get("split", ""), "split" in row)


def named(board: Board, model: str) -> Cell:
    """A model in a table, with a link if submitted, and remarks."""
    entry = board.shown.get(model)
    if entry is None:
        return Cell(model, after=role(model))
    n = len(entry.seen)
    seen = (
        f"beside: {entry.beside}"
        if entry.beside
        else f"it has seen {n} item{'s' * (n > 1)}, left out for all"
        if n
        else ""
    )
    return Cell(model, href=f"models/{model}.html", below="; ".join(filter(None, (seen, entry.remark))))


def ranking(board: Board) -> list[Any]:
    """Tables of models x metrics, one per data set and split: ranked by the leading metric, then references,
    then models beside the ranking. Papers' numbers over the same shapes are in grey below the means; a
    separate table has the other reported numbers."""
    frame = pandas.concat([board.tables["compact"], board.beside], ignore_index=True)
    splits = frame["split"] if "split" in frame else frame["dataset"].map(lambda name: "")
    drawings, blocks = drawings_of(board), list[Any]()
    for dataset, split in dict.fromkeys(zip(frame["dataset"], splits)):
        part = frame[(frame["dataset"] == dataset) & (splits == split)]
        part = part.iloc[(part["metric"] != board.study.chief).argsort(kind="stable")]
        by_cell = {(row["model"], row["metric"]): row for row in rows_of(part)}
        better = dict(zip(part["metric"], part["better"]))
        first, title = next(iter(better)), DATASETS[dataset] + words.of_split(
            split, splits[frame["dataset"] == dataset].any()
        )
        columns = [
            Column("Model", partial(named, board), numeric=False),
            Column(f"{label_of(first)} rank", partial(rank_of, by_cell, first)),
        ]
        same, others = of_papers(board, dataset, split, by_cell)
        for metric, direction in better.items():
            of = drawings.get((dataset, split, metric), {})
            columns.append(
                Column(
                    label_of(metric),
                    partial(mean_of, by_cell, same, metric, of),
                    better=direction,
                    foot=Cell("", drawn=of.get(AXIS)),
                )
            )
        known = [Column(head, partial(show, board), numeric=False) for head, show in KNOWN]
        menus = [
            column.head
            for column in known
            if column.head in MENUS and len({column.show(model).text for model in part["model"].unique()}) > 1
        ]
        caption = f"{title}: means with half of their 95 % intervals; below, the distance from the best."
        identifier = re.sub(r"\W+", "-", title)
        made = sheet(f"ranking-{identifier}", caption, [*columns, *known], part["model"].unique(), menus)
        blocks += [made, Fold("How to read it", [Note(READING.format(label_of(first)))])]
        if others:
            blocks.append(apart(f"reported-{identifier}", others))
    return blocks or [Note("No submission could be ranked.", missing=True)]


READING = (
    "Ranks, by {}, and letters are those among all models, whatever the menus leave in sight. Models that"
    " share a letter cannot be told apart; those without one are people, chance, a constant map, or stand"
    " beside the ranking. A mean has half of its 95 % interval, or its ends where it was cut at the range of"
    " the metric; the best is bold. Drawn is the distance from the best mean with its 95 % interval, joint"
    " for all pairs of models: one that leaves out 0 shows that the model is behind. Filled: may be the best."
    " A baseline uses nothing that a model deserves credit for."
)


def rank_cell(row: Row) -> Cell:
    return Cell("" if pandas.isna(row["rank"]) else str(row["rank"]))


def rank_of(by_cell: Mapping[tuple[str, str], Row], metric: str, model: str) -> Cell:
    row = by_cell.get((model, metric))
    return (
        Cell("–", "") if row is None or pandas.isna(row["rank"]) else Cell(str(row["rank"]), int(row["rank"]))
    )


def mean_of(
    by_cell: Mapping[tuple[str, str], Row],
    same: Mapping[tuple[str, str], str],
    metric: str,
    drawings: Mapping[str, Drawn],
    model: str,
) -> Cell:
    return replace(
        mean_cell(by_cell.get((model, metric))),
        drawn=drawings.get(model),
        below=same.get((model, metric), ""),
    )


def of_papers(
    board: Board, dataset: str, split: str, by_cell: Mapping[tuple[str, str], Row]
) -> tuple[dict[tuple[str, str], str], list[Row]]:
    """Numbers from papers for metrics of the table: means over the same shapes, by model and metric, in
    words; and all other rows."""
    same, others, metrics = dict[tuple[str, str], str](), list[Row](), {metric for _, metric in by_cell}
    for row in published.beside(board.study, dataset, split):
        ours = by_cell.get((row["model"], row["metric"]))
        agrees = published.verdict(ours["mean"], ours["n_shapes"], row) if ours else published.OTHERS
        if agrees != published.OTHERS:
            shown = value(row)
            said = f"{shown.text} {shown.after}".rstrip()
            same[
                row["model"], row["metric"]
            ] = f"reported {said} ({row['source']}): {'outside' if agrees == published.NO else agrees}"
        elif row["metric"] in metrics:
            others.append(row)
    return same, others


def measured(board: Board, model: str) -> Cell:
    entry = board.shown.get(model)
    return Cell(entry.measured if entry else MEASURED_HERE)


def weights(board: Board, model: str) -> Cell:
    """Cell on a model's weights; those of the program's models are open."""
    card = entry.card if (entry := board.shown.get(model)) else None
    return Cell(
        "yes" if card is None or card.has_open_weights else "no" if card.weights else "not said",
        below="it has none" if card is not None and card.weights == "none" else "",
    )


def trained_here(board: Board, model: str) -> Cell:
    entry = board.shown.get(model)
    what = entry.trained_here if entry else board.learned.get(model, "")
    return Cell("yes" if what else "no", below=what)


# per model, for any metric
KNOWN = (("Open weights", weights), ("Trained on this set", trained_here), ("How it came about", measured))
MENUS = ("Open weights", "Trained on this set")  # if models differ in it


DATA_SET, METRIC = text("Data set", heading), text("Metric", lambda row: label_of(row["metric"]))
N = Column("n", lambda row: Cell(str(row["n"])))
OF_A_METRIC = ("Data set", "Metric")  # menus with one selected value each


def model_of(board: Board) -> Column:
    return Column("Model", lambda row: named(board, row["model"]), numeric=False)


def rows_of(frame: pandas.DataFrame) -> list[Row]:
    rows: list[Row] = frame.to_dict("records")
    return rows


def level_of(row: Row) -> Level:
    return row["dataset"], row.get("split", ""), row["metric"]


def lower_is_better(board: Board) -> set[str]:
    metrics = board.tables["metrics"]
    return set(metrics.loc[metrics["better"] == "lower", "metric"])


def drawings_of(board: Board) -> dict[Level, dict[str, Drawn]]:
    """Distances of the ranked models of each level from the best, drawn as in the report."""
    of_level: dict[str, dict[Level, list[Row]]] = {
        name: defaultdict(list) for name in ("ranking", "significance", "compact")
    }
    for name, rows in of_level.items():
        for row in rows_of(board.tables[name]):
            rows[level_of(row)].append(row)
    first = {
        (level.dataset, level.split, leader.metric.name): leader.models
        for level in board.leaders
        for leader in level.leaders
    }
    lower = lower_is_better(board)
    found = {
        level: behind(rows, of_level["significance"][level], of_level["compact"][level], level[2] in lower)
        for level, rows in of_level["ranking"].items()
    }
    looks = looks_of(sorted({one.model for models in found.values() for one in models}))
    return {level: drawn(models, first.get(level, ()), looks) for level, models in found.items() if models}


def by_metric(board: Board) -> list[Any]:
    drawings, lower = drawings_of(board), lower_is_better(board)

    def drawing(row: Row) -> Drawn | None:
        return drawings.get(level_of(row), {}).get(row["model"])

    def model(row: Row) -> Cell:
        found = drawing(row)
        return replace(
            named(board, row["model"]),
            badge=("may be best", "holds") if found and found.dot and found.dot.first else ("", ""),
        )

    def from_best(row: Row) -> Cell:
        """Mean minus the best one, with its interval, for either direction of the metric."""
        found = drawing(row)
        if found is None or found.dot is None or found.dot.behind.distance == 0:
            return cell(None)
        one, sign = found.dot.behind, -1 if row["metric"] in lower else 1
        low, high = sorted((sign * one.low, sign * one.high))
        return cell(sign * one.distance, below=interval(low, high).text, drawn=found)

    columns = [
        Column("Model", model, numeric=False),
        DATA_SET,
        METRIC,
        number("Mean", "mean"),
        Column("From the best", from_best),
        Column("Rank", rank_cell),
        Column(
            "95 % of ranks",
            lambda row: Cell("" if pandas.isna(row["rank"]) else f"{row['rank_low']} to {row['rank_high']}"),
        ),
        number("Share first", "first", 2),
        text("Group", "group"),
    ]
    caption = (
        "“May be best”: no model is shown to be better. From the best: difference from the best mean, with"
        " its 95 % interval, and drawn with 0 and the best at the right; it and those of ranks are joint for"
        " all pairs of models. Share first: of the resamples."
    )
    return [sheet("ranks", caption, columns, rows_of(board.tables["ranking"]), OF_A_METRIC, 2)]


def by_class(board: Board, model: str | None = None) -> list[Any]:
    rows = [row for row in rows_of(board.tables["per_class"]) if model in (None, row["model"])]
    if not rows:
        return [Note("There are no scores by class.")]
    columns = [
        text("Class", "class"),
        DATA_SET,
        METRIC,
        model_of(board),
        number("Mean", "mean"),
        Column("95 %", within_range),
        N,
    ]
    return [
        sheet(
            "classes",
            "Means by class of shapes, with 95 % intervals; Avg is the mean over the competitors.",
            columns,
            rows,
            (*OF_A_METRIC, "Class", "Model"),
            2,
        )
    ]


def within_range(row: Row) -> Cell:
    low, high = cut(
        row["ci95_low"], row["mean"], row["ci95_high"], of_program().get(row["metric"], Metric(row["metric"]))
    )
    return interval(float(low), float(high))


def submissions(board: Board, entries: list[Entry]) -> list[Any]:
    def model(entry: Entry) -> Cell:
        return Cell(entry.card.name) if entry.refused else named(board, entry.card.name)

    columns = [
        text("File", lambda entry: entry.name),
        Column("Model", model, numeric=False),
        text("Status", lambda entry: entry.status),
        text(
            "Reason or remark",
            lambda entry: "; ".join(filter(None, (entry.refused or entry.beside, entry.remark))),
        ),
    ]
    return [sheet("submissions", "Submissions, and why some were refused.", columns, entries)]


def scores(board: Board, model: str) -> list[Any]:
    rows = [
        row
        for row in rows_of(pandas.concat([board.tables["compact"], board.beside]))
        if row["model"] == model
    ]
    columns = [METRIC, DATA_SET, Column("Mean", mean_cell), Column("Rank", rank_cell), N]
    return [sheet("scores", "Means with half of their 95 % intervals, and ranks.", columns, rows)]
