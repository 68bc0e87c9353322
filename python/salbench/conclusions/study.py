# SPDX-License-Identifier: GPL-3.0-or-later
"""What all tables of conclusions are functions of, so that they speak of the same units, shapes and resamples."""

from dataclasses import dataclass, field
from functools import cached_property

import pandas

from salbench.conclusions.resampling import Bootstrap
from salbench.conclusions.units import Level, Scores, levels

DEFAULT_SEED = 2016


@dataclass(frozen=True)
class Study:
    """Scores, what counts as one observation of them, and what else a run has written; None for what it has not.

    people: item, class, n and a column per metric: scores of n participants against n others.
    smoothed: of smoothed maps, the columns of the scores behind `smoothing`, a number of steps.
    constant: of the constant map, the columns of the scores.
    claims: what a text says of pairs of models, like configs/paper/claims.csv.
    """

    scores: Scores
    unit: str = "mesh"
    seed: int = DEFAULT_SEED
    people: pandas.DataFrame | None = None
    smoothed: pandas.DataFrame | None = None
    constant: pandas.DataFrame | None = None
    claims: pandas.DataFrame | None = None
    bootstrap: Bootstrap = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "bootstrap", Bootstrap(self.seed))

    @cached_property
    def levels(self) -> list[Level]:
        """Data sets with scores, each followed by its splits."""
        return levels(self.scores, self.unit)
