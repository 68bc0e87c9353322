# SPDX-License-Identifier: GPL-3.0-or-later
"""Number of participants a model is worth: where the mean human curve first reaches the model's mean on the
same meshes. human_equivalents.csv. The curve is used up to the largest group size that at least half of the
meshes have, over the meshes that have it. [tasse2016]"""

from collections.abc import Iterator

import numpy as np
import pandas

from salbench.conclusions.people import curve_level
from salbench.conclusions.resampling import FEWEST, percentile_interval
from salbench.conclusions.samples import means
from salbench.conclusions.study import Study
from salbench.conclusions.tables import (
    CI95,
    DATASET,
    METRIC,
    MODEL,
    N,
    N_SHAPES,
    Part,
    count,
    framed,
    number,
    text,
)
from salbench.conclusions.units import Floats, Level, Numbers, UnitScores

COLUMNS = (
    DATASET,
    METRIC,
    MODEL,
    N,
    N_SHAPES,
    count(
        "largest_group",
        "participants up to which the curve is used: the most that at least half of the meshes have",
    ),
    number("mean", "mean of the model on these meshes"),
    number(
        "k",
        (
            "participants that it is worth: where the mean curve, straight between the numbers, first is as"
            " good as `mean`; empty beyond it"
        ),
    ),
    *CI95,
    text("k_bound", '"<1" or ">largest_group" where k is beyond the curve'),
    text("low_bound", "likewise of the lower end"),
    text("high_bound", "likewise of the upper end"),
    count("crossings", "how often the curve passes the model's mean; for 2 or more k is the first"),
    text("remark", "why there is no interval; or that HS is not at 1, so that `k` counts no people"),
)

_ONE = "HS"  # score of one participant, worth one by definition

Found = dict[str, Floats]  # by model
# Row of a model without comparable meshes.
_NONE = {
    "n": 0.0,
    "n_shapes": 0.0,
    "mean": np.nan,
    "k": np.nan,
    "low": np.nan,
    "high": np.nan,
    "crossings": 0.0,
}


def first_reached(curves: Floats, levels: Floats, higher_is_better: bool) -> Floats:
    """First position where each piecewise linear curve, with values at 1, 2, ..., reaches its level:
    -infinity if it starts better, infinity if it never does. curves: k x length."""
    ahead = (curves - levels[:, None]) * (1 if higher_is_better else -1)
    first = np.argmax(ahead >= 0, axis=1)
    row = np.arange(len(ahead))
    after, before = ahead[row, first], ahead[row, np.maximum(first - 1, 0)]
    with np.errstate(divide="ignore", invalid="ignore"):  # the first point has no predecessor
        place = first + 1 - np.where(first > 0, after / (after - before), 0)
    reached = np.where((ahead >= 0).any(axis=1), place, np.inf)
    return np.where(ahead[:, 0] > 0, -np.inf, reached)


def crossings(curve: Floats, level: float) -> int:
    """Counts how often the curve passes from one side of the level to the other."""
    sides = np.sign(curve - level)
    sides = sides[sides != 0]
    return int(np.count_nonzero(sides[1:] != sides[:-1]))


def human_equivalents(study: Study) -> pandas.DataFrame:
    """A row per metric and model on meshes, references included, over the meshes that all competitors are
    scored on and whose curve reaches `largest_group`. Intervals are percentiles over resampled units; none
    for fewer than six."""
    meshes = next((level for level in study.levels if level.dataset == "meshes"), None)
    if meshes is None:
        return framed(COLUMNS, [])
    level, curve = curve_level(study, study.scores.frame[study.scores.frame["dataset"] == "meshes"])
    return framed(
        COLUMNS, (_part(study, meshes, level, curve, metric) for metric in range(len(level.metrics)))
    )


def _part(study: Study, meshes: Level, level: Level, curve: Numbers, metric: int) -> Part:
    """Rows of one metric, one per model."""
    length = usable_length(level, metric, curve, meshes.competitors(metric))
    found: Found = {name: np.full(len(meshes.models), none) for name, none in _NONE.items()}
    for scores in _samples(meshes, level, curve[:length], metric) if length else ():
        for name, values in (
            _equivalents(study, scores, length, level.metrics[metric].higher_is_better).items()
            if scores.n
            else ()
        ):
            found[name][scores.models[length:]] = values
    places = {"k": found["k"], "ci95_low": found["low"], "ci95_high": found["high"]}
    bounds = {
        f"{name}_bound": [_bound(place, length) for place in found[name]] for name in ("k", "low", "high")
    }
    return found | {
        "dataset": meshes.dataset,
        "metric": meshes.metrics[metric].name,
        "model": meshes.models,
        "largest_group": length,
        **bounds,
        **{name: np.where(np.isfinite(values), values, np.nan) for name, values in places.items()},
        "remark": [_remark(meshes, metric, model, found, length) for model in range(len(meshes.models))],
    }


def usable_length(level: Level, metric: int, curve: Numbers, required: Numbers) -> int:
    """Length of the curve that is used: the number of participants that at least half of the meshes reach."""
    has_models = level.defined[:, required, metric].all(axis=1)
    n_shapes = (np.logical_and.accumulate(level.defined[:, curve, metric], axis=1) & has_models[:, None]).sum(
        axis=0
    )
    usable = (n_shapes > 0) & (2 * n_shapes >= n_shapes[:1])
    return len(usable) if usable.all() else int(np.argmin(usable))


def _samples(meshes: Level, level: Level, used: Numbers, metric: int) -> Iterator[UnitScores]:
    """Yields the curve, then the models, on the same meshes. References exclude no meshes of others; mostly
    they have scores on all."""
    competitors, scored = meshes.competitors(metric), meshes.scored(metric)
    every, bound = (
        level.averaged(metric, np.concatenate([used, models]), competitors)
        for models in (scored, competitors)
    )
    if every.n_shapes == bound.n_shapes:
        yield every
        return
    yield bound
    for model in scored[meshes.is_reference[scored]]:
        yield level.averaged(metric, [*used, model], competitors)


def _equivalents(study: Study, scores: UnitScores, length: int, higher_is_better: bool) -> Found:
    """Positions of the models on the curve. Columns of the scores: the curve, then the models."""
    curve, own = np.split(means(scores.values), [length])
    resampled = study.bootstrap.means(scores.values)
    reached = (
        first_reached(resampled[:, :length], values, higher_is_better) for values in resampled[:, length:].T
    )
    low, high = np.array([percentile_interval(places, scores.n) for places in reached]).reshape(-1, 2).T
    return {
        "n": np.array(scores.n),
        "n_shapes": np.array(scores.n_shapes),
        "mean": own,
        "low": low,
        "high": high,
        "k": first_reached(np.broadcast_to(curve, (len(own), length)), own, higher_is_better),
        "crossings": np.array([crossings(curve, level) for level in own]),
    }


def _bound(place: float, length: int) -> str:
    return "<1" if place == -np.inf else f">{length}" if place == np.inf else ""


def _remark(meshes: Level, metric: int, model: int, found: Found, length: int) -> str:
    if not meshes.is_scored[model, metric]:
        return "no scores"
    if found["n"][model] == 0:
        return "no mesh has a human curve and scores of all models"
    if found["n"][model] < FEWEST:
        return f"no interval: fewer than {FEWEST} units"
    if np.isnan(found["low"][model]):
        return "no interval: the values do not vary"
    one = meshes.find(_ONE)
    if (
        one is None
        or one == model
        or np.isnan(found["low"][one])
        or found["low"][one] <= 1 <= found["high"][one]
    ):
        return ""
    # Models are scored against all participants, the curve against as many others: the same map scores
    # differently.
    k = found["k"][one]
    return (
        f"not a number of people: one participant ({_ONE}) has k"
        f" {f'{k:.2f}' if np.isfinite(k) else _bound(k, length)} here"
    )
