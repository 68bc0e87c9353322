# SPDX-License-Identifier: GPL-3.0-or-later
# Imported by scripts/figures and by a test.
"""Coverage of intervals and error rates of tests: the tables at the end of docs/statistics.md.

`calibration`: simulates scores of equal models with the variances between and within meshes estimated from
the scans of a table of scores, and draws conclusions as a run does. If human_curve_by_mesh.csv is beside the
table, also simulates meshes with models and people, with their means and covariances. `pairs`: false
positives among pairs of equal models, power, new classes with the variances of a table with classes, and low
scores missing.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
import pandas as pd

from . import common  # noqa: F401: locates the package
from salbench.conclusions.equivalents import first_reached, human_equivalents
from salbench.conclusions.leaders import find_leaders
from salbench.conclusions.means import ranking, summary
from salbench.conclusions.metrics import Metric
from salbench.conclusions.pairs import compare
from salbench.conclusions.people import human_curve_differences
from salbench.conclusions.ranks import differing
from salbench.conclusions.resampling import Bootstrap, on_grid
from salbench.conclusions.samples import CONFIDENCE, LEVEL, summarise
from salbench.conclusions.scores import read_scores
from salbench.conclusions.shares import human_share
from salbench.conclusions.significance import significance
from salbench.conclusions.study import Study
from salbench.conclusions.units import TEXTS, Level, Scores

SEED = 2016
SCORE, AUC = Metric("score"), Metric("auc", True, chance=0.5)


@dataclass(frozen=True)
class ScoreModel:
    """Standard deviations of the components of a score; all normal."""

    mesh: float = 1  # common to all models: difficulty of a mesh
    view: float = 1  # and of a view of it
    model_of_mesh: float = 1  # interaction of model and mesh
    model_of_view: float = 1
    models: int = 4
    meshes: int = 30
    views: int = 12

    def draw(self, rng, ahead=0.0):
        """meshes x views x models; the first model is better by `ahead`."""
        of_mesh = self.mesh * rng.normal(size=(self.meshes, 1, 1)) + self.model_of_mesh * rng.normal(
            size=(self.meshes, 1, self.models)
        )
        of_mesh[:, :, 0] += ahead
        of_view = self.view * rng.normal(size=(self.meshes, self.views, 1))
        return (
            of_mesh + of_view + self.model_of_view * rng.normal(size=(self.meshes, self.views, self.models))
        )

    def rows(self):
        """Texts of the scores, in the order of draw()."""
        of = np.indices((self.meshes, self.views, self.models)).reshape(3, -1).astype(str).astype(object)
        return pd.DataFrame(
            {"dataset": "scans", "split": "", "item": of[0], "class": "", "view": of[1], "model": "M" + of[2]}
        )

    def standard_error(self):
        """Standard error of the mean difference of two models."""
        return np.sqrt(2 * (self.model_of_mesh**2 + self.model_of_view**2 / self.views) / self.meshes)


def score_model(scores: Scores, metric: int) -> ScoreModel:
    """Estimated from the scores of the competitors on scans: analysis of variance, components below 0
    being 0."""
    scans = scores.part(scores.frame["dataset"] == "scans")
    level = Level(scans, "scans", "shape")
    values = level.compared(metric, level.competitors(metric))
    mesh = pd.Series(Level(scans, "scans", "mesh").unit_of_shape[values.units])
    own = pd.DataFrame(values.values - values.values.mean(axis=0))
    shared = own.mean(axis=1)
    k, views = own.shape[1], len(own) / mesh.nunique()
    left = k / (k - 1)  # loss by subtracting a mean over k
    (within, between), (own_within, own_between) = _spread(shared.to_frame(), mesh), _spread(
        own.sub(shared, axis=0), mesh
    )
    mesh_variance, own_variance = between - within / views, left * (own_between - own_within / views)
    deviations = np.sqrt(np.maximum([mesh_variance, within, own_variance, left * own_within], 0))
    return ScoreModel(*deviations, models=k, meshes=mesh.nunique(), views=round(views))


def _spread(values, mesh):
    """Variance within meshes, and variance of the means of meshes; columns of several models count as
    separate meshes."""
    groups = values.groupby(mesh.to_numpy())
    freedom = (groups.size() - 1).sum()
    within = (
        ((values - groups.transform("mean")) ** 2).sum().sum() / (freedom * values.shape[1])
        if freedom
        else 0.0
    )
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
        """Yields name, nominal rate, observed rate."""
        return ((what, self.expected[what], float(np.mean(hits))) for what, hits in self.hits.items() if hits)


def calibrate(model: ScoreModel, data_sets: int, seed: int) -> Rates:
    rates, rows = Rates(), model.rows()
    pair = replace(model, models=2)
    margin = 3 * pair.standard_error()
    for i in range(data_sets):
        rng = np.random.default_rng([seed, i])
        _add_equal_models(rates, Scores(rows.assign(score=model.draw(rng).ravel()), (SCORE,)), seed + i)
        # Two models that differ by exactly the margin; a naive test would call half of them equivalent.
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
    rates.add_intervals(
        "interval of a difference", pairs["ci95_low"], pairs["ci95_high"], np.zeros(len(pairs))
    )
    rates.add_intervals(
        "interval of the superiority",
        pairs["superiority_low"],
        pairs["superiority_high"],
        np.full(len(pairs), 0.5),
    )
    rates.add("paired t-test", LEVEL, pairs["t_p"] < LEVEL)
    rates.add("signed-rank test", LEVEL, pairs["signed_rank_p"] < LEVEL)
    rates.add("any of a family after Holm", LEVEL, pairs["signed_rank_p_holm"].min() < LEVEL)
    covers = (ranks["rank_low"] == 1) & (ranks["rank_high"] == len(ranks))
    rates.add("interval of a rank", CONFIDENCE, covers)
    rates.add("intervals of all ranks", CONFIDENCE, covers.all())
    by_shape = significance(Study(scores, "shape"))
    rates.add_intervals(
        "unit shape: interval of a difference",
        by_shape["ci95_low"],
        by_shape["ci95_high"],
        np.zeros(len(pairs)),
    )
    rates.add("unit shape: rank-sum test", LEVEL, pairs["rank_sum_p"] < LEVEL)


@dataclass(frozen=True)
class PeopleModel:
    """Scores of meshes by models, then by 1, 2, ... participants."""

    metric: Metric
    models: list[str]
    values: np.ndarray  # meshes x columns

    def draw(self, meshes, rng):
        """Normal values with the means and covariances of the columns."""
        weights = rng.normal(size=(meshes, len(self.values))) / np.sqrt(len(self.values) - 1)
        return self.values.mean(axis=0) + weights @ (self.values - self.values.mean(axis=0))

    def study(self, values, seed):
        items, k = np.arange(len(values)).astype(str).astype(object), len(self.models)
        texts = dict.fromkeys(TEXTS, "") | {
            "dataset": "meshes",
            "item": np.repeat(items, k),
            "model": np.tile(self.models, len(items)),
        }
        length = values.shape[1] - k
        people = pd.DataFrame(
            {
                "item": np.repeat(items, length),
                "class": "",
                "n": np.tile(np.arange(1, length + 1), len(items)),
                self.metric.name: values[:, k:].ravel(),
            }
        )
        rows = pd.DataFrame(texts).assign(**{self.metric.name: values[:, :k].ravel()})
        return Study(Scores(rows, (self.metric,)), seed=seed, people=people)


def people_model(scores: Scores, curve_by_mesh: Path, metric: Metric) -> PeopleModel | None:
    """Model of the meshes that all models are scored on and that have the longest curve; None for fewer than
    two, or without HS or RS."""
    rows = scores.frame[scores.frame["dataset"] == "meshes"]
    models = list(rows["model"].unique())
    curves = pd.read_csv(curve_by_mesh, dtype={"item": str}, comment="#")
    curve = curves[curves["metric"] == metric.name].pivot(index="item", columns="n", values="value")
    both = (
        rows.pivot(index="item", columns="model", values=metric.name)[models]
        .join(curve, how="inner")
        .dropna()
    )
    known = len(both) >= 2 and not curve.empty and {"HS", "RS"} <= set(models)
    return PeopleModel(metric, models, both.to_numpy()) if known else None


def calibrate_people(model: PeopleModel, meshes: int, data_sets: int, seed: int) -> Rates:
    """Counts against the truth implied by the means. Shares and positions count only if they are finite."""
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
        ends = [
            worth[f"ci95_{end}"]
            .mask(worth[f"{end}_bound"].str.startswith("<"), -np.inf)
            .mask(worth[f"{end}_bound"].str.startswith(">"), np.inf)
            for end in ("low", "high")
        ]
        rates.add_intervals("interval of k participants", *ends, worth["model"].map(place))
        added = human_curve_differences(study)
        rise = curve[added["to_participants"] - 1] - curve[added["from_participants"] - 1]
        rates.add_intervals("interval of what participants add", added["ci95_low"], added["ci95_high"], rise)
    return rates


def show(rates: Rates, data_sets: int) -> None:
    for what, expected, rate in rates:
        error = 100 * np.sqrt(rate * (1 - rate) / data_sets)
        print(
            f"  {what:<38} {100 * rate:6.2f} %  (nominal {100 * expected:.0f} %, standard error {error:.2f})",
            flush=True,
        )


def calibration(scores: Path, n: int, meshes: int) -> None:
    """Coverage and error rates with the variances of a table of scores, and as many meshes as it has, or
    `meshes`."""
    known, curves = read_scores(scores)[0], scores.parent / "human_curve_by_mesh.csv"
    for place, metric in enumerate(known.metrics):
        model = score_model(known, place)
        model = replace(model, meshes=meshes or model.meshes)
        print(
            f"{metric.name}: {model.models} models, {model.meshes} meshes of {model.views} views; deviations:"
            f" mesh {model.mesh:.4f}, view {model.view:.4f}, model by mesh {model.model_of_mesh:.4f}, by view"
            f" {model.model_of_view:.4f}; {n} data sets"
        )
        show(calibrate(model, n, SEED), n)
        people = people_model(known, curves, metric) if curves.exists() else None
        if people is not None:
            print(f"{metric.name}: people beside models on {meshes or len(people.values)} meshes")
            show(calibrate_people(people, meshes or len(people.values), n, SEED), n)


# -- several models at once


MODELS, MESHES, VIEWS = (3, 5, 8, 11, 20), (6, 10, 19, 60, 400), 12
DRAWS = 2000  # a fifth of the package's: error rates of sign-flip tests do not depend on it
BATCH = 50  # data sets that share draws


def normal(rng, *shape):
    return rng.normal(size=shape)


def skewed(rng, *shape):
    return (rng.chisquare(4, size=shape) - 4) / 8**0.5


def strongly_skewed(rng, *shape):
    """Skewed noise with unequal deviations: with equal ones, skewness cancels in differences of models."""
    return (rng.chisquare(1, size=shape) - 1) / 2**0.5 * (1 + np.arange(shape[-1]) % 3)


def heavy(rng, *shape):
    return rng.standard_t(3, size=shape) / 3**0.5


def unequal(rng, *shape):
    return rng.normal(size=shape) * 2.0 ** (np.arange(shape[-1]) % 3)


def tied(rng, *shape):
    """Whole numbers, with zeros on a third of the meshes."""
    return np.where(rng.random(size=(*shape[:-1], 1)) < 1 / 3, 0, np.rint(rng.normal(size=shape)))


NOISES = {
    "normal": normal,
    "skewed": skewed,
    "heavy tails": heavy,
    "unequal variances": unequal,
    "ties and zeros": tied,
    "strongly skewed": strongly_skewed,
}


def drawn(noise, rng, meshes, models, views):
    """Scores of equal models, meshes x models: an effect per mesh, and an equally large one per view."""
    own = noise(rng, meshes, models)
    return own if views == 1 else own + np.mean([noise(rng, meshes, models) for _ in range(views)], axis=0)


def batches(noise, meshes, models, views, data_sets, seed, shift=0.0):
    """Yields data sets, the sums of their scores in each draw of signs, and the sums of the signs."""
    for batch in range(0, data_sets, BATCH):
        rng = np.random.default_rng([seed, meshes, models, views, batch])
        values = [
            on_grid(drawn(noise, rng, meshes, models, views) + shift)
            for _ in range(min(BATCH, data_sets - batch))
        ]
        bootstrap = Bootstrap(seed + batch, DRAWS, threads=1)
        flipped = bootstrap.flipped_of_each([np.hstack(values)])[0]
        yield values, np.hsplit(flipped, len(values)), bootstrap.sums_of_signs(meshes)


def any_pair(noise, meshes, views, data_sets, seed=SEED):
    """Share of data sets in which some pair of equal models differs, by number of models, using the first
    ones of the same data sets."""
    found = dict.fromkeys(MODELS, 0)
    for values, flipped, signs in batches(noise, meshes, max(MODELS), views, data_sets, seed):
        for of_models, sums in zip(values, flipped):
            for k in MODELS:
                found[k] += differing(of_models[:, :k], sums[:, :k], signs).better.any()
    return {k: count / data_sets for k, count in found.items()}


@dataclass
class Power:
    leads: float  # share of data sets in which the best model is ahead of every other one
    pairs: float  # share of differing pairs that are found
    # share of data sets in which the interval of the best mean's lead holds the true one
    lead: float


def power(meshes, means, data_sets, seed=SEED):
    means, found = np.array(means), np.zeros(3)
    truth = means[:, None] > means
    for values, flipped, signs in batches(normal, meshes, len(means), 1, data_sets, seed, means):
        for of_models, sums in zip(values, flipped):
            best, second = np.argsort(-of_models.mean(axis=0))[:2]
            lead = summarise(of_models[:, [best]] - of_models[:, [second]])
            better, _, joint = differing(of_models, sums, signs)
            held = abs(lead.mean[0] - (means[best] - means[second])) <= joint * lead.sd[0] / np.sqrt(meshes)
            found += better[0, 1:].all(), better[truth].mean(), held
    return Power(*found / data_sets)


def components(values, classes):
    """Deviations of the differences between models: between classes, and between meshes of a class; negative
    estimates become 0."""
    own = (
        values
        - values.mean(axis=1, keepdims=True)
        - (values - values.mean(axis=1, keepdims=True)).mean(axis=0)
    )
    groups = pd.DataFrame(own).groupby(classes)
    k, size = values.shape[1], len(values) / groups.ngroups
    within = ((own - groups.transform("mean").to_numpy()) ** 2).sum() / (
        (len(values) - groups.ngroups) * (k - 1)
    )
    between = (groups.mean().to_numpy() ** 2).sum() / ((groups.ngroups - 1) * (k - 1))
    return np.sqrt(max(between - within / size, 0)), np.sqrt(within)


def frame(values, classes=None):
    """Scores of meshes x models."""
    meshes, models = values.shape
    item, model = np.indices(values.shape).reshape(2, -1)
    texts = dict.fromkeys(TEXTS, "") | {
        "dataset": "meshes",
        "item": item.astype(str),
        "model": "M" + model.astype(str).astype(object),
    }
    if classes is not None:
        texts["class"] = np.repeat(classes, models)
    return pd.DataFrame(texts).astype(object).assign(auc=values.ravel())


def new_classes(of_class, of_mesh, data_sets, classes=20, meshes=20, models=4, seed=SEED):
    """Models that are equal over the population of classes."""
    names = np.repeat(np.arange(classes).astype(str), meshes)
    covered, leads = {"mesh": 0, "class": 0}, {"on these": 0, "new classes": 0}
    for i in range(data_sets):
        rng = np.random.default_rng([seed, i])
        values = (
            0.7
            + np.repeat(of_class * rng.normal(size=(classes, models)), meshes, axis=0)
            + of_mesh * rng.normal(size=(classes * meshes, models))
        )
        difference = values[:, 0] - values[:, 1]
        for unit, units in (
            ("mesh", difference),
            ("class", difference.reshape(classes, meshes).mean(axis=1)),
        ):
            interval = summarise(units[:, None])
            covered[unit] += bool(interval.low[0] <= 0 <= interval.high[0])
        (leader,) = find_leaders(Study(Scores(frame(values, names), (AUC,)), seed=seed + i, threads=1))[
            0
        ].leaders
        leads["on these"] += leader.verdict == "leads"
        leads["new classes"] += leader.new_classes.verdict == "leads"
    return {what: count / data_sets for what, count in {**covered, **leads}.items()}


def missing(data_sets, meshes=60, share=0.1, models=4, seed=SEED):
    """Equal models, the first of which has no score where it would be lowest."""
    found = dict.fromkeys(
        (
            "interval of a difference from the first model covers it",
            "the first model leads",
            "and its sentence says what it lacks",
            "it ranks first with these at chance",
        ),
        0.0,
    )
    for i in range(data_sets):
        rng = np.random.default_rng([seed, i])
        values = 0.65 + 0.04 * rng.normal(size=(meshes, 1)) + 0.06 * rng.normal(size=(meshes, models))
        lowest = np.argsort(values[:, 0])[: round(share * meshes)]
        values[lowest, 0] = np.nan
        interval = summarise(np.delete(values[:, :1] - values[:, 1:], lowest, axis=0))
        level = find_leaders(Study(Scores(frame(values), (AUC,)), seed=seed + i, threads=1))[0]
        (leader,) = level.leaders
        first = leader.verdict == "leads" and leader.models == ["M0"]
        said = (
            f"M0 has no score on {len(lowest)}" in level.sentence and "at chance, M0 ranks" in level.sentence
        )
        for what, hit in zip(
            found,
            (
                np.mean((interval.low <= 0) & (0 <= interval.high)),
                first,
                first and said,
                leader.missing["M0"][1] == 1,
            ),
        ):
            found[what] += hit / data_sets
    return found


def percent(share):
    return f"{100 * share:.1f}"


def show_joint(data_sets):
    print(
        f"any pair told apart, % of {data_sets} data sets (standard error of 5 %:"
        f" {percent(np.sqrt(.05 * .95 / data_sets))})\n"
    )
    print(
        f"| scores | meshes | {' | '.join(f'{k} models' for k in MODELS)} | with {VIEWS} views:"
        f" {' | '.join(f'{k}' for k in MODELS)} |"
    )
    print("|---" * (2 + 2 * len(MODELS)) + "|")
    for name, noise in NOISES.items():
        for meshes in MESHES:
            cells = [
                percent(rate)
                for views in (1, VIEWS)
                for rate in any_pair(noise, meshes, views, data_sets).values()
            ]
            print(f"| {name} | {meshes} | {' | '.join(cells)} |", flush=True)


def show_power(data_sets):
    print(
        f"\npower, % of {data_sets} data sets\n\n| models | meshes | the best leads | pairs found | the"
        " lead's interval holds |\n" + "|---" * 5 + "|"
    )
    for meshes in (19, 393):
        step = np.sqrt(19 / meshes)
        for what, means in (
            ("4, one ahead", [1.2, 0, 0, 0]),
            ("4, each ahead of the next", [2.4, 1.6, 0.8, 0]),
        ):
            found = power(meshes, step * np.array(means), data_sets)
            print(
                (
                    f"| {what} | {meshes} | {percent(found.leads)} | {percent(found.pairs)} |"
                    f" {percent(found.lead)} |"
                ),
                flush=True,
            )


def show_classes(scores, data_sets):
    for number, metric in enumerate(scores.metrics):
        level = Level(scores.part(scores.frame["class"] != ""), scores.frame["dataset"].iloc[0], "mesh")
        values = level.compared(number, level.competitors(number))
        own = scores.frame.drop_duplicates("item").set_index("item")["class"]
        items = np.array(scores.frame["item"].unique())[values.units]
        of_class, of_mesh = components(values.values, own[items].to_numpy())
        found = new_classes(of_class, of_mesh, data_sets)
        print(
            f"{metric.name}: deviations of a model from class to class {of_class:.4f}, from mesh to mesh"
            f" {of_mesh:.4f}; {data_sets} data sets: "
            + "; ".join(f"{what} {percent(rate)} %" for what, rate in found.items()),
            flush=True,
        )


def pairs(n, scores):
    """Prints statements about several models at once."""
    show_joint(n)
    show_power(n)
    print(f"\n{n // 4} data sets of 60 meshes, 4 equal models, the lowest 10 % of one missing:")
    for what, rate in missing(n // 4).items():
        print(f"  {what}: {percent(rate)} %", flush=True)
    if scores:
        print(
            "\n20 classes of 20 meshes, 4 equal models: intervals that cover the difference over new classes,"
            " by unit; tables in which one leads"
        )
        show_classes(read_scores(scores)[0], n // 4)
