# SPDX-License-Identifier: GPL-3.0-or-later
"""The ranking of the models, how sure it is, and what may be said of it in a sentence."""

import re

from report import people, statistics
from report.blocks import Cell, Note, Table, attempt, cell, interval
from report.names import DATASETS, spoken
from report.results import Missing
from report.units import HEAD, count_cell

CAPTION = ("Models by their mean. Ranks have joint 95 % intervals: all pairs of models under one metric are compared at once. First: "
           "in how large a share of the resamples the model has the best mean. Group: two models without a letter in common differ; "
           "two with one cannot be told apart, which does not say that they are equal. Means have 95 % intervals of their own "
           f"(Student). HS and RS, human performance and chance, are references: they have no rank. {people.SHARE}")
HEADS = ["Data set", "Metric", "Model", "Rank", "95 % ranks", "First", "Group", "Mean", "95 % interval", "Of HS", HEAD]


def tables(shop):
    """A sentence per data set, and the table of the leading metrics."""
    shop.results.table("ranking.csv", *statistics.RANKING)
    notes = [Note(said) for dataset in statistics.shown(shop.results) if (said := said_of(shop.results, dataset))]
    leading = list(shop.results.leading)
    return notes + attempt(lacking, shop) + attempt(table, shop, "ranking", leading) + chance(shop, leading)


def lacking(shop):
    """No blocks, but Missing where the column "Of HS" has no file."""
    shop.results.table("human_share.csv", *statistics.SHARES)
    return []


def chance(shop, metrics):
    """The remarks of run.yaml on metrics by which chance or a constant map is as good as a model."""
    remarks = shop.results.record.get("remarks")
    notes = []
    for remark in remarks if isinstance(remarks, list) else []:
        if isinstance(remark, dict) and remark.get("metric") in metrics and remark.get("dataset") in DATASETS:
            label = shop.results.metric(remark["metric"]).label
            notes.append(Note(f"By the means of {label} on {spoken(remark['dataset'])}, {remark.get('remark')}."))
    return notes


def said_of(results, dataset):
    return sentence(spoken(dataset), [(of.label, statistics.ranking(results, dataset, name))
                                      for name, of in results.leading.items()])


def table(shop, identifier, metrics):
    rows = [row for dataset in statistics.shown(shop.results) for metric in metrics for row in rows_of(shop, dataset, metric)]
    if not rows:
        raise Missing("ranking.csv ranks no model: none has scores.")
    return Table(identifier, CAPTION, HEADS, rows, [False] * 3 + [True] * 3 + [False] + [True] * 4, filters=[0, 1])


def rows_of(shop, dataset, metric):
    """The ranked models, below them the references."""
    of = shop.results.metric(metric)
    head = [Cell(DATASETS[dataset]), Cell(of.label, below=of.below)]
    try:
        means = {row["model"]: row for row in statistics.summary(shop.results, dataset, metric).to_dict("records")}
    except Missing:
        means = {}
    shares = statistics.human_shares(shop.results, dataset, metric)
    rows = []
    for row in statistics.ranking(shop.results, dataset, metric).to_dict("records"):
        known = means.pop(row["model"], {})
        ranks = [cell(row["rank"], 0), interval(row["rank_low"], row["rank_high"], 0), cell(row["first"], 2), Cell(row["group"] or "–")]
        rows.append(head + [Cell(row["model"]), *ranks] + mean_cells(shop, dataset, row, known, shares.get(row["model"])))
    for model, row in means.items():
        if row["n"] > 0:
            rows.append(head + [Cell(model), cell(None), cell(None), cell(None), Cell("reference")]
                        + mean_cells(shop, dataset, row, row))
    return rows


def mean_cells(shop, dataset, row, known, share=None):
    """known: the row of summary.csv, which has the interval; empty if there is none. share: that of human_share.csv."""
    return [cell(row["mean"]), interval(known.get("ci95_low", float("nan")), known.get("ci95_high", float("nan"))),
            people.share_cell(share), count_cell(shop.results, dataset, row["n"], row["n_shapes"])]


def sentence(dataset, rankings):
    """What the intervals of the ranks allow to say, and no more; empty if there is no ranking. rankings: (label, rows of
    ranking.csv) of each metric."""
    said = {}
    for label, rows in rankings:
        if len(rows):
            form, first, others = statement(rows)
            said.setdefault((form, frozenset(first), frozenset(others)), (form, first, others, []))[3].append(label)
    clauses = [form(listed(labels), first, others) for form, first, others, labels in said.values()]
    return f"On {dataset}, {'; '.join(clauses)}." if clauses else ""


def statement(rows):
    """One of the forms below with the models that it speaks of."""
    models = list(rows["model"])
    if len(models) == 1:
        return only, models, []
    if rows[["rank_low", "rank_high"]].isna().any(axis=None):
        return unknown, models, []
    first = rows[rows["rank_low"] == 1]
    names, others = list(first["model"]), list(rows.loc[rows["rank_low"] > 1, "model"])
    if len(names) > 1:
        return several, names, others
    best = first.iloc[0]
    if best["rank_high"] == 1:
        return leads, names, []
    return not_behind, names, [row.model for row in rows.itertuples() if row.model in others and share(row.group, best["group"])]


def share(group, other):
    """Whether two entries of the column `group` have a letter in common; a letter beyond z is one with an apostrophe."""
    return bool(set(re.findall("[a-z]'*", group)) & set(re.findall("[a-z]'*", other)))


def leads(metrics, first, others):
    return f"{first[0]} leads by {metrics}"


def not_behind(metrics, first, others):
    return f"by {metrics}, {first[0]} is behind no other model, but cannot be told apart from {listed(others)}"


def several(metrics, first, others):
    if not others and len(first) > 2:
        return f"by {metrics}, no two of {listed(first)} can be told apart"
    behind = f", and {listed(others)} {'is' if len(others) == 1 else 'are'} behind at least one other model" if others else ""
    return f"by {metrics}, {listed(first)} cannot be told apart{behind}"


def only(metrics, first, others):
    return f"{first[0]} is the only model that is scored by {metrics}"


def unknown(metrics, first, others):
    return f"one observation does not tell how the models rank by {metrics}"


def listed(names):
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} and {names[-1]}"
