# SPDX-License-Identifier: GPL-3.0-or-later
"""Models of a level, ranked by each metric, with all statistics of each: the frame behind summary.csv,
ranking.csv and compact.csv."""

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pandas

from salbench.conclusions.metrics import Metric
from salbench.conclusions.parallel import mapped
from salbench.conclusions.ranks import Ranking, rank_models, ranks
from salbench.conclusions.resampling import FEWEST, Bootstrap, bca_interval
from salbench.conclusions.samples import means, summarise
from salbench.conclusions.tables import stacked
from salbench.conclusions.units import Floats, Level, UnitScores


@dataclass(frozen=True)
class RankedMetric:
    """One metric of a level: the ranked competitors, and the references if they can be compared."""

    # Scores with resampled means, competitors first: each scored model once, on the shapes that it and all
    # competitors have.
    samples: list[UnitScores]
    ranking: Ranking  # competitors only
    # ranks with missing scores at chance; NaN if none is missing, or for few units
    at_chance: Floats

    @property
    def competitors(self) -> UnitScores:
        return self.samples[0]


def rank_level(level: Level, bootstrap: Bootstrap, threads: int | None = None) -> list[RankedMetric]:
    """Ranks per metric; all sums are computed together."""
    samples: list[list[UnitScores]] = []
    for number in range(len(level.metrics)):
        references = [[model] for model in level.scored(number) if level.is_reference[model]]
        samples.append(
            [
                level.compared(number, level.competitors(number)),
                *(scores for _, scores in level.groups(number, references)),
            ]
        )
    resampled = iter(
        bootstrap.means_of_each([scores.values for of_metric in samples for scores in of_metric])
    )
    samples = [[replace(scores, resampled=next(resampled)) for scores in of_metric] for of_metric in samples]
    flipped = bootstrap.flipped_of_each([scores.values for scores, *_ in samples])
    signs = {n: bootstrap.sums_of_signs(n) for n in {scores.n for scores, *_ in samples} if n >= FEWEST}

    def rank(number: int) -> RankedMetric:
        competitors, higher_is_better = samples[number][0], level.metrics[number].higher_is_better
        ranking = rank_models(
            competitors.values,
            flipped[number],
            signs.get(competitors.n, np.empty(0)),
            competitors.resampled,
            higher_is_better,
        )
        at_chance: Floats = np.full(len(competitors.models), np.nan)
        if (
            level.n_missing(number)[competitors.models].any()
            and len(filled := level.at_chance(number)) >= FEWEST
        ):
            at_chance = ranks(means(filled), higher_is_better)
        return RankedMetric(samples[number], ranking, at_chance)

    return mapped(rank, range(len(level.metrics)), threads)


def cut(low: Any, mean: Any, high: Any, metric: Metric) -> tuple[Any, Any]:
    """Clips an interval of a mean to the range of the metric; the mean itself always stays inside.

    The true mean is within the range, so clipping keeps the coverage.
    """
    return (
        np.where(low < metric.low, np.minimum(metric.low, mean), low),
        np.where(high > metric.high, np.maximum(metric.high, mean), high),
    )


def estimates(levels: Iterable[tuple[Level, list[RankedMetric]]]) -> pandas.DataFrame:
    """Returns a row per level, metric and model, with or without scores: the columns of the tables, and
    `level`, `of_metric` and `of_model` (indices), `place` among the competitors, best mean first, and
    `is_scored`."""
    return stacked(
        _COLUMNS,
        (
            _of_metric(level, metric, of_metric) | {"level": number, "of_metric": metric}
            for number, (level, ranked) in enumerate(levels)
            for metric, of_metric in enumerate(ranked)
        ),
    )


_COUNTS = ("n", "n_shapes", "n_own_shapes")
_NUMBERS = (
    "mean",
    "sd",
    "ci95_low",
    "ci95_high",
    "low",
    "high",
    "half",
    "bca95_low",
    "bca95_high",
    "own_mean",
    "rank",
    "rank_low",
    "rank_high",
    "first",
    "rank_at_chance",
    "place",
)
_COLUMNS = (
    dict.fromkeys(("dataset", "split", "metric", "better", "model", "kind", "group"), "str")
    | {"is_scored": "bool"}
    | dict.fromkeys(("level", "of_metric", "of_model", "n_missing", *_COUNTS), "int64")
    | dict.fromkeys(_NUMBERS, "float64")
)


def _of_metric(level: Level, number: int, ranked: RankedMetric) -> dict[str, Any]:
    """Rows of `estimates` for one metric, one per model."""
    k, metric, ranking = len(level.models), level.metrics[number], ranked.ranking
    cells: dict[str, Any] = {name: np.full(k, np.nan) for name in _NUMBERS} | {
        name: np.zeros(k, dtype=int) for name in _COUNTS
    }
    cells["group"] = np.full(k, "", dtype=object)
    of_competitors = {
        "rank": ranking.rank,
        "rank_low": ranking.low,
        "rank_high": ranking.high,
        "first": ranking.first,
        "group": ranking.letters,
        "rank_at_chance": ranked.at_chance,
        "place": np.argsort(ranking.order),
    }
    known = [
        (ranked.competitors.models, of_competitors),
        *((of.models, _of_sample(level, number, of)) for of in ranked.samples),
    ]
    for models, found in known:
        for name, values in found.items():
            cells[name][models] = values
    return {
        "dataset": level.dataset,
        "split": level.split,
        "metric": metric.name,
        "better": "higher" if metric.higher_is_better else "lower",
        "model": level.models,
        "kind": np.where(level.is_reference, "reference", "model"),
        "of_model": np.arange(k),
        "n_missing": level.n_missing(number),
        "is_scored": level.is_scored[:, number],
        **cells,
    }


def _of_sample(level: Level, number: int, scores: UnitScores) -> dict[str, Any]:
    """Columns of `estimates` for the models of a sample."""
    summary = summarise(scores.values)
    low, high = cut(summary.low, summary.mean, summary.high, level.metrics[number])
    was_cut = (low > summary.low) | (high < summary.high)
    bca = np.array(
        [
            bca_interval(scores.values[:, model], scores.resampled[:, model])
            for model in range(scores.values.shape[1])
        ]
    ).reshape(-1, 2)
    own = [level.averaged(number, [model]) for model in scores.models]
    n_own = np.array([of.n_shapes for of in own])
    own_mean = np.where(n_own == scores.n_shapes, summary.mean, [means(of.values)[0] for of in own])
    return {
        "n": summary.n,
        "n_shapes": scores.n_shapes,
        "n_own_shapes": n_own,
        "own_mean": own_mean,
        "mean": summary.mean,
        "sd": summary.sd,
        "ci95_low": summary.low,
        "ci95_high": summary.high,
        "low": low,
        "high": high,
        "half": np.where(was_cut, np.nan, (summary.high - summary.low) / 2),
        "bca95_low": bca[:, 0],
        "bca95_high": bca[:, 1],
    }
