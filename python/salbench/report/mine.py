# SPDX-License-Identifier: GPL-3.0-or-later
"""The model that a report is about, compared with every other."""

from functools import cache

from salbench import conclusions
from salbench.conclusions.against import AHEAD, BEHIND, OPEN, against
from salbench.conclusions.words import listed, of_split
from salbench.pages.blocks import Block, Cell, Missing, signed
from salbench.pages.columns import Column, between, sheet, text
from salbench.pages.names import several, spoken
from salbench.report import latex, statistics
from salbench.report.results import Frame, Shown
from salbench.report.units import DATA_SET, OF_A_METRIC, metric_of, n_of
from salbench.report.report import Report
from salbench.system.errors import InputError

CAPTION = (
    "{} less each other model: mean difference with its 95 % interval, joint for these comparisons alone."
    " They are fewer than all pairs of models, so that smaller differences show than in ranks and groups."
    " The verdict is that of a step-down test, which may tell two apart although their interval reaches 0;"
    " “not told apart” does not say that two are equal."
)
NAMED = 3  # models listed in a sentence
STYLES = {AHEAD: "holds", BEHIND: "fails", OPEN: "open"}


def require(results: Shown) -> None:
    """Throws InputError if the model, or another requested name, is missing."""
    known = statistics.models(Shown(results.folder) if results.wanted_models else results)
    for option, names, there in (
        ("--mine", [results.mine] if results.mine else [], known),
        ("--models", results.wanted_models, known),
        ("--metrics", results.wanted_metrics, list(results.metrics)),
    ):
        if unknown := [name for name in names if name not in there]:
            raise InputError(
                f"{option} {unknown[0]}: is not in {results.folder}; there are {', '.join(there)}"
            )
    if results.mine and results.has("results") and results.mine not in set(results.table("results")["model"]):
        raise InputError(
            f"--mine {results.mine}: has no scores in"
            f" {results.folder}{': ' * (results.mine in results.failed)}{results.failed.get(results.mine, '')};"
            " name another model, or leave --mine out"
        )


@cache
def compared(folder: str, model: str, unit: str) -> Frame:
    try:
        return against(conclusions.source_of(folder, unit or None).study, model)
    except InputError as error:
        raise Missing(f"{model} cannot be compared with the others: {error}") from None


def table_of(results: Shown, dataset: str) -> Frame:
    """Comparisons over all splits together, by the metrics of the pages."""
    rows = compared(str(results.folder), results.mine, results.unit)
    rows = rows[(rows["dataset"] == dataset) & rows["metric"].isin(list(results.leading))]
    rows = rows[rows["split"] == rows["split"].iloc[0]] if "split" in rows and len(rows) else rows
    return rows[rows["other"].isin(statistics.models(results))]


def tables(report: Report) -> list[Block]:
    results = report.results
    rows = [
        row for dataset in statistics.shown(results) for row in table_of(results, dataset).to_dict("records")
    ]
    if not rows:
        raise Missing(f"{results.mine} has no scores that others could be compared with.")
    is_what = Column(
        f"{results.mine} is",
        lambda row: Cell("", badge=(row["verdict"], STYLES.get(row["verdict"], ""))),
        numeric=False,
    )
    columns = [
        text("Other", "other"),
        is_what,
        DATA_SET,
        metric_of(results),
        n_of(results),
        Column("Difference", lambda row: signed(row["mean_difference"])),
        between("95 % interval", "low", "high"),
    ]
    made = sheet("mine", CAPTION.format(results.mine), columns, rows, OF_A_METRIC, 2)
    return [
        latex.beside(
            report,
            made,
            [f"{results.mine} less each other model, 95 % intervals joint for these comparisons"],
        )
    ]


def sentence(results: Shown, dataset: str) -> str:
    """Sentence on the models that it is ahead of, and behind, by each metric; empty if unknown."""
    said = []
    for metric, rows in table_of(results, dataset).groupby("metric", sort=False):
        parts = []
        for verdict, words in ((AHEAD, "ahead of"), (BEHIND, "behind"), (OPEN, "not told apart from")):
            others = list(rows.loc[rows["verdict"] == verdict, "other"])
            if others:
                parts.append(
                    f"{words} {listed(others) if len(others) <= NAMED else several(len(others), 'other')}"
                )
        if parts:
            label = results.metric(str(metric)).label
            said.append(f"by {label} {', '.join(parts[:-1])}{', and ' if parts[1:] else ''}{parts[-1]}")
    return (
        f"On {spoken(dataset)}{of_split(results.split_of(dataset), results.in_splits)} it is"
        f" {'; '.join(said)}. Here only its own pairs are compared, so that smaller differences show."
        if said
        else ""
    )
