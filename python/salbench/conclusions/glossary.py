# SPDX-License-Identifier: GPL-3.0-or-later
"""Meaning of the letters in tables: the authors of each model, and what each metric compares. Pages show one
line per letter, or tooltips."""

from collections.abc import Iterable
from math import isinf

from salbench._core import models_about
from salbench.conclusions.metrics import Metric, label_of, lower_is_better, of_program


# In plain words; other metrics use the program's text.
_COMPARES = {
    "auc": "how often a point that people picked lies above one drawn at random; 0.5 is chance",
    "auc_exact": "how often a point that people picked lies above one that nobody picked; 0.5 is chance",
    "nss": "how far picked points lie above the mean of the map, in its standard deviations; 0 is chance",
    "cc": "how far map and ground truth rise and fall together (Pearson's correlation); 0 is chance",
    "lcc": (
        "how far map and ground truth rise and fall together, whichever way (magnitude of the correlation)"
    ),
    "spearman": "how far map and ground truth order the points alike (correlation of ranks); 0 is chance",
    "sim": "what map and ground truth share, both as distributions",
}


def compares(name: str) -> str:
    """Plain description of a metric; empty if it is not one of the program's."""
    from salbench import _core

    of_program = {row[0]: row[2] for row in _core.metric_rows()}
    return _COMPARES.get(name, of_program.get(name, ""))


def range_of(name: str) -> str:
    """Range of a metric, such as "0 to 1"."""
    known = of_program().get(name, Metric(name))
    low, high = ("" if isinf(end) else f"{end:.0f}".replace("-", "−") for end in (known.low, known.high))
    return f"{low} to {high}" if low and high else f"{low} or more" if low else "any number"


def better(name: str) -> str:
    return f"{'lower' if lower_is_better(name) else 'higher'} is better"


def titles(models: Iterable[str], metrics: Iterable[str]) -> dict[str, str]:
    """Maps models and metrics of a table to their meaning. models: only the program's own; others may use the
    same letters."""
    found = {
        name: ", ".join(filter(None, (models_about[name].name, models_about[name].source)))
        for name in models
        if name in models_about
    }
    return found | {
        label_of(name): f"{compares(name)}; {range_of(name)}, {better(name)}"
        for name in metrics
        if compares(name)
    }
