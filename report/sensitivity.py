# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether the ranking of the models depends on the convention that the same maps are scored by."""

from collections import Counter

import pandas
from scipy import stats

from report import statistics
from report.blocks import Cell, Note, Table, attempt, cell, count
from report.metrics import PAPER, family_label, family_of
from report.names import DATASETS, spoken
from report.results import Missing, write_csv

CAPTION = ("{}: mean of each model and its rank under each convention, over the shapes that every convention of a family scores "
           "under every model. Bold: the rank is another than under the first convention of the family, which is the paper's "
           "where it has one. Tau: Kendall's tau-b of the two rankings, 1 where they agree. A rank may differ by chance: the "
           "pairwise tests say which differences count.")


def tables(shop):
    """A table per data set: families of conventions by models."""
    blocks = [block for dataset in statistics.shown(shop.results) for block in attempt(table, shop, dataset)]
    return blocks + [matching(shop)]


def matching(shop):
    if shop.other is None:
        return Note("Matched against unmatched maps: the program scores matched maps alone, and has no option that leaves the "
                    "matching out. The conventions of another run, given with --compare, stand beside those of this one.",
                    missing=True)
    return Note(f"Conventions of {shop.other.folder.resolve().name} are those of the run given with --compare, over the shapes "
                "and models that both runs have.")


def families(results):
    """Family -> its metrics, the paper's first."""
    found = {}
    for name in results.metrics:
        found.setdefault(family_of(name), []).append(name)
    return {family: sorted(names, key=lambda name: name not in PAPER) for family, names in found.items()}


def scored(results, dataset, names):
    """metric -> shapes by models of those metrics that have any score."""
    found = {}
    for name in names:
        try:
            wide = statistics.scores(results, dataset, name).dropna(axis=1, how="all")
        except Missing:
            continue
        if not wide.empty:
            found[name] = wide
    return found


def common(tables):
    """The tables over the models that all have, and the shapes that all score under each of them."""
    models = [model for model in tables[0] if all(model in wide for wide in tables)]
    shapes = None
    for wide in tables:
        known = wide[models].dropna().index
        shapes = known if shapes is None else shapes.intersection(known, sort=False)
    return [wide.loc[shapes, models] for wide in tables]


def conventions(shop, dataset):
    """Rows (family, run, Metric, number of shapes, tau, means, ranks), the family's reference first; means and ranks are
    Series over the models."""
    rows = []
    for family, names in families(shop.results).items():
        found = {("", name): wide for name, wide in scored(shop.results, dataset, names).items()}
        if shop.other is not None:
            found |= {(shop.other.folder.resolve().name, name): wide
                      for name, wide in scored(shop.other, dataset, names).items()}
        if len(found) < 2 or next(iter(found))[0]:
            continue
        reference = None
        for (run, name), wide in zip(found, common(list(found.values()))):
            if wide.empty:
                continue
            of = shop.results.metric(name)
            means = wide.mean()
            ranks = means.round(12).rank(ascending=of.lower, method="min")
            reference = ranks if reference is None else reference
            tau = stats.kendalltau(reference, ranks)[0] if len(ranks) > 1 else float("nan")
            rows.append((family, run, of, len(wide), tau, means, ranks))
    return rows


def table(shop, dataset):
    rows = conventions(shop, dataset)
    if not rows:
        raise Missing(f"No metric of the {spoken(dataset)} was computed by several conventions: metrics: all in the "
                      "configuration computes every one.")
    models = [model for model in shop.models if any(model in row[5] for row in rows)]
    lines, data, references = [], [], {}
    for family, run, of, shapes, tau, means, ranks in rows:
        reference = references.setdefault(family, ranks)
        label = f"{of.label}, {run}" if run else of.label
        line = [Cell(family_label(family)), Cell(label, below="lower is better" if of.lower else ""), count(shapes), cell(tau, 2)]
        for model in models:
            if model not in means:
                line.append(cell(None))
                continue
            differs = ranks[model] != reference[model]
            below = f"rank {int(ranks[model])}" + (f", not {int(reference[model])}" if differs else "")
            line.append(cell(means[model], bold=differs, below=below))
            data.append((family, of.name, run, shapes, tau, model, means[model], int(ranks[model]), int(reference[model])))
        lines.append(line)
    name = f"sensitivity-{dataset}"
    write_csv(pandas.DataFrame(data, columns=["family", "metric", "run", "n", "kendall_tau", "model", "mean", "rank",
                                              "rank_of_reference"]), shop.file(f"data/{name}.csv"))
    return [Note(sentence(dataset, rows)),
            Table(name, CAPTION.format(DATASETS[dataset]), ["Family", "Convention", "Shapes", "Tau", *models], lines,
                  [False, False, True, True] + [True] * len(models), filters=[0], files=[("numbers (CSV)", f"data/{name}.csv")])]


def sentence(dataset, rows):
    """How many conventions rank otherwise, and which one most."""
    first = Counter()
    others = []
    for row in rows:
        if first[row[0]]:
            others.append(row)
        first[row[0]] += 1
    changed = [row for row in others if row[4] == row[4] and row[4] < 1 - 1e-12]
    if not changed:
        return f"On {spoken(dataset)} none of {len(others)} other conventions changes the ranking of the models."
    least = min(changed, key=lambda row: row[4])
    tau = f"{least[4]:.2f}".replace("-", "−")
    return (f"On {spoken(dataset)} {len(changed)} of {len(others)} other conventions change the ranking of the models; "
            f"furthest from the first of its family is {least[2].label}, with a tau of {tau}.")
