# SPDX-License-Identifier: GPL-3.0-or-later
"""One function per kind of claim: our figure, its interval, and whether the claim holds by that interval.

A difference holds where its 95 % interval lies on the claimed side, and does not where it lies on the other. "Do not differ"
holds where the 90 % interval lies within the margin, which is two one-sided tests at 0.05, and does not where the 95 %
interval leaves out 0 all the same. Everything else is undecided. [schuirmann1987] [lakens2017]"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from itertools import product

import numpy
from scipy import special

from salbench.conclusions.units import Floats
from salbench.pages.blocks import Missing
from salbench.pages.names import several
from salbench.report import paper, statistics
from salbench.report.results import Frame, Results, Row
from salbench.report.units import counted

HOLDS, FAILS, UNDECIDED = "holds", "does not hold", "undecided"
NAN = float("nan")
NEAR, APART = 0.05, 0.1  # largest distances of two distributions: our reading of the paper's words, undecided between them


@dataclass
class Finding:
    figure: str               # what was compared
    value: float = NAN        # the effect
    low: float = NAN          # its 95 % interval
    high: float = NAN
    low90: float = NAN        # and 90 %, where a margin decides
    high90: float = NAN
    count: str = ""           # units and shapes
    test: str = ""
    verdict: str = UNDECIDED
    others: str = ""          # verdicts of the other comparisons of the same claim

    @property
    def how(self) -> str:
        return ", ".join(filter(None, (self.test, self.count)))


def beyond(finding: Finding) -> str:
    """The difference is claimed to be above 0."""
    return HOLDS if finding.low > 0 else FAILS if finding.high < 0 else UNDECIDED


def leaves_out_0(finding: Finding) -> bool:
    return finding.low > 0 or finding.high < 0


def equal(finding: Finding, margin: float) -> str:
    """The difference is claimed to be none."""
    if -margin < finding.low90 and finding.high90 < margin:
        return HOLDS
    return FAILS if leaves_out_0(finding) else UNDECIDED


def unequal(finding: Finding, margin: float) -> str:
    """A difference is claimed, of whichever sign."""
    if leaves_out_0(finding):
        return HOLDS
    return FAILS if -margin < finding.low90 and finding.high90 < margin else UNDECIDED


def no_rise(finding: Finding, margin: float) -> str:
    """No rise is claimed: one that is smaller than the margin counts as none."""
    return HOLDS if finding.high90 < margin else FAILS if finding.low > 0 else UNDECIDED


def tally(counts: Mapping[str, int]) -> str:
    """counts: verdict -> number"""
    words = {HOLDS: ("holds", "hold"), FAILS: ("does not", "do not"), UNDECIDED: ("undecided", "undecided")}
    return ", ".join(f"{counts[verdict]} {words[verdict][counts[verdict] != 1]}" for verdict in words if counts[verdict])


def combined(findings: list[Finding], support: Callable[[Finding], float]) -> Finding:
    """The finding that decides about all together: they hold if each does, and do not if one does not. support: larger for
    findings that speak more for the claim. Missing if there is none."""
    if not findings:
        raise Missing("the table has no two means to compare")
    counts = {verdict: sum(finding.verdict == verdict for finding in findings) for verdict in (FAILS, UNDECIDED, HOLDS)}
    worst = next(verdict for verdict, number in counts.items() if number)

    def rank(finding: Finding) -> float:
        value = support(finding)
        return value if value == value else -numpy.inf

    deciding = min((finding for finding in findings if finding.verdict == worst), key=rank)
    if len(findings) > 1:
        deciding.others = f"of {len(findings)}: {tally(counts)}"
    return deciding


def by(results: Results) -> str:
    """How tests name their unit."""
    return f" by {results.unit}" if results.unit else ""


def pair(results: Results, claim: Row, a: str, b: str, test: str = "paired t") -> Finding:
    """The difference a less b, without a verdict."""
    dataset = claim["dataset"]
    row = statistics.pair(results, dataset, claim["metric"], a, b)
    return Finding(f"{a} − {b}", row["mean_difference"], row["ci95_low"], row["ci95_high"], row["ci90_low"], row["ci90_high"],
                   counted(results.unit, dataset, row["n"], row["n_shapes"]), f"{test}{by(results)}")


def above(results: Results, claim: Row) -> Finding:
    """Every model of a is above every one of b."""
    findings = [pair(results, claim, a, b) for a, b in product(claim["a"].split(), claim["b"].split())]
    for finding in findings:
        finding.verdict = beyond(finding)
    return combined(findings, lambda finding: finding.value)


def differ(results: Results, claim: Row) -> Finding:
    """Every model of a differs from every one of b."""
    findings = [pair(results, claim, a, b, "paired t and two one-sided t")
                for a, b in product(claim["a"].split(), claim["b"].split())]
    for finding in findings:
        finding.verdict = unequal(finding, claim["margin"])
    return combined(findings, lambda finding: abs(finding.value))


def same(results: Results, claim: Row) -> Finding:
    finding = pair(results, claim, claim["a"], claim["b"], "two one-sided t")
    finding.verdict = equal(finding, claim["margin"])
    return finding


def classes_of(results: Results, claim: Row) -> Frame:
    """Rows of per_class.csv by class and model, and the classes in their order."""
    table = statistics.per_class(results, claim["dataset"], claim["metric"])
    return table.set_index(["class", "model"])


def class_row(table: Frame, name: str, model: str = "Avg") -> Row:
    if (name, model) not in table.index:
        raise Missing(f"no scores of {'the models' if model == 'Avg' else model} in class {name}")
    row: Row = table.loc[(name, model)]
    return row


def averages(table: Frame) -> Frame:
    """Rows of the mean over the competitors by class; a run of references alone has none."""
    if "Avg" not in table.index.get_level_values("model"):
        raise Missing("no scores of a model, only of references")
    return table.xs("Avg", level="model")


def around(text: str, value: float, half: float, count: str, test: str) -> Finding:
    """A finding with an interval of half that width, and the verdict that it is above 0."""
    finding = Finding(text, float(value), float(value - half), float(value + half), count=count, test=test)
    finding.verdict = beyond(finding)
    return finding


def leads_class(results: Results, claim: Row) -> Finding:
    """a: a model and a class, in which it is above each model of b. Both are over the same shapes there, so that their half
    intervals together are at least that of the paired difference."""
    table = classes_of(results, claim)
    (a, name), findings = claim["a"].split(), []
    best = class_row(table, name, a)
    for model in claim["b"].split():
        row = class_row(table, name, model)
        if (row["n"], row["n_shapes"]) != (best["n"], best["n_shapes"]):
            raise Missing(f"{a} and {model} have scores of different shapes in class {name}")
        findings.append(around(f"{a} − {model}", best["mean"] - row["mean"], best["ci95"] + row["ci95"],
                               meshes(best["n"]), "half intervals of both added"))
    return combined(findings, lambda finding: finding.value)


def meshes(*numbers: float) -> str:
    return " and ".join([str(int(n)) for n in numbers[:-1]] + [several(int(numbers[-1]), "mesh")])


INDEPENDENT = "half intervals added in squares"  # of independent means [zou2008]


def class_above(results: Results, claim: Row) -> Finding:
    """The shapes of class a are above those of class b, in their mean over the models."""
    table = classes_of(results, claim)
    a, b = (class_row(table, claim[side]) for side in "ab")
    return around(f"{claim['a']} − {claim['b']}", a["mean"] - b["mean"], numpy.hypot(a["ci95"], b["ci95"]), meshes(a["n"], b["n"]),
                  INDEPENDENT)


def classes_above_mean(results: Results, claim: Row) -> Finding:
    """Each class of a is above the mean of the classes, which it is one of."""
    table = classes_of(results, claim)
    rows = averages(table)
    findings = []
    for name in claim["a"].split():
        row = class_row(table, name)
        weights = (rows.index == name) - 1 / len(rows)
        findings.append(around(f"{name} − mean of {len(rows)} classes", row["mean"] - rows["mean"].mean(),
                               float(numpy.linalg.norm(weights * rows["ci95"])), meshes(rows["n"].sum()), INDEPENDENT))
    return combined(findings, lambda finding: finding.value)


def hardest_class(results: Results, claim: Row) -> Finding:
    """Every other class is above class a; one that is not there might be below it."""
    table = classes_of(results, claim)
    name = claim["a"]
    lowest = class_row(table, name)
    rows = averages(table)
    if len(rows) < 2:
        raise Missing("no scores of another class")
    finding = combined([around(f"{other} − {name}", row["mean"] - lowest["mean"], numpy.hypot(row["ci95"], lowest["ci95"]),
                               meshes(row["n"], lowest["n"]), INDEPENDENT) for other, row in rows.drop(name).iterrows()],
                       lambda finding: finding.value)
    if finding.verdict == HOLDS and len(rows) < paper.CLASSES:
        finding.verdict, finding.others = UNDECIDED, f"{len(rows)} of {paper.CLASSES} classes"
    return finding


def steps(results: Results, table: Frame, test: str) -> list[Finding]:
    """Findings, without verdicts, of rows of human_curve_differences.csv."""
    return [Finding(f"n = {row.from_participants:.0f} to {row.to_participants:.0f}", row.mean_difference, row.ci95_low, row.ci95_high,
                    row.ci90_low, row.ci90_high, counted(results.unit, "meshes", row.n, row.n_shapes), f"{test}{by(results)}")
            for row in table.itertuples()]


def beyond_first(results: Results, claim: Row) -> Frame:
    """Rows of human_curve_differences.csv from n = a to every later n."""
    table = statistics.human_differences(results, claim["metric"])
    rows = table[table["from_participants"] == float(claim["a"])]
    if rows.empty:
        raise Missing(f"the human curve does not go beyond {claim['a']} participants")
    return rows


def rises(results: Results, claim: Row) -> Finding:
    rows = beyond_first(results, claim)
    rows = rows[rows["to_participants"] == float(claim["b"])]
    if rows.empty:
        raise Missing(f"the human curve does not reach {claim['b']} participants")
    finding = steps(results, rows, "paired t")[0]
    finding.verdict = beyond(finding)
    return finding


def no_rise_beyond(results: Results, claim: Row) -> Finding:
    """From n = a to none of the later n does the curve rise by the margin."""
    findings = steps(results, beyond_first(results, claim), "one-sided t")
    for finding in findings:
        finding.verdict = no_rise(finding, claim["margin"])
    return combined(findings, lambda finding: -finding.high90)


def same_beyond(results: Results, claim: Row) -> Finding:
    """From n = a to each of the later n there is no change."""
    findings = steps(results, beyond_first(results, claim), "two one-sided t")
    for finding in findings:
        finding.verdict = equal(finding, claim["margin"])
    return combined(findings, lambda finding: -max(abs(finding.low90), abs(finding.high90)))


def keeps_rising(results: Results, claim: Row) -> Finding:
    """Every step is up."""
    findings = steps(results, statistics.one_more(statistics.human_differences(results, claim["metric"])), "paired t")
    for finding in findings:
        finding.verdict = beyond(finding)
    return combined(findings, lambda finding: finding.value)


def cumulative(results: Results, claim: Row, model: str) -> tuple[Floats, Floats]:
    """Right ends of the bins and the mean cumulative distribution of a model's unmatched maps."""
    from salbench.report.figures import cumulative_data
    data = cumulative_data(results, claim["dataset"])
    if model not in data:
        raise Missing(f"no distribution of {model}")
    return data["value"].to_numpy(), data[model].to_numpy()


def distance(text: str, first: Floats, second: Floats) -> Finding:
    """Kolmogorov and Smirnov's distance of two mean distributions, and the verdict that they are near. It has no interval: it
    is of these shapes."""
    value = float(numpy.abs(first - second).max())
    verdict = HOLDS if value <= NEAR else FAILS if value >= APART else UNDECIDED
    return Finding(text, value, test=f"largest distance: near up to {NEAR}, apart from {APART}; no interval", verdict=verdict)


def near_uniform(results: Results, claim: Row) -> Finding:
    ends, shares = cumulative(results, claim, claim["a"])
    return distance(f"{claim['a']} and the uniform distribution", shares, ends)


def near_normal(results: Results, claim: Row) -> Finding:
    """The normal distribution with the same mean and deviation."""
    ends, shares = cumulative(results, claim, claim["a"])
    middles, weights = (ends[1:] + ends[:-1]) / 2, numpy.diff(shares)
    mean = (middles * weights).sum()
    deviation = numpy.sqrt(((middles - mean) ** 2 * weights).sum())
    return distance(f"{claim['a']} and a normal distribution", shares, special.ndtr((ends - mean) / deviation))


def distributions_differ(results: Results, claim: Row) -> Finding:
    """The two models whose distributions are nearest are still apart."""
    found = {model: cumulative(results, claim, model)[1] for model in claim["a"].split()}
    pairs = [(a, b) for a, b in product(found, found) if a < b]
    a, b = min(pairs, key=lambda pair: float(numpy.abs(found[pair[0]] - found[pair[1]]).max()))
    finding = distance(f"{a} and {b}, the nearest two", found[a], found[b])
    finding.verdict = {HOLDS: FAILS, FAILS: HOLDS}.get(finding.verdict, UNDECIDED)
    return finding
