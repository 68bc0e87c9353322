# SPDX-License-Identifier: GPL-3.0-or-later
"""The paper's diagrams. `..._data` gives the numbers of a diagram, the function beside it draws them."""

import numpy
import pandas

from report import statistics, style
from report.metrics import family_of
from report.names import DATASETS, spoken
from report.results import Missing


def cumulative_data(results, dataset):
    """Column value: right ends of 100 bins of [0, 1] after a 0; then the share of points at or below it, per model."""
    name = f"mean_histograms_{dataset}.csv"
    table = results.table(name, "bin_left")
    columns = [column for column in table if column != "bin_left" and table[column].sum() > 0]
    if not columns:
        raise Missing(f"{name} holds no distribution: the run left the {spoken(dataset)} out.")
    density = table[columns].to_numpy()
    shares = numpy.vstack([numpy.zeros(len(columns)), density.cumsum(axis=0) / density.sum(axis=0)])
    edges = numpy.append(table["bin_left"].to_numpy(), 1.0)
    return pandas.DataFrame({"value": edges, **dict(zip(columns, shares.T))})


def cumulative(shop, dataset):
    data = cumulative_data(shop.results, dataset)
    figure = style.new_figure(7, 4.4)
    axes = figure.subplots()
    for column in data.columns[1:]:
        ground_truth = column == "GS"
        axes.plot(data["value"], data[column], label="Ground truth" if ground_truth else column,
                  color="black" if ground_truth else shop.colours.get(column), lw=2.4 if ground_truth else 1.8,
                  ls=shop.dashes.get(column, "-"))
    axes.set(xlim=(0, 1), ylim=(0, 1.01), xlabel="Saliency", ylabel="Share of points at or below")
    axes.legend(loc="lower right")
    medians = ", ".join(f"{column} {numpy.interp(0.5, data[column], data['value']):.2f}" for column in data.columns[1:])
    return shop.plot(f"distributions-{dataset}", figure, data,
                     f"Cumulative distributions of saliency on {spoken(dataset)}; half of the points lie below: {medians}.",
                     f"{DATASETS[dataset]}: mean cumulative distribution of the ground truth and of each model's maps "
                     "before histogram matching.")


def ranking_data(results, dataset, metric):
    """Columns model, n, mean, ci95_low, ci95_high: rows of summary.csv, best mean first."""
    return statistics.summary(results, dataset, metric)[["model", "n", "mean", "ci95_low", "ci95_high"]]


def draw_ranking(axes, data, shop, metric):
    """Bars of the mean, best on top, with 95 % intervals."""
    data = data.dropna(subset=["mean"])
    at = numpy.arange(len(data))
    axes.barh(at, data["mean"], color=[shop.colours.get(model) for model in data["model"]], height=0.62)
    known = data["ci95_low"].notna().to_numpy()
    spread = (data[["ci95_low", "ci95_high"]].sub(data["mean"], axis=0).abs().to_numpy().T)[:, known]
    axes.errorbar(data["mean"][known], at[known], xerr=spread, fmt="none", ecolor=style.INK, elinewidth=1.4, capsize=4)
    right = data["ci95_high"].fillna(data["mean"]).clip(lower=0)
    span = max(right.max(), 0.02) if len(data) else 1
    for y, x, mean in zip(at, right, data["mean"]):
        axes.annotate(f"{mean:.3f}", (x, y), xytext=(6, 0), textcoords="offset points", va="center")
    axes.set_yticks(at, data["model"])
    axes.invert_yaxis()
    axes.set_xlim(min(0, data["mean"].min() * 1.2) if len(data) else 0, span * 1.22)
    axes.grid(axis="y", visible=False)
    axes.set_xlabel(f"Mean {metric.label}" + (", lower is better" if metric.lower else ""))
    if family_of(metric.name) == "auc":
        axes.axvline(0.5, color="#555555", lw=1, ls=":")


def sentence(data):
    return ", ".join(f"{row.model} {row.mean:.3f}" for row in data.itertuples() if row.mean == row.mean)


def heat_data(results, dataset, metric):
    """Shapes by models, worst mean over the models first; columns item, view, mean, then one per model."""
    mean = statistics.mean_per_shape(results, dataset, metric)
    wide = statistics.scores(results, dataset, metric).loc[mean.index]
    lower = results.metric(metric).lower
    order = wide.mean().sort_values(ascending=lower, kind="stable", na_position="last").index
    return pandas.concat([mean.rename("mean"), wide[order]], axis=1).reset_index()


def performance(shop, dataset, metric):
    """The paper's panels of one metric: colour map, ranking, mean per shape."""
    of = shop.results.metric(metric)
    heat = heat_data(shop.results, dataset, metric)
    ranking = ranking_data(shop.results, dataset, metric)
    if heat.empty:
        raise Missing(f"No shape of the {spoken(dataset)} has a {of.label}.")
    models = list(heat.columns[3:])
    figure = style.new_figure(11, 4.6)
    panels = figure.subplot_mosaic([["map", "bars"], ["line", "bars"]], width_ratios=[1.75, 1], height_ratios=[1.1, 1])
    values = heat[models].to_numpy().T
    finite = values[numpy.isfinite(values)]
    low, high = numpy.percentile(finite, [1, 99]) if len(finite) else (0, 1)
    image = panels["map"].imshow(values, aspect="auto", interpolation="nearest", vmin=low, vmax=max(high, low + 1e-9),
                                 extent=(0.5, len(heat) + 0.5, len(models) - 0.5, -0.5))
    panels["map"].set_yticks(range(len(models)), models)
    panels["map"].grid(visible=False)
    figure.colorbar(image, ax=panels["map"], location="top", shrink=0.5, aspect=40, label=of.label, extend="both")
    rank = numpy.arange(1, len(heat) + 1)
    panels["line"].plot(rank, heat["mean"], color=style.INK, lw=1.6, marker="o" if len(heat) < 60 else "", ms=3.5)
    panels["line"].set(xlabel=f"Shapes, {'highest' if of.lower else 'lowest'} mean {of.label} first",
                       ylabel=f"Mean {of.label}")
    for panel in ("map", "line"):
        panels[panel].set_xlim(0.5, len(heat) + 0.5)
        panels[panel].xaxis.get_major_locator().set_params(integer=True)
    draw_ranking(panels["bars"], ranking, shop, of)
    name = f"performance-{dataset}-{shop.metric_files[metric]}"
    block = shop.plot(name, figure, heat,
                      f"{of.label} on {spoken(dataset)}, best model first: {sentence(ranking)}. The mean per shape runs from "
                      f"{heat['mean'].iloc[0]:.3f} to {heat['mean'].iloc[-1]:.3f} over {len(heat)} shapes.",
                      f"{of.label}: every shape under every model, shapes ordered by their mean; models ordered by "
                      "their mean, with 95 % confidence intervals; mean per shape.")
    return block


def rankings(shop, dataset):
    """Models ordered by mean, one panel per metric."""
    data, missing = {}, []
    for metric in shop.results.leading:
        try:
            data[metric] = ranking_data(shop.results, dataset, metric)
        except Missing as reason:
            missing.append(str(reason))
    if not data:
        raise Missing(" ".join(missing))
    figure = style.new_figure(11, 0.42 * max(len(table) for table in data.values()) + 1.1)
    for axes, (metric, table) in zip(figure.subplots(1, len(data), squeeze=False)[0], data.items()):
        of = shop.results.metric(metric)
        draw_ranking(axes, table, shop, of)
        axes.set_title(of.label)
    text = "; ".join(f"{shop.results.metric(metric).label}: {sentence(table)}" for metric, table in data.items())
    plotted = pandas.concat([table.assign(metric=metric) for metric, table in data.items()])
    return shop.plot(f"ranking-{dataset}", figure, plotted, f"Models on {spoken(dataset)}, best first. {text}.",
                     f"{DATASETS[dataset]}: models ordered by their mean, with 95 % confidence intervals.")


def human_data(results, metric):
    """Columns n, n_meshes, mean, ci95_low, ci95_high of human_curve.csv."""
    columns = ["n", "n_meshes", "mean", "ci95_low", "ci95_high"]
    table = results.table("human_curve.csv", "metric", *columns)
    rows = table[table["metric"] == metric][columns].dropna(subset=["n", "mean"]).reset_index(drop=True)
    if rows.empty:
        raise Missing(f"human_curve.csv has no {results.metric(metric).label}.")
    return rows


def human_curves(shop):
    """n participants against n others, one panel per metric, with each model's mean as a line across."""
    data = {metric: human_data(shop.results, metric) for metric in shop.results.leading}
    figure = style.new_figure(11, 4.1)
    for axes, (metric, table) in zip(figure.subplots(1, len(data)), data.items()):
        if shop.results.has("summary.csv"):
            for row in statistics.summary(shop.results, "meshes", metric).itertuples():
                if row.model not in ("HS", "RS"):
                    axes.axhline(row.mean, color=shop.colours.get(row.model), lw=1.2, ls="--", label=row.model)
        axes.fill_between(table["n"], table["ci95_low"], table["ci95_high"], color="#E69F00", alpha=0.3, lw=0)
        axes.plot(table["n"], table["mean"], color=style.INK, lw=2, marker="o", ms=4, label="participants")
        label = shop.results.metric(metric).label
        axes.set(title=label, xlabel="Participants n", ylabel=f"Mean {label}")
        axes.set_xticks(range(1, int(table["n"].max()) + 1, 2))
    axes.legend(loc="lower right", ncol=2, fontsize=9, handlelength=1.4, columnspacing=1)
    ends = "; ".join(f"{shop.results.metric(metric).label} from {table['mean'].iloc[0]:.3f} to {table['mean'].iloc[-1]:.3f}"
                     for metric, table in data.items())
    plotted = pandas.concat([table.assign(metric=metric) for metric, table in data.items()])
    return shop.plot("human-curves", figure, plotted,
                     f"n participants against n others, n = 1 to {int(table['n'].max())}: {ends}.",
                     "How well n participants predict n others, with the 95 % interval; dashed: each model's mean, against all participants.")
