# SPDX-License-Identifier: GPL-3.0-or-later
"""Metrics as conclusions and pages use them: name, label, direction and range."""

import math
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache

PAPERS = ("auc", "nss", "lcc")
_LEADING = 3  # metrics that every page shows and sentences are about
# by the part of the name before the first "_"
_CHANCE = {"auc": 0.5, "sauc": 0.5, "nss": 0, "cc": 0, "lcc": 0, "spearman": 0}


@dataclass(frozen=True)
class Metric:
    """A column of scores. `low` and `high` bound its values; infinite for columns that are not the
    program's."""

    name: str
    higher_is_better: bool = True
    low: float = -math.inf
    high: float = math.inf
    label: str = ""
    # mean score of uninformative maps, or `low` if that is all that is known of it; NaN: unknown, except
    # through RS
    chance: float = math.nan


@cache
def of_program() -> dict[str, Metric]:
    """The program's metrics by name, in the order of its tables."""
    from salbench import _core

    return {
        name: Metric(name, higher_is_better, low, high, label, _CHANCE.get(name.split("_")[0], math.nan))
        for name, _, _, higher_is_better, label, low, high in _core.metric_rows()
    }


def label_of(name: str) -> str:
    """Label for readers; the name itself if the column is not the program's."""
    return of_program().get(name, Metric(name)).label or name


def lower_is_better(name: str) -> bool:
    return not of_program().get(name, Metric(name)).higher_is_better


def leading_metrics(names: Iterable[str], chief: str = "") -> list[str]:
    """Selects the chief metric, by which models are ranked, and those of the paper among `names`, filled up
    to three with the first of the others. Variants of selected metrics come last, since they are nearly
    redundant. The default chief metric is the first."""
    known = list(names)
    papers = [name for name in PAPERS if name in known]
    others = [name for name in known if name not in papers]
    kinds = [name.partition("_")[0] for name in [*papers, *others]]
    is_variant = {
        name: kinds.index(kind) < at for at, (name, kind) in enumerate(zip([*papers, *others], kinds))
    }
    found = sorted(
        papers + sorted(others, key=lambda name: is_variant[name])[: _LEADING - len(papers)], key=known.index
    )
    return [chief, *(name for name in found if name != chief)][:_LEADING] if chief in known else found
