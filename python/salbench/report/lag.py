# SPDX-License-Identifier: GPL-3.0-or-later
"""How far each model is behind the one with the best mean, with intervals that are joint for all pairs of models: they leave out 0 where ranks
and groups have the two differ. Beside it what else readers of benchmarks look for [agarwal2021]."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import pandas

from salbench.conclusions.significance import joint_interval
from salbench.pages import dots
from salbench.pages.blocks import Block, Fold, Missing, Plot, attempt
from salbench.pages.names import DATASETS, several, spoken
from salbench.report import statistics, style
from salbench.report.drawing import Drawing
from salbench.report.figures import REFERENCES, draw_references, draw_rows
from salbench.report.metrics import Metric
from salbench.report.names import Looks, cut, panel_rows
from salbench.report.results import Frame, Results
from salbench.report.workshop import Workshop

NAN = float("nan")
MOST_NAMED = 14  # models of a legend


@dataclass(frozen=True)
class Behind(dots.Behind):
    """A model beside the best."""

    model: str = ""
    mean: float = NAN
    wins: float = NAN       # share of the units on which the best has the better score, ties half; and its own interval (Wilson)
    wins_low: float = NAN
    wins_high: float = NAN


def lags(results: Results, dataset: str, metric: str) -> list[Behind]:
    """The ranked models, the best first, then references: of the models that pages show."""
    ranked = statistics.ranking(results, dataset, metric).dropna(subset=["mean"])
    if ranked.empty:
        raise Missing(f"ranking.csv ranks no model by {results.metric(metric).label}.")
    best, first = ranked["model"].iloc[0], float(ranked["mean"].iloc[0])
    sign = -1 if results.metric(metric).lower else 1
    found = [Behind(0.0, model=best, mean=first)]
    found += [behind(results, dataset, metric, best, first, row.model, row.mean, sign) for row in ranked.iloc[1:].itertuples()]
    named = {one.model for one in found}
    means = statistics.compact(results, dataset, metric).dropna(subset=["mean"])
    return found + [Behind(sign * (row.mean - first), model=row.model, mean=row.mean) for row in means.itertuples() if row.model not in named]


def behind(results: Results, dataset: str, metric: str, best: str, of_best: float, model: str, mean: float, sign: int) -> Behind:
    try:
        pair = statistics.pair(results, dataset, metric, model, best)
    except Missing:
        return Behind(sign * (mean - of_best), model=model, mean=mean)
    distance = sign * pair["mean_difference"]
    shares = [1 - pair[name] if sign > 0 else pair[name] for name in statistics.SHARES]
    return Behind(distance, *joint_interval(distance, pair["t"], pair["t_bound"]), model, mean, shares[0], *sorted(shares[1:]))


# --- figures ---------------------------------------------------------------------------------------------------------

COLUMNS = ("metric", "model", "mean", "distance", "low", "high", "wins", "wins_low", "wins_high")


@dataclass(frozen=True)
class Panel:
    """A metric on a data set."""

    metric: Metric
    these: str                # Results.of_these
    models: list[Behind]      # that are ranked
    references: dict[str, float]  # model -> its distance behind the best
    groups: list[str]         # letters of each model
    profile: dict[str, list[float]]  # model -> its score on each unit, in ascending order


def panels_of(shop: Workshop, dataset: str) -> list[Panel]:
    found = []
    for metric in shop.results.leading:
        try:
            known = lags(shop.results, dataset, metric)
            groups = statistics.ranking(shop.results, dataset, metric).set_index("model")["group"].to_dict()
            units = statistics.by_unit(shop.results, statistics.scores(shop.results, dataset, metric)[list(groups)].dropna())
        except Missing:
            continue
        models = [one for one in known if one.model in groups]
        found.append(Panel(shop.results.metric(metric), shop.results.of_these, models, {one.model: one.distance for one in known if one.model in REFERENCES},
                           [groups[one.model] for one in models], {model: sorted(map(float, units[model])) for model in groups}))
    if not found:
        raise Missing(f"No model is ranked on {spoken(dataset)}.")
    return found


def tables(shop: Workshop) -> list[Block]:
    return [block for dataset in statistics.shown(shop.results) for block in attempt(figures, shop, dataset)]


def figures(shop: Workshop, dataset: str) -> list[Block]:
    panels = panels_of(shop, dataset)
    data = pandas.DataFrame([{"metric": panel.metric.name, **vars(one)} for panel in panels for one in panel.models], columns=COLUMNS)
    profiles = pandas.DataFrame([(panel.metric.name, model, score) for panel in panels for model, scores in panel.profile.items()
                                 for score in scores], columns=["metric", "model", "score"])
    groups = pandas.DataFrame([(panel.metric.name, one.model, one.mean, group) for panel in panels
                               for one, group in zip(panel.models, panel.groups)], columns=["metric", "model", "mean", "group"])
    name, unit = DATASETS[dataset], shop.results.unit or "unit"
    units, these = several(2, unit).removeprefix("2 "), shop.results.of_these
    rows = panel_rows((one.model for panel in panels for one in panel.models), len(panels))
    height = rows * (0.36 * max(len(panel.models) for panel in panels) + 1.2)
    said = "; ".join(f"{panel.metric.label}: " + ", ".join(f"{one.model} {one.distance:.3f}" for one in panel.models) for panel in panels)

    def plot(kind: str, draw: Callable[..., None], high: float, table: Frame, alt: str, caption: str) -> Plot:
        return shop.plot(f"{kind}-{dataset}", Drawing(draw, (panels, shop.looks, rows), (11, high), layout=None), table, alt, f"{name}: {caption}")
    return [
        plot("lag", draw_lags, height, data, f"Distance of each model behind the best mean{these}. {said}.".replace("-", "−"),
             f"how far each model is behind the best mean{these}, with 95 % intervals that are joint for all pairs of models. One that leaves "
             "out 0 shows that the model is behind; one that does not shows neither that it is nor that it is not."),
        Fold(f"{name}: probability of improvement, performance profile, critical differences", [
            plot("wins", draw_wins, height, data, f"On how large a share of the units the model with the best mean{these} scores better than each other.",
                 f"probability that the model with the best mean{these} scores better on a new {unit} than each other model, with the 95 % interval of "
                 "that pair alone (Wilson). 0.5: as often as not."),
            plot("profile", draw_profiles, 3.6, profiles, "Share of the units on which each model reaches a score.",
                 f"on which share of the {units} each model reaches a score. It describes these, and has no interval."),
            plot("differences", draw_differences, 2.6, groups, "Models by their mean; lines join, at their dots, those that are not shown to differ.",
                 "models at their means. A line joins, at its dots, models that are not shown to differ when all pairs are compared at once: the groups of "
                 "the ranking, in place of Nemenyi's test of mean ranks.")])]


def columns(figure: Any, panels: Sequence[Panel], left: float, right: float, rows: int = 1) -> Iterator[tuple[Any, Panel]]:
    """Axes and what they show, one beside or below the other, with inches free beside each. A layout that measures would take as long as
    drawing."""
    width, height = figure.get_size_inches()
    wide, high, below, above = width * rows / len(panels), height / rows, 0.55, 0.6
    for at, panel in enumerate(panels):
        row, column = divmod(at, len(panels) // rows)
        place = (column * wide + left) / width, 1 - ((row + 1) * high - below) / height
        yield figure.add_axes([*place, (wide - left - right) / width, (high - below - above) / height]), panel


def beside(panels: Sequence[Panel]) -> float:
    """Inches that the names of models take."""
    return 0.25 + 0.085 * max(len(cut(one.model)) for panel in panels for one in panel.models)


def draw_lags(figure: Any, panels: Sequence[Panel], looks: Looks, rows: int) -> None:
    for axes, panel in columns(figure, panels, beside(panels), 0.75, rows):
        draw_rows(axes, [(one.model, one.distance, one.low, one.high) for one in panel.models], looks, 3)
        axes.set_title(panel.metric.label, pad=26)  # above the names of references
        axes.axvline(0, color=looks.colours.get(panel.models[0].model), lw=1.2, zorder=1)
        draw_references(axes, panel.references)
        axes.set_xlabel(f"Mean {panel.metric.label}, behind the best{panel.these}")


def draw_wins(figure: Any, panels: Sequence[Panel], looks: Looks, rows: int) -> None:
    for axes, panel in columns(figure, panels, beside(panels), 0.75, rows):
        draw_rows(axes, [(one.model, one.wins, one.wins_low, one.wins_high) for one in panel.models[1:]], looks, 2)
        axes.set_title(panel.metric.label)
        axes.axvline(0.5, color="#555555", lw=1.1, ls=(0, (2, 2)), zorder=1)
        axes.set(xlim=(-0.02, 1.02), xlabel=f"{cut(panel.models[0].model)} is better than")


def draw_profiles(figure: Any, panels: Sequence[Panel], looks: Looks, _: int) -> None:
    for axes, panel in columns(figure, panels, 0.65, 0.15):
        for model, scores in panel.profile.items():
            n = len(scores)
            reached = [(at + 1) / n for at in range(n)] if panel.metric.lower else [1 - at / n for at in range(n)]
            axes.plot(scores, reached, drawstyle="steps-post" if panel.metric.lower else "steps-pre", color=looks.colours.get(model),
                      ls=looks.dashes.get(model, "-"), lw=1.8, marker=looks.markers.get(model, "o"), ms=4, markevery=max(1, n // 6), label=cut(model))
        axes.set(ylim=(0, 1.02), xlabel=f"{panel.metric.label}, at {'most' if panel.metric.lower else 'least'}", ylabel="Share")
        axes.set_title(panel.metric.label)
    if sum(len(panel.profile) for panel in panels[:1]) <= MOST_NAMED:
        axes.legend(loc="lower right" if panels[-1].metric.lower else "upper right", fontsize=9)  # where no curve is


def draw_differences(figure: Any, panels: Sequence[Panel], looks: Looks, _: int) -> None:
    for axes, panel in columns(figure, panels, 0.2, 0.2):
        means = [one.mean for one in panel.models]
        low, high = min(means), max(means)
        span = (high - low) or 1.0
        order = sorted(range(len(means)), key=lambda at: means[at])
        for at, place in zip(order, style.spread([(means[at] - low) / span for at in order], 0.11)):
            model = panel.models[at].model
            axes.annotate(cut(model), (means[at], 0), (low + place * span, 0.5), ha="center", fontsize=9, color=looks.colours.get(model),
                          annotation_clip=False, arrowprops={"arrowstyle": "-", "color": style.INK, "lw": 0.7})
        axes.plot(means, [0] * len(means), color=style.INK, marker="o", ms=5, ls="none", clip_on=False, zorder=3)
        letters = sorted(set("".join(panel.groups)))
        for depth, letter in enumerate(letters, 1):
            members = [mean for mean, group in zip(means, panel.groups) if letter in group]
            axes.plot(members, [-0.28 * depth] * len(members), color=style.INK, lw=2.5, marker="o", ms=5)  # others may lie between
        axes.set(ylim=(-0.28 * (len(letters) + 1), 0.8), xlabel=f"Mean {panel.metric.label}", yticks=[])
        axes.set_xlim(*((low - 0.06 * span, high + 0.06 * span)[::-1 if panel.metric.lower else 1]))
        axes.axhline(0, color=style.INK, lw=1)
        axes.grid(visible=False)
        axes.spines["left"].set_visible(False)
        axes.set_title(panel.metric.label)
