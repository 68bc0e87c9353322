# SPDX-License-Identifier: GPL-3.0-or-later
"""Sentences about who leads, which say no more than the intervals of the ranks allow."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

from salbench.conclusions.metrics import Metric

_NAMED = 4  # models that a sentence lists
_SHORT = ("auc", "nss", "lcc", "cc", "kl", "sim", "ig", "mse", "mae", "sauc")  # written as "AUC"
_SHAPES = {"meshes": ("mesh", "meshes"), "scans": ("scan", "scans"), "clouds": ("point cloud", "point clouds")}


@dataclass
class Leader:
    """The competitors at the top by one metric. Verdicts, of the joint intervals of the ranks:

    leads: one model has the rank 1 to 1, and is ahead of every other one.
    not behind: one model's interval alone reaches 1, but it is not ahead of all others.
    not told apart: intervals of several models reach 1.
    only model; one unit: ranks have no intervals; no common shape: that all competitors have a score for.
    """

    metric: Metric
    verdict: str
    models: list[str]  # whose rank may be the first, best mean first; all for one unit
    mean: float  # of the best model
    interval: tuple[float, float]  # of it, 95 %, within the range of the metric
    n: int  # units
    n_shapes: int
    near: list[str] = field(default_factory=list)  # not behind: those that it cannot be told apart from
    second: str = ""  # model with the next best mean; empty: none
    lead: float = math.nan  # how far the best mean is ahead of that, positive whether higher or lower is better
    lead_interval: tuple[float, float] = (math.nan, math.nan)  # 95 %, joint for all pairs of models: above 0 where the pair differs


def sentence(dataset: str, split: str, unit: str, leaders: Sequence[Leader]) -> str:
    """Of these metrics: those that say alike in one clause."""
    of_split = f" of split {split}" if split else ""
    if not leaders:
        return f"On {_spoken(dataset)}{of_split}, no model has scores but references."
    alike: dict[tuple[str, frozenset[str], frozenset[str]], list[int]] = {}
    for place, leader in enumerate(leaders):
        alike.setdefault((leader.verdict, frozenset(leader.models), frozenset(leader.near)), []).append(place)
    shapes = [_counted(dataset, unit, leader) for leader in leaders]
    figures = [_figures(leader, place == 0, "" if over == shapes[0] else f", on {over}") for place, (leader, over) in enumerate(zip(leaders, shapes))]
    clauses = [_clause([leaders[place] for place in places], [figures[place] for place in places]) for places in alike.values()]
    return f"On {shapes[0]}{of_split}, {'; '.join(clauses)}."


def _clause(leaders: list[Leader], figures: list[str]) -> str:
    """What several metrics say alike."""
    labels = [_label(leader.metric.name) for leader in leaders]
    metrics = _listed([f"{label} ({text})" for label, text in zip(labels, figures)])
    models, near = leaders[0].models, leaders[0].near
    verdict = leaders[0].verdict
    if verdict == "leads":
        return f"{models[0]} leads by {metrics}"
    if verdict == "not behind":
        return f"by {metrics}, {models[0]} is behind no other model, but cannot be told apart from {_named(near)}"
    if verdict == "not told apart":
        return f"by {metrics}, {_named(models)} cannot be told apart"
    if verdict == "only model":
        return f"{models[0]} is the only model that is scored by {metrics}"
    if verdict == "one unit":
        return f"one observation does not tell how the models rank by {_listed(labels)}"
    return f"no shape has scores of all models by {_listed(labels)}"


def _figures(leader: Leader, explained: bool, over: str) -> str:
    """ "mean 0.613, 95 % interval 0.590 to 0.636": whose it is where that is not clear, and over what if that is not what the sentence
    begins with."""
    whose = f"{leader.models[0]} " if leader.verdict == "not told apart" else ""
    mean = f"{whose}{'mean ' if explained else ''}{leader.mean:.3f}"
    low, high = leader.interval
    if math.isnan(low):
        return f"{mean}, no interval{over}"
    return f"{mean}, {'95 % interval ' if explained else ''}{low:.3f} to {high:.3f}{over}"


def _counted(dataset: str, unit: str, leader: Leader) -> str:
    """ "228 scans of 19 meshes" """
    if leader.n == 0:
        return _spoken(dataset)
    shapes = _several(leader.n_shapes, *_SHAPES[dataset])
    if unit == "class":
        return f"{shapes} of {_several(leader.n, 'class', 'classes')}"
    return f"{shapes} of {_several(leader.n, 'mesh', 'meshes')}" if dataset == "scans" and unit == "mesh" else shapes


def _spoken(dataset: str) -> str:
    return _SHAPES[dataset][1]


def _several(n: int, one: str, more: str) -> str:
    return f"{n} {one if n == 1 else more}"


def _label(metric: str) -> str:
    return metric.upper() if metric in _SHORT else metric


def _named(models: list[str]) -> str:
    """A long list is cut: the tables have it."""
    few = models if len(models) <= _NAMED + 1 else [*models[:_NAMED], f"{len(models) - _NAMED} others"]
    return _listed(few)


def _listed(names: list[str]) -> str:
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} and {names[-1]}"
