# SPDX-License-Identifier: GPL-3.0-or-later
"""Metrics that do not tell models from chance: by their means, random values (RS) or a constant map are as good. chance.csv."""

from collections.abc import Iterator
from dataclasses import replace

import pandas

from salbench.conclusions.samples import ROUNDING, means
from salbench.conclusions.study import Study
from salbench.conclusions.tables import DATASET, METRIC, Part, framed, text
from salbench.conclusions.units import DATASETS, Level

COLUMNS = (DATASET, METRIC, text("remark", "which of the two is level with or ahead of which models, or of people, and by how much"))

_REFERENCES = {"RS": "chance (RS)", "constant": "a constant map"}


def chance(study: Study) -> pandas.DataFrame:
    """A row per data set and metric by which chance (RS) or a constant map reaches the mean of a model or of people."""
    return framed(COLUMNS, (part for dataset in DATASETS for part in _parts(study, dataset)))


def _parts(study: Study, dataset: str) -> Iterator[Part]:
    frames = (rows for rows in (study.scores.frame, study.constant) if rows is not None)
    frame = pandas.concat((rows[rows["dataset"] == dataset] for rows in frames), ignore_index=True)
    level = Level(replace(study.scores, frame=frame), dataset, study.unit)
    for number, metric in enumerate(level.metrics):
        if remark := _remark(level, number):
            yield {"dataset": dataset, "metric": metric.name, "remark": remark}


def _remark(level: Level, metric: int) -> str:
    passed = ((words, _passed_by(level, metric, reference)) for reference, words in _REFERENCES.items())
    return "; ".join(f"{words} is level with or ahead of {models}" for words, models in passed if models)


def _passed_by(level: Level, metric: int, reference: str) -> str:
    """ "PS (by 0.064), HS (level)": the models that the reference is level with or ahead of."""
    scored, place, passed = level.scored(metric), level.find(reference), []
    if place is None or place not in scored:
        return ""
    for model in scored[[level.models[model] not in _REFERENCES for model in scored]]:
        scores = level.compared(metric, [place, model])
        if not scores.n:
            continue
        ours, theirs = means(scores.values)
        if (lead := _lead(ours, theirs, level.metrics[metric].higher_is_better)) >= 0:
            passed.append(f"{level.models[model]} ({f'by {lead:.3g}' if lead > 0 else 'level'})")
    return ", ".join(passed)


def _lead(reference: float, model: float, higher_is_better: bool) -> float:
    """How far the reference is ahead; 0 where the two are equal but for rounding."""
    lead = reference - model if higher_is_better else model - reference
    return 0 if abs(lead) <= ROUNDING * max(abs(reference), abs(model)) else lead
