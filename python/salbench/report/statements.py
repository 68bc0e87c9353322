# SPDX-License-Identifier: GPL-3.0-or-later
"""What the paper says of significance, beside the authors' own scores: configs/paper/statements.csv, whatever the run."""

from salbench.pages.blocks import Block, Cell, Fold, Note, interval, p_value
from salbench.pages.columns import Column, sheet, text
from salbench.pages.names import DATASETS, spoken
from salbench.report import paper
from salbench.report.claims import STYLES
from salbench.report.results import Row
from salbench.report.workshop import Workshop

CAPTION = ("Statements of the paper's text about significance or an order of scores, pair by pair, beside the scores that its authors "
           "published. By shapes: the paper's rank-sum test at 0.05, which takes every scan for a shape of its own. By meshes: the "
           "mean difference with its paired 95 % interval, one observation per mesh; p: its signed-rank test, corrected for all pairs of "
           "the metric. By classes: the same over the means of the 20 classes, for what is said of kinds of shapes. That two do not "
           "differ takes a margin, which is our choice. These figures are not of this run; scripts/figures statements makes them.")
KINDS = {"by_meshes": "meshes", "by_classes": "classes"}


def table(shop: Workshop) -> list[Block]:
    rows = paper.read("statements.csv").to_dict("records")
    columns = [text("Pair", lambda row: f"{row['model_a']} − {row['model_b']}"), verdict("By meshes", "by_meshes"), verdict("By classes", "by_classes"),
               verdict("By shapes", "by_shapes"), text("Data set", lambda row: DATASETS[row["dataset"]]),
               text("Metric", lambda row: row["metric"].upper()), text("Its word", "word"), text("The paper", "claim"),
               Column("Difference", lambda row: Cell(row["mean_difference"].replace("-", "−"), number(row["mean_difference"]))),
               between("95 % interval", "ci95"), Column("p", lambda row: p_value(number(row["signed_rank_p_holm"]))),
               between("Classes: 95 % interval", "class_ci95"), Column("Rank-sum p", lambda row: p_value(number(row["rank_sum_p"]))),
               text("Section", "section")]
    pairs = sheet("paper-statements", CAPTION, columns, rows, ["By meshes", "By classes", "Data set", "Metric"])
    return [Note(said(rows)), Fold("Every statement, pair by pair", [pairs])]


def said(rows: list[Row]) -> str:
    """How many pairs hold by which unit, and which do not."""
    counts = [f"{sum(row['by_shapes'] == 'holds' for row in rows)} follow from the paper's test over shapes"]
    counts += [f"{sum(row[column] == 'holds' for row in rows)} hold with {unit} as observations" for column, unit in KINDS.items()]
    n = max((number(row["n"]) for row in rows), default=0)
    text = (f"The paper's text says of {len(rows)} pairs which differ. On the scores that its authors published (up to {n:.0f} meshes), "
            f"{', '.join(counts)}.")
    for column, unit in KINDS.items():
        for verdict_, words in (("does not hold", "does not hold"), ("undecided", "is undecided")):
            pairs = dict.fromkeys(f"{row['model_a']} and {row['model_b']} by {row['metric'].upper()} on {spoken(row['dataset'])}"
                                  for row in rows if row[column] == verdict_)
            if pairs:
                text += f" By {unit}, what it says of {'; '.join(pairs)} {words}."
    return text


def number(text: str) -> float:
    return float(text or "nan")


def verdict(head: str, name: str) -> Column:
    return Column(head, lambda row: Cell(row[name] or "–", style=STYLES.get(row[name], "")), numeric=False)


def between(head: str, name: str) -> Column:
    return Column(head, lambda row: interval(number(row[f"{name}_low"]), number(row[f"{name}_high"])))
