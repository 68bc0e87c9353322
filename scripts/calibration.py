# SPDX-License-Identifier: GPL-3.0-or-later
# Run by scripts/check calibrate, by a test, and by whoever changes how conclusions are drawn.
"""How often intervals hold and tests err:  PYTHONPATH=build/release/python scripts/calibration.py SCORES.csv [DATA_SETS [MESHES]]

Scores of models that are equal by construction are simulated with the variances between and within meshes that the scans of a table of
scores have, as many meshes as it has (or MESHES), and concluded from as a run concludes from its own. Where human_curve_by_mesh.csv lies
beside the table, meshes with models and people are simulated, too, with the means and covariances of these.
"""

import sys
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
import pandas as pd

from salbench.conclusions.equivalents import first_reached, human_equivalents
from salbench.conclusions.means import summary
from salbench.conclusions.metrics import Metric
from salbench.conclusions.pairs import compare
from salbench.conclusions.people import human_curve_differences
from salbench.conclusions.ranking import ranking
from salbench.conclusions.samples import CONFIDENCE, LEVEL
from salbench.conclusions.scores import read_scores
from salbench.conclusions.shares import human_share
from salbench.conclusions.significance import significance
from salbench.conclusions.study import Study
from salbench.conclusions.units import TEXTS, Level, Scores

SEED = 2016
SCORE = Metric("score")


@dataclass(frozen=True)
class ScoreModel:
    """Standard deviations of what a score is the sum of; all normal."""

    mesh: float = 1  # what all models share: how hard a mesh is
    view: float = 1  # and a view of it
    model_of_mesh: float = 1  # what a model does otherwise on a mesh
    model_of_view: float = 1
    models: int = 4
    meshes: int = 30
    views: int = 12

    def draw(self, rng, ahead=0.0):
        """meshes x views x models; the first model is better by `ahead`."""
        of_mesh = self.mesh * rng.normal(size=(self.meshes, 1, 1)) + self.model_of_mesh * rng.normal(size=(self.meshes, 1, self.models))
        of_mesh[:, :, 0] += ahead
        of_view = self.view * rng.normal(size=(self.meshes, self.views, 1))
        return of_mesh + of_view + self.model_of_view * rng.normal(size=(self.meshes, self.views, self.models))

    def rows(self):
        """Texts of the scores, in the order of draw()."""
        of = np.indices((self.meshes, self.views, self.models)).reshape(3, -1).astype(str).astype(object)
        return pd.DataFrame({"dataset": "scans", "split": "", "item": of[0], "class": "", "view": of[1], "model": "M" + of[2]})

    def standard_error(self):
        """Of the mean difference of two models."""
        return np.sqrt(2 * (self.model_of_mesh**2 + self.model_of_view**2 / self.views) / self.meshes)


def score_model(scores: Scores, metric: int) -> ScoreModel:
    """Estimated from the scores of the competitors on scans: analysis of variance, components below 0 being 0."""
    scans = scores.part(scores.frame["dataset"] == "scans")
    level = Level(scans, "scans", "shape")
    values = level.compared(metric, level.competitors(metric))
    mesh = pd.Series(Level(scans, "scans", "mesh").unit_of_shape[values.units])
    own = pd.DataFrame(values.values - values.values.mean(axis=0))
    shared = own.mean(axis=1)
    k, views = own.shape[1], len(own) / mesh.nunique()
    left = k / (k - 1)  # what a mean over k takes away
    (within, between), (own_within, own_between) = _spread(shared.to_frame(), mesh), _spread(own.sub(shared, axis=0), mesh)
    mesh_variance, own_variance = between - within / views, left * (own_between - own_within / views)
    deviations = np.sqrt(np.maximum([mesh_variance, within, own_variance, left * own_within], 0))
    return ScoreModel(*deviations, models=k, meshes=mesh.nunique(), views=round(views))


def _spread(values, mesh):
    """Variance within meshes, and that of the means of meshes; those of several models are meshes of their own."""
    groups = values.groupby(mesh.to_numpy())
    freedom = (groups.size() - 1).sum()
    within = ((values - groups.transform("mean")) ** 2).sum().sum() / (freedom * values.shape[1]) if freedom else 0.0
    return within, groups.mean().stack().var(ddof=1)


@dataclass
class Rates:
    """Hits and cases of each kind of interval and test, in the order of the tables."""

    expected: dict[str, float] = field(default_factory=dict)
    hits: dict[str, list[bool]] = field(default_factory=dict)

    def add(self, what, expected, hits):
        self.expected[what] = expected
        self.hits.setdefault(what, []).extend(np.atleast_1d(hits).tolist())

    def add_intervals(self, what, low, high, truth):
        known = ~(np.isnan(low) | np.isnan(high) | np.isnan(truth))
        self.add(what, CONFIDENCE, ((low <= truth) & (truth <= high))[known])

    def __iter__(self) -> Iterator[tuple[str, float, float]]:
        """What, nominal rate, rate."""
        return ((what, self.expected[what], float(np.mean(hits))) for what, hits in self.hits.items() if hits)


def calibrate(model: ScoreModel, data_sets: int, seed: int) -> Rates:
    rates, rows = Rates(), model.rows()
    pair = replace(model, models=2)
    margin = 3 * pair.standard_error()
    for i in range(data_sets):
        rng = np.random.default_rng([seed, i])
        _add_equal_models(rates, Scores(rows.assign(score=model.draw(rng).ravel()), (SCORE,)), seed + i)
        # Two models that differ by exactly the margin, which half of the tests would find equal if they took no care.
        by_mesh = pair.draw(rng, margin).mean(axis=1)
        found = compare(by_mesh[:, :1] - by_mesh[:, 1:])
        rates.add("equivalence at its margin", LEVEL, (-margin < found.ci90_low) & (found.ci90_high < margin))
    return rates


def _add_equal_models(rates, scores, seed):
    study = Study(scores, seed=seed)
    means, pairs, ranks = summary(study), significance(study), ranking(study)
    zero = np.zeros(len(means))
    rates.add_intervals("interval of a mean (Student)", means["ci95_low"], means["ci95_high"], zero)
    rates.add_intervals("interval of a mean (BCa)", means["bca95_low"], means["bca95_high"], zero)
    rates.add_intervals("interval of a difference", pairs["ci95_low"], pairs["ci95_high"], np.zeros(len(pairs)))
    rates.add_intervals("interval of the superiority", pairs["superiority_low"], pairs["superiority_high"], np.full(len(pairs), .5))
    rates.add("paired t-test", LEVEL, pairs["t_p"] < LEVEL)
    rates.add("signed-rank test", LEVEL, pairs["signed_rank_p"] < LEVEL)
    rates.add("any of a family after Holm", LEVEL, pairs["signed_rank_p_holm"].min() < LEVEL)
    covers = (ranks["rank_low"] == 1) & (ranks["rank_high"] == len(ranks))
    rates.add("interval of a rank", CONFIDENCE, covers)
    rates.add("intervals of all ranks", CONFIDENCE, covers.all())
    by_shape = significance(Study(scores, "shape"))
    rates.add_intervals("unit shape: interval of a difference", by_shape["ci95_low"], by_shape["ci95_high"], np.zeros(len(pairs)))
    rates.add("unit shape: rank-sum test", LEVEL, pairs["rank_sum_p"] < LEVEL)


@dataclass(frozen=True)
class PeopleModel:
    """Scores of meshes by models, then by numbers of participants 1, 2, ..."""

    metric: Metric
    models: list[str]
    values: np.ndarray  # meshes x columns

    def draw(self, meshes, rng):
        """Normal values with the means and covariances of the columns."""
        weights = rng.normal(size=(meshes, len(self.values))) / np.sqrt(len(self.values) - 1)
        return self.values.mean(axis=0) + weights @ (self.values - self.values.mean(axis=0))

    def study(self, values, seed):
        items, k = np.arange(len(values)).astype(str).astype(object), len(self.models)
        texts = dict.fromkeys(TEXTS, "") | {"dataset": "meshes", "item": np.repeat(items, k), "model": np.tile(self.models, len(items))}
        length = values.shape[1] - k
        people = pd.DataFrame({"item": np.repeat(items, length), "class": "", "n": np.tile(np.arange(1, length + 1), len(items)),
                               self.metric.name: values[:, k:].ravel()})
        rows = pd.DataFrame(texts).assign(**{self.metric.name: values[:, :k].ravel()})
        return Study(Scores(rows, (self.metric,)), seed=seed, people=people)


def people_model(scores: Scores, curve_by_mesh: Path, metric: Metric) -> PeopleModel | None:
    """Of the meshes that all models have a score for and that have the longest curve; None for fewer than two, or without HS or RS."""
    rows = scores.frame[scores.frame["dataset"] == "meshes"]
    models = list(rows["model"].unique())
    curves = pd.read_csv(curve_by_mesh, dtype={"item": str}, comment="#")
    curve = curves[curves["metric"] == metric.name].pivot(index="item", columns="n", values="value")
    both = rows.pivot(index="item", columns="model", values=metric.name)[models].join(curve, how="inner").dropna()
    known = len(both) >= 2 and not curve.empty and {"HS", "RS"} <= set(models)
    return PeopleModel(metric, models, both.to_numpy()) if known else None


def calibrate_people(model: PeopleModel, meshes: int, data_sets: int, seed: int) -> Rates:
    """The truth is what the means say. Shares and places are counted where it is a number."""
    rates, k = Rates(), len(model.models)
    truth = model.values.mean(axis=0)
    mean, curve = dict(zip(model.models, truth)), truth[k:]
    places = first_reached(np.tile(curve, (k, 1)), truth[:k], model.metric.higher_is_better)
    place = dict(zip(model.models, np.where(np.isfinite(places), places, np.nan)))
    for i in range(data_sets):
        study = model.study(model.draw(meshes, np.random.default_rng([seed, i])), seed + i)
        shares = human_share(study)
        true_shares = (shares["model"].map(mean) - mean["RS"]) / (mean["HS"] - mean["RS"])
        rates.add_intervals("interval of a share of HS", shares["ci95_low"], shares["ci95_high"], true_shares)
        worth = human_equivalents(study)
        ends = [worth[f"ci95_{end}"].mask(worth[f"{end}_bound"].str.startswith("<"), -np.inf).mask(
            worth[f"{end}_bound"].str.startswith(">"), np.inf) for end in ("low", "high")]
        rates.add_intervals("interval of k participants", *ends, worth["model"].map(place))
        added = human_curve_differences(study)
        rise = curve[added["to_participants"] - 1] - curve[added["from_participants"] - 1]
        rates.add_intervals("interval of what participants add", added["ci95_low"], added["ci95_high"], rise)
    return rates


def show(rates: Rates, data_sets: int) -> None:
    for what, expected, rate in rates:
        error = 100 * np.sqrt(rate * (1 - rate) / data_sets)
        print(f"  {what:<38} {100 * rate:6.2f} %  (nominal {100 * expected:.0f} %, standard error {error:.2f})", flush=True)


def main(scores_file: str, data_sets: str = "2000", meshes: str = "0") -> None:
    scores, n, chosen = read_scores(scores_file).scores, int(data_sets), int(meshes)
    curves = Path(scores_file).parent / "human_curve_by_mesh.csv"
    for place, metric in enumerate(scores.metrics):
        model = score_model(scores, place)
        model = replace(model, meshes=chosen or model.meshes)
        print(f"{metric.name}: {model.models} models, {model.meshes} meshes of {model.views} views; deviations: mesh {model.mesh:.4f}, view "
              f"{model.view:.4f}, model by mesh {model.model_of_mesh:.4f}, by view {model.model_of_view:.4f}; {n} data sets")
        show(calibrate(model, n, SEED), n)
        people = people_model(scores, curves, metric) if curves.exists() else None
        if people is not None:
            print(f"{metric.name}: people beside models on {chosen or len(people.values)} meshes")
            show(calibrate_people(people, chosen or len(people.values), n, SEED), n)


if __name__ == "__main__":
    if not 2 <= len(sys.argv) <= 4:
        sys.exit("usage: calibration.py SCORES.csv [DATA_SETS [MESHES]]")
    main(*sys.argv[1:])
