# SPDX-License-Identifier: GPL-3.0-or-later
"""Scores of smoothed maps, beside those of the unsmoothed maps in all other tables. smoothing.csv."""

from collections.abc import Iterable, Iterator
from dataclasses import replace
from itertools import chain

import numpy as np
import pandas

from salbench.conclusions.metrics import Metric
from salbench.conclusions.samples import by_model
from salbench.conclusions.study import Study
from salbench.conclusions.tables import (
    CI95,
    DATASET,
    MEAN,
    METRIC,
    MODEL,
    N,
    N_SHAPES,
    SPLIT,
    Part,
    count,
    framed,
    text,
)
from salbench.conclusions.units import Level, Scores, levels

COLUMNS = (
    DATASET,
    SPLIT,
    MODEL,
    METRIC,
    text(
        "steps",
        (
            'of smoothing: in each, a point takes the mean over itself and its neighbours along edges;'
            ' "best": for each shape and model the best of them'
        ),
    ),
    N,
    N_SHAPES,
    MEAN,
    *CI95,
    count(
        "upper_bound",
        "1 for best: the ground truth itself chose it, so that it is an upper bound and no score",
    ),
)

_BEST = "best"


def smoothing(study: Study) -> pandas.DataFrame:
    """A row per data set, model, metric and number of steps, with `metrics: {smoothing: [...]}`, over the
    shapes that all competitors are scored on."""
    assert study.smoothed is not None
    metrics = study.scores.metrics
    frames = {
        str(steps): rows.reset_index(drop=True)
        for steps, rows in study.smoothed.groupby("smoothing", sort=False)
    }
    if not frames:  # every item failed
        return framed(COLUMNS, (), study.in_splits)
    frames[_BEST] = best_of(list(frames.values()), metrics)
    # the levels of each number of steps
    parts = zip(*(levels(replace(study.scores, frame=frame), study.unit) for frame in frames.values()))
    return framed(
        COLUMNS,
        chain.from_iterable(_parts(part, list(frames)) for part in parts),
        Scores(frames[_BEST], metrics).in_splits,
    )


def best_of(smoothed: list[pandas.DataFrame], metrics: Iterable[Metric]) -> pandas.DataFrame:
    """Best score of each row by each metric, ignoring undefined ones; all frames have the same shapes and
    models, in the same order."""
    best = smoothed[0].copy()
    for metric in metrics:
        values = [frame[metric.name] for frame in smoothed]
        best[metric.name] = np.fmax.reduce(values) if metric.higher_is_better else np.fmin.reduce(values)
    return best


def _parts(of_steps: tuple[Level, ...], steps: list[str]) -> Iterator[Part]:
    found = [by_model(level) for level in of_steps]
    for model, name in enumerate(of_steps[0].models):
        for metric, of_metric in enumerate(of_steps[0].metrics):
            yield {
                "dataset": of_steps[0].dataset,
                "split": of_steps[0].split,
                "model": name,
                "metric": of_metric.name,
                "steps": steps,
                **{column: [cells[column][model, metric] for cells in found] for column in found[0]},
                "upper_bound": [int(step == _BEST) for step in steps],
            }
