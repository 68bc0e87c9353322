# SPDX-License-Identifier: GPL-3.0-or-later
"""What all tables of conclusions are functions of, so that they speak of the same units, shapes and resamples."""

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
import pandas

from salbench.conclusions.pairs import Pairs, pairs_of
from salbench.conclusions.parallel import mapped
from salbench.conclusions.ranks import Ranking, rank_models
from salbench.conclusions.resampling import Bootstrap
from salbench.conclusions.units import Floats, Level, Scores, UnitScores, levels

DEFAULT_SEED = 2016


@dataclass(frozen=True)
class Resampled:
    """Scores of some models on the same units, with their resampled means; none for fewer than two units."""

    scores: UnitScores
    means: Floats  # resamples x models


@dataclass(frozen=True)
class RankedMetric:
    """One metric of a level: the competitors, ranked, and the references where they can be compared."""

    competitors: Resampled
    references: list[Resampled]
    ranking: Ranking

    @property
    def samples(self) -> list[Resampled]:
        """Each scored model once, on the shapes that it and all competitors have a score for."""
        return [self.competitors, *self.references]

    def resampled(self, scores: UnitScores, bootstrap: Bootstrap) -> Floats:
        """Resampled means of scores of these models on the shapes that all of them are compared on: mostly known already."""
        known: dict[int, Floats] = {}
        for sample in self.samples:
            if sample.scores.n_shapes == scores.n_shapes:
                known.update(zip(sample.scores.model_of_column, sample.means.T))
        if all(model in known for model in scores.model_of_column):
            return np.stack([known[model] for model in scores.model_of_column], axis=1)
        return bootstrap.means(scores.values)


def rank_level(level: Level, bootstrap: Bootstrap, threads: int | None = None) -> list[RankedMetric]:
    """Per metric; all means are resampled together."""
    samples: list[list[UnitScores]] = []
    for number in range(len(level.metrics)):
        references = [[model] for model in level.scored(number) if level.is_reference[model]]
        samples.append([level.compared(number, level.competitors(number)), *(scores for _, scores in level.groups(number, references))])
    resampled = iter(bootstrap.means_of_each([scores.values for of_metric in samples for scores in of_metric]))
    known = [[Resampled(scores, next(resampled)) for scores in of_metric] for of_metric in samples]

    def rank(number: int) -> RankedMetric:
        first, *others = known[number]
        return RankedMetric(first, others, rank_models(first.scores.values, first.means, level.metrics[number].higher_is_better))

    return mapped(rank, range(len(level.metrics)), threads)


@dataclass(frozen=True)
class Study:
    """Scores, what counts as one observation of them, and what else a run has written; None for what it has not.

    people: item, class, n and a column per metric: scores of n participants against n others.
    smoothed: of smoothed maps, the columns of the scores behind `smoothing`, a number of steps.
    constant: of the constant map, the columns of the scores.
    claims: what a text says of pairs of models, like configs/paper/claims.csv.
    threads: that may work on it; no table depends on it. None: one per core.
    """

    scores: Scores
    unit: str = "mesh"
    seed: int = DEFAULT_SEED
    people: pandas.DataFrame | None = None
    smoothed: pandas.DataFrame | None = None
    constant: pandas.DataFrame | None = None
    claims: pandas.DataFrame | None = None
    threads: int | None = None
    bootstrap: Bootstrap = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "bootstrap", Bootstrap(self.seed, threads=self.threads))

    @cached_property
    def levels(self) -> list[Level]:
        """Data sets with scores, each followed by its splits."""
        return levels(self.scores, self.unit)

    @cached_property
    def ranked(self) -> list[tuple[Level, list[RankedMetric]]]:
        """Each level with its models ranked by each metric."""
        return [(level, rank_level(level, self.bootstrap, self.threads)) for level in self.levels]

    @cached_property
    def pairs(self) -> list[tuple[Level, list[Pairs]]]:
        """Each level with its pairs of models by each metric."""
        return [(level, mapped(lambda metric: pairs_of(level, metric), range(len(level.metrics)), self.threads)) for level in self.levels]

    @property
    def in_splits(self) -> bool:
        return self.scores.in_splits
