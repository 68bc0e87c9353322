# SPDX-License-Identifier: GPL-3.0-or-later
"""Trivial baselines of a benchmark, which a model has to beat, and its ceiling, which people reach."""

from collections.abc import Sequence

import pandas

from salbench._core import models_about
from salbench.conclusions.metrics import lower_is_better

CONSTANT = "constant"  # the constant map, a baseline in constant.csv
FLOORS = tuple(name for name, about in models_about.items() if about.is_floor and name != CONSTANT)
CEILING = "HS"


def role(model: str) -> str:
    """Returns "baseline" (a trivial one), "ceiling", or "" for a model."""
    return "baseline" if model in (*FLOORS, CONSTANT) else "ceiling" if model == CEILING else ""


def above_floors(significance: pandas.DataFrame, floors: Sequence[str] = FLOORS) -> dict[str, list[str]]:
    """Maps each metric to the models better than every baseline by their paired intervals, uncorrected.
    significance: rows of one data set."""
    found = {}
    for metric, pairs in significance.groupby("metric", sort=False):
        sign = -1 if lower_is_better(metric) else 1
        wins: dict[str, list[bool]] = {}  # by model, one per baseline
        for pair in pairs.to_dict("records"):
            for model, other, direction in (
                (pair["model_a"], pair["model_b"], sign),
                (pair["model_b"], pair["model_a"], -sign),
            ):
                if other in floors and not role(model):
                    wins.setdefault(model, []).append(
                        min(direction * pair["ci95_low"], direction * pair["ci95_high"]) > 0
                    )
        found[metric] = [model for model, of in wins.items() if len(of) == len(floors) and all(of)]
    return found
