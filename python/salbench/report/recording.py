# SPDX-License-Identifier: GPL-3.0-or-later
"""Recordings of gaze behind the ground truth: the use of each person's samples, and the agreement between
people."""

import re
from collections.abc import Iterable

from salbench.pages.blocks import Block, Cell, Missing, Note, Table, attempt, cell
from salbench.pages.columns import Column, counted, number, sheet, text
from salbench.report import people
from salbench.report.results import Frame, Row, number_of
from salbench.report.report import Report

COUNTS = ("samples", "lost", "fixations", "hits", "snapped", "missed", "seconds", "tracked")
CAPTION = (
    "Lost: samples without an eye or a place. Missed: fixations that are on no part of the shape, nor near"
    " enough to its outline to be snapped to it. People whose share of either stands out are worth a look"
    " before anything is concluded."
)
REMARKS = (
    "Remarks of run.yaml on these shapes: what is unusual about them, whose recording could not be used, who"
    " is left out."
)
NOBODY = "on no shape"
NUMBER = re.compile(r"\d\S*")  # of a reason


def share(part: str, whole: str) -> Column:
    """Column in percent of the whole, with the count below."""

    def show(row: Row) -> Cell:
        below = f"{row[part]:.0f}" if row[part] == row[part] else ""
        return cell(100 * row[part] / row[whole] if row[whole] else None, 1, below=below)

    return Column(f"{part.capitalize()} %", show)


def columns(first: Column) -> list[Column]:
    return [
        first,
        counted("Samples", "samples"),
        share("lost", "samples"),
        number("Seconds tracked", "tracked", 1),
        counted("Fixations", "fixations"),
        share("missed", "fixations"),
        counted("Snapped", "snapped"),
        number("Seconds on shapes", "seconds", 1),
    ]


def reasons(left_out: Iterable[str]) -> str:
    """Reasons for a person on several shapes: those that differ in their number together, with the range of
    it and the number of shapes."""
    alike: dict[str, list[str]] = {}
    for reason in left_out:
        alike.setdefault(NUMBER.sub("", reason), []).append(reason)
    said = []
    for found in alike.values():
        numbers = sorted((number for reason in found for number in NUMBER.findall(reason)), key=number_of)
        text = NUMBER.sub(" to ".join(dict.fromkeys((*numbers[:1], *numbers[-1:]))), found[0])
        said.append(f"{text} ({len(found)} shapes)" if len(found) > 1 else text)
    return ", ".join(said)


def people_of(report: Report) -> Frame:
    """gaze.csv. Lost samples of recorded fixations, whose tracked time is unknown, are unknown as well."""
    table = report.results.table("gaze")
    return table.assign(lost=table["lost"].where(table["tracked"].notna()))


def by_person(table: Frame) -> Frame:
    """Sums over all shapes; people with the largest share of lost samples first."""
    sums = table.groupby("person", sort=False)[[*COUNTS]].sum(min_count=1)
    sums["shapes"] = table[table["hits"] > 0].groupby("person")["item"].nunique()
    sums["shown"] = table.groupby("person", sort=False)["item"].nunique()
    sums["left_out"] = table[table["left_out"] != ""].groupby("person")["left_out"].agg(reasons)
    sums = sums.fillna({"shapes": 0, "left_out": ""}).reset_index()
    order = (-sums["lost"] / sums["samples"].clip(lower=1)).sort_values(kind="stable").index
    return sums.loc[order]


def tables(report: Report) -> list[Block]:
    found = by_person(people_of(report))
    left_out = text("Left out", "left_out")
    looked = Column(
        "Shapes",
        lambda row: Cell(
            f"{row['shapes']:.0f} of {row['shown']:.0f}",
            float(row["shapes"]),
            below=NOBODY if row["shapes"] == 0 else "",
        ),
    )
    listed = sheet(
        "people-recorded",
        f"People whose gaze was recorded, by what was lost. {CAPTION}",
        [*columns(text("Person", "person")), looked, left_out],
        found.to_dict("records"),
    )
    return [
        *attempt(recipe, report),
        listed,
        *remarks(report),
        *attempt(people.reliability, report),
        Note("How well n people predict n others: Figure 5, Human performance."),
    ]


def recipe(report: Report) -> Table:
    """Stages that made the ground truth, with versions and options, as in run.yaml."""
    made = report.results.record.get("ground_truth", {})
    rows = [
        (
            stage.replace("_", " "),
            options.pop("version", ""),
            ", ".join(f"{name}: {value}" for name, value in options.items()),
        )
        for stage, options in ((stage, dict(options)) for stage, options in made.items())
    ]
    if not rows:
        raise Missing("run.yaml does not say how the ground truth was made.")
    return sheet(
        "recipe",
        "Computation of the ground truth from the recordings, to be cited by papers that report these scores.",
        [
            text("Stage", lambda row: row[0]),
            text("Version", lambda row: row[1]),
            text("Options", lambda row: row[2]),
        ],
        rows,
    )


def remarks(report: Report) -> list[Block]:
    rows = report.results.record.get("remarks", [])
    columns = [
        text("Shape", lambda row: row.get("item", "")),
        text("Remark", lambda row: row.get("remark", "")),
    ]
    return [sheet("remarks", REMARKS, columns, rows)] if rows else []


def of_shape(report: Report, item: str) -> Table:
    """Use of each person's samples on one shape."""
    table = people_of(report)
    rows = table[table["item"] == item]
    if rows.empty:
        raise Missing("Nobody's gaze on this shape was recorded.")
    return sheet(
        "people-of-shape",
        f"People whose gaze on this shape was recorded. {CAPTION}",
        [*columns(text("Person", "person")), text("Left out", "left_out")],
        rows.to_dict("records"),
    )
