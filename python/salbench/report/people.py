# SPDX-License-Identifier: GPL-3.0-or-later
"""People compared with models: the gain from more participants, the number of participants a model is worth,
its share of human performance, and the reliability of the ground truth."""

from salbench.pages.blocks import Block, Cell, Missing, Note, Table, attempt, cell, interval, signed
from salbench.pages.columns import Column, between, number, probability, sheet, text
from salbench.report import statistics
from salbench.report.results import Row
from salbench.report.tables import HUMAN
from salbench.report.units import MODEL, counted, metric_of, n_of
from salbench.report.report import Report

UNDECIDED, ABOVE = "undecided", "above HS"
SHARE = (
    "Of HS: which share of the way from chance to human performance the model goes, with its 95 % interval."
    f" “{UNDECIDED}”: the interval contains 1, and these data do not show whether the model is above or below"
    f" one participant; “{ABOVE}”: it lies beyond 1."
)


NO_NUMBER = "not a number of people"  # beginning of the remark if one participant is not worth one


def tables(report: Report) -> list[Block]:
    """Blocks below the human curve."""
    explained = [Note(HUMAN)] if report.results.has("human_curve") else []
    return (
        explained
        + attempt(reliability, report)
        + attempt(worth, report, "worth", list(report.results.leading))
        + attempt(more_participants, report, "more-participants", list(report.results.leading))
    )


def share_cell(row: Row | None) -> Cell:
    """Cell for a row of human_share.csv, or None."""
    if row is None:
        return cell(None)
    if row["share"] != row["share"]:
        missing = row["remark"].startswith("no scores")  # no HS on scans, since nobody was asked about them
        return cell(None, below="" if missing else row["remark"])
    low, high = row["ci95_low"], row["ci95_high"]
    if low != low or high != high:
        return cell(row["share"], 2, below=row["remark"])
    mark = ABOVE if low > 1 else UNDECIDED if high >= 1 else ""
    return cell(
        row["share"],
        2,
        bold=mark == ABOVE,
        below=", ".join(filter(None, [interval(low, high, 2).text, mark])),
    )


def reliability(report: Report) -> Note:
    table = report.results.table("human_reliability").dropna(subset=["mean"])
    if table.empty:
        raise Missing("human_reliability.csv is empty: reliability takes the metric cc and two participants.")
    row = table.iloc[0]
    people = " to ".join(
        dict.fromkeys(f"{row[name]:.0f}" for name in ("fewest_participants", "most_participants"))
    )
    spread = (
        f" (95 % interval {interval(row['ci95_low'], row['ci95_high'], 2).text})"
        if row["ci95_low"] == row["ci95_low"]
        else ""
    )
    return Note(
        f"Reliability of the ground truth of {people} participants: {row['mean']:.2f}{spread} over"
        f" {counted(report.results.unit, 'meshes', row['n'], row['n_shapes'])}, from two halves that"
        f" correlate by {row['split_half']:.2f} (Spearman and Brown).".replace("-", "−")
    )


WORTH = (
    "How many participants a model is worth: where the mean human curve first is as good as the model's mean"
    " on the same meshes, with 95 % intervals from resampled meshes. The curve scores participants against as"
    " many others, a model is scored against all: HS, one participant, should be at 1. Where it is not, no"
    " number is given: it would not be one of people."
)


def worth(report: Report, identifier: str, metrics: list[str]) -> Table:
    table = report.results.table("human_equivalents")
    rows = [
        row
        for metric in metrics
        for row in table[(table["metric"] == metric) & (table["model"] != "")].to_dict("records")
    ]
    if not rows:
        raise Missing("The run has no model to compare with the participants.")
    columns = [
        MODEL,
        metric_of(report.results),
        Column("Participants", worth_cell),
        text("95 % interval", between_people),
        n_of(report.results),
        number("Mean", "mean"),
        text("Remark", "remark"),
    ]
    return sheet(identifier, WORTH, columns, report.results.mine_first(rows), ["Metric"], 1)


def counts_people(row: Row) -> bool:
    return not row["remark"].startswith(NO_NUMBER)


def between_people(row: Row) -> str:
    ends = (
        [place(row[f"ci95_{end}"], row[f"{end}_bound"]) for end in ("low", "high")]
        if counts_people(row)
        else [""]
    )
    return " to ".join(dict.fromkeys(ends)) if all(ends) else "–"


def place(number: float, bound: str) -> str:
    """A position on the curve as text, such as "less than 1", or "" if unknown."""
    if number == number:
        return f"{number:.1f}"
    return bound.replace("<", "less than ").replace(">", "more than ")


def worth_cell(row: Row) -> Cell:
    people = place(row["k"], row["k_bound"])
    if not people or not counts_people(row):
        return cell(None)
    key = row["k"] if row["k"] == row["k"] else 0.0 if row["k_bound"].startswith("<") else float("1e9")
    several = f"the first of {row['crossings']:.0f} places" if row["crossings"] > 1 else ""
    return Cell(people, key, below=several)


def more_participants(report: Report, identifier: str, metrics: list[str]) -> Table:
    has_any = report.results.has("human_curve_differences")
    rows = (
        statistics.one_more(report.results, metrics).assign(dataset="meshes").to_dict("records")
        if has_any
        else []
    )
    if not rows:
        raise Missing("What one more participant adds takes meshes with four of them.")
    columns = [
        number("From", "from_participants", 0),
        number("To", "to_participants", 0),
        metric_of(report.results),
        n_of(report.results),
        Column("Mean difference", lambda row: signed(row["mean_difference"])),
        between("95 % interval", "ci95_low", "ci95_high"),
        probability("p", "t_p"),
    ]
    return sheet(
        identifier,
        (
            "What one more participant adds: differences within a mesh, with their paired 95 % interval and p"
            " (Student). human_curve_differences.csv has every number of participants beside every larger"
            " one."
        ),
        columns,
        rows,
        ["Metric"],
        1,
    )
