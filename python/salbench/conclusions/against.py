# SPDX-License-Identifier: GPL-3.0-or-later
"""Compares one model with every other, using only its own pairs: against.csv. These are fewer than all pairs,
so smaller differences become significant. Sign flips and joint intervals as for ranks; the many-to-one
comparison is Dunnett's [dunnett1955]."""

from collections.abc import Iterator

import numpy as np
import pandas

from salbench.conclusions.ranks import differing
from salbench.conclusions.resampling import FEWEST, on_grid
from salbench.conclusions.samples import summarise
from salbench.conclusions.study import Study
from salbench.conclusions.tables import DATASET, METRIC, N_SHAPES, SPLIT, N, Part, framed, number, text
from salbench.conclusions.units import Floats

AHEAD, BEHIND, OPEN = "ahead", "behind", "not told apart"
COLUMNS = (
    DATASET,
    SPLIT,
    METRIC,
    text("model", "the one"),
    text("other", "another competitor"),
    N,
    N_SHAPES,
    number("mean_difference", "mean over the units of the one less the other"),
    number("low", "95 % interval, joint for all pairs of the one; empty for fewer than six units"),
    number("high", "upper end"),
    text(
        "verdict",
        f'"{AHEAD}", "{BEHIND}" or "{OPEN}", as the metric is better; empty for fewer than six units',
    ),
)


def against(study: Study, model: str) -> pandas.DataFrame:
    """A row per data set, metric and other competitor compared with the model; none for references."""
    return framed(COLUMNS, _parts(study, model), study.in_splits)


def _parts(study: Study, model: str) -> Iterator[Part]:
    for level, ranked in study.ranked:
        for metric, of_metric in zip(level.metrics, ranked):
            scores = of_metric.competitors
            names = [level.models[at] for at in scores.models]
            if model not in names or len(names) < 2 or not scores.n:
                continue
            one = names.index(model)
            others = [at for at in range(len(names)) if at != one]
            found = summarise(scores.values[:, [one]] - scores.values[:, others])
            half: Floats = np.full(len(others), np.nan)
            verdicts = [""] * len(others)
            if scores.n >= FEWEST:
                flipped = study.bootstrap.flipped_of_each([scores.values])[0]
                better, _, joint = differing(
                    on_grid(scores.values),
                    flipped,
                    study.bootstrap.sums_of_signs(scores.n),
                    metric.higher_is_better,
                    one,
                )
                half = np.where(found.sd > 0, joint * found.sd / np.sqrt(scores.n), np.nan)
                verdicts = [
                    AHEAD if better[one, at] else BEHIND if better[at, one] else OPEN for at in others
                ]
            yield {
                "dataset": level.dataset,
                "split": level.split,
                "metric": metric.name,
                "model": model,
                "other": [names[at] for at in others],
                "n": scores.n,
                "n_shapes": scores.n_shapes,
                "mean_difference": found.mean,
                "low": found.mean - half,
                "high": found.mean + half,
                "verdict": verdicts,
            }
