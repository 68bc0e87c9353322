# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether the ranking of the models depends on the convention that the same maps are scored by."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy
import pandas

from salbench.conclusions.agreement import tau_b
from salbench.conclusions.metrics import PAPERS
from salbench.pages.blocks import Block, Cell, Missing, Note, attempt, cell, interval
from salbench.pages.columns import Column, sheet, text
from salbench.pages.names import DATASETS, spoken
from salbench.report import statistics
from salbench.report.metrics import Metric, family_label, family_of
from salbench.report.results import Results, csv_text
from salbench.report.units import n_of
from salbench.report.workshop import Workshop

CAPTION = ("{}: mean of each model and its rank under each convention, over the shapes that all models have its score for. Human "
           "performance and chance are references and have no rank. Bold: the rank is another than under the first convention of "
           "the family, which is the paper's where it has one. Tau: Kendall's tau-b of the two rankings, 1 where they agree, with "
           "its 95 % interval over resampled units. A rank may differ by chance: the ranking above says how sure it is.")


def tables(shop: Workshop) -> list[Block]:
    """A table per data set: families of conventions by models."""
    blocks = [block for dataset in statistics.shown(shop.results) for block in attempt(table, shop, dataset)]
    return blocks + [matching(shop)]


def matching(shop: Workshop) -> Note:
    if shop.other is None:
        return Note("Matched against unmatched maps: run the configuration again with metrics: {matching: none}, or histogram, and "
                    "give the folder of its results with --compare; its conventions then stand beside those of this run.",
                    missing=True)
    return Note(f"Conventions of {shop.other.folder.resolve().name} are those of the run given with --compare, over the shapes "
                "and models that both runs have; their taus have no interval.")


def families(results: Results) -> dict[str, list[str]]:
    """Family -> its metrics, the paper's first."""
    found: dict[str, list[str]] = {}
    for name in results.metrics:
        found.setdefault(family_of(name), []).append(name)
    return {family: sorted(names, key=lambda name: name not in PAPERS) for family, names in found.items()}


@dataclass
class Convention:
    """One ranking of the models, and how it agrees with that of the first convention of its family."""
    family: str
    run: str           # that it is of; empty for the one reported
    metric: Metric
    n: int             # units
    n_shapes: int
    means: pandas.Series  # over the models, as all that follow
    ranks: pandas.Series
    reference: pandas.Series  # their ranks under the first convention
    tau: float = float("nan")
    low: float = float("nan")
    high: float = float("nan")

    def changes(self) -> bool:
        return self.tau == self.tau and self.tau < 1 - 1e-12

    def lines(self, models: Sequence[str]) -> list[dict[str, Any]]:
        """Of the table in data/, one per model."""
        of_all = {"family": self.family, "metric": self.metric.name, "run": self.run, "n": self.n, "n_shapes": self.n_shapes, "kendall_tau": self.tau,
                  "ci95_low": self.low, "ci95_high": self.high}
        return [{**of_all, "model": model, "mean": self.means[model], "rank": int(self.ranks[model]),
                 "rank_of_reference": self.reference.get(model, float("nan"))} for model in models if model in self.means]


def conventions(shop: Workshop, dataset: str) -> list[Convention]:
    """Those of each family that has several, its reference first."""
    found = []
    for family, names in families(shop.results).items():
        own = own_conventions(shop.results, dataset, family, names)
        others = others_conventions(shop, shop.other, dataset, family, own[0], names) if own and shop.other else []
        if len(own) + len(others) > 1:
            found += own + others
    return found


def own_conventions(results: Results, dataset: str, family: str, names: Sequence[str]) -> list[Convention]:
    """From ranking.csv and ranking_agreement.csv."""
    found: list[Convention] = []
    for name in names:
        rows = statistics.ranking(results, dataset, name).dropna(subset=["mean", "rank", "n", "n_shapes"]).set_index("model")
        if rows.empty:
            continue
        first = found[0] if found else None
        tau = statistics.agreement(results, dataset, first.metric.name, name) if first else ()
        found.append(Convention(family, "", results.metric(name), int(rows["n"].iloc[0]), int(rows["n_shapes"].iloc[0]),
                                rows["mean"], rows["rank"], first.ranks if first else rows["rank"], *tau))
    return found


def others_conventions(shop: Workshop, other: Results, dataset: str, family: str, first: Convention, names: Sequence[str]) -> list[Convention]:
    """Of the run to compare with, over the shapes and models that both have scores of: no table holds that. The reference is
    ranked anew over these shapes."""
    found = []
    reference = statistics.scores(shop.results, dataset, first.metric.name)
    for name in names:
        try:
            theirs = statistics.scores(other, dataset, name)
        except Missing:
            continue
        models = [model for model in first.means.index if model in theirs and theirs[model].notna().any()]
        both = pandas.concat({"ours": reference[models], "theirs": theirs[models]}, axis=1, join="inner").dropna()
        if both.empty:
            continue
        means = statistics.by_unit(shop.results, both)
        of = other.metric(name)
        ranks = ranks_of(means["theirs"].mean(), of)
        against = ranks_of(means["ours"].mean(), first.metric)
        found.append(Convention(family, other.folder.resolve().name, of, len(means), len(both), means["theirs"].mean(), ranks, against,
                                tau_of(against, ranks)))
    return found


def tau_of(first: pandas.Series, second: pandas.Series) -> float:
    """Kendall's tau-b; NaN for a single model."""
    a, b = numpy.triu_indices(len(first), 1)
    signs = (numpy.sign(ranks[a] - ranks[b]).astype(numpy.int8)[None, :, None] for ranks in (first.to_numpy(), second.to_numpy()))
    return float(tau_b(*signs)[0, 0, 0])


def ranks_of(means: pandas.Series, metric: Metric) -> pandas.Series:
    return means.round(12).rank(ascending=metric.lower, method="min")


def table(shop: Workshop, dataset: str) -> list[Block]:
    rows = conventions(shop, dataset)
    if not rows:
        raise Missing(f"No metric of the {spoken(dataset)} was computed by several conventions: metrics: all in the "
                      "configuration computes every one.")
    name = f"sensitivity-{dataset}"
    shop.write(f"data/{name}.csv", csv_text(pandas.DataFrame([line for row in rows for line in row.lines(shop.models)])))

    def of_maps(row: Convention) -> str:
        differs = shop.other is not None and shop.other.metric(row.metric.name).maps != shop.results.metric(row.metric.name).maps
        return f"maps {row.metric.maps}" if differs and row.metric.maps else row.metric.below

    def convention(row: Convention) -> Cell:
        label = f"{row.metric.label}, {row.run}" if row.run else row.metric.label
        return Cell(label, below=", ".join(filter(None, ("lower is better" if row.metric.lower else "", of_maps(row)))))
    n = n_of(shop.results)
    columns = [text("Family", lambda row: family_label(row.family)), Column("Convention", convention, numeric=False),
               Column(n.head, lambda row: n.show({"dataset": dataset, **vars(row)})),
               Column("Tau", lambda row: cell(row.tau, 2, below=interval(row.low, row.high, 2).text if row.low == row.low else ""))]
    columns += [Column(model, partial(rank_cell, model=model)) for model in shop.models if any(model in row.means for row in rows)]
    return [Note(sentence(dataset, rows)),
            sheet(name, CAPTION.format(DATASETS[dataset]), columns, rows, ["Family"], files=[("numbers (CSV)", f"data/{name}.csv")])]


def rank_cell(row: Convention, model: str) -> Cell:
    if model not in row.means:
        return cell(None)
    rank, known = int(row.ranks[model]), row.reference.get(model, float("nan"))
    differs = known == known and rank != known
    return cell(row.means[model], bold=differs, below=f"rank {rank}" + (f", not {int(known)}" if differs else ""))


def sentence(dataset: str, rows: list[Convention]) -> str:
    """How many conventions order the means otherwise, and which one most."""
    first, others = set(), []
    for row in rows:
        if row.family in first:
            others.append(row)
        first.add(row.family)
    changed = [row for row in others if row.changes()]
    if not changed:
        return f"On {spoken(dataset)} none of {len(others)} other conventions orders the means of the models otherwise."
    least = min(changed, key=lambda row: row.tau)
    tau = f"{least.tau:.2f}".replace("-", "−")
    sure = f" (95 % interval {interval(least.low, least.high, 2).text})" if least.low == least.low else ""
    return (f"On {spoken(dataset)} {len(changed)} of {len(others)} other conventions order the means of the models otherwise; "
            f"furthest from the first of its family is {least.metric.label}, with a tau of {tau}{sure}.")
