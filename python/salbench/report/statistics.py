# SPDX-License-Identifier: GPL-3.0-or-later
"""Rows of the program's tables, and what pages of single shapes need of results.csv: scores by shape and their ranks."""

from typing import Any

import numpy
import pandas

from salbench.conclusions.metrics import Metric as ProgramMetric, of_program
from salbench.conclusions.ranked import cut
from salbench.conclusions.units import DATASETS
from salbench.pages.blocks import Missing
from salbench.report.metrics import Metric
from salbench.report.names import natural
from salbench.report.results import Frame, Row, Shown

def datasets(results: Shown) -> list[str]:
    """The data sets that have scores, in the program's order."""
    try:
        present = set(results.table("results")["dataset"])
    except Missing:
        present = set(results.table("summary")["dataset"])
    return [dataset for dataset in DATASETS if dataset in present]


def shown(results: Shown) -> list[str]:
    """The data sets that have scores, and those that the run was asked for: what is missing of these is named."""
    try:
        scored = datasets(results)
    except Missing:
        scored = []
    meshes = results.option("dataset.meshes") != "false" and results.record.get("data_set", {}).get("meshes") != "0"
    asked = {"meshes": meshes, "scans": meshes and results.option("dataset.scans") != "false", "clouds": False}
    return [dataset for dataset in DATASETS if dataset in scored or asked[dataset]]


def models(results: Shown) -> list[str]:
    """Every model that any table names, in the order of the configuration, one's own first."""
    found = list(results.record.get("configuration", {}).get("models", []))
    for name in ("summary", "results"):
        if results.has(name):
            found += list(results.table(name)["model"].unique())
    known = [model for model in dict.fromkeys(found) if model and (not results.wanted_models or model in results.wanted_models)]
    return sorted(known, key=lambda model: model != results.mine)


def scores(results: Shown, dataset: str, metric: str) -> Frame:
    """One row per shape (index item, view), one column per model; NaN where a score is undefined or missing. Made once
    per data set and metric: callers leave it as it is."""
    known = results.pivoted.get((dataset, metric))
    if known is None:
        known = results.pivoted[dataset, metric] = pivot_scores(results, dataset, metric)
    return known


def pivot_scores(results: Shown, dataset: str, metric: str) -> Frame:
    table = results.table("results")
    if metric not in table:
        raise Missing(f"results.csv has no column {metric}: the run did not compute it.")
    rows = table[table["dataset"] == dataset]
    if rows.empty:
        raise Missing(f"results.csv has no scores of {dataset}: none of them has ground truth, or the run left them out.")
    index, columns, at = placed(results, dataset, rows)
    values = numpy.full((len(index), len(columns) + 1), numpy.nan)
    values[at] = rows[metric].to_numpy(dtype=float)
    return pandas.DataFrame(values[:, :-1], index, columns)


def placed(results: Shown, dataset: str, rows: Frame) -> Any:
    """Index and columns of every metric's scores of a data set, and where each row stands: one without a model, which was
    cut short, behind the last column. Made once."""
    if (dataset, None) not in results.pivoted:
        shapes = list(zip(rows["item"], rows["view"]))
        order = sorted(set(shapes), key=lambda key: (natural(key[0]), natural(key[1])))
        present = set(rows["model"])
        columns = [model for model in models(results) if model in present]
        row_of, column_of = {shape: at for at, shape in enumerate(order)}, {model: at for at, model in enumerate(columns)}
        at = ([row_of[shape] for shape in shapes], [column_of.get(model, len(columns)) for model in rows["model"]])
        results.pivoted[dataset, None] = (pandas.MultiIndex.from_tuples(order, names=["item", "view"]),
                                          pandas.Index(columns, name="model"), at)
    return results.pivoted[dataset, None]


def classes(results: Shown) -> dict[str, str]:
    """item -> class."""
    table = results.table("results")
    return dict(zip(table["item"], table["class"]))


def mean_per_shape(results: Shown, dataset: str, metric: str) -> pandas.Series:
    """Mean over the models per shape, worst first; shapes without any score are left out."""
    means = scores(results, dataset, metric).mean(axis=1).dropna()
    return means.sort_values(ascending=not results.metric(metric).lower, kind="stable")


def ranks(wide: Frame, metric: Metric) -> Frame:
    """Rank of each shape within its data set per model, 1 for the best score; NaN where there is no score."""
    return wide.rank(ascending=metric.lower, method="min")


def compact(results: Shown, dataset: str, metric: str) -> Frame:
    """Rows of compact.csv of one metric, in its order: competitors by rank, then references."""
    rows = of_metric(results.table("compact"), dataset, metric)
    if rows.empty:
        raise Missing(f"compact.csv has no {metric} of {dataset}.")
    return rows.reset_index(drop=True)


def leaders(results: Shown, dataset: str, metric: str = "") -> Frame:
    """Rows of leaders.csv: of one metric, or the sentences of the data set. All splits together come first, then each."""
    return of_metric(results.table("leaders"), dataset, metric).reset_index(drop=True)


def summary(results: Shown, dataset: str, metric: str) -> Frame:
    """Rows of summary.csv of one metric, best mean first."""
    rows = of_metric(results.table("summary"), dataset, metric)
    if rows.empty:
        raise Missing(f"summary.csv has no {metric} of {dataset}.")
    lower = results.metric(metric).lower
    return rows.sort_values("mean", ascending=lower, kind="stable", na_position="last").reset_index(drop=True)


def of_metric(table: Frame, dataset: str, metric: str) -> Frame:
    return table[(table["dataset"] == dataset) & (table["metric"] == metric)]


def ranking(results: Shown, dataset: str, metric: str) -> Frame:
    """Rows of ranking.csv of one metric, in its order: best first, without references."""
    return of_metric(results.table("ranking"), dataset, metric).reset_index(drop=True)


def per_class(results: Shown, dataset: str, metric: str) -> Frame:
    """Rows of per_class.csv of one metric: class, model, n, n_shapes, mean; ci95, half of the interval as the paper prints it; its ends `low` and
    `high` cut at the values that the metric can take, and `half`, which is NaN where that changed them. The model "Avg" is the mean over the
    competitors."""
    rows = of_metric(results.table("per_class"), dataset, metric)
    if rows.empty:
        raise Missing(f"per_class.csv has no {results.metric(metric).label} of {dataset}: there are no scores, or no classes.")
    low, high = cut(rows["ci95_low"], rows["mean"], rows["ci95_high"], of_program().get(metric, ProgramMetric(metric)))
    ci95 = (rows["ci95_high"] - rows["ci95_low"]) / 2
    half = ci95.where((low == rows["ci95_low"]) & (high == rows["ci95_high"]))
    return rows.assign(ci95=ci95, low=low, high=high, half=half).reset_index(drop=True)


def human_differences(results: Shown, metric: str) -> Frame:
    """Rows of human_curve_differences.csv of one metric: what more participants add, over the meshes that have both numbers."""
    table = results.table("human_curve_differences")
    rows = table[(table["metric"] == metric) & (table["n"] > 0)].dropna(subset=["from_participants", "to_participants"])
    if rows.empty:
        raise Missing(f"human_curve_differences.csv has no {results.metric(metric).label}: it takes four participants of a mesh.")
    return rows.reset_index(drop=True)


def one_more(table: Frame) -> Frame:
    """The rows of human_differences from each number of participants to the next."""
    return table[table["to_participants"] == table["from_participants"] + 1]


def human_shares(results: Shown, dataset: str, metric: str) -> dict[str, Row]:
    """model -> its row of human_share.csv; empty where there are none."""
    try:
        table = results.table("human_share")
    except Missing:
        return {}
    return {row["model"]: row for row in of_metric(table, dataset, metric).to_dict("records")}
