# SPDX-License-Identifier: GPL-3.0-or-later
# Imported by scripts/figures and by a test.
"""Coverage of joint intervals, for equal and unequal models; and the effect of skew on comparisons of one
model with the others."""

import numpy as np

from .calibration import SEED, batches, normal, percent
from .common import ROOT, markdown, show
from salbench.conclusions.ranks import differing
from salbench.conclusions.samples import summarise

UNITS, MODELS = (8, 10, 20), (3, 6, 10)
PATTERNS = {
    "all equal": lambda k: np.zeros(k),
    "half equal": lambda k: np.r_[np.zeros(k // 2), np.linspace(0, 4, k - k // 2)],
    "0 to 4 sd apart": lambda k: np.linspace(0, 4, k),
}


def log_normal_first(rng, *shape):
    """Equal means; log-normal scores of the first model, normal ones of the others."""
    values = rng.normal(size=shape)
    values[..., 0] = np.exp(values[..., 0]) - np.exp(0.5)
    return values


def holds(values, means, joint, of=None):
    """True if the intervals of all differences, or of those from one model, hold the true ones."""
    a, b = np.triu_indices(len(means), 1)
    kept = slice(None) if of is None else (a == of) | (b == of)
    a, b = a[kept], b[kept]
    found = summarise(values[:, a] - values[:, b])
    return bool((np.abs(found.mean - (means[a] - means[b])) <= joint * found.sd / np.sqrt(len(values))).all())


def coverage(units, means, data_sets):
    """Share of data sets in which all joint intervals hold: for all pairs, and for one model against every
    other."""
    found = np.zeros(2)
    for values, flipped, signs in batches(normal, units, len(means), 1, data_sets, SEED, means):
        for of_models, sums in zip(values, flipped):
            found += [
                holds(of_models, means, differing(of_models, sums, signs, of=of).joint, of)
                for of in (None, 0)
            ]
    return found / data_sets


def errors_of_one(units, models, data_sets):
    """Share of data sets of equal models in which one, with log-normal scores, is found to differ from
    another."""
    found = 0
    for values, flipped, signs in batches(log_normal_first, units, models, 1, data_sets, SEED):
        for of_models, sums in zip(values, flipped):
            better = differing(of_models, sums, signs, of=0).better
            found += better[0].any() or better[:, 0].any()
    return found / data_sets


def joint(n, write):
    rows = [
        [
            f"{units}",
            f"{k}",
            *("; ".join(map(percent, coverage(units, of(k), n))) for of in PATTERNS.values()),
            percent(errors_of_one(units, k, n)),
        ]
        for units in UNITS
        for k in MODELS
    ]
    show(
        f"{n} data sets in each cell:\n\n"
        + markdown(["meshes", "models", *PATTERNS, "one skewed: told apart"], rows),
        ROOT / "docs/statistics.md",
        "joint",
        write,
    )
