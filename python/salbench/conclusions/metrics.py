# SPDX-License-Identifier: GPL-3.0-or-later
"""Metrics as conclusions know them: name, direction, and the values that they can take."""

import math
from dataclasses import dataclass

_SHARE, _CORRELATION, _DIVERGENCE = (0.0, 1.0), (-1.0, 1.0), (0.0, math.inf)

# By the part of the name before the first "_". Heights in standard deviations (nss) and gains (ig) have no bounds.
_RANGES = {"auc": _SHARE, "cc": _CORRELATION, "lcc": _SHARE, "spearman": _CORRELATION, "kl": _DIVERGENCE, "sim": _SHARE, "mse": _SHARE,
           "mae": _SHARE, "sauc": _SHARE, "cosine": _CORRELATION, "fne": _SHARE, "fpe": _SHARE, "wme": _SHARE, "precision": _SHARE,
           "recall": _SHARE}
_CHANCE = {"auc": .5, "sauc": .5, "nss": 0, "cc": 0, "lcc": 0, "spearman": 0}  # by maps that know nothing; of others RS alone knows


@dataclass(frozen=True)
class Metric:
    """A column of scores. `low` and `high` bound its values; nothing is known of those of a column that is not the program's."""

    name: str
    higher_is_better: bool = True
    low: float = -math.inf
    high: float = math.inf
    chance: float = math.nan  # the mean score of maps that know nothing; NaN: not known


def of_program() -> dict[str, Metric]:
    """The program's metrics by name, in the order of its tables."""
    from salbench import _core

    metrics = {}
    for name, _, _, higher_is_better in _core.metric_rows():
        kind = name.split("_")[0]
        metrics[name] = Metric(name, higher_is_better, *_RANGES.get(kind, (-math.inf, math.inf)), _CHANCE.get(kind, math.nan))
    return metrics
