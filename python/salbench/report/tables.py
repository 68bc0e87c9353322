# SPDX-License-Identifier: GPL-3.0-or-later
"""Means of the models, and pairwise tests."""

from collections.abc import Sequence

from salbench.pages.blocks import Block, Cell, Missing, Note, Table, cell, interval, p_value, signed
from salbench.pages.columns import Column, between, number, probability, sheet
from salbench.pages.names import KIND_NAMES, several
from salbench.report import latex, reported
from salbench.report.results import Frame, Row
from salbench.report.units import DATA_SET, MODEL, OF_A_METRIC, metric_of, n_of
from salbench.report.report import Report

MEANS = (
    "Means over the shapes that all models have a score for, with 95 % intervals of Student and of the"
    " bootstrap (BCa) over the units that n counts. Best of each data set and metric in bold, which does not"
    " say that it differs from the others."
)
HUMAN = (
    "HS is one participant against all others, and no model. One person picks few points, so that most of"
    " such a map has the same value: a model, which values every point, may score above it without knowing"
    " more than people do together. The human curve shows what more participants reach."
)


def by_metrics(table: Frame, metrics: Sequence[str]) -> Frame:
    return table[table["metric"].isin(metrics)]


def means(report: Report) -> list[Block]:
    """Means of the leading metrics from summary.csv, beside numbers from papers."""
    table = report.results.table("summary")
    if table.empty:
        raise Missing("summary.csv holds no scores: no shape of the run has ground truth.")
    of_people = [Note(HUMAN)] if (table["model"] == "HS").any() else []
    made = means_table(report, "means", by_metrics(table, list(report.results.leading)))
    return [
        latex.beside(report, made, ["means with 95 % intervals of Student and of the bootstrap"]),
        *of_people,
    ]


def means_table(report: Report, identifier: str, table: Frame) -> Table:
    best = {
        key: report.results.metric(key[1]).best(dict(zip(part["model"], part["mean"])))
        for key, part in table.groupby(["dataset", "metric"])
    }

    def mean(row: Row) -> Cell:
        return cell(
            row["mean"], bold=row["model"] in best[row["dataset"], row["metric"]], below=own_shapes(row)
        )

    columns = [
        MODEL,
        DATA_SET,
        metric_of(report.results),
        n_of(report.results),
        Column("Mean", mean),
        number("95 % low", "ci95_low"),
        number("95 % high", "ci95_high"),
        number("SD", "sd"),
        between("95 % by bootstrap", "bca95_low", "bca95_high"),
    ]
    rows = report.results.mine_first(table.to_dict("records"))
    caption, known = MEANS, [found for row in rows if (found := reported.beside(report.results, row))]
    if known:
        columns.append(reported.column(report.results))
        caption += reported.CAPTION.format("; ".join(dict.fromkeys(row["source"] for row in known)))
    return sheet(identifier, caption, columns, rows, (*OF_A_METRIC, "Model"), 2)


def own_shapes(row: Row) -> str:
    """Mean over all shapes that the model has a score for, if these differ from the compared ones."""
    if row["n_own_shapes"] == row["n_shapes"] or row["own_mean"] != row["own_mean"]:
        return ""
    kind = several(row["n_own_shapes"], KIND_NAMES.get(row["dataset"], "shape"))
    return f"{row['own_mean']:.3f} over all {kind} that it has a score for".replace("-", "−")


PAIRS = (
    "Every pair of models, and whether the two differ when all models are compared at once, as in ranks,"
    " groups and sentences: they do where |t| is beyond its bound. The interval and p are those of the paired"
    " t-test over the units that n counts, for this pair alone. Signed-rank p: by Holm's correction over all"
    " pairs of one data set and metric, whose number stands below it; it is no test of means where"
    " differences are skewed. Effect: Cohen's d_z, below it the matched-pairs rank-biserial correlation."
    " Higher: on how large a share of the units the first model has the higher score. Rank sum: the paper's"
    " test, which takes every shape for an independent one. Undecided: the test finds no difference, which"
    " does not say that there is none."
)


def pairwise(report: Report) -> Table:
    """Rows of significance.csv for the leading metrics."""
    made = pairs_table(report, "pairs", by_metrics(significance(report), list(report.results.leading)))
    return latex.beside(
        report, made, ["every pair of models: paired differences with 95 % intervals, and tests"]
    )


def significance(report: Report) -> Frame:
    table = report.results.table("significance")
    if table.empty:
        raise Missing("significance.csv holds no test: it takes two models and a shape with ground truth.")
    return table


def pairs_table(report: Report, identifier: str, table: Frame) -> Table:
    def of_all(row: Row) -> str:
        return f"{int(row['n_tests'])} pairs" if row["n_tests"] == row["n_tests"] else ""

    columns = [
        Column(
            "Pair",
            lambda row: Cell(f"{row['model_a']} − {row['model_b']}", badge=jointly(row["t"], row["t_bound"])),
            numeric=False,
        ),
        DATA_SET,
        metric_of(report.results),
        n_of(report.results),
        Column("Mean difference", lambda row: signed(row["mean_difference"])),
        between("95 % interval", "ci95_low", "ci95_high"),
        Column("Effect", lambda row: signed(row["d_z"], 2, below=signed(row["rank_biserial"], 2).text)),
        Column("All pairs: |t|", lambda row: nearness(row["t"], row["t_bound"])),
        probability("p (t)", "t_p"),
        Column("Signed-rank p (Holm)", lambda row: p_value(row["signed_rank_p_holm"], below=of_all(row))),
        Column(
            "Higher",
            lambda row: cell(
                row["superiority"], 2, below=interval(row["superiority_low"], row["superiority_high"], 2).text
            ),
        ),
        probability("Rank sum p", "rank_sum_p"),
    ]
    return sheet(
        identifier,
        PAIRS,
        columns,
        report.results.mine_first(table.to_dict("records")),
        (*OF_A_METRIC, "Pair"),
        2,
    )


def jointly(t: float, bound: float) -> tuple[str, str]:
    """Verdict on a pair in the simultaneous comparison, as a badge; none for a pair with a reference."""
    return (
        ("", "")
        if t != t or bound != bound
        else ("differ", "holds")
        if abs(t) > bound
        else ("undecided", "open")
    )


def nearness(t: float, bound: float) -> Cell:
    """Margin of the verdict: another seed moves the bound by some hundredths."""
    return cell(None) if t != t or bound != bound else cell(abs(t), below=f"bound {bound:.3f}")
