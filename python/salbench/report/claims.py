# SPDX-License-Identifier: GPL-3.0-or-later
"""What the paper's text claims, beside our figures."""

from salbench.pages.blocks import Block, Cell, Missing, Note, cell, interval
from salbench.pages.columns import Column, sheet, text
from salbench.pages.names import DATASETS
from salbench.report import checks, paper
from salbench.report.checks import Finding
from salbench.report.results import Results, Row
from salbench.report.workshop import Workshop

CAPTION = ("What the paper's text says of its figures, and what this run finds. Verdict, effect and interval are of one test. A "
           "difference holds where its 95 % interval lies on the claimed side, and does not where it lies on the other. That two do "
           "not differ holds where the 90 % interval lies within the margin (two one-sided tests at 0.05), and does not where the "
           "95 % interval leaves out 0 all the same. Everything else is undecided. A claim about several pairs holds if each of "
           "them does; shown is the one that decides. Margins are our choice; below each stands its reason, in the paper's means.")
STYLES = {checks.HOLDS: "holds", checks.FAILS: "fails", checks.UNDECIDED: "open"}


def find(results: Results, claim: Row) -> Finding:
    """The finding of one claim, or Missing."""
    finding: Finding = getattr(checks, claim["check"])(results, claim)
    return finding


def table(shop: Workshop) -> Block | list[Block]:
    """Verdicts on the paper, which only its data and protocol allow."""
    reason = paper.other_data(shop.results) or paper.other_protocol(shop.results, shop.protocols)
    if reason:
        return Note(f"No verdicts on the paper: {reason}.")
    found = [(claim, attempted(shop.results, claim)) for claim in paper.read("claims.csv").to_dict("records")]
    counts = {verdict: sum(finding.verdict == verdict for _, finding in found) for verdict in STYLES}
    lacking = len(found) - sum(counts.values())
    said = f"Of {len(found)} claims: {checks.tally(counts)}" + (f"; {lacking} without the scores that they take." if lacking else ".")
    columns = [Column("Verdict", lambda row: Cell(row[1].verdict, style=STYLES.get(row[1].verdict, "open")), numeric=False),
               Column("The paper", lambda row: Cell(row[0]["claim"], below=f"Section {row[0]['section']}"), numeric=False),
               text("Data set", lambda row: DATASETS[row[0]["dataset"]]),
               text("Metric", lambda row: shop.results.metric(row[0]["metric"]).label if row[0]["metric"] else ""),
               Column("Found", lambda row: Cell(row[1].figure, below=row[1].others, further=row[1].how), numeric=False),
               Column("Effect", lambda row: cell(row[1].value)), Column("95 % interval", lambda row: interval_cell(*row)),
               Column("Margin", lambda row: cell(row[0]["margin"], below=row[0]["reason"]))]
    return [Note(said), sheet("claims", CAPTION, columns, found, ["Verdict", "Data set", "Metric"])]


def attempted(results: Results, claim: Row) -> Finding:
    try:
        return find(results, claim)
    except Missing as reason:
        return Finding(f"Missing: {str(reason).rstrip('.')}.", verdict="no verdict")


def interval_cell(claim: Row, finding: Finding) -> Cell:
    made = interval(finding.low, finding.high)
    if claim["margin"] == claim["margin"] and finding.low90 == finding.low90:
        made.below = f"90 %: {interval(finding.low90, finding.high90).text}"
    return made
