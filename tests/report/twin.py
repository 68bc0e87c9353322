# SPDX-License-Identifier: GPL-3.0-or-later
"""The program's tables of statistics made a second time, from results.csv by NumPy and SciPy: fixtures are written with them,
and statistics_test compares the program's with them. The mesh is the unit: a mesh's score is the mean over its scans."""

from functools import cache, cached_property
from itertools import combinations, groupby

import numpy
import pandas
from scipy import stats

REFERENCES = ("HS", "RS")
LEVEL = 0.05
NAN = float("nan")


@cache
def draws(n, resamples):
    """How often each of n units is drawn, resamples x n, as shares."""
    drawn = numpy.random.default_rng(n).integers(n, size=(resamples, n))
    return numpy.stack([numpy.bincount(row, minlength=n) for row in drawn]) / n


class Scores:
    """Of one data set and metric: shapes by models, and what is compared of them."""

    def __init__(self, part, metric, lower=False, resamples=400):
        self.wide = part.pivot(index=["item", "view"], columns="model", values=metric)[list(part["model"].unique())]
        self.metric, self.lower, self.resamples = metric, lower, resamples

    @cached_property
    def scored(self):
        return [model for model in self.wide if self.wide[model].notna().any()]

    @cached_property
    def competitors(self):
        return [model for model in self.scored if model not in REFERENCES]

    def compared(self, models):
        """Units by models, and the number of shapes: those that these models and all competitors have a score for."""
        known = self.wide.dropna(subset=list(dict.fromkeys([*models, *self.competitors])))[list(models)]
        return known.groupby(level="item", sort=False).mean(), len(known)

    def own(self, model):
        known = self.wide[model].dropna()
        return known.groupby(level="item", sort=False).mean(), len(known)


def each(results, lower=lambda metric: False, **options):
    """(data set, metric, Scores)"""
    metrics = metrics_of(results)
    for dataset, part in results.groupby("dataset", sort=False):
        for metric in metrics:
            yield dataset, metric, Scores(part, metric, lower(metric), **options)


def metrics_of(results):
    known = ("dataset", "item", "class", "view", "model", "n_points", "n_picks", "key", "content")
    return [column for column in results if column not in known]


def student(values, level=0.95):
    n = len(values)
    if n < 2:
        return NAN, NAN
    half = stats.t.ppf((1 + level) / 2, n - 1) * stats.sem(values)
    return numpy.mean(values) - half, numpy.mean(values) + half


def bca_levels(values, means):
    """Which quantiles of the resampled means the interval ends at."""
    away = values - values.mean()
    bias = stats.norm.ppf(((means < values.mean()).mean() + (means <= values.mean()).mean()) / 2)
    acceleration = (away ** 3).sum() / (6 * (away ** 2).sum() ** 1.5)
    z = bias + stats.norm.ppf([LEVEL / 2, 1 - LEVEL / 2])
    return stats.norm.cdf(bias + z / (1 - acceleration * z))


def bca(values, resamples):
    if len(values) < 2 or numpy.ptp(values) == 0:
        return NAN, NAN
    means = draws(len(values), resamples) @ values
    return tuple(numpy.quantile(means, bca_levels(values, means)))


def summary(results, **options):
    rows = []
    for dataset, metric, scores in each(results, **options):
        for model in scores.wide:
            units, n_shapes = scores.compared([model])
            own, n_own = scores.own(model)
            values = units[model].to_numpy()
            rows.append((dataset, model, metric, len(values), values.mean() if len(values) else NAN,
                         values.std(ddof=1) if len(values) > 1 else NAN, *student(values), *bca(values, scores.resamples),
                         n_shapes, n_own, own.mean() if n_own else NAN))
    return pandas.DataFrame(rows, columns=[
        "dataset", "model", "metric", "n", "mean", "sd", "ci95_low", "ci95_high", "bca95_low", "bca95_high", "n_shapes",
        "n_own_shapes", "own_mean"])


def per_class(results):
    rows = []
    for (dataset, name), part in results[results["class"] != ""].groupby(["dataset", "class"], sort=False):
        for metric in metrics_of(results):
            scores = Scores(part, metric)
            for model in [*scores.wide, "Avg"]:
                units, n_shapes = scores.compared(scores.competitors if model == "Avg" else [model])
                values = units.mean(axis=1).to_numpy()
                if len(values):
                    rows.append((dataset, name, model, metric, len(values), n_shapes, values.mean(), *student(values)))
    return pandas.DataFrame(rows, columns=["dataset", "class", "model", "metric", "n", "n_shapes", "mean", "ci95_low", "ci95_high"])


def human_differences(curves):
    """human_curve_differences.csv. curves: human_curve_by_mesh.csv."""
    rows = []
    for metric in curves["metric"].unique():
        wide = curves[curves["metric"] == metric].pivot(index="item", columns="n", values="value")
        for fewer, more in combinations(wide, 2):
            both = wide[[fewer, more]].dropna()
            mean, low, high, p, low90, high90, *_ = compare((both[more] - both[fewer]).to_numpy())
            rows.append((metric, fewer, more, len(both), len(both), mean, low, high, p, low90, high90))
    return pandas.DataFrame(rows, columns=["metric", "from_participants", "to_participants", "n", "n_shapes", "mean_difference",
                                           "ci95_low", "ci95_high", "t_p", "ci90_low", "ci90_high"])


def human_reliability(curves):
    """human_reliability.csv"""
    last = curves[curves["metric"] == "cc"].dropna(subset=["value"]).groupby("item", sort=False).last()
    r = last["value"].to_numpy()
    values = 2 * numpy.maximum(r, 0) / (1 + numpy.maximum(r, 0))
    rows = [("cc", len(r), len(r), 2 * last["n"].min(), 2 * last["n"].max(), r.mean(), values.mean(),
             values.std(ddof=1) if len(r) > 1 else NAN, *student(values))] if len(r) else []
    return pandas.DataFrame(rows, columns=["metric", "n", "n_shapes", "fewest_participants", "most_participants", "split_half", "mean",
                                           "sd", "ci95_low", "ci95_high"])


FEWEST = 6  # units of an interval by percentiles


def percentiles(values, n):
    """The levels that make the interval of a mean Student's, and the interval of these resampled values at them."""
    if n < FEWEST or (values == values[0]).all() and numpy.isfinite(values[0]):
        return NAN, NAN
    place = int(stats.norm.cdf(-(n / (n - 1)) ** 0.5 * stats.t.ppf(1 - LEVEL / 2, n - 1)) * (len(values) - 1))
    values = numpy.sort(values)
    return values[place], values[len(values) - 1 - place]


def reached(curve, level, lower):
    """Where curves, one per row, first are as good as the level of their row."""
    ahead = (curve - level[:, None]) * (-1 if lower else 1)
    places = numpy.full(len(ahead), numpy.inf)
    for i in range(ahead.shape[1] - 1, -1, -1):
        step = ahead[:, i] - ahead[:, i - 1] if i else 1.0
        with numpy.errstate(divide="ignore", invalid="ignore"):
            places = numpy.where(ahead[:, i] >= 0, i + 1 - (ahead[:, i] / step if i else 0), places)
    return numpy.where(ahead[:, 0] > 0, -numpy.inf, places)


def human_places(curves, results, lower, resamples=400):
    """(metric, model, n, largest group, mean, place, resampled places, crossings), over meshes with the whole curve that all
    models of a metric have scores for."""
    part = results[results["dataset"] == "meshes"]
    for metric in metrics_of(results):
        scores = Scores(part, metric)
        curve = curves[curves["metric"] == metric].pivot(index="item", columns="n", values="value").dropna()
        for model in scores.wide:
            units = scores.compared([model])[0].join(curve, how="inner")
            if units.empty:
                yield metric, model, 0, curve.shape[1], NAN, NAN, numpy.array([]), 0
                continue
            means = numpy.vstack([units.mean().to_numpy(), draws(len(units), resamples) @ units.to_numpy()])
            places = reached(means[:, 1:], means[:, 0], lower(metric))
            sides = numpy.sign(means[0, 1:] - means[0, 0])
            sides = sides[sides != 0]
            yield metric, model, len(units), curve.shape[1], means[0, 0], places[0], places[1:], int((sides[1:] != sides[:-1]).sum())


def bound(place, largest):
    return "<1" if place == -numpy.inf else f">{largest}" if place == numpy.inf else ""


def human_equivalents(curves, results, lower, **options):
    """human_equivalents.csv, without the remark on HS."""
    rows = []
    for metric, model, n, largest, mean, place, resampled, crossings in human_places(curves, results, lower, **options):
        places = (place, *(percentiles(resampled, n) if n else (NAN, NAN)))
        remark = "no scores" if n == 0 else f"no interval: fewer than {FEWEST} units" if n < FEWEST else ""
        rows.append(("meshes", metric, model, n, n, largest, mean, *(one if numpy.isfinite(one) else NAN for one in places),
                     *(bound(one, largest) for one in places), crossings, remark))
    return pandas.DataFrame(rows, columns=["dataset", "metric", "model", "n", "n_shapes", "largest_group", "mean", "k", "ci95_low",
                                           "ci95_high", "k_bound", "low_bound", "high_bound", "crossings", "remark"])


def human_shares(results, lower, resamples=400):
    """human_share.csv"""
    rows = []
    for dataset, metric, scores in each(results, lower, resamples=resamples):
        lacking = [model for model in ("RS", "HS") if model not in scores.scored]
        for model in scores.wide:
            if model in REFERENCES:
                continue
            if lacking or model not in scores.scored:
                remark = f"no scores of {lacking[0]}" if lacking else "no scores"
                rows.append((dataset, metric, model, 0, 0, *(NAN,) * 6, remark))
                continue
            units, n_shapes = scores.compared([*scores.competitors, "RS", "HS"])
            rows.append((dataset, metric, model, len(units), n_shapes, *share(units, model, scores.lower, resamples)))
    return pandas.DataFrame(rows, columns=["dataset", "metric", "model", "n", "n_shapes", "mean", "mean_rs", "mean_hs", "share",
                                           "ci95_low", "ci95_high", "remark"])


def share(units, model, lower, resamples):
    """Means of the model, RS and HS, the share with its interval, and the remark."""
    n, means = len(units), units[[model, "RS", "HS"]].mean()
    if n < 2:
        return *means, NAN, NAN, NAN, "one unit: it does not show that HS is better than RS"
    ahead = (units["HS"] - units["RS"]).to_numpy() * (-1 if lower else 1)
    if ahead.mean() <= 0 or numpy.ptp(ahead) > 0 and stats.ttest_1samp(ahead, 0).pvalue >= LEVEL:
        return *means, NAN, NAN, NAN, "HS is not clearly better than RS"
    resampled = draws(n, resamples) @ units[[model, "RS", "HS"]].to_numpy()
    low, high = percentiles((resampled[:, 0] - resampled[:, 1]) / (resampled[:, 2] - resampled[:, 1]), n)
    remark = f"no interval: fewer than {FEWEST} units" if n < FEWEST else ""
    return *means, (means[model] - means["RS"]) / (means["HS"] - means["RS"]), low, high, remark


def wilson(share, n):
    z = stats.norm.ppf(1 - LEVEL / 2)
    centre = (share + z * z / (2 * n)) / (1 + z * z / n)
    half = z / (1 + z * z / n) * (share * (1 - share) / n + z * z / (4 * n * n)) ** 0.5
    return max(0, centre - half), min(1, centre + half)


def compare(difference):
    """mean_difference, ci95, t_p, ci90, d_z, rank_biserial, superiority and its interval."""
    n = len(difference)
    if n < 2:
        return (difference.mean() if n else NAN, *(NAN,) * 10)
    changed = difference[difference != 0]
    ranks = stats.rankdata(numpy.abs(changed))
    biserial = (ranks * numpy.sign(changed)).sum() / ranks.sum() if len(changed) else 0
    superiority = ((difference > 0).mean() + (difference >= 0).mean()) / 2
    if numpy.ptp(difference) == 0:
        intervals, p, d_z = (NAN,) * 4, 1.0 if difference[0] == 0 else 0.0, NAN
    else:
        intervals = (*student(difference), *student(difference, 0.9))
        p, d_z = stats.ttest_1samp(difference, 0).pvalue, difference.mean() / difference.std(ddof=1)
    return difference.mean(), *intervals[:2], p, *intervals[2:], d_z, biserial, superiority, *wilson(superiority, n)


def holm(p_values):
    p_values = numpy.array(p_values, dtype=float)
    order = p_values.argsort(kind="stable")
    known = numpy.isfinite(p_values).sum()
    adjusted = numpy.full(len(p_values), NAN)
    adjusted[order[:known]] = numpy.minimum(1, numpy.maximum.accumulate(p_values[order[:known]] * numpy.arange(known, 0, -1)))
    return adjusted, known


def significance(results, **options):
    rows = []
    for dataset, metric, scores in each(results, **options):
        found, p_values = [], []
        for a, b in combinations(scores.scored, 2):
            units, n_shapes = scores.compared([a, b])
            difference = (units[a] - units[b]).to_numpy()
            rank_sum = stats.ranksums(scores.wide[a].dropna(), scores.wide[b].dropna())
            changed = difference[difference != 0]
            signed = stats.wilcoxon(changed) if len(changed) else (0.0, 1.0 if len(difference) else NAN)
            p_values.append(signed[1])
            found.append((dataset, metric, a, b, len(units), n_shapes, *compare(difference), *rank_sum, *signed))
        adjusted, n_tests = holm(p_values)
        rows += [(*row, p, n_tests) for row, p in zip(found, adjusted)]
    return pandas.DataFrame(rows, columns=[
        "dataset", "metric", "model_a", "model_b", "n", "n_shapes", "mean_difference", "ci95_low", "ci95_high", "t_p", "ci90_low",
        "ci90_high", "d_z", "rank_biserial", "superiority", "superiority_low", "superiority_high", "rank_sum_z", "rank_sum_p",
        "signed_rank", "signed_rank_p", "signed_rank_p_holm", "n_tests"])


def joint_bound(units, resamples):
    """Standard errors that bound all differences of pairs together, and the pairs as differences with their errors."""
    n = len(units)
    pairs = [(units[a] - units[b]).to_numpy() for a, b in combinations(units, 2)]
    away = [numpy.abs(draws(n, resamples) @ (d - d.mean())) / stats.sem(d) for d in pairs if numpy.ptp(d) > 0]
    if not away:
        return NAN
    freedom = (n / (n - 1)) ** 0.5 * stats.t.ppf(1 - LEVEL / 2, n - 1) / stats.norm.ppf(1 - LEVEL / 2)
    return numpy.quantile(numpy.max(away, axis=0), 1 - LEVEL) * freedom


def letters(models, apart):
    """A letter per largest set of models of which no two are apart; models best first."""
    def together(some):
        return not any(pair in apart for pair in combinations(some, 2))
    sets = [set(some) for size in range(len(models), 0, -1) for some in combinations(models, size) if together(some)]
    largest = [some for some in sets if not any(some < other for other in sets)]
    largest.sort(key=lambda some: sorted(models.index(model) for model in some))
    return {model: "".join(chr(97 + at) for at, some in enumerate(largest) if model in some) for model in models}


def rank(units, lower, resamples):
    """Rows (model, mean, rank, rank_low, rank_high, first, group), best first."""
    means = units.mean()
    ranks = means.rank(ascending=lower, method="min")
    order = list(means.sort_values(ascending=lower, kind="stable").index)
    k, n = len(order), len(units)
    if n < 2:
        return [(model, means[model], int(ranks[model]), NAN, NAN, NAN, "") for model in order]
    bound = joint_bound(units, resamples)
    apart, low, high = set(), dict.fromkeys(order, 1), dict.fromkeys(order, k)
    for better, worse in combinations(order, 2):
        difference = (units[better] - units[worse]).to_numpy()
        error = stats.sem(difference) if numpy.ptp(difference) > 0 else 0
        if abs(difference.mean()) > (bound * error if error > 0 else 0):
            apart.add((better, worse))
            low[worse] += 1
            high[better] -= 1
    resampled = draws(n, resamples) @ units.to_numpy()
    best = resampled == (resampled.min if lower else resampled.max)(axis=1, keepdims=True)
    first = dict(zip(units, (best / best.sum(axis=1, keepdims=True)).mean(axis=0)))
    groups = letters(order, apart)
    return [(model, means[model], int(ranks[model]), low[model], high[model], first[model], groups[model]) for model in order]


def ranking(results, lower, **options):
    rows = []
    for dataset, metric, scores in each(results, lower, **options):
        if not scores.competitors:
            continue
        units, n_shapes = scores.compared(scores.competitors)
        if len(units):
            rows += [(dataset, metric, model, len(units), n_shapes, *of)
                     for model, *of in rank(units, scores.lower, scores.resamples)]
    return pandas.DataFrame(rows, columns=["dataset", "metric", "model", "n", "n_shapes", "mean", "rank", "rank_low", "rank_high",
                                           "first", "group"])


def signs(units, lower, resamples):
    """Which of each pair of models is better, in the sample and in each resample: rows x pairs."""
    means = numpy.vstack([units.mean().to_numpy(), draws(len(units), resamples) @ units.to_numpy()])
    a, b = numpy.array(list(combinations(range(units.shape[1]), 2))).T
    return numpy.sign(means[:, a] - means[:, b]) * (-1 if lower else 1)


def agreement(results, lower, **options):
    rows = []
    for dataset, part in results.groupby("dataset", sort=False):
        known = {}
        for metric in metrics_of(results):
            scores = Scores(part, metric, lower(metric), **options)
            units = scores.compared(scores.competitors)[0]
            if len(units) > 1 and units.shape[1] > 1:
                known[metric] = (units, scores)
        made = {}
        for (first, (a, scores)), (second, (b, _)) in combinations(known.items(), 2):
            items = [item for item in a.index if item in set(b.index)]
            models = [model for model in a if model in b]
            if len(models) < 2 or len(items) < 2:
                continue
            of = []
            for metric, units in ((first, a), (second, b)):
                key = (metric, tuple(items), tuple(models))
                if key not in made:
                    made[key] = signs(units.loc[items, models], lower(metric), scores.resamples)
                of.append(made[key])
            x, y = of
            with numpy.errstate(invalid="ignore"):  # all models tie
                taus = (x * y).sum(axis=1) / numpy.sqrt((x * x).sum(axis=1) * (y * y).sum(axis=1))
            resampled = taus[1:][numpy.isfinite(taus[1:])]
            ends = numpy.quantile(resampled, [LEVEL / 2, 1 - LEVEL / 2]) if len(resampled) else (NAN, NAN)
            rows.append((dataset, first, second, len(items), len(models), taus[0], *ends))
    return pandas.DataFrame(rows, columns=["dataset", "metric_a", "metric_b", "n", "n_models", "tau", "ci95_low", "ci95_high"])


RANGES = {"auc": (0, 1), "cc": (-1, 1), "lcc": (0, 1), "spearman": (-1, 1), "kl": (0, numpy.inf), "sim": (0, 1), "mse": (0, 1), "mae": (0, 1)}


def within_range(values, metric):
    """Student's interval, cut at what the metric can be."""
    least, most = RANGES.get(metric.split("_")[0], (-numpy.inf, numpy.inf))
    low, high = student(values) if len(values) and numpy.ptp(values) > 0 else (NAN, NAN)
    return low, high, max(low, min(least, numpy.mean(values))) if low == low else NAN, min(high, max(most, numpy.mean(values))) if low == low else NAN


def compact(results, lower, **options):
    """compact.csv"""
    rows = []
    for dataset, metric, scores in each(results, lower, **options):
        units = scores.compared(scores.competitors)[0] if scores.competitors else pandas.DataFrame()
        ranks = {model: (place, group) for model, _, place, _, _, _, group in rank(units, scores.lower, scores.resamples)} if len(units) else {}
        known = scores.wide.notna()
        missing = known.any(axis=1).sum() - known.sum()
        order = sorted(scores.scored, key=lambda model: (model in REFERENCES, ranks.get(model, (0,))[0]))
        for model in order:
            own, n_shapes = scores.compared([model])
            values = own[model].to_numpy()
            low, high, kept_low, kept_high = within_range(values, metric) if len(values) else (NAN,) * 4
            half = (high - low) / 2 if (low, high) == (kept_low, kept_high) else NAN
            place, group = ranks.get(model, (NAN, ""))
            rows.append((dataset, metric, "lower" if scores.lower else "higher", model, "reference" if model in REFERENCES else "model",
                         len(values), n_shapes, missing[model], values.mean() if len(values) else NAN, kept_low, kept_high, half, place,
                         group, int(place == 1)))
    return pandas.DataFrame(rows, columns=["dataset", "metric", "better", "model", "kind", "n", "n_shapes", "n_missing", "mean", "low",
                                           "high", "half", "rank", "group", "best"])


def leaders(results, lower, **options):
    """leaders.csv, with sentences of another wording."""
    rows = []
    for dataset, of_dataset in groupby(each(results, lower, **options), key=lambda entry: entry[0]):
        found = []
        for _, metric, scores in of_dataset:
            if scores.competitors:
                units, n_shapes = scores.compared(scores.competitors)
                found.append((dataset, metric, *leader(units, metric, scores), len(units), n_shapes))
        said = [f"{row[3]}: {row[2]} by {row[1]}, {row[4]:.3f} ({row[5]:.3f} to {row[6]:.3f}), n = {row[11]}" for row in found]
        rows.append((dataset, "", "", "", *(NAN,) * 3, "", *(NAN,) * 5, f"On {dataset}, {'; '.join(said[:3])}."))
        rows += [(*row, f"On {dataset}, {text}.") for row, text in zip(found, said)]
    return pandas.DataFrame(rows, columns=["dataset", "metric", "verdict", "leaders", "mean", "ci95_low", "ci95_high", "second", "lead",
                                           "lead_low", "lead_high", "n", "n_shapes", "sentence"])


def leader(units, metric, scores):
    """verdict, leaders, mean, ci95, second, lead and its joint interval."""
    if not len(units):
        return "no common shape", ", ".join(units), *(NAN,) * 3, "", *(NAN,) * 3
    ranked = rank(units, scores.lower, scores.resamples)
    best = ranked[0][0]
    first = [model for model, _, _, low, *_ in ranked if not low > 1]
    of_best = (ranked[0][1], *within_range(units[best].to_numpy(), metric)[2:])
    if len(units) < 2 or len(ranked) < 2:
        return "one unit" if len(units) < 2 else "only model", ", ".join(first), *of_best, "", *(NAN,) * 3
    second = ranked[1][0]
    ahead = (units[best] - units[second]).to_numpy() * (-1 if scores.lower else 1)
    half = joint_bound(units, scores.resamples) * stats.sem(ahead) if numpy.ptp(ahead) > 0 else 0
    verdict = "not told apart" if len(first) > 1 else "leads" if ranked[0][4] == 1 else "not behind"
    return verdict, ", ".join(first), *of_best, second, ahead.mean(), ahead.mean() - half, ahead.mean() + half
