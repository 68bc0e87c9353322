# SPDX-License-Identifier: GPL-3.0-or-later
"""What the report needs beyond the program's own statistics, computed from results.csv alone."""

import numpy
import pandas
from scipy import stats

from report.names import natural
from report.results import DATASETS, Missing


def datasets(results):
    """The data sets that have scores, in the program's order."""
    try:
        present = set(results.table("results.csv", "dataset")["dataset"])
    except Missing:
        present = set(results.table("summary.csv", "dataset")["dataset"])
    return [dataset for dataset in DATASETS if dataset in present]


def shown(results):
    """The data sets that every report speaks of, which are the paper's, and point clouds where they have scores."""
    try:
        scored = datasets(results)
    except Missing:
        scored = []
    return [dataset for dataset in DATASETS if dataset != "clouds" or dataset in scored]


def models(results):
    """Every model that any table names, in the order of the configuration."""
    found = list(results.record.get("configuration", {}).get("models") or []) if results.record else []
    for name in ("summary.csv", "results.csv"):
        if results.has(name) and "model" in results.table(name):
            found += list(results.table(name)["model"].unique())
    return list(dict.fromkeys(model for model in found if model))


def scores(results, dataset, metric):
    """One row per shape (index item, view), one column per model; NaN where a score is undefined or missing. Made once
    per data set and metric: callers leave it as it is."""
    known = results.pivoted.get((dataset, metric))
    if known is None:
        known = results.pivoted[dataset, metric] = pivot_scores(results, dataset, metric)
    return known


def pivot_scores(results, dataset, metric):
    table = results.table("results.csv", "dataset", "item", "view", "model", metric)
    rows = table[table["dataset"] == dataset]
    if rows.empty:
        raise Missing(f"results.csv has no scores of {dataset}: none of them has ground truth, or the run left them out.")
    index, columns, at = placed(results, dataset, rows)
    values = numpy.full((len(index), len(columns) + 1), numpy.nan)
    values[at] = rows[metric].to_numpy(dtype=float)
    return pandas.DataFrame(values[:, :-1], index, columns)


def placed(results, dataset, rows):
    """Index and columns of every metric's scores of a data set, and where each row stands: one without a model, which was
    cut short, behind the last column. Made once."""
    if (dataset, None) not in results.pivoted:
        shapes = list(zip(rows["item"], rows["view"]))
        order = sorted(set(shapes), key=lambda key: (natural(key[0]), natural(key[1])))
        present = set(rows["model"])
        columns = [model for model in models(results) if model in present]
        row_of, column_of = ({name: at for at, name in enumerate(names)} for names in (order, columns))
        at = ([row_of[shape] for shape in shapes], [column_of.get(model, len(columns)) for model in rows["model"]])
        results.pivoted[dataset, None] = (pandas.MultiIndex.from_tuples(order, names=["item", "view"]),
                                          pandas.Index(columns, name="model"), at)
    return results.pivoted[dataset, None]


def classes(results):
    """item -> class."""
    table = results.table("results.csv", "item", "class")
    return dict(zip(table["item"], table["class"]))


def mean_per_shape(results, dataset, metric):
    """Mean over the models per shape, worst first; shapes without any score are left out."""
    means = scores(results, dataset, metric).mean(axis=1).dropna()
    return means.sort_values(ascending=not results.metric(metric).lower, kind="stable")


def ranks(wide, metric):
    """Rank of each shape within its data set per model, 1 for the best score; NaN where there is no score."""
    return wide.rank(ascending=metric.lower, method="min")


def summary(results, dataset, metric):
    """Rows of summary.csv of one metric, best mean first."""
    table = results.table("summary.csv", "dataset", "model", "metric", "n", "mean", "sd", "ci95_low", "ci95_high")
    rows = table[(table["dataset"] == dataset) & (table["metric"] == metric)]
    if rows.empty:
        raise Missing(f"summary.csv has no {metric} of {dataset}.")
    lower = results.metric(metric).lower
    return rows.sort_values("mean", ascending=lower, kind="stable", na_position="last").reset_index(drop=True)


def student_half_width(values):
    """Half of the 95 % confidence interval of a mean; NaN for fewer than two values."""
    n = len(values)
    return float(stats.t.ppf(0.975, n - 1) * numpy.std(values, ddof=1) / numpy.sqrt(n)) if n > 1 else float("nan")


def per_class(results, dataset, metric):
    """Columns class, model, n, mean, ci95: of per_class.csv where it has the metric, as of the paper's metrics it has AUC
    alone; else made from results.csv in the same way. The model "Avg" is the mean over the models' means."""
    mean, half = f"{metric}_mean", f"{metric}_ci95"
    needed = (mean, half) if metric == "auc" else ()
    try:
        table = results.table("per_class.csv", "dataset", "class", "model", "n", *needed)
    except Missing:
        if needed:
            raise
        return class_means(results, dataset, metric)
    if mean not in table or half not in table:
        return class_means(results, dataset, metric)
    rows = table[table["dataset"] == dataset].rename(columns={mean: "mean", half: "ci95"})
    if rows.empty:
        raise Missing(f"per_class.csv has no rows of {dataset}: they have no scores, or no classes.")
    rows = rows.replace({"model": {"Avg-AUC": "Avg"}})[["class", "model", "n", "mean", "ci95"]].reset_index(drop=True)
    if next(column for column in table if column.endswith("_mean")) != mean:  # n counts what the first is defined for
        wide, class_of = scores(results, dataset, metric), classes(results)
        counts = wide.groupby(wide.index.get_level_values("item").map(class_of)).count()
        counted = counts.assign(Avg=(counts > 0).sum(axis=1)).stack().to_dict()
        rows["n"] = [counted.get(key, 0) for key in zip(rows["class"], rows["model"])]
    return rows


def class_means(results, dataset, metric):
    """What per_class gives, from results.csv."""
    wide = scores(results, dataset, metric)
    class_of = classes(results)
    rows = []
    for name, group in wide.groupby(wide.index.get_level_values("item").map(class_of), sort=False):
        means = []
        for model in wide:
            values = group[model].dropna().to_numpy()
            if len(values) == 0:
                continue
            means.append(values.mean())
            rows.append((name, model, len(values), means[-1], student_half_width(values)))
        if means:
            rows.append((name, "Avg", len(means), float(numpy.mean(means)), student_half_width(means)))
    return pandas.DataFrame(rows, columns=["class", "model", "n", "mean", "ci95"])


def paired_difference(wide, a, b):
    """Mean over the shapes of score of a less score of b: n, mean, low and high end of its 95 % interval (Student)."""
    for model in (a, b):
        if model not in wide:
            raise Missing(f"no scores of {model}")
    difference = (wide[a] - wide[b]).dropna().to_numpy()
    if len(difference) == 0:
        raise Missing(f"no shape has scores of both {a} and {b}")
    half = student_half_width(difference)
    return len(difference), float(difference.mean()), float(difference.mean() - half), float(difference.mean() + half)


def pair(results, dataset, metric, a, b):
    """The row of significance.csv of a pair, its differences turned so that they are a less b."""
    table = results.table("significance.csv", "dataset", "metric", "model_a", "model_b", "mean_difference", "rank_sum_p")
    rows = table[(table["dataset"] == dataset) & (table["metric"] == metric)]
    for first, second, sign in ((a, b, 1), (b, a, -1)):
        match = rows[(rows["model_a"] == first) & (rows["model_b"] == second)]
        if not match.empty:
            row = match.iloc[0].to_dict()
            row["mean_difference"] *= sign
            return row
    raise Missing(f"significance.csv has no test of {a} against {b} by {metric} on {dataset}.")
