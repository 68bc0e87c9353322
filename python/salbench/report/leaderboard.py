# SPDX-License-Identifier: GPL-3.0-or-later
"""The pages of a leaderboard: scripts/report leaderboard SITE draws the tables that salbench leaderboard wrote to SITE/data.

Nothing is computed here, and nothing that a submission says is more than text.
"""

import csv
import itertools
import shutil
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from salbench.conclusions.csv_file import InputError
from salbench.conclusions.metrics import label_of
from salbench.pages import blocks
from salbench.pages.blocks import Block, Cell, Note, Table, cell, interval
from salbench.pages.names import DATASETS
from salbench.pages.rendering import SIMULATED, environment, is_ours
from salbench.report.pages import HERE
from salbench.report.results import Row

STATIC = ("report.css", "tables.js")
NAVIGATION = (("index.html", "Ranking"), ("metrics.html", "Metrics"), ("classes.html", "Classes"),
              ("history.html", "History"), ("submissions.html", "Submissions"))


def rows_of(path: Path) -> list[Row]:
    """Rows of a CSV file as the program writes it, below its remarks."""
    try:
        with open(path, encoding="utf-8", errors="replace", newline="") as file:
            return list(csv.DictReader(itertools.dropwhile(lambda line: line.startswith("#"), file)))
    except OSError as error:
        raise InputError(f"{path}: {error.strerror}; salbench leaderboard writes it") from None


def number(text: str) -> float:
    return float(text) if text else float("nan")


Part = tuple[str, str]


@dataclass
class Board:
    """The tables, by name, and the submissions that are ranked, by model."""
    site: Path

    def __post_init__(self) -> None:
        data = self.site / "data"
        self.submissions = rows_of(data / "submissions.csv")
        self.metrics = {row["metric"]: row for row in rows_of(data / "metrics.csv")}
        self.summary, self.ranking, self.compact, self.classes, self.history = (
            rows_of(data / f"{name}.csv") for name in ("summary", "ranking", "compact", "per_class", "history"))
        self.sentences = [row["sentence"] for row in rows_of(data / "leaders.csv") if not row["metric"]]
        self.protocol = (data / "protocol.yaml").read_text(encoding="utf-8")
        self.models = {row["model"]: row for row in self.submissions if row["status"] == "ranked"}
        self.ranks = {(part_of(row), row["metric"], row["model"]): row for row in self.ranking}

    @property
    def banners(self) -> list[str]:
        simulated = (self.site / "data/results.csv").read_text(encoding="utf-8").startswith("# SIMULATED")
        return [SIMULATED] if simulated else []

    def named(self, model: str) -> Cell:
        """A model in a table: a link where it was submitted."""
        return Cell(model, href=f"models/{model}.html" if model in self.models else "")


def part_of(row: Row) -> Part:
    return row["dataset"], row.get("split", "")


def heading(part: Part) -> str:
    dataset, split = part
    return DATASETS.get(dataset, dataset) + (f", split {split}" if split else "")


def parts_of(rows: list[Row]) -> list[Part]:
    return list(dict.fromkeys(part_of(row) for row in rows))


def mean_cell(row: Row, rank: Row | None) -> Cell:
    """Mean, half of its interval, and its group."""
    value = number(row["mean"])
    half = (number(row["ci95_high"]) - number(row["ci95_low"])) / 2
    below = (f"± {half:.3f}" if half == half else "") + (f", group {rank['group']}" if rank and rank["group"] else "")
    return cell(value, bold=rank is not None and rank["rank"] == "1", below=below.removeprefix(", "))


def ranking(board: Board) -> list[Block]:
    """A table per data set and split: models x metrics, the best by the first metric first, references last."""
    found: list[Block] = []
    for part in parts_of(board.compact):
        by_cell = {(row["model"], row["metric"]): row for row in board.compact if part_of(row) == part}
        metrics = [metric for metric in board.metrics if any(metric == of for _, of in by_cell)]
        rows = [[board.named(model), *(compact_cell(by_cell.get((model, metric))) for metric in metrics)]
                for model in dict.fromkeys(model for model, _ in by_cell)]
        caption = (f"{heading(part)}: mean ± half of its 95 % interval, or its ends where it was cut at the range of the metric; best in "
                   "bold. Models that share a letter are not shown to differ. Models without a letter are people or chance.")
        found.append(Table("ranking-" + "-".join(filter(None, part)), caption, ["Model", *map(label_of, metrics)], rows,
                            [False] + [True] * len(metrics), better=["", *(board.metrics[metric]["better"] for metric in metrics)]))
    return found or [Note("No submission could be ranked.", missing=True)]


def compact_cell(row: Row | None) -> Cell:
    return blocks.mean_cell(row and {**row, **{key: number(row[key]) for key in ("mean", "low", "high", "half", "best")}})


def by_metric(board: Board) -> list[Block]:
    rows = [[Cell(heading(part_of(row))), Cell(row["metric"]), board.named(row["model"]), cell(number(row["mean"])),
             Cell(row["rank"]), Cell(f"{row['rank_low']} to {row['rank_high']}" if row["rank_low"] else "–"),
             Cell(f"{100 * number(row['first']):.0f} %" if row["first"] else "–"),
             Cell(row["group"])] for row in board.ranking]
    heads = ["Data set", "Metric", "Model", "Mean", "Rank", "95 % of ranks", "Best in resamples", "Group"]
    return [Table("ranks", "Ranks with joint 95 % intervals, and in how many of the resamples a model has the best mean.",
                  heads, rows, [False] * 3 + [True] * 4 + [False], filters=[0, 1])]


def by_class(board: Board, model: str | None = None) -> list[Block]:
    rows = [[Cell(heading(part_of(row))), Cell(row["class"]), Cell(row["metric"]), board.named(row["model"]),
             cell(number(row["mean"])), interval(number(row["ci95_low"]), number(row["ci95_high"])), Cell(row["n"])]
            for row in board.classes if model in (None, row["model"])]
    if not rows:
        return [Note("The items have no classes.")]
    return [Table("classes", "Means by class of shapes, with 95 % intervals; Avg is the mean over the competitors.",
                  ["Data set", "Class", "Metric", "Model", "Mean", "95 %", "n"], rows, [False] * 4 + [True] * 3, filters=[0, 1, 2])]


def history(board: Board) -> list[Block]:
    rows = [[Cell(heading(part_of(row))), Cell(row["metric"]), Cell(row["date"] or "–"), board.named(row["model"]),
             cell(number(row["mean"]), bold=row["best"] == "yes")] for row in board.history]
    return [Table("history", "Submissions by date, then by file; in bold those that were the best of all until then.",
                  ["Data set", "Metric", "Date", "Model", "Mean"], rows, [False] * 4 + [True], filters=[0, 1])]


def submissions(board: Board) -> list[Block]:
    rows = [[Cell(row["file"]), board.named(row["model"]) if row["status"] == "ranked" else Cell(row["model"]),
             Cell(row["status"]), Cell(row["reason"] or row["remark"])] for row in board.submissions]
    return [Table("submissions", "Every submission, ranked or refused, and why.", ["File", "Model", "Status", "Reason or remark"], rows,
                  [False] * 4)]


def card_rows(row: Row) -> list[tuple[str, str]]:
    names = {"file": "File", "date": "Date", "citation": "Citation", "licence": "Licence", "training_data": "Training data",
             "test_overlap": "Overlap with the test items", "url": "Page", "program": "Checked before by salbench", "remark": "Remark"}
    return [(label, row[key]) for key, label in names.items() if row[key]]


def scores(board: Board, model: str) -> list[Block]:
    rows = [[Cell(heading(part_of(row))), Cell(row["metric"]), mean_cell(row, board.ranks.get((part_of(row), row["metric"], model))),
             Cell(board.ranks.get((part_of(row), row["metric"], model), {}).get("rank", "")), Cell(row["n"])]
            for row in board.summary if row["model"] == model]
    return [Table("scores", "Means with half of their 95 % intervals, and ranks.", ["Data set", "Metric", "Mean", "Rank", "n"], rows,
                  [False] * 2 + [True] * 3)]


def write_pages(site: Path) -> set[Path]:
    """The pages written, all below the site. Pages of models that are gone go."""
    board = Board(site)
    written = set()

    def write(path: str, template: str, **values: Any) -> None:
        root = "../" * path.count("/")
        text = environment(HERE).get_template(template).render(path=path, root=root, navigation=NAVIGATION, banners=board.banners, board=board,
                                                              **values)
        file = site / path
        file.parent.mkdir(exist_ok=True)
        file.write_text(text, encoding="utf-8")
        written.add(file)

    (site / "static").mkdir(exist_ok=True)
    for name in STATIC:
        shutil.copyfile(HERE / "static" / name, site / "static" / name)
    for path, title, blocks in (("metrics.html", "Metrics", by_metric(board)), ("classes.html", "Classes", by_class(board)),
                                ("history.html", "History", history(board)),
                                ("submissions.html", "Submissions", submissions(board))):
        write(path, "leaderboard.html", title=title, sections=[(title, blocks)], card=(), protocol="")
    for model, row in board.models.items():
        write(f"models/{model}.html", "leaderboard.html", title=model, card=card_rows(row), protocol="",
              sections=[("Scores", scores(board, model)), ("Classes", by_class(board, model))])
    for page in (site / "models").glob("*.html"):
        if page not in written and is_ours(page):
            page.unlink()
    refused = sum(row["status"] == "refused" for row in board.submissions)
    sections = [("Ranking", ranking(board))]
    if refused:
        sections.append(("Refused", submissions(board)))
    write("index.html", "leaderboard.html", title="Leaderboard", sections=sections, card=(), protocol=board.protocol)
    return written


def main(argv: Sequence[str]) -> int:
    if len(argv) != 1:
        print("usage: scripts/report leaderboard SITE", file=sys.stderr)
        return 2
    try:
        write_pages(Path(argv[0]))
    except (InputError, OSError) as error:
        print(f"scripts/report leaderboard: {error}", file=sys.stderr)
        return 2
    return 0
