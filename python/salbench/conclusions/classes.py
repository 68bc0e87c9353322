# SPDX-License-Identifier: GPL-3.0-or-later
"""Means by class of the items: per_class.csv."""

from collections.abc import Iterator

import numpy as np
import pandas

from salbench.conclusions.samples import by_model
from salbench.conclusions.study import Study, made_once
from salbench.conclusions.tables import (
    CI95,
    DATASET,
    MEAN,
    METRIC,
    MODEL,
    N_SHAPES,
    SPLIT,
    N,
    Part,
    framed,
    text,
)
from salbench.conclusions.units import AVERAGE, DATASETS, Level, with_splits

COLUMNS = (DATASET, SPLIT, text("class", "of the items"), MODEL, METRIC, N, N_SHAPES, MEAN, *CI95)


@made_once
def per_class(study: Study) -> pandas.DataFrame:
    """A row per data set, class, model and metric, over the shapes of the class that all competitors are
    scored on. The model "Avg" is the mean over the competitors, unit by unit."""
    return framed(COLUMNS, _parts(study), study.in_splits)


def _parts(study: Study) -> Iterator[Part]:
    """Classes in the order of their first item, each followed by its splits. Within a class its shapes are
    the units."""
    unit = "mesh" if study.unit == "class" else study.unit
    for dataset in DATASETS:
        of_dataset = study.scores.part(study.scores.frame["dataset"] == dataset)
        names, splits = (list[str](of_dataset.frame[column].unique()) for column in ("class", "split"))
        for name in filter(None, names):
            of_class = of_dataset.part(of_dataset.frame["class"] == name)
            yield from (_part(name, level) for level in with_splits(of_class, splits, dataset, unit))


def _part(name: str, level: Level) -> Part:
    """Rows by model and metric, with the average after all models."""
    models, metrics = [*level.models, AVERAGE], [metric.name for metric in level.metrics]
    cells = by_model(level, with_average=True)
    known = cells["n"] > 0
    model, metric = np.nonzero(known)
    return {
        "dataset": level.dataset,
        "split": level.split,
        "class": name,
        "model": [models[place] for place in model],
        "metric": [metrics[place] for place in metric],
        **{column: values[known] for column, values in cells.items()},
    }
