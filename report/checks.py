# SPDX-License-Identifier: GPL-3.0-or-later
"""One function per kind of claim: our figure, its 95 % interval, and whether the claim holds.

A claim about a difference holds or fails by the paper's own test, the rank sum at 0.05. Where the test finds nothing that
says little over few shapes: then, unless there are nearly as many as in the paper, the claim is undecided."""

from dataclasses import dataclass
from itertools import product

import numpy
from scipy import stats

from report import paper, statistics
from report.names import MODELS
from report.results import Missing
from report.tables import LEVEL

HOLDS, FAILS, UNDECIDED = "holds", "does not hold", "cannot be decided with this many shapes"
ENOUGH = 0.9  # of the paper's number of shapes: 380 of its 400 meshes can be had


@dataclass
class Finding:
    verdict: str
    figure: str               # what was found, in words and numbers
    value: float = float("nan")
    low: float = float("nan")
    high: float = float("nan")
    n: int = 0


def few(dataset, n):
    return n < ENOUGH * paper.SHAPES[dataset]


def combined(findings):
    """The finding that decides: a failure, else an open one, else the one nearest to failing."""
    for verdict in (FAILS, UNDECIDED):
        found = [finding for finding in findings if finding.verdict == verdict]
        if found:
            return min(found, key=lambda finding: finding.value)
    return min(findings, key=lambda finding: finding.value)


def compared(results, claim, a, b):
    """The pair's p of the rank-sum test, and a finding without verdict: the mean difference a less b."""
    row = statistics.pair(results, claim["dataset"], claim["metric"], a, b)
    wide = statistics.scores(results, claim["dataset"], claim["metric"])
    n, _, low, high = statistics.paired_difference(wide, a, b)
    p = row["rank_sum_p"]
    text = "p < 0.001" if p < 0.001 else f"p = {p:.3f}"
    return p, Finding("", f"{a} − {b}, {text}", row["mean_difference"], low, high, n)


def decide(claim, finding, significant, as_claimed):
    """as_claimed: the sign of the difference is that of the claim."""
    finding.verdict = ((HOLDS if as_claimed else FAILS) if significant
                       else UNDECIDED if few(claim["dataset"], finding.n) else FAILS)
    return finding


def above(results, claim):
    """Every model of a is significantly above every one of b."""
    findings = []
    for a, b in product(claim["a"].split(), claim["b"].split()):
        p, finding = compared(results, claim, a, b)
        findings.append(decide(claim, finding, p < LEVEL, finding.value > 0))
    return combined(findings)


def differ(results, claim):
    findings = []
    for a, b in product(claim["a"].split(), claim["b"].split()):
        p, finding = compared(results, claim, a, b)
        findings.append(decide(claim, finding, p < LEVEL, True))
    open_ones = [finding for finding in findings if finding.verdict != HOLDS]
    return min(open_ones or findings, key=lambda finding: abs(finding.value))


def same(results, claim):
    """No significant difference, which means something only over many shapes."""
    p, finding = compared(results, claim, claim["a"], claim["b"])
    finding.verdict = FAILS if p < LEVEL else UNDECIDED if few(claim["dataset"], finding.n) else HOLDS
    return finding


def leads(results, claim):
    """a has the highest mean of the paper's models; the figure is its lead over the best other."""
    table = statistics.summary(results, claim["dataset"], claim["metric"])
    means = table[table["model"].isin(MODELS)].set_index("model")["mean"].dropna()
    if claim["a"] not in means or len(means) < 2:
        raise Missing(f"needs the means of {claim['a']} and of another of the paper's models")
    other = means.drop(claim["a"]).idxmax()
    p, finding = compared(results, claim, claim["a"], other)
    ahead = finding.value > 0
    enough = not few(claim["dataset"], finding.n)
    finding.verdict = ((HOLDS if ahead else FAILS) if p < LEVEL or enough else UNDECIDED)
    return finding


def class_means(results, claim):
    table = statistics.per_class(results, claim["dataset"], claim["metric"])
    return table.set_index(["class", "model"])


def leads_class(results, claim):
    """Model a is above every other one of the paper's in class b."""
    wide = statistics.scores(results, claim["dataset"], claim["metric"])
    class_of = statistics.classes(results)
    part = wide[[class_of.get(item) == claim["b"] for item, _ in wide.index]]
    others = [model for model in part if model in MODELS and model not in (claim["a"], "RS") and part[model].notna().any()]
    if part.empty or not others:
        raise Missing(f"no scores of class {claim['b']}")
    best = part[others].mean().idxmax()
    n, mean, low, high = statistics.paired_difference(part, claim["a"], best)
    verdict = HOLDS if low > 0 else FAILS if high < 0 else UNDECIDED
    return Finding(verdict, f"{claim['a']} − {best} in {claim['b']}", mean, low, high, n)


def average_of(results, claim, name):
    table = class_means(results, claim)
    if (name, "Avg") not in table.index:
        raise Missing(f"no scores of class {name}")
    return table.loc[(name, "Avg")]


def class_above(results, claim):
    """The averages over the models of class a and of class b; independent classes, so that intervals add in squares."""
    a, b = (average_of(results, claim, claim[side]) for side in "ab")
    return class_difference(f"{claim['a']} − {claim['b']}", a["mean"] - b["mean"], numpy.hypot(a["ci95"], b["ci95"]))


def class_difference(text, difference, half):
    verdict = HOLDS if difference - half > 0 else FAILS if difference + half < 0 else UNDECIDED
    return Finding(verdict, text, float(difference), float(difference - half), float(difference + half))


def classes_above_mean(results, claim):
    table = class_means(results, claim)
    overall = table.xs("Avg", level="model")["mean"].mean()
    found = [(name, average_of(results, claim, name)) for name in claim["a"].split()]
    return combined([class_difference(f"{name} − mean of the classes", row["mean"] - overall, row["ci95"])
                     for name, row in found])


def hardest_class(results, claim):
    averages = class_means(results, claim).xs("Avg", level="model")["mean"].dropna()
    average_of(results, claim, claim["a"])
    lowest = averages.idxmin()
    if lowest == claim["a"] and len(averages) < paper.CLASSES:
        verdict = UNDECIDED
    else:
        verdict = HOLDS if lowest == claim["a"] else FAILS
    return Finding(verdict, f"lowest average: {lowest}, {averages.min():.3f}; {claim['a']}: {averages[claim['a']]:.3f}",
                   n=len(averages))


def curve(results, claim):
    table = results.table("human_curve.csv", "n", "metric", "n_meshes", "mean", "sd")
    rows = table[table["metric"] == claim["metric"]].dropna(subset=["n", "n_meshes", "mean"])
    rows = rows.drop_duplicates("n").sort_values("n").set_index("n")
    if len(rows) < 2:
        raise Missing("human_curve.csv has no curve of this metric")
    return rows


def step(rows, first, second):
    """Rise of the curve from one number of participants to another, with Welch's interval."""
    if first not in rows.index or second not in rows.index:
        raise Missing(f"the curve does not reach from {first} to {second} participants")
    a, b = rows.loc[first], rows.loc[second]
    half = welch_half_width([a["sd"], b["sd"]], [a["n_meshes"], b["n_meshes"]])
    rise = b["mean"] - a["mean"]
    n = int(min(a["n_meshes"], b["n_meshes"]))
    return Finding("", f"n = {int(first)} to {int(second)}", rise, rise - half, rise + half, n)


def welch_half_width(deviations, counts):
    """Half of the 95 % interval of the difference of two means; NaN where a deviation is undefined."""
    deviations, counts = numpy.asarray(deviations, dtype=float), numpy.asarray(counts, dtype=float)
    if not (counts > 1).all():
        return float("nan")
    variances = deviations ** 2 / counts
    if not variances.sum() > 0:
        return float(variances.sum())
    shares = variances / variances.sum()
    return float(stats.t.ppf(0.975, 1 / (shares ** 2 / (counts - 1)).sum()) * numpy.sqrt(variances.sum()))


def undefined(findings):
    """The first finding without an interval, undecided; None if there is none."""
    found = next((finding for finding in findings if finding.low != finding.low), None)
    if found:
        found.verdict = UNDECIDED
    return found


def rises(results, claim):
    finding = step(curve(results, claim), float(claim["a"]), float(claim["b"]))
    return undefined([finding]) or decide(claim, finding, finding.low > 0 or finding.high < 0, finding.value > 0)


def flat_beyond(results, claim):
    """No step from n = a on is significant; the figure is the largest one."""
    rows = curve(results, claim)
    beyond = [n for n in rows.index if n >= float(claim["a"])]
    if len(beyond) < 2:
        raise Missing(f"the curve ends before {claim['a']} participants")
    steps = [step(rows, first, second) for first, second in zip(beyond, beyond[1:])]
    if undefined(steps):
        return undefined(steps)
    largest = max(steps, key=lambda found: found.low)
    largest.verdict = FAILS if largest.low > 0 else UNDECIDED if few(claim["dataset"], largest.n) else HOLDS
    return largest


def drop_not_significant(results, claim):
    rows = curve(results, claim)
    finding = step(rows, float(claim["a"]), rows.index.max())
    if undefined([finding]):
        return finding
    if finding.low > 0 or finding.high < 0:
        finding.verdict = FAILS
    else:
        finding.verdict = UNDECIDED if few(claim["dataset"], finding.n) else HOLDS if finding.value < 0 else FAILS
    return finding


def keeps_rising(results, claim):
    """Every step of the mean is up; the figure is the smallest."""
    rows = curve(results, claim)
    smallest = min((step(rows, first, second) for first, second in zip(rows.index, rows.index[1:])),
                   key=lambda found: found.value)
    smallest.verdict = HOLDS if smallest.value > 0 else UNDECIDED if few(claim["dataset"], smallest.n) else FAILS
    return smallest


def cumulative(results, claim, model):
    """Right ends of the bins and the mean cumulative distribution of a model's unmatched maps."""
    from report.figures import cumulative_data
    data = cumulative_data(results, claim["dataset"])
    if model not in data:
        raise Missing(f"no distribution of {model}")
    return data["value"].to_numpy(), data[model].to_numpy()


def distance(text, first, second, bound):
    """Kolmogorov and Smirnov's distance of two cumulative distributions, and the claim that it is at most the bound."""
    value = float(numpy.abs(first - second).max())
    return Finding(HOLDS if value <= bound else FAILS, f"{text}: largest distance {value:.3f}, near: up to {bound}", value)


def near_uniform(results, claim):
    ends, shares = cumulative(results, claim, claim["a"])
    return distance(f"{claim['a']} and the uniform distribution", shares, ends, float(claim["b"]))


def near_normal(results, claim):
    """The normal distribution with the same mean and deviation."""
    ends, shares = cumulative(results, claim, claim["a"])
    middles, weights = (ends[1:] + ends[:-1]) / 2, numpy.diff(shares)
    mean = (middles * weights).sum()
    deviation = numpy.sqrt(((middles - mean) ** 2 * weights).sum())
    normal = stats.norm.cdf(ends, mean, deviation)
    return distance(f"{claim['a']} and a normal distribution", shares, normal, float(claim["b"]))


def distributions_differ(results, claim):
    """The two models whose distributions are nearest are still further apart than the bound."""
    found = {}
    for model in claim["a"].split():
        found[model] = cumulative(results, claim, model)[1]
    pairs = [(a, b) for a, b in product(found, found) if a < b]
    a, b = min(pairs, key=lambda pair: numpy.abs(found[pair[0]] - found[pair[1]]).max())
    finding = distance(f"{a} and {b}, the nearest two", found[a], found[b], float(claim["b"]))
    finding.verdict = FAILS if finding.verdict == HOLDS else HOLDS
    return finding
