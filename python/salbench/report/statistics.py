# SPDX-License-Identifier: GPL-3.0-or-later
"""Look-ups in the program's tables for pages: data sets, models, rows by metric, scores by shape."""

from collections.abc import Iterable

import numpy
import pandas

from salbench.conclusions.metrics import Metric, of_program
from salbench.conclusions.ranked import cut
from salbench.conclusions.units import DATASETS, REFERENCES
from salbench.pages.blocks import Missing
from salbench.report.exports import Shape
from salbench.report.names import natural
from salbench.report.results import NO_METRICS, Frame, Shown

OF_A_SCORE = ["item", "view", "model"]


def datasets(results: Shown) -> list[str]:
    """Data sets with scores, in the program's order."""
    try:
        present = set(results.table("results")["dataset"])
    except Missing:
        present = set(results.table("summary")["dataset"])
    return [dataset for dataset in DATASETS if dataset in present]


def shown(results: Shown) -> list[str]:
    """Data sets with scores, and those that the run requested, since pages report missing ones."""
    try:
        scored = datasets(results)
    except Missing:
        scored = []
    meshes = (
        results.option("dataset.meshes") != "false"
        and results.record.get("data_set", {}).get("meshes") != "0"
    )
    asked = {
        "meshes": meshes,
        "scans": meshes and results.option("dataset.scans") != "false",
        "clouds": False,
    }
    return [dataset for dataset in DATASETS if dataset in scored or asked[dataset]]


def models(results: Shown) -> list[str]:
    """Every model named in a table, in the order of the configuration, your own first."""
    found = list(results.record.get("configuration", {}).get("models", []))
    for name in ("summary", "results"):
        if results.has(name):
            found += list(results.table(name)["model"].unique())
    known = [
        model
        for model in dict.fromkeys(found)
        if model and (not results.wanted_models or model in results.wanted_models)
    ]
    return sorted(known, key=lambda model: model != results.mine)


def scores(results: Shown, dataset: str, metric: str) -> Frame:
    """One row per shape (index item, view), one column per model; NaN if a score is undefined or missing."""
    table = results.table("results")
    if metric not in table:
        raise Missing(f"results.csv has no column {metric}: the run did not compute it.")
    if dataset not in results.wide:
        rows = table[table["dataset"] == dataset].drop_duplicates(OF_A_SCORE, keep="last")
        if rows.empty:
            raise Missing(
                f"results.csv has no scores of {dataset}: none of them has ground truth, or the run left them"
                " out."
            )
        wide = rows.set_index(OF_A_SCORE).drop(columns=NO_METRICS, errors="ignore").unstack("model")
        results.wide[dataset] = wide.loc[
            sorted(wide.index, key=lambda shape: (natural(shape[0]), natural(shape[1])))
        ]
    of_metric = results.wide[dataset][metric]
    known = pandas.Index([model for model in models(results) if model in of_metric], name="model")
    # Contiguous rows, since the last digit of means depends on the layout.
    return pandas.DataFrame(numpy.ascontiguousarray(of_metric[known]), of_metric.index, known)


def classes(results: Shown) -> dict[str, str]:
    """item -> class."""
    table = results.table("results")
    return dict(zip(table["item"], table["class"]))


def left_out(results: Shown) -> dict[str, set[str]]:
    """item -> names of the people whose gaze is not in its ground truth."""
    if not results.has("gaze"):
        return {}
    table = results.table("gaze")
    return {item: set(people) for item, people in table[table["left_out"] != ""].groupby("item")["person"]}


def mean_per_shape(results: Shown, dataset: str, metric: str) -> pandas.Series:
    """Mean over the competing models per shape, or over the references if none competes, worst first;
    without shapes that have no score."""
    wide = scores(results, dataset, metric)
    means = wide[[model for model in wide if model not in REFERENCES] or list(wide)].mean(axis=1).dropna()
    return means.sort_values(ascending=not results.metric(metric).lower, kind="stable")


class Scores:
    """Scores and ranks of all shapes under the leading metrics, by shape: read once for all pages."""

    def __init__(self, results: Shown) -> None:
        self.metrics = results.leading
        self._known: dict[tuple[str, str, str, str], dict[str, tuple[float, float, int]]] = {}
        for dataset in DATASETS:
            for metric, of in self.metrics.items():
                try:
                    wide = scores(results, dataset, metric)
                except Missing:
                    continue
                ranks, counts = (
                    wide.rank(ascending=of.lower, method="min").to_dict("index"),
                    wide.notna().sum().to_dict(),
                )
                for (item, view), row in wide.to_dict("index").items():
                    self._known[metric, dataset, item, view] = {
                        model: (value, ranks[item, view][model], counts[model])
                        for model, value in row.items()
                    }

    def of(self, metric: str, dataset: str, item: str, view: str = "") -> dict[str, tuple[float, float, int]]:
        """model -> (score, rank within the data set, 1 for the best score, number of ranked shapes), for the
        models with rows of this shape."""
        return self._known.get((metric, dataset, item, view), {})

    def best(self, metric: str, dataset: str, item: str, view: str = "") -> set[str]:
        """Models with the best score of the shape."""
        return self.metrics[metric].best(
            {model: value for model, (value, _, _) in self.of(metric, dataset, item, view).items()}
        )

    def pieces(self, shape: Shape, model: str, when: str = "") -> list[tuple[str, bool]]:
        """Scores of a map as text, each with True if it is the best of several competing models. when:
        restricts to metrics whose maps the picture "before" or "after" matching shows."""
        found = []
        for metric in (name for name, of in self.metrics.items() if when in ("", of.pictured)):
            scores = {
                name: score
                for name, (score, _, _) in self.of(metric, shape.dataset, shape.item, shape.view).items()
                if score == score
            }
            competing = {name: score for name, score in scores.items() if name not in REFERENCES}
            found.append(
                (
                    f"{scores[model]:.2f}".replace("-", "−") if model in scores else "–",
                    len(competing) > 1 and model in self.metrics[metric].best(competing),
                )
            )
        return found

    def dataset_of(self, item: str) -> str:
        """Data set of a mesh or point cloud that has scores."""
        return "clouds" if any(self.of(metric, "clouds", item) for metric in self.metrics) else "meshes"

    def views(self, item: str) -> list[str]:
        return sorted(
            {view for _, dataset, name, view in self._known if (dataset, name) == ("scans", item)},
            key=natural,
        )


def compact(results: Shown, dataset: str, metric: str) -> Frame:
    """Rows of compact.csv for one metric, in its order: competitors by rank, then references."""
    rows = results.rows("compact", dataset, metric)
    if rows.empty:
        raise Missing(f"compact.csv has no {metric} of {dataset}.")
    return rows


def summary(results: Shown, dataset: str, metric: str) -> Frame:
    """Rows of summary.csv for one metric, best mean first."""
    rows = results.rows("summary", dataset, metric)
    if rows.empty:
        raise Missing(f"summary.csv has no {metric} of {dataset}.")
    return rows.sort_values(
        "mean", ascending=results.metric(metric).lower, kind="stable", na_position="last", ignore_index=True
    )


def per_class(results: Shown, dataset: str, metric: str) -> Frame:
    """Rows of per_class.csv for one metric, with interval ends `low` and `high` clipped to the range of the
    metric, and `half` of the interval, which is NaN if they were clipped. The model "Avg" is the mean over
    the competitors."""
    rows = results.rows("per_class", dataset, metric)
    if rows.empty:
        raise Missing(
            f"per_class.csv has no {results.metric(metric).label} of {dataset}: there are no scores, or no"
            " classes."
        )
    low, high = cut(
        rows["ci95_low"], rows["mean"], rows["ci95_high"], of_program().get(metric, Metric(metric))
    )
    half = ((rows["ci95_high"] - rows["ci95_low"]) / 2).where(
        (low == rows["ci95_low"]) & (high == rows["ci95_high"])
    )
    return rows.assign(low=low, high=high, half=half)


def one_more(results: Shown, metrics: Iterable[str]) -> Frame:
    """Rows of human_curve_differences.csv for some metrics, from each number of participants to the next,
    over the meshes that have both."""
    table = results.table("human_curve_differences")
    table = table[(table["n"] > 0) & (table["to_participants"] == table["from_participants"] + 1)]
    return pandas.concat([table[table["metric"] == metric] for metric in metrics])
