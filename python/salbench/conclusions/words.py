# SPDX-License-Identifier: GPL-3.0-or-later
"""Sentences about who leads, which claim no more than the intervals of the ranks allow."""

import math
from collections.abc import Container, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from salbench.conclusions.metrics import Metric
from salbench.conclusions.resampling import FEWEST

NO_SCORES = "There are no scores: no shape has ground truth, or none was finished."
_NAMED = 4  # models that a sentence lists
_SHORT = ("auc", "nss", "lcc", "cc", "kl", "sim", "ig", "sauc")  # in capitals, such as "AUC"
_OWN = ("by ", "one ", "no ")  # lower-case beginnings of our clauses; models keep their spelling
_REFERENCES = {"RS": "chance", "HS": "human performance"}
_SHAPES = {
    "meshes": ("mesh", "meshes"),
    "scans": ("scan", "scans"),
    "clouds": ("point cloud", "point clouds"),
}
_VIEWS = ("view", "views")
_WHOLE = {"scans": "meshes"}  # what a scan is a view of


@dataclass
class Leader:
    """The competitors at the top by one metric. Verdicts, from the pairs that differ in the simultaneous
    comparison:

    leads: one model is ahead of every other one.
    not behind: a single model is behind no other, but it is not ahead of all.
    not told apart: several models are behind no other.
    at chance: none of these is significantly ahead of chance and a constant map.
    only model; one unit; too few units: no ranks.
    no common shape: no shape has scores of all competitors.
    no variation: the two best have the same scores on all units, which are no more evidence than one.
    """

    metric: Metric
    verdict: str
    models: list[str] = field(default_factory=list)  # behind no other, best mean first
    best: str = ""  # model with the best mean
    mean: float = math.nan  # of the best model
    interval: tuple[float, float] = (math.nan, math.nan)  # of the mean, 95 %, within the range of the metric
    n: int = 0  # units
    n_shapes: int = 0
    # items that count as one observation, being equal in shape and ground truth
    copies: list[list[str]] = field(default_factory=list)
    in_views: bool = False  # the shapes are views of meshes or clouds, or scans
    n_missing: int = 0  # shapes left out because some, but not all competitors have a score
    # by competitor: number of missing shapes, and its rank if they were at chance
    missing: dict[str, tuple[int, float]] = field(default_factory=dict)
    near: list[str] = field(default_factory=list)  # "not behind": the models that it is not ahead of
    behind: list[str] = field(default_factory=list)  # models that one of `models` is ahead of
    second: str = ""  # next best mean; empty: none
    # lead of the best mean over the second, positive for either direction of the metric
    lead: float = math.nan
    lead_interval: tuple[float, float] = (math.nan, math.nan)  # 95 %: excludes 0 if the pair differs
    # those of `models` not significantly ahead of `baseline`
    not_ahead: list[str] = field(default_factory=list)
    # chance, a constant map or both; "at chance": the baseline that no model is significantly ahead of
    baseline: str = ""
    new_classes: "Leader | None" = None  # the same with classes as units, if there are enough


def without_rank(models: Iterable[str]) -> list[str]:
    """Returns a line that explains why references among the models have no rank, if there are any."""
    known = set(models)
    found = [f"{model} is {what}" for model, what in _REFERENCES.items() if model in known]
    why = "it, so it has" if len(found) == 1 else "them, so they have"
    return [f"{' and '.join(found)}: models are compared with {why} no rank."] if found else []


def sentence(dataset: str, of: str, unit: str, leaders: Sequence[Leader]) -> str:
    """States who leads by these metrics; those with equal leaders share a clause. Missing scores and new
    classes get separate sentences. of: the split, as of_split() names it."""
    if not leaders:
        return f"On {_SHAPES[dataset][1]}{of}, no model has scores but references."
    shapes = [_counted(dataset, unit, leader) + _without(leader) for leader in leaders]
    figures = [
        _figures(leader, place == 0, "" if over == shapes[0] else f", on {over}")
        for place, (leader, over) in enumerate(zip(leaders, shapes))
    ]
    said = f"On {shapes[0]}{of}, {_clauses(leaders, figures)}."
    copies = f"Copies, {counted_once(leaders[0].copies)}." if leaders[0].copies else ""
    return " ".join(
        filter(None, (said, _of_six(leaders), copies, _at_chance(leaders), _of_new_classes(leaders)))
    )


@dataclass(frozen=True)
class Brief:
    """Leaders by one metric, for short sentences. Fields without a comment are as in Leader."""

    label: str
    verdict: str
    models: Sequence[str]
    ranked: Sequence[str]  # all competitors, or those that are shown
    n_missing: int = 0
    new_classes: str = ""  # verdict; empty: unknown
    new_classes_models: Sequence[str] = ()
    not_ahead: Sequence[str] = ()
    baseline: str = ""
    shows_all: bool = True  # False: `ranked` lacks some


def brief_of(row: Mapping[str, Any], label: str, ranked: Sequence[str], shows_all: bool = True) -> Brief:
    """Brief of a row of leaders.csv."""
    n_missing = int(row["n_missing"]) if row["n_missing"] > 0 else 0
    return Brief(
        label,
        row["verdict"],
        names_in(row["leaders"]),
        ranked,
        n_missing,
        row["new_classes"],
        names_in(row["new_classes_leaders"]),
        names_in(row["not_ahead"]),
        row["baseline"],
        shows_all,
    )


def names_in(cell: str) -> list[str]:
    """Models in a cell of leaders.csv."""
    return list(filter(None, cell.split(", ")))


def brief(metrics: Sequence[Brief]) -> str:
    """States who leads, without figures and in about a dozen words: "LS, PS or CS may be best; MS is not
    (AUC, NSS)." Metrics are in brackets."""
    if not metrics:
        return "No model has scores."
    alike: dict[tuple[str, ...], list[Brief]] = {}
    for metric in metrics:
        alike.setdefault(
            (
                metric.verdict,
                *sorted(metric.models),
                metric.baseline if metric.verdict == "at chance" else "",
            ),
            [],
        ).append(metric)
    said = [
        f"{_in_brief(group[0], len(alike) == 1)} ({', '.join(metric.label for metric in group)})"
        for group in alike.values()
    ]
    known = [metric for metric in metrics if metric.new_classes]
    same = [
        metric.label
        for metric in known
        if (metric.new_classes, set(metric.new_classes_models)) == (metric.verdict, set(metric.models))
    ]
    on_new = "the same" if len(same) == len(known) else f"{listed(same)} only" if same else "not the same"
    missing = max(metric.n_missing for metric in metrics)
    not_ahead = [
        f"(Not shown to be ahead of {metric.baseline} by {metric.label}: {_named(list(metric.not_ahead))}.)"
        for metric in metrics
        if metric.not_ahead
    ]
    return " ".join(
        [
            f"{'; '.join(said)}.",
            *not_ahead,
            *([f"New classes: {on_new}."] if known else []),
            *(
                [f"({several(missing, 'shape', 'shapes')} left out: some model has no score there.)"]
                if missing
                else []
            ),
        ]
    )


def _in_brief(metric: Brief, alone: bool) -> str:
    """Clause for one metric. alone: the only clause, which has room for models that are not the best."""
    if metric.verdict == "leads":
        return f"{metric.models[0]} leads{' on these classes' if metric.new_classes else ''}"
    if metric.verdict == "not behind":
        return f"no model is ahead of {metric.models[0]}"
    if metric.verdict == "at chance":
        return f"no model is shown to be ahead of {metric.baseline}"
    if metric.verdict == "not told apart":
        others = [name for name in metric.ranked if name not in metric.models]
        if not others and not metric.not_ahead and metric.shows_all:
            return "any model may be best"
        not_best = f"; {_named(others)} {'is' if len(others) == 1 else 'are'} not" if alone and others else ""
        return f"{_named(list(metric.models), 'or')} may be best{not_best}"
    return {
        "only model": "there is one model alone",
        "no common shape": "no shape has scores of all models",
        "no variation": "the observations do not vary",
    }.get(metric.verdict, "too few observations to rank")


def _clauses(leaders: Sequence[Leader], figures: Sequence[str]) -> str:
    """One sentence per group of metrics with equal leaders, starting with the first metric's. figures: per
    metric, in brackets behind its label."""
    alike: dict[tuple[object, ...], tuple[Leader, list[str], list[str]]] = {}
    for leader, text in zip(leaders, figures):
        _, labels, metrics = alike.setdefault(
            (*_claim(leader), leader.verdict == "too few units" and leader.n), (leader, [], [])
        )
        labels.append(_label(leader.metric.name))
        metrics.append(f"{labels[-1]} ({text})" if text else labels[-1])
    first, *others = [_clause(*group) for group in alike.values()]
    more = [f"{text[0].upper()}{text[1:]}" if text.startswith(_OWN) else text for text in others[1:]]
    return ". ".join([first, *(f"Beside it, {text}" for text in others[:1]), *more])


def _claim(leader: Leader) -> tuple[object, ...]:
    """The content of a clause: equal for metrics that share one."""
    return (
        leader.verdict,
        frozenset(leader.models),
        frozenset(leader.near),
        frozenset(leader.behind),
        frozenset(leader.not_ahead),
        leader.baseline,
    )


def _not_ahead(models: Sequence[str], baseline: str) -> str:
    """Clause on models that are not significantly ahead of chance; empty if all are."""
    return (
        f"; {_named(list(models))} {'is' if len(models) == 1 else 'are'} not shown to be ahead of {baseline}"
        if models
        else ""
    )


def _clause(leader: Leader, labels: list[str], metrics: list[str]) -> str:
    models, by = leader.models, listed(metrics)
    if leader.verdict == "leads":
        return f"{models[0]} leads by {by}"
    if leader.verdict == "not behind":
        are = "is" if len(leader.near) == 1 else "are"
        return (
            f"by {by}, no model is ahead of {models[0]}, and {_named(leader.near)} {are} not shown to be"
            " behind it"
        )
    if leader.verdict == "not told apart":
        are = (
            f"; {_named(leader.behind)} {'is' if len(leader.behind) == 1 else 'are each'} behind at least one"
            " of them"
            if leader.behind
            else ""
        )
        return (
            f"by {by}, {_named(models, 'or')} may be best{are}{_not_ahead(leader.not_ahead, leader.baseline)}"
        )
    if leader.verdict == "at chance":
        return f"by {by}, no model is shown to be ahead of {leader.baseline}"
    if leader.verdict == "no variation":
        return (
            f"by {by}, the scores of {leader.best} and of {leader.second} do not vary, and all observations"
            " show no more than one"
        )
    if leader.verdict == "only model":
        return f"{models[0]} is the only model that is scored by {by}"
    if leader.verdict == "one unit":
        return f"one observation does not tell how the models rank by {listed(labels)}"
    if leader.verdict == "too few units":
        return (
            f"{leader.n} observations are too few to tell how the models rank by {listed(labels)}: it takes"
            f" {FEWEST}"
        )
    return f"no shape has scores of all models by {listed(labels)}"


def _without(leader: Leader) -> str:
    """Names the models whose missing scores exclude shapes, in the order of the ranking: " (A has no score on
    12)"."""
    lacking = [f"{name} has no score on {count}" for name, (count, _) in leader.missing.items()]
    return f" ({listed(_cut(lacking))})" if lacking and leader.n else ""


def _of_six(leaders: Sequence[Leader]) -> str:
    """Sentence for the smallest number of units that can separate models."""
    if not any(
        leader.n == FEWEST and leader.verdict in ("leads", "not behind", "not told apart")
        for leader in leaders
    ):
        return ""
    return f"{FEWEST} observations tell two models apart only if all of them agree (p = {2 / 2**FEWEST:.3f})."


def counted_once(copies: Sequence[Sequence[str]]) -> str:
    """Groups of equal items: "counted once: a and b; c, d and e"."""
    return f"counted once: {'; '.join(_cut([_named(list(group)) for group in copies]))}"


def _at_chance(leaders: Sequence[Leader]) -> str:
    """Sentence on every model named before: "With its missing scores at chance, A ranks 3 by AUC and NSS, 1
    by LCC."
    """
    ranks: dict[str, dict[str, list[str]]] = {}
    for leader in leaders:
        for name in _cut(list(leader.missing)):
            rank = leader.missing.get(name, (0, math.nan))[1]
            if not math.isnan(rank):
                ranks.setdefault(name, {}).setdefault(f"{rank:.0f}", []).append(_label(leader.metric.name))
    said = [
        f"{name} ranks {', '.join(f'{rank} by {listed(labels)}' for rank, labels in by_rank.items())}"
        for name, by_rank in ranks.items()
    ]
    return f"With missing scores at chance, {'; '.join(said)}." if said else ""


def _of_new_classes(leaders: Sequence[Leader]) -> str:
    """Metrics whose verdict generalises to new classes, "New classes: AUC only.", or else the weaker
    verdict."""
    pairs = [(leader, leader.new_classes) for leader in leaders if leader.new_classes]
    if not pairs:
        return ""
    if all(_claim(leader) == _claim(on_new) for leader, on_new in pairs):
        return "New classes: the same."
    leading = [(leader, on_new) for leader, on_new in pairs if on_new.verdict == "leads"]
    is_same = all((leader.verdict, leader.models) == ("leads", on_new.models) for leader, on_new in leading)
    if is_same and {(leader.verdict, *leader.models) for leader in leaders} == {
        ("leads", *on_new.models) for _, on_new in leading
    }:
        return f"New classes: {listed([_label(on_new.metric.name) for _, on_new in leading])} only."
    return f"New classes: {_clauses([on_new for _, on_new in pairs], [''] * len(pairs))}."


def _figures(leader: Leader, explained: bool, over: str) -> str:
    """Figures such as "mean 0.613, 95 % interval 0.590 to 0.636", with the model if that is ambiguous. over:
    the shapes, if they differ from those at the beginning of the sentence."""
    whose = f"{leader.best} " if leader.verdict in ("not told apart", "at chance", "no variation") else ""
    mean = f"{whose}{'mean ' if explained else ''}{leader.mean:.3f}"
    low, high = leader.interval
    if math.isnan(low):
        return f"{mean}{' on each' if leader.n > 1 else ', no interval'}{over}"
    return f"{mean}, {'95 % interval ' if explained else ''}{low:.3f} to {high:.3f}{over}"


def _counted(dataset: str, unit: str, leader: Leader) -> str:
    """Number of observations, such as "228 scans of 19 meshes", "12 views of 6 meshes", "48 of 60 meshes" or
    "393 meshes of these 20 classes"."""
    if leader.n == 0:
        return _SHAPES[dataset][1]
    shapes = f"{leader.n_shapes} of " if leader.n_missing else ""
    shapes += several(leader.n_shapes + leader.n_missing, *_of_a_shape(dataset, leader.in_views))
    if leader.in_views and unit == "mesh":
        shapes += f" of {several(leader.n, *_SHAPES[_WHOLE.get(dataset, dataset)])}"
    elif leader.copies and unit != "class":
        shapes += f" ({leader.n} without copies)"
    if unit == "class":
        return f"{shapes} of {several(leader.n, 'class', 'classes')}"
    classes = leader.new_classes
    all_have_one = classes is not None and classes.n > 0 and classes.n_shapes == leader.n_shapes
    return (
        f"{shapes} of these {several(classes.n, 'class', 'classes')}" if classes and all_have_one else shapes
    )


def observation(unit: str, datasets: Iterable[str], in_views: Container[str]) -> str:
    """Unit of observation of these data sets: "mesh", "mesh or point cloud", "class of shapes". in_views: those
    whose shapes are views."""
    if unit == "class":
        return "class of shapes"
    units = (
        _SHAPES[_WHOLE.get(dataset, dataset)] if unit == "mesh" else _of_a_shape(dataset, dataset in in_views)
        for dataset in datasets
    )
    return listed(list(dict.fromkeys(one for one, _ in units)), "or")


def _of_a_shape(dataset: str, in_views: bool) -> tuple[str, str]:
    """Noun and plural for one shape of a data set."""
    return _VIEWS if in_views and dataset != "scans" else _SHAPES[dataset]


def of_split(split: str, in_splits: bool) -> str:
    """Phrase such as " of split test" or " of all splits", empty without splits."""
    return f" of split {split}" if split else " of all splits" if in_splits else ""


def several(n: int, one: str, more: str) -> str:
    return f"{n} {one if n == 1 else more}"


def _label(metric: str) -> str:
    return metric.upper() if metric in _SHORT else metric


def _named(models: list[str], last: str = "and") -> str:
    return listed(_cut(models), last)


def _cut(names: list[str]) -> list[str]:
    """Shortens a long list: the tables have all of it."""
    return names if len(names) <= _NAMED + 1 else [*names[:_NAMED], f"{len(names) - _NAMED} others"]


def listed(names: list[str], last: str = "and") -> str:
    return "".join(names) if len(names) < 2 else f"{', '.join(names[:-1])} {last} {names[-1]}"
