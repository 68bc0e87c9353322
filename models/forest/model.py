#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""A trained model for a laptop: boosted trees that predict gaze at a point from descriptors that the program
computes there.

    models/forest/model.py DATA [--config FILE] [--by class|mesh|split] [--folds N] [--cache DIR] [--out DIR]

Cross-validates it beside the models of the configuration (models/forest/model.yaml), and prints the means.
Neither the descriptors nor the numbers below were tuned on scores. The same seed gives the same bytes with
any number of threads.
"""

import argparse
import functools
import os
from pathlib import Path

# Must be set before OpenMP is loaded. Spinning threads take cores from other processes: on two busy cores
# training took ten times as long.
os.environ.setdefault("OMP_WAIT_POLICY", "passive")

import numpy as np
import salbench
from scipy.stats import rankdata
from sklearn.ensemble import HistGradientBoostingRegressor

SEED = 0
POINTS = 2000  # training points per shape, so that large shapes count no more than small ones
RADII = (0.02, 0.05)  # radii of descriptors, in R
WIDTH = 2 + 9 + 33 * len(RADII)
TREES = {"loss": "poisson", "max_iter": 200, "learning_rate": 0.05, "max_leaf_nodes": 15, "min_samples_leaf": 50, "l2_regularization": 1.0,
         "early_stopping": False}


def maps_of(shape, threads):
    """Maps by several models and at several sizes; NaN if a model fails on the shape, which trees handle."""
    models = salbench.models
    calls = [functools.partial(models.nv, radius=radius) for radius in (0.02, 0.05, 0.1)]
    for model in (*calls, models.cb, models.mc, models.ls, models.cs, models.ps, models.ms):
        try:
            yield model(shape, threads=threads)
        except ValueError:
            yield np.full(len(shape), np.nan)


def features(shape):
    """Features (n, WIDTH): variation of the normals and distance to the centroid unchanged, all maps as ranks
    within the shape, descriptors."""
    threads = len(os.sched_getaffinity(0))
    maps = list(maps_of(shape, threads))
    ranks = [rankdata(values) / len(values) if np.isfinite(values).all() else values for values in maps]
    descriptors = [salbench.fpfh(shape.points, shape.normals, neighbourhood="radius", radius=radius, threads=threads) for radius in RADII]
    return np.column_stack([maps[0], maps[3], *ranks, *descriptors]).astype(np.float32)


@functools.lru_cache(maxsize=4096)
def examples(shape):
    """Features and targets at some points; the target is the ground truth as a density with mean 1 over the
    shape."""
    seen = np.flatnonzero(shape.mask)
    chosen = np.random.default_rng([SEED, *shape.id.encode()]).permutation(seen)[:POINTS]
    mean = shape.ground_truth[seen].mean() if len(seen) else 0
    if mean <= 0:  # nobody looked at it
        return np.empty((0, WIDTH), np.float32), np.empty(0)
    return features(shape)[chosen], shape.ground_truth[chosen] / mean


def fit(shapes):
    """Minimises Poisson loss: with equally many points per shape, its minimum is that of the KL divergence of
    densities."""
    x, y = map(np.concatenate, zip(*map(examples, shapes)))
    trees = HistGradientBoostingRegressor(**TREES, random_state=SEED).fit(x, y)
    return lambda shape: trees.predict(features(shape))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("data")
    parser.add_argument("--config", default=Path(__file__).with_name("model.yaml"))
    parser.add_argument("--by", default="class", choices=("class", "mesh", "split"))
    parser.add_argument("--folds", type=int, default=5)
    parser.add_argument("--cache", default="salbench-cache")
    parser.add_argument("--out", default="salbench-out/forest")
    given = parser.parse_args()
    try:
        results = salbench.cross_validate({"FOREST": fit}, given.data, given.config, folds=given.folds, by=given.by, cache=given.cache,
                                          out=given.out)
    except (KeyError, ValueError) as error:  # no such split, fewer classes than folds
        parser.error(error.args[0])
    print(f"FOREST: {results.trained['FOREST']}")
    summary = results.summary
    rows = [name for name in ("dataset", "split") if name in summary and summary[name].nunique() > 1]
    print(summary.pivot(index=[*rows, "model"], columns="metric", values="mean").round(3).to_string(sparsify=False))


if __name__ == "__main__":
    main()
