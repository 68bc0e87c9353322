# SPDX-License-Identifier: GPL-3.0-or-later
"""What all tables of conclusions are functions of, so that they speak of the same units, shapes and resamples."""

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
import pandas

from salbench.conclusions.pairs import Pairs, pairs_of
from salbench.conclusions.parallel import mapped
from salbench.conclusions.ranks import Ranking, rank_models, ranks
from salbench.conclusions.resampling import FEWEST, Bootstrap
from salbench.conclusions.samples import means
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
    at_chance: Floats  # ranks of the competitors if scores that are missing were at chance; NaN where none is missing, or for few units

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


def rank_level(level: Level, bootstrap: Bootstrap, threads: int | None = None, means_too: bool = True) -> list[RankedMetric]:
    """Per metric; all sums are drawn together. means_too: with resampled means, those of references among them."""
    samples: list[list[UnitScores]] = []
    for number in range(len(level.metrics)):
        references = [[model] for model in level.scored(number) if level.is_reference[model]] if means_too else []
        samples.append([level.compared(number, level.competitors(number)), *(scores for _, scores in level.groups(number, references))])
    every = [scores.values for of_metric in samples for scores in of_metric]
    resampled = iter(bootstrap.means_of_each(every) if means_too else [values[:0] for values in every])
    known = [[Resampled(scores, next(resampled)) for scores in of_metric] for of_metric in samples]
    flipped = bootstrap.flipped_of_each([scores.values for scores, *_ in samples])

    def rank(number: int) -> RankedMetric:
        first, *others = known[number]
        higher_is_better = level.metrics[number].higher_is_better
        ranking = rank_models(first.scores.values, flipped[number], first.means, higher_is_better)
        at_chance: Floats = np.full(len(first.scores.models), np.nan)
        if level.n_missing(number)[first.scores.models].any() and len(filled := level.at_chance(number)) >= FEWEST:
            at_chance = ranks(means(filled), higher_is_better)
        return RankedMetric(first, others, ranking, at_chance)

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
    def of_classes(self) -> dict[tuple[str, str], tuple[Level, list[RankedMetric]]]:
        """The same with classes for units, for what new ones would show: by data set and split, where six classes have several items."""
        if self.unit == "class":
            return {}
        found = {}
        for level in levels(self.scores, "class"):
            rows = self.scores.frame[(self.scores.frame["dataset"] == level.dataset) & (self.scores.frame["class"] != "")]
            if level.split:
                rows = rows[rows["split"] == level.split]
            if (rows.groupby("class")["item"].nunique() > 1).sum() >= FEWEST:
                found[level.dataset, level.split] = level, rank_level(level, self.bootstrap, self.threads, means_too=False)
        return found

    @cached_property
    def pairs(self) -> list[tuple[Level, list[Pairs]]]:
        """Each level with its pairs of models by each metric."""
        return [(level, mapped(lambda metric: pairs_of(level, metric), range(len(level.metrics)), self.threads)) for level in self.levels]

    @property
    def in_splits(self) -> bool:
        return self.scores.in_splits
