# SPDX-License-Identifier: GPL-3.0-or-later
"""What the paper's text claims, beside our figures."""

from salbench.pages.blocks import Block, Cell, Missing, Note, Table, cell, interval
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
HEADS = ["Verdict", "The paper", "Data set", "Metric", "Found", "Effect", "95 % interval", "Margin"]
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
    rows = []
    counts = dict.fromkeys(STYLES, 0)
    for claim in paper.read("claims.csv").to_dict("records"):
        head = [Cell(claim["claim"], below=f"Section {claim['section']}"), Cell(DATASETS[claim["dataset"]]),
                Cell(shop.results.metric(claim["metric"]).label if claim["metric"] else "")]
        try:
            finding = find(shop.results, claim)
        except Missing as reason:
            rows.append([Cell("no verdict", style="open"), *head, Cell(f"Missing: {str(reason).rstrip('.')}."), cell(None), cell(None),
                         margin_cell(claim)])
            continue
        counts[finding.verdict] += 1
        how = ", ".join(filter(None, (finding.test, finding.count)))
        rows.append([Cell(finding.verdict, style=STYLES[finding.verdict]), *head, Cell(finding.figure, below=finding.others, further=how),
                     cell(finding.value), interval_cell(claim, finding), margin_cell(claim)])
    lacking = len(rows) - sum(counts.values())
    said = f"Of {len(rows)} claims: {checks.tally(counts)}" + (f"; {lacking} without the scores that they take." if lacking else ".")
    return [Note(said),
            Table("claims", CAPTION, HEADS, rows, [False] * 5 + [True] * 3, filters=[0, 2, 3])]


def interval_cell(claim: Row, finding: Finding) -> Cell:
    made = interval(finding.low, finding.high)
    if claim["margin"] == claim["margin"] and finding.low90 == finding.low90:
        made.below = f"90 %: {interval(finding.low90, finding.high90).text}"
    return made


def margin_cell(claim: Row) -> Cell:
    return cell(claim["margin"], below=claim["reason"])
