# SPDX-License-Identifier: GPL-3.0-or-later
# Run by scripts/check calibrate, by a test, and by whoever changes how conclusions are drawn.
"""How often statements about several models at once err:  PYTHONPATH=build/release/python scripts/calibration_joint.py [DATA_SETS [SCORES.csv]]

Prints the tables of docs/statistics.md: any pair told apart of equal models, power beside the bootstrap bound of before, new classes with the
variances of SCORES.csv (a table with classes), and scores that are missing where they are low.
"""

import sys
from dataclasses import dataclass

import numpy as np
import pandas as pd
from scipy import special

from salbench.conclusions.leaders import find_leaders
from salbench.conclusions.metrics import Metric
from salbench.conclusions.ranks import differing
from salbench.conclusions.resampling import Bootstrap, on_grid
from salbench.conclusions.samples import summarise
from salbench.conclusions.scores import read_scores
from salbench.conclusions.study import Study
from salbench.conclusions.units import TEXTS, Level, Scores

SEED = 2016
MODELS, MESHES, VIEWS = (3, 5, 8, 11, 20), (6, 10, 19, 60, 400), 12
DRAWS = 2000  # a fifth of the package's: tests by flips err as often with any number of them
BATCH = 50  # data sets that share their draws
SCORE = Metric("auc", True, chance=.5)


def normal(rng, *shape):
    return rng.normal(size=shape)


def skewed(rng, *shape):
    return (rng.chisquare(4, size=shape) - 4) / 8**.5


def strongly_skewed(rng, *shape):
    """And not alike: with equal deviations the skewness of two models cancels in their difference."""
    return (rng.chisquare(1, size=shape) - 1) / 2**.5 * (1 + np.arange(shape[-1]) % 3)


def heavy(rng, *shape):
    return rng.standard_t(3, size=shape) / 3**.5


def unequal(rng, *shape):
    return rng.normal(size=shape) * 2.0**(np.arange(shape[-1]) % 3)


def tied(rng, *shape):
    """Whole numbers, and nothing at all on a third of the meshes."""
    return np.where(rng.random(size=(*shape[:-1], 1)) < 1 / 3, 0, np.rint(rng.normal(size=shape)))


NOISES = {"normal": normal, "skewed": skewed, "heavy tails": heavy, "unequal variances": unequal, "ties and zeros": tied,
          "strongly skewed": strongly_skewed}


def drawn(noise, rng, meshes, models, views):
    """Scores of equal models: what they do on a mesh and, as large, on a view of it. meshes x models."""
    own = noise(rng, meshes, models)
    return own if views == 1 else own + np.mean([noise(rng, meshes, models) for _ in range(views)], axis=0)


def batches(noise, meshes, models, views, data_sets, seed, shift=0.0):
    """Data sets, and the sums of their scores with the signs of each draw."""
    for batch in range(0, data_sets, BATCH):
        rng = np.random.default_rng([seed, meshes, models, views, batch])
        values = [on_grid(drawn(noise, rng, meshes, models, views) + shift) for _ in range(min(BATCH, data_sets - batch))]
        bootstrap = Bootstrap(seed + batch, DRAWS, threads=1)
        flipped = np.hsplit(bootstrap.flipped_of_each([np.hstack(values)])[0], len(values))
        yield bootstrap, values, flipped


def any_pair(noise, meshes, views, data_sets, seed=SEED):
    """Share of data sets in which some pair of equal models differs, by number of models: the first ones of the same data sets."""
    found = dict.fromkeys(MODELS, 0)
    for _, values, flipped in batches(noise, meshes, max(MODELS), views, data_sets, seed):
        for of_models, sums in zip(values, flipped):
            for k in MODELS:
                found[k] += differing(of_models[:, :k], sums[:, :k])[0].any()
    return {k: count / data_sets for k, count in found.items()}


def bound_of_bootstrap(values, resampled):
    """Version 1.7: the largest |difference - resampled difference| / standard error, made Student's for one pair."""
    n, (a, b) = len(values), np.triu_indices(values.shape[1], 1)
    of = summarise(values[:, a] - values[:, b])
    away = np.abs(resampled[:, a] - resampled[:, b] - of.mean) / (of.sd / np.sqrt(n))
    return np.quantile(away.max(axis=1), .95) * np.sqrt(n / (n - 1)) * special.stdtrit(n - 1, .975) / special.ndtri(.975)


@dataclass
class Power:
    leads: float  # share of the data sets in which the best model is ahead of every other one
    pairs: float  # share of the pairs that differ which are found
    lead: float  # share of the data sets in which the interval of the lead of the best mean holds the true one


def power(meshes, means, data_sets, seed=SEED):
    """By flips, and by the bound of the bootstrap."""
    means = np.array(means)
    truth, found = means[:, None] > means, np.zeros((2, 3))
    for bootstrap, values, flipped in batches(normal, meshes, len(means), 1, data_sets, seed, means):
        resampled = np.hsplit(bootstrap.means(np.hstack(values)), len(values))
        for of_models, sums, of_means in zip(values, flipped, resampled):
            best, second = np.argsort(-of_models.mean(axis=0))[:2]
            bootstrapped = bound_of_bootstrap(of_models, of_means)
            a, b = np.nonzero(~np.eye(len(means), dtype=bool))
            of = summarise(of_models[:, a] - of_models[:, b])
            old = np.zeros_like(truth)
            old[a, b] = of.mean > bootstrapped * of.sd / np.sqrt(meshes)
            lead = summarise(of_models[:, [best]] - of_models[:, [second]])
            for row, (better, bound) in enumerate((differing(of_models, sums), (old, bootstrapped))):
                held = abs(lead.mean[0] - (means[best] - means[second])) <= bound * lead.sd[0] / np.sqrt(meshes)
                found[row] += better[0, 1:].all(), better[truth].mean(), held
    return [Power(*shares) for shares in found / data_sets]


def components(values, classes):
    """Deviations of the differences between models: from class to class, and from mesh to mesh of one; below 0 they are 0."""
    own = values - values.mean(axis=1, keepdims=True) - (values - values.mean(axis=1, keepdims=True)).mean(axis=0)
    groups = pd.DataFrame(own).groupby(classes)
    k, size = values.shape[1], len(values) / groups.ngroups
    within = ((own - groups.transform("mean").to_numpy()) ** 2).sum() / ((len(values) - groups.ngroups) * (k - 1))
    between = (groups.mean().to_numpy() ** 2).sum() / ((groups.ngroups - 1) * (k - 1))
    return np.sqrt(max(between - within / size, 0)), np.sqrt(within)


def frame(values, classes=None):
    """Scores of meshes x models."""
    meshes, models = values.shape
    item, model = np.indices(values.shape).reshape(2, -1)
    texts = dict.fromkeys(TEXTS, "") | {"dataset": "meshes", "item": item.astype(str), "model": "M" + model.astype(str).astype(object)}
    if classes is not None:
        texts["class"] = np.repeat(classes, models)
    return pd.DataFrame(texts).astype(object).assign(auc=values.ravel())


def new_classes(of_class, of_mesh, data_sets, classes=20, meshes=20, models=4, seed=SEED):
    """Of models that are equal over all classes that there could be."""
    names = np.repeat(np.arange(classes).astype(str), meshes)
    covered, leads = {"mesh": 0, "class": 0}, {"on these": 0, "new classes": 0}
    for i in range(data_sets):
        rng = np.random.default_rng([seed, i])
        values = np.repeat(of_class * rng.normal(size=(classes, models)), meshes, axis=0) + of_mesh * rng.normal(size=(classes * meshes, models))
        difference = values[:, 0] - values[:, 1]
        for unit, units in (("mesh", difference), ("class", difference.reshape(classes, meshes).mean(axis=1))):
            interval = summarise(units[:, None])
            covered[unit] += bool(interval.low[0] <= 0 <= interval.high[0])
        (leader,) = find_leaders(Study(Scores(frame(values, names), (SCORE,)), seed=seed + i, threads=1))[0].leaders
        leads["on these"] += leader.verdict == "leads"
        leads["new classes"] += leader.new_classes.verdict == "leads"
    return {what: count / data_sets for what, count in {**covered, **leads}.items()}


def missing(data_sets, meshes=60, share=.1, models=4, seed=SEED):
    """Of equal models, the first of which has no score where it would be lowest."""
    found = dict.fromkeys(("interval of a difference from the first model covers it", "the first model leads", "and its sentence says what it lacks",
                           "it ranks first with these at chance"), 0.0)
    for i in range(data_sets):
        rng = np.random.default_rng([seed, i])
        values = .65 + .04 * rng.normal(size=(meshes, 1)) + .06 * rng.normal(size=(meshes, models))
        lowest = np.argsort(values[:, 0])[: round(share * meshes)]
        values[lowest, 0] = np.nan
        interval = summarise(np.delete(values[:, :1] - values[:, 1:], lowest, axis=0))
        level = find_leaders(Study(Scores(frame(values), (SCORE,)), seed=seed + i, threads=1))[0]
        (leader,) = level.leaders
        first = leader.verdict == "leads" and leader.models == ["M0"]
        said = f"M0 has no score on {len(lowest)}" in level.sentence and "at chance, M0 ranks" in level.sentence
        for what, hit in zip(found, (np.mean((interval.low <= 0) & (0 <= interval.high)), first, first and said, leader.missing["M0"][1] == 1)):
            found[what] += hit / data_sets
    return found


def percent(share):
    return f"{100 * share:.1f}"


def show_joint(data_sets):
    print(f"any pair told apart, % of {data_sets} data sets (standard error of 5 %: {percent(np.sqrt(.05 * .95 / data_sets))})\n")
    print(f"| scores | meshes | {' | '.join(f'{k} models' for k in MODELS)} | with {VIEWS} views: {' | '.join(f'{k}' for k in MODELS)} |")
    print("|---" * (2 + 2 * len(MODELS)) + "|")
    for name, noise in NOISES.items():
        for meshes in MESHES:
            cells = [percent(rate) for views in (1, VIEWS) for rate in any_pair(noise, meshes, views, data_sets).values()]
            print(f"| {name} | {meshes} | {' | '.join(cells)} |", flush=True)


def show_power(data_sets):
    print(f"\npower, % of {data_sets} data sets\n\n| models | meshes | the best leads | before | pairs found | before | the lead's interval holds | before |\n" + "|---" * 8 + "|")
    for meshes in (19, 393):
        step = np.sqrt(19 / meshes)
        for what, means in (("4, one ahead", [1.2, 0, 0, 0]), ("4, each ahead of the next", [2.4, 1.6, .8, 0])):
            new, old = power(meshes, step * np.array(means), data_sets)
            print(f"| {what} | {meshes} | {percent(new.leads)} | {percent(old.leads)} | {percent(new.pairs)} | {percent(old.pairs)} | {percent(new.lead)} | "
                  f"{percent(old.lead)} |", flush=True)


def show_classes(scores, data_sets):
    for number, metric in enumerate(scores.metrics):
        level = Level(scores.part(scores.frame["class"] != ""), scores.frame["dataset"].iloc[0], "mesh")
        values = level.compared(number, level.competitors(number))
        own = scores.frame.drop_duplicates("item").set_index("item")["class"]
        items = np.array(scores.frame["item"].unique())[values.units]
        of_class, of_mesh = components(values.values, own[items].to_numpy())
        found = new_classes(of_class, of_mesh, data_sets)
        print(f"{metric.name}: deviations of a model from class to class {of_class:.4f}, from mesh to mesh {of_mesh:.4f}; {data_sets} data sets: "
              + "; ".join(f"{what} {percent(rate)} %" for what, rate in found.items()), flush=True)


def main(data_sets="2000", scores=""):
    n = int(data_sets)
    show_joint(n)
    show_power(n)
    print(f"\n{n // 4} data sets of 60 meshes, 4 equal models, the lowest 10 % of one missing:")
    for what, rate in missing(n // 4).items():
        print(f"  {what}: {percent(rate)} %", flush=True)
    if scores:
        print("\n20 classes of 20 meshes, 4 equal models: intervals that cover the difference over new classes, by unit; tables in which one leads")
        show_classes(read_scores(scores).scores, n // 4)


if __name__ == "__main__":
    if len(sys.argv) > 3:
        sys.exit("usage: calibration_joint.py [DATA_SETS [SCORES.csv]]")
    main(*sys.argv[1:])
