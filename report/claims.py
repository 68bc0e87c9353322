# SPDX-License-Identifier: GPL-3.0-or-later
"""What the paper's text claims, beside our figures."""

from report import checks, paper
from report.blocks import Cell, Note, Table, cell, count, interval
from report.names import DATASETS
from report.results import Missing

CAPTION = ("What the paper's text says of its figures, and what this run finds. Differences with 95 % intervals; verdicts by "
           "the paper's rank-sum test at 0.05. Without a significant difference a verdict takes nearly as many shapes as the "
           "paper had.")
HEADS = ["Section", "The paper", "Data set", "Metric", "Found", "Figure", "95 % interval", "Shapes", "Verdict"]
STYLES = {checks.HOLDS: "holds", checks.FAILS: "fails", checks.UNDECIDED: "open"}


def find(results, claim):
    """The finding of one claim, or Missing."""
    return getattr(checks, claim["check"])(results, claim)


def table(shop):
    rows = []
    counts = dict.fromkeys(STYLES, 0)
    for claim in paper.read("claims.csv").to_dict("records"):
        head = [Cell(claim["section"]), Cell(claim["claim"]), Cell(DATASETS[claim["dataset"]]),
                Cell(shop.results.metric(claim["metric"]).label if claim["metric"] else "")]
        try:
            finding = find(shop.results, claim)
        except Missing as reason:
            rows.append(head + [Cell(f"Missing: {str(reason).rstrip('.')}."), cell(None), cell(None), cell(None),
                                Cell("no verdict", style="open")])
            continue
        verdict = Cell(finding.verdict, style=STYLES[finding.verdict])
        if shop.results.simulated:
            verdict = Cell("no verdict", style="open")
        counts[finding.verdict] += 1
        rows.append(head + [Cell(finding.figure), cell(finding.value), interval(finding.low, finding.high),
                            count(finding.n) if finding.n else cell(None), verdict])
    made = Table("claims", CAPTION, HEADS, rows, [False] * 5 + [True] * 3 + [False], filters=[2, 3, 8])
    if shop.results.simulated:
        return [Note("No verdicts: the participants are simulated, so that nothing here speaks for or against the paper."), made]
    return [Note(", ".join(f"{number} {verdict}" for verdict, number in counts.items()) + "."), made]
