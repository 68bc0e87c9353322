# SPDX-License-Identifier: GPL-3.0-or-later
"""What was fitted to the maps, so that they can be read as densities (fitted.csv)."""

from typing import Any

from salbench.pages.blocks import Block, attempt
from salbench.pages.names import DATASETS, spoken
from salbench.report import names, statistics
from salbench.report.drawing import Drawing
from salbench.report.results import Frame, Results
from salbench.report.workshop import Workshop

AXES = {"value": "Value of the blurred map", "distance": "Distance from the centroid, R"}


def figures(shop: Workshop) -> list[Block]:
    fitted = set(shop.results.table("fitted")["dataset"])
    return [block for dataset in statistics.shown(shop.results) if dataset in fitted for block in attempt(plot, shop, dataset)]


def data_of(results: Results, dataset: str) -> Frame:
    """Rows of fitted.csv, log_density as the mean over the folds and 0 at its mean over each curve; the mean blur with it."""
    table = results.table("fitted")
    means = table[table["dataset"] == dataset].groupby(["model", "of", "at"], sort=False)[["log_density", "blur"]].mean().reset_index()
    means["log_density"] -= means.groupby(["model", "of"])["log_density"].transform("mean")
    return means


def draw(figure: Any, data: Frame) -> None:
    looks = names.looks(list(data["model"].unique()))
    for axes, (of, label) in zip(figure.subplots(1, 2, sharey=True), AXES.items()):
        for model, curve in data[data["of"] == of].groupby("model", sort=False):
            axes.plot(curve["at"], curve["log_density"], color=looks.colours[model], ls=looks.dashes[model], marker=looks.markers[model],
                      ms=4, markevery=4, label=names.cut(model))
        axes.set(xlim=(0, 1), xlabel=label)
    figure.axes[0].set_ylabel("Logarithm of the density")
    figure.axes[1].legend(fontsize=8)


def plot(shop: Workshop, dataset: str) -> Block:
    data = data_of(shop.results, dataset)
    blurs = ", ".join(f"{model} {blur:.3f}" for model, blur in data.groupby("model", sort=False)["blur"].first().items())
    return shop.plot(f"fitted-{dataset}", Drawing(draw, (data,), (8, 3.8)), data,
                     f"Logarithm of the fitted density on {spoken(dataset)}, by value and by distance from the centroid.",
                     f"{DATASETS[dataset]}: how the density that is fitted to each model's maps follows from their values, and from the "
                     f"distance from the centroid; means over the folds, each curve about 0. Blur of the maps, in R: {blurs}.")
