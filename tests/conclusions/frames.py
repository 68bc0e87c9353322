# SPDX-License-Identifier: GPL-3.0-or-later
"""Scores in few words, for tests."""

import pandas as pd

from salbench.conclusions.metrics import Metric
from salbench.conclusions.study import Study
from salbench.conclusions.units import TEXTS, Scores

AUC, NSS, CC = (Metric(name) for name in ("auc", "nss", "cc"))
KL = Metric("kl", higher_is_better=False)


def row(item, model, *values, view="", category="", split=""):
    """Of a mesh, or of a scan if there is a view."""
    return {"dataset": "scans" if view else "meshes", "split": split, "item": item, "class": category, "view": view, "model": model,
            "values": values}


def scores(rows, *metrics):
    metrics = metrics or (AUC,)
    frame = pd.DataFrame({name: pd.Series([one[name] for one in rows], dtype=object) for name in TEXTS})
    for place, metric in enumerate(metrics):
        frame[metric.name] = pd.Series([one["values"][place] for one in rows], dtype=float)
    return Scores(frame, metrics)


def study(rows, *metrics, **more):
    return Study(scores(rows, *metrics), seed=1, **more)


def curves(of_meshes, metric=AUC, category=None):
    """people.csv of {item: values at 1, 2, ... participants}."""
    rows = [(item, (category or {}).get(item, ""), n, value) for item, values in of_meshes.items() for n, value in enumerate(values, start=1)]
    return pd.DataFrame(rows, columns=["item", "class", "n", metric.name])
