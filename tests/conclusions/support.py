# SPDX-License-Identifier: GPL-3.0-or-later
"""Small tables of scores, and cells of the tables made of them."""

import itertools

import numpy as np
import pandas
from scipy import stats

from salbench.conclusions.metrics import Metric, of_program
from salbench.conclusions.study import Study
from salbench.conclusions.units import TEXTS, Scores

NAN = float("nan")


def row(item, view, model, *values, category="", split=""):
    """A row of scores; with a view it is one of a scan."""
    return ("scans" if str(view) else "meshes", split, str(item), category, str(view), model, *values)


def scores_of(rows, metrics=("auc",)):
    known = of_program()
    frame = pandas.DataFrame(rows, columns=[*TEXTS, *metrics])
    frame[list(metrics)] = frame[list(metrics)].astype(float)
    return Scores(frame, tuple(known.get(name, Metric(name)) for name in metrics))


def study_of(rows, metrics=("auc",), unit="mesh", **others):
    return Study(scores_of(rows, metrics), unit, seed=1, **others)


def one(frame, **cells):
    """The only row that has these cells."""
    for name, value in cells.items():
        frame = frame[frame[name] == value]
    assert len(frame) == 1, frame
    return frame.iloc[0]


def apart(values, pairs):
    """Of pairs of columns those that differ, one after the other: a slow twin of what is said of flips in docs/statistics.md, of every pattern of signs."""
    def largest(signed, pairs):
        return max(abs(stats.ttest_1samp(signed[:, a] - signed[:, b], 0).statistic) for a, b in pairs)

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
