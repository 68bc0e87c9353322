# SPDX-License-Identifier: GPL-3.0-or-later
"""The common input of all tables of conclusions, which fixes units, shapes and resamples."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, wraps

import pandas

from salbench.conclusions.metrics import leading_metrics
from salbench.conclusions.pairs import PAIRS, pairs_of
from salbench.conclusions.parallel import mapped
from salbench.conclusions.ranked import RankedMetric, estimates, rank_level
from salbench.conclusions.resampling import FEWEST, Bootstrap
from salbench.conclusions.tables import stacked
from salbench.conclusions.units import Level, Scores, levels

DEFAULT_SEED = 2016


@dataclass(frozen=True)
class Study:
    """Scores, their unit of observation, and the other tables of a run; None for missing ones.

    people: item, class, n and a column per metric: scores of n participants against n others.
    smoothed: `smoothing`, a number of steps, then the columns of the scores.
    constant: scores of the constant map.
    reported: numbers from papers on this data set by these metrics (papers.of_run), for models in the scores
    and others.
    chief: metric that the protocol ranks by; empty: the first of the leading ones.
    threads: number of threads, without effect on tables; None: one per core.
    """

    scores: Scores
    unit: str = "mesh"
    seed: int = DEFAULT_SEED
    people: pandas.DataFrame | None = None
    smoothed: pandas.DataFrame | None = None
    constant: pandas.DataFrame | None = None
    reported: pandas.DataFrame | None = None
    chief: str = ""
    threads: int | None = None

    @cached_property
    def made(self) -> dict[Callable[["Study"], pandas.DataFrame], pandas.DataFrame]:
        """Tables that others are made from, by their functions: see `made_once`."""
        return {}

    @cached_property
    def bootstrap(self) -> Bootstrap:
        return Bootstrap(self.seed, threads=self.threads)

    @cached_property
    def levels(self) -> list[Level]:
        """Data sets with scores, each followed by its splits."""
        return levels(self.scores, self.unit, self.constant)

    @cached_property
    def ranked(self) -> list[tuple[Level, list[RankedMetric]]]:
        """Each level with its models ranked by each metric."""
        return [(level, rank_level(level, self.bootstrap, self.threads)) for level in self.levels]

    @cached_property
    def of_classes(self) -> dict[tuple[str, str], tuple[Level, list[RankedMetric]]]:
        """Ranked levels whose units are classes, to generalise to new classes: by data set and split, if six
        classes have several items."""
        if self.unit == "class":
            return {}
        found = {}
        for level in levels(self.scores, "class", self.constant):
            rows = self.scores.frame[
                (self.scores.frame["dataset"] == level.dataset) & (self.scores.frame["class"] != "")
            ]
            if level.split:
                rows = rows[rows["split"] == level.split]
            items = self.scores.without_copies(rows["item"])
            if (items.groupby(rows["class"]).nunique() > 1).sum() >= FEWEST:
                found[level.dataset, level.split] = level, rank_level(level, self.bootstrap, self.threads)
        return found

    @cached_property
    def estimates(self) -> pandas.DataFrame:
        """Statistics of each model by each metric of each level."""
        return estimates(self.ranked)

    @cached_property
    def pairs(self) -> pandas.DataFrame:
        """Every pair of models that have scores, by each metric of each level; `level` is its index."""
        each = [
            (number, level, metric, of_metric)
            for number, (level, ranked) in enumerate(self.ranked)
            for metric, of_metric in enumerate(ranked)
        ]
        return stacked(
            PAIRS,
            mapped(
                lambda one: pairs_of(one[1], one[2], one[3].ranking) | {"level": one[0]}, each, self.threads
            ),
        )

    @cached_property
    def published(self) -> pandas.DataFrame | None:
        """Rows of `reported` whose models, classes and splits are in these scores; None if there are none."""
        if self.reported is None:
            return None
        metrics = {metric.name for metric in self.scores.metrics}
        models = set(zip(*(self.scores.frame[name] for name in ("dataset", "class", "model"))))
        models |= {(dataset, "", model) for dataset, _, model in models}
        splits = {(level.dataset, level.split) for level in self.levels}
        kept = [
            (row["dataset"], row["class"], row["model"]) in models
            and (row["dataset"], row["split"]) in splits
            and row["metric"] in metrics
            for row in self.reported.to_dict("records")
        ]
        return self.reported[kept] if any(kept) else None

    @property
    def leading(self) -> list[str]:
        """Metrics for sentences, starting with the one that models are ranked by."""
        return leading_metrics((metric.name for metric in self.scores.metrics), self.chief)

    @property
    def in_splits(self) -> bool:
        return self.scores.in_splits


def made_once(make: Callable[[Study], pandas.DataFrame]) -> Callable[[Study], pandas.DataFrame]:
    """Decorator of a table that several tables or sentences of a study need. Each gets a copy."""

    @wraps(make)
    def made(study: Study) -> pandas.DataFrame:
        if make not in study.made:
            study.made[make] = make(study)
        return study.made[make].copy()

    return made
