# SPDX-License-Identifier: GPL-3.0-or-later
"""Compares models with chance: random values (RS) and a constant map. chance.csv lists metrics by whose means
these reach a model. Only models significantly ahead of them can lead."""

from collections.abc import Iterator

import numpy as np
import pandas
from numpy.typing import NDArray

from salbench.conclusions.pairs import compare, holm_adjusted
from salbench.conclusions.resampling import FEWEST
from salbench.conclusions.samples import LEVEL, ROUNDING, means
from salbench.conclusions.study import Study
from salbench.conclusions.tables import DATASET, METRIC, Part, framed, text
from salbench.conclusions.units import DATASETS, Floats, Level

COLUMNS = (
    DATASET,
    METRIC,
    text("remark", "which of the two is level with or ahead of which models, or of people, and by how much"),
)

CHANCE, CONSTANT = "chance", "a constant map"


def baselines(level: Level, metric: int) -> dict[str, Floats]:
    """Scores by shape of chance and of a constant map, under these names, if known. Chance is RS, or else the
    metric's value for uninformative maps, unless that is the end of its range: |CC| of noise is above 0."""
    rs, of = level.find("RS"), level.metrics[metric]
    chance = (
        np.full(len(level.values), of.chance if of.chance > of.low else np.nan)
        if rs is None or not level.is_scored[rs, metric]
        else level.values[:, rs, metric]
    )
    found = {CHANCE: chance, CONSTANT: level.constant[:, metric]}
    return {name: scores for name, scores in found.items() if not np.isnan(scores).all()}


def ahead(level: Level, metric: int) -> dict[str, NDArray[np.bool_]]:
    """Competitors significantly ahead of each baseline, by paired t-tests with Holm's correction over the
    competitors, or signed-rank tests if a difference is the same on all units. Baselines with fewer than six
    units are left out."""
    models, sign, found = (
        level.competitors(metric),
        1.0 if level.metrics[metric].higher_is_better else -1.0,
        {},
    )
    for name, baseline in baselines(level, metric).items():
        values = level.beside(metric, models, baseline)
        if len(values) >= FEWEST:
            paired = compare(sign * (values[:, :-1] - values[:, -1:]))
            found[name] = (paired.mean_difference > 0) & (holm_adjusted(paired.p) < LEVEL)
    return found


def chance(study: Study) -> pandas.DataFrame:
    """A row per data set and metric by which chance (RS) or a constant map reaches the mean of a model or of
    people."""
    whole = (
        next((level for level in study.levels if level.dataset == dataset), None) for dataset in DATASETS
    )
    return framed(COLUMNS, (part for level in whole if level is not None for part in _parts(level)))


def _parts(level: Level) -> Iterator[Part]:
    for number, metric in enumerate(level.metrics):
        if remark := _remark(level, number):
            yield {"dataset": level.dataset, "metric": metric.name, "remark": remark}


def _remark(level: Level, metric: int) -> str:
    known = baselines(level, metric)
    if level.find("RS") is None:
        known.pop(CHANCE, None)
    passed = ((name, _passed_by(level, metric, scores)) for name, scores in known.items())
    return "; ".join(
        f"{'chance (RS)' if name == CHANCE else name} is level with or ahead of {models}"
        for name, models in passed
        if models
    )


def _passed_by(level: Level, metric: int, baseline: Floats) -> str:
    """Models that the baseline ties or beats, such as "PS (by 0.064), HS (level)"."""
    passed = []
    for model in level.scored(metric):
        values = level.beside(metric, [model], baseline)
        if level.models[model] == "RS" or not len(values):
            continue
        ours, theirs = means(values)[::-1]
        if (lead := _lead(ours, theirs, level.metrics[metric].higher_is_better)) >= 0:
            passed.append(f"{level.models[model]} ({f'by {lead:.3g}' if lead > 0 else 'level'})")
    return ", ".join(passed)


def _lead(reference: float, model: float, higher_is_better: bool) -> float:
    """Lead of the reference; 0 if the two are equal up to rounding."""
    lead = reference - model if higher_is_better else model - reference
    return 0 if abs(lead) <= ROUNDING * max(abs(reference), abs(model)) else lead
