# SPDX-License-Identifier: GPL-3.0-or-later
"""Small tables of scores, and cells of the tables made of them."""

import itertools
import tempfile
import unittest
from pathlib import Path

import numpy as np
import pandas

from salbench.conclusions.metrics import Metric, of_program
from salbench.conclusions.study import Study
from salbench.conclusions.units import TEXTS, Scores

NAN = float("nan")
AUC, NSS, CC, KL = (of_program()[name] for name in ("auc", "nss", "cc", "kl"))


class InAFolder(unittest.TestCase):
    """A temporary folder: self.folder."""

    def setUp(self):
        self.folder = Path(self.enterContext(tempfile.TemporaryDirectory()))


def row(item, view, model, *values, category="", split=""):
    """A row of scores; with a view it is one of a scan."""
    return ("scans" if str(view) else "meshes", split, str(item), category, str(view), model, *values)


def scores_of(rows, metrics=("auc",)):
    """metrics: or names of them."""
    known = [metric if isinstance(metric, Metric) else of_program().get(metric, Metric(metric)) for metric in metrics]
    names = [metric.name for metric in known]
    frame = pandas.DataFrame(rows, columns=[*TEXTS, *names])
    frame[names] = frame[names].astype(float)
    return Scores(frame, tuple(known))


def study_of(rows, metrics=("auc",), unit="mesh", **others):
    return Study(scores_of(rows, metrics), unit, seed=1, **others)


def curves(of_meshes, metric=AUC, category=None):
    """people.csv of {item: values at 1, 2, ... participants}."""
    rows = [(item, (category or {}).get(item, ""), n, value) for item, values in of_meshes.items() for n, value in enumerate(values, start=1)]
    return pandas.DataFrame(rows, columns=["item", "class", "n", metric.name])


def one(frame, **cells):
    """The only row that has these cells."""
    for name, value in cells.items():
        frame = frame[frame[name] == value]
    assert len(frame) == 1, frame
    return frame.iloc[0]


def t_statistic(differences):
    """Statistic of a paired t-test."""
    with np.errstate(all="ignore"):
        return differences.mean() / (differences.std(ddof=1) / len(differences) ** .5)


def apart(values, pairs):
    """Pairs of columns that differ: a slow reference implementation of the sign flips in docs/statistics.md, over every pattern of signs."""
    def largest(signed, pairs):
        return max(abs(t_statistic(signed[:, a] - signed[:, b])) for a, b in pairs)

    flips = [np.array([1, *signs])[:, None] for signs in itertools.product((1, -1), repeat=len(values) - 1)]
    left, found = list(pairs), set()
    while left:
        drawn = [largest(values * signs, left) for signs in flips]
        new = {pair for pair in left if np.mean(np.array(drawn) >= largest(values, [pair]) - 1e-9) <= .05}
        if not new:
            break
        found |= new
        left = [pair for pair in left if pair not in new]
    return found
