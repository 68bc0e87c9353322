# SPDX-License-Identifier: GPL-3.0-or-later
# Imported by scripts/figures.
"""Time of a metric beside the same by NumPy, SciPy and scikit-learn, in turns: the least of many calls."""

import timeit

import numpy as np
import salbench
from scipy import stats
from sklearn.metrics import roc_auc_score

EPS = 2.2204e-16  # as the metric kl adds it
POINTS, PICKS, MAPS, ROUNDS = 20_000, 200, 16, 15


def normalised(values):
    return (values - values.min()) / (values.max() - values.min())


def sim(a, b):
    return np.minimum(a / a.sum(), b / b.sum()).sum()


def kl(a, b):
    p, g = a / a.sum(), b / b.sum()
    return (g * np.log(EPS + g / (p + EPS))).sum()


def nss(a, picks):
    return ((a[picks] - a.mean()) / a.std()).mean()


def auc(a, picks):
    """The area by ranks, which shares ties out: what scikit-learn's curve holds."""
    ranks, positives = stats.rankdata(a), len(picks)
    return (ranks[picks].sum() - positives * (positives + 1) / 2) / (positives * (len(a) - positives))


def least(functions):
    """Seconds of a call of each function, in turns."""
    times = [[] for _ in functions]
    for _ in range(ROUNDS):
        for function, taken in zip(functions, times):
            taken.append(timeit.timeit(function, number=20) / 20)
    return [min(taken) for taken in times]


def metrics():
    draws = np.random.default_rng(1)
    a, b = (normalised(draws.random(POINTS)) for _ in range(2))
    many = np.stack([normalised(draws.random(POINTS)) for _ in range(MAPS)])
    picks = np.sort(draws.choice(POINTS, PICKS, replace=False))
    picked = np.isin(np.arange(POINTS), picks)
    m = salbench.metrics
    rows = {
        "cc": (lambda x: m.cc(x, b), lambda: np.corrcoef(a, b)[0, 1]),
        "sim": (lambda x: m.sim(x, b), lambda: sim(a, b)),
        "kl": (lambda x: m.kl(x, b), lambda: kl(a, b)),
        "nss": (lambda x: m.nss(x, picks=picks), lambda: nss(a, picks)),
        "auc_exact": (lambda x: m.auc_exact(x, picks=picks), lambda: auc(a, picks)),
        "auc_exact*": (lambda x: m.auc_exact(x, picks=picks), lambda: roc_auc_score(picked, a)),
    }
    print(
        f"{POINTS} points, {PICKS} picks; ms: salbench, NumPy or SciPy (* scikit-learn), times as long; salbench per map of {MAPS}"
        " in a call; difference of the values"
    )
    for name, (ours, theirs) in rows.items():
        one, peer, batch = least([lambda: ours(a), theirs, lambda: ours(many)])
        print(
            f"  {name:<10}{1e3 * one:8.3f}{1e3 * peer:8.3f}{one / peer:8.2f}{1e3 * batch / MAPS:10.3f}{abs(ours(a) - theirs()):12.1e}"
        )
