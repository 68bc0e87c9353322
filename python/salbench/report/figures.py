# SPDX-License-Identifier: GPL-3.0-or-later
"""The paper's diagrams. `..._data` returns the numbers of a diagram, the function beside it draws them."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy
import pandas

from salbench.pages.blocks import Missing, Plot
from salbench.pages.dots import LINES
from salbench.pages.looks import Look, looks_of
from salbench.pages.names import DATASETS, spoken
from salbench.report import names, statistics, style
from salbench.report.drawing import Drawing
from salbench.report.metrics import Metric
from salbench.report.results import Frame, Shown
from salbench.report.report import Report


def cumulative_data(results: Shown, dataset: str) -> Frame:
    """Column value: 0, then the right ends of 100 bins of [0, 1]; then per model the fraction of points at or
    below it."""
    name = f"mean_histograms_{dataset}"
    table = results.table(name)
    columns = [column for column in table if column != "bin_left" and table[column].sum() > 0]
    if not columns:
        raise Missing(f"{name}.csv holds no distribution: the run left the {spoken(dataset)} out.")
    density = table[columns].to_numpy()
    shares = numpy.vstack([numpy.zeros(len(columns)), density.cumsum(axis=0) / density.sum(axis=0)])
    edges = numpy.append(table["bin_left"].to_numpy(), 1.0)
    return pandas.DataFrame({"value": edges, **dict(zip(columns, shares.T))})


def draw_cumulative(figure: Any, data: Frame, looks: Mapping[str, Look]) -> None:
    axes = figure.subplots()
    columns = list(data.columns[1:])
    short = names.short(columns)
    for at, column in enumerate(columns):
        axes.plot(
            data["value"],
            data[column],
            color=looks[column].colour,
            ls=looks[column].dash,
            lw=2.4 if column == "GS" else 1.8,
            marker=looks[column].marker,
            ms=5,
            markevery=(3 + 2 * at, 16),
        )
    axes.set(xlim=(0, 1), ylim=(0, 1.01), xlabel="Saliency", ylabel="Share of points at or below")
    # All curves end at 1, 1: each is labelled at its own fraction of the way there, highest first.
    order = sorted(columns, key=lambda column: -float(data[column].sum()))
    for part, column in zip(numpy.linspace(0.86, 0.3, len(order)), order):
        axes.annotate(
            "Ground truth" if column == "GS" else short[column],
            (numpy.interp(part, data[column], data["value"]), part),
            xytext=(5, 0),
            textcoords="offset points",
            va="center",
            fontsize=9,
            color=looks[column].colour,
            bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.6, "alpha": 0.85},
        )


def cumulative(report: Report, dataset: str) -> Plot:
    data = cumulative_data(report.results, dataset)
    medians = ", ".join(
        f"{column} {numpy.interp(0.5, data[column], data['value']):.2f}" for column in data.columns[1:]
    )
    return report.plot(
        f"distributions-{dataset}",
        Drawing(draw_cumulative, (data, looks_of([*report.models, *data.columns[1:]])), (7, 4.4)),
        data,
        (
            f"Cumulative distributions of saliency on {spoken(dataset)}; half of the points lie below:"
            f" {medians}."
        ),
        (
            f"{DATASETS[dataset]}: mean cumulative distribution of the ground truth and of each model's maps "
            "before histogram matching."
        ),
    )


def ranking_data(results: Shown, dataset: str, metric: str) -> Frame:
    """Columns model, n, mean, ci95_low, ci95_high: rows of summary.csv, best mean first, with intervals
    clipped as in compact.csv."""
    data = statistics.summary(results, dataset, metric)[
        ["model", "n", "mean", "ci95_low", "ci95_high"]
    ].copy()
    try:
        cut = statistics.compact(results, dataset, metric).set_index("model")
    except Missing:
        return data
    for column, of in (("ci95_low", "low"), ("ci95_high", "high")):
        data[column] = data["model"].map(cut[of]).fillna(data[column])
    return data


DASHES = {"RS": (0, (2, 2)), "HS": (0, (7, 3))}  # of the line of a reference


def draw_references(axes: Any, places: Mapping[str, float]) -> None:
    """Draws a named line per reference; the names have separate rows, since references may be close
    together."""
    for at, (model, value) in enumerate(places.items()):
        axes.axvline(value, color="#555555", lw=1.1, ls=DASHES[model], zorder=1)
        axes.annotate(
            LINES[model],
            (value, 1),
            (0, 1 + 10 * at),
            xycoords=("data", "axes fraction"),
            textcoords="offset points",
            fontsize=8,
            color="#555555",
            ha="center",
            va="bottom",
            annotation_clip=False,
            bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.4},
        )


def draw_rows(
    axes: Any, rows: Sequence[tuple[str, float, float, float]], looks: Mapping[str, Look], digits: int
) -> None:
    """Draws a row per model: a dot at the first number, a line between the others, and the first as text at
    the right."""
    for y, (model, at, low, high) in enumerate(rows):
        axes.plot([low, high], [y, y], color=style.INK, lw=1.4, marker="|", ms=7, mew=1.4, zorder=2)
        axes.plot([at], [y], color=looks[model].colour, marker=looks[model].marker, ms=8, ls="none", zorder=3)
        axes.annotate(
            "–" if at != at else f"{at:.{digits}f}".replace("-", "−"),
            (1.02, y),
            xycoords=("axes fraction", "data"),
            va="center",
            annotation_clip=False,
        )
    axes.set_yticks(range(len(rows)), list(names.short(row[0] for row in rows).values()))
    axes.set_ylim(max(len(rows), 1) - 0.5, -0.5)
    axes.grid(axis="y", visible=False)


def draw_ranking(axes: Any, data: Frame, looks: Mapping[str, Look], metric: Metric) -> None:
    """Draws means with 95 % intervals, best on top, and references as named lines. The axis of an AUC begins
    at .5 unless something lies below."""
    data = data.dropna(subset=["mean"])
    low, high = data["ci95_low"].fillna(data["mean"]), data["ci95_high"].fillna(data["mean"])
    least, most = (low.min(), high.max()) if len(data) else (0, 1)
    margin = 0.06 * (most - least) or 0.05
    draw_rows(axes, list(zip(data["model"], data["mean"], low, high)), looks, 3)
    draw_references(axes, {row.model: row.mean for row in data.itertuples() if row.model in LINES})
    begin = 0.5 if metric.name.startswith("auc") and least >= 0.5 else least - margin
    axes.set_xlim(begin, most + margin)
    axes.set_xlabel(f"Mean {metric.label}" + (", lower is better" if metric.lower else ""))


def sentence(data: Frame) -> str:
    return ", ".join(f"{row.model} {row.mean:.3f}" for row in data.itertuples() if row.mean == row.mean)


def heat_data(results: Shown, dataset: str, metric: str) -> Frame:
    """Shapes by models, worst mean over the models first; columns item, view, mean, then one per model."""
    mean = statistics.mean_per_shape(results, dataset, metric)
    wide = statistics.scores(results, dataset, metric).loc[mean.index]
    lower = results.metric(metric).lower
    order = wide.mean().sort_values(ascending=lower, kind="stable", na_position="last").index
    return pandas.concat([mean.rename("mean"), wide[order]], axis=1).reset_index()


def performance(report: Report, dataset: str, metric: str) -> Plot:
    """Panels of the paper for one metric: colour map, ranking, mean per shape."""
    of = report.results.metric(metric)
    heat = heat_data(report.results, dataset, metric)
    ranking = ranking_data(report.results, dataset, metric)
    if heat.empty:
        raise Missing(f"No shape of the {spoken(dataset)} has a {of.label}.")
    name = f"performance-{dataset}-{report.metric_files[metric]}"
    height = 4.6 + 0.35 * max(0, len(ranking) - 10)  # room for the names of ten models, and of each more
    return report.plot(
        name,
        Drawing(draw_performance, (heat, ranking, of, report.looks), (11, height)),
        heat,
        (
            f"{of.label} on {spoken(dataset)}, best model first: {sentence(ranking)}. The mean per shape runs"
            f" from {heat['mean'].iloc[0]:.3f} to {heat['mean'].iloc[-1]:.3f} over {len(heat)} shapes."
        ),
        (
            f"{of.label}: every shape under every model, shapes ordered by their mean; models ordered by "
            "their mean, with 95 % confidence intervals; mean per shape, references aside."
        ),
    )


def draw_performance(figure: Any, heat: Frame, ranking: Frame, of: Metric, looks: Mapping[str, Look]) -> None:
    models = list(heat.columns[3:])
    panels = figure.subplot_mosaic(
        [["map", "bars"], ["line", "bars"]], width_ratios=[1.75, 1], height_ratios=[1.1, 1]
    )
    values = heat[models].to_numpy().T
    finite = values[numpy.isfinite(values)]
    low, high = numpy.percentile(finite, [1, 99]) if len(finite) else (0, 1)
    image = panels["map"].imshow(
        values,
        aspect="auto",
        interpolation="nearest",
        vmin=low,
        vmax=max(high, low + 1e-9),
        extent=(0.5, len(heat) + 0.5, len(models) - 0.5, -0.5),
    )
    panels["map"].set_yticks(range(len(models)), list(names.short(models).values()))
    panels["map"].grid(visible=False)
    figure.colorbar(
        image, ax=panels["map"], location="top", shrink=0.5, aspect=40, label=of.label, extend="both"
    )
    rank = numpy.arange(1, len(heat) + 1)
    panels["line"].plot(
        rank, heat["mean"], color=style.INK, lw=1.6, marker="o" if len(heat) < 60 else "", ms=3.5
    )
    panels["line"].set(
        xlabel=f"Shapes, {'highest' if of.lower else 'lowest'} mean {of.label} first",
        ylabel=f"Mean {of.label}",
    )
    for panel in ("map", "line"):
        panels[panel].set_xlim(0.5, len(heat) + 0.5)
        panels[panel].xaxis.get_major_locator().set_params(integer=True)
    draw_ranking(panels["bars"], ranking, looks, of)


def rankings(report: Report, dataset: str) -> Plot:
    """Models ordered by mean, one panel per metric."""
    data, missing = {}, []
    for metric in report.results.leading:
        try:
            data[metric] = ranking_data(report.results, dataset, metric)
        except Missing as reason:
            missing.append(str(reason))
    if not data:
        raise Missing(" ".join(missing))
    panels = [(report.results.metric(metric), table) for metric, table in data.items()]
    rows = names.panel_rows(report.models, len(data))
    height = rows * (0.42 * max(len(table) for table in data.values()) + 1.2)
    text = "; ".join(
        f"{report.results.metric(metric).label}: {sentence(table)}" for metric, table in data.items()
    )
    plotted = pandas.concat([table.assign(metric=metric) for metric, table in data.items()])
    return report.plot(
        f"ranking-{dataset}",
        Drawing(draw_rankings, (panels, report.looks, rows), (11, height)),
        plotted,
        f"Models on {spoken(dataset)}, best first. {text}.",
        f"{DATASETS[dataset]}: models ordered by their mean, with 95 % confidence intervals.",
    )


def draw_rankings(
    figure: Any, panels: Sequence[tuple[Metric, Frame]], looks: Mapping[str, Look], rows: int
) -> None:
    for axes, (of, table) in zip(figure.subplots(rows, len(panels) // rows, squeeze=False).flat, panels):
        draw_ranking(axes, table, looks, of)
        axes.set_title(of.label, pad=26)


def human_data(results: Shown, metric: str) -> Frame:
    """Columns n, n_meshes, mean, ci95_low, ci95_high of human_curve.csv."""
    columns = ["n", "n_meshes", "mean", "ci95_low", "ci95_high"]
    table = results.table("human_curve")
    rows = table[table["metric"] == metric][columns].dropna(subset=["n", "mean"]).reset_index(drop=True)
    if rows.empty:
        raise Missing(f"human_curve.csv has no {results.metric(metric).label}.")
    return rows


def model_means(report: Report, metric: str) -> dict[str, float]:
    """model -> mean on meshes, without references."""
    if not report.results.has("summary"):
        return {}
    rows = statistics.summary(report.results, "meshes", metric).dropna(subset=["mean"])
    return {row.model: row.mean for row in rows.itertuples() if row.model not in LINES}


def draw_curve(axes: Any, table: Frame, means: Mapping[str, float], looks: Mapping[str, Look]) -> None:
    """Draws the human curve and a line per model, each named at its right end."""
    first, last = table["n"].min(), table["n"].max()
    axes.fill_between(table["n"], table["ci95_low"], table["ci95_high"], color="#E69F00", alpha=0.3, lw=0)
    if first == last:  # two or three participants
        axes.vlines(table["n"], table["ci95_low"], table["ci95_high"], color="#E69F00", alpha=0.3, lw=8)
        first, last = first - 0.5, last + 0.5
    axes.plot(table["n"], table["mean"], color=style.INK, lw=2, marker="o", ms=4)
    for model, mean in means.items():
        axes.plot([first, last], [mean, mean], color=looks[model].colour, lw=1.4, ls=looks[model].dash)
    short = names.short(means)
    values = [*table["mean"], *table["ci95_low"].dropna(), *table["ci95_high"].dropna(), *means.values()]
    margin = 0.05 * (max(values) - min(values)) or 0.05
    limits = (min(values) - margin, max(values) + margin)
    axes.set_ylim(*limits)
    axes.set_xlim(first, last)
    axes.set_xticks(range(1, int(last) + 1, 2))
    style.label_ends(
        axes,
        [(mean, short[model], looks[model].colour) for model, mean in means.items()]
        + [(table["mean"].iloc[-1], "people", style.INK)],
        limits,
        3.2,
    )


def human_curves(report: Report) -> Plot:
    """Curves of n participants against n others, one panel per metric, with a horizontal line at each model's
    mean."""
    data = {metric: human_data(report.results, metric) for metric in report.results.leading}
    panels = [
        (report.results.metric(metric).label, table, model_means(report, metric))
        for metric, table in data.items()
    ]
    ends = "; ".join(
        f"{report.results.metric(metric).label} from {table['mean'].iloc[0]:.3f} to"
        f" {table['mean'].iloc[-1]:.3f}"
        for metric, table in data.items()
    )
    plotted = pandas.concat([table.assign(metric=metric) for metric, table in data.items()])
    most = int(panels[-1][1]["n"].max())
    return report.plot(
        "human-curves",
        Drawing(draw_human_curves, (panels, report.looks), (11, 4.1)),
        plotted,
        f"n participants against n others, n = 1 to {most}: {ends}.",
        (
            "How well n participants predict n others, with the 95 % interval; lines across: each model's"
            " mean, against all participants."
        ),
    )


def draw_human_curves(
    figure: Any, panels: Sequence[tuple[str, Frame, Mapping[str, float]]], looks: Mapping[str, Look]
) -> None:
    for axes, (label, table, means) in zip(figure.subplots(1, len(panels), squeeze=False)[0], panels):
        draw_curve(axes, table, means, looks)
        axes.set(title=label, xlabel="Participants n", ylabel=f"Mean {label}")
