# SPDX-License-Identifier: GPL-3.0-or-later
"""What the paper says of significance, beside the authors' own scores: configs/paper/statements.csv, whatever the run."""

from salbench.pages.blocks import Block, Cell, Fold, Note, Table, interval, p_value
from salbench.pages.names import DATASETS, spoken
from salbench.report import paper
from salbench.report.claims import STYLES
from salbench.report.results import Row
from salbench.report.workshop import Workshop

CAPTION = ("Statements of the paper's text about significance or an order of scores, pair by pair, beside the scores that its authors "
           "published. By shapes: the paper's rank-sum test at 0.05, which takes every scan for a shape of its own. By meshes: the "
           "mean difference with its paired 95 % interval, one observation per mesh; p: its signed-rank test, corrected for all pairs of "
           "the metric. By classes: the same over the means of the 20 classes, for what is said of kinds of shapes. That two do not "
           "differ takes a margin, which is our choice. These figures are not of this run; scripts/paper_statements makes them.")
HEADS = ["Pair", "By meshes", "By classes", "By shapes", "Data set", "Metric", "Its word", "The paper", "Difference", "95 % interval", "p",
         "Classes: 95 % interval", "Rank-sum p", "Section"]
KINDS = {"by_meshes": "meshes", "by_classes": "classes"}


def table(shop: Workshop) -> list[Block]:
    rows = paper.read("statements.csv").to_dict("records")
    made = [[Cell(f"{row['model_a']} − {row['model_b']}"), verdict(row["by_meshes"]), verdict(row["by_classes"]), verdict(row["by_shapes"]),
             Cell(DATASETS[row["dataset"]]), Cell(row["metric"].upper()), Cell(row["word"]), Cell(row["claim"]),
             Cell(row["mean_difference"].replace("-", "−"), number(row["mean_difference"])),
             interval(number(row["ci95_low"]), number(row["ci95_high"])), p_value(number(row["signed_rank_p_holm"])),
             interval(number(row["class_ci95_low"]), number(row["class_ci95_high"])), p_value(number(row["rank_sum_p"])),
             Cell(row["section"])] for row in rows]
    pairs = Table("paper-statements", CAPTION, HEADS, made, [False] * 8 + [True] * 5 + [False], filters=[1, 2, 4, 5])
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


def verdict(text: str) -> Cell:
    return Cell(text or "–", style=STYLES.get(text, ""))
