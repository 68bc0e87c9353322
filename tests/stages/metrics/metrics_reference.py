#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Every metric of random cases against other implementations: metrics_reference.py METRIC_CASES [COUNT]

SciPy has correlations and entropies, scikit-learn exact ROC areas and errors. What neither has is written here from
the published formulas, each beside its source. Random draws follow the documented generator. Prints the largest
difference of each metric, and fails beyond 1e-9.
"""
import json
import math
import subprocess
import sys
import warnings

import numpy as np
from scipy import stats
from sklearn import metrics as sk

import interest_reference

EPS = 2.2204e-16
MASK = (1 << 64) - 1
TOLERANCE = 1e-9  # times the value where that is larger than 1


class Rng:
    """xoshiro256** (Blackman and Vigna 2021), seeded by SplitMix64 from the seed and an FNV hash of two names."""

    def __init__(self, seed, stage, item):
        hashed = 0xCBF29CE484222325
        for name in (stage, item):
            for byte in name.encode() + b"\xff":
                hashed = (hashed ^ byte) * 0x100000001B3 & MASK
        self.mixed = seed
        self.mixed = self.split_mix() ^ hashed
        self.state = [self.split_mix() for _ in range(4)]

    def split_mix(self):
        self.mixed = (self.mixed + 0x9E3779B97F4A7C15) & MASK
        z = self.mixed
        z = (z ^ z >> 30) * 0xBF58476D1CE4E5B9 & MASK
        z = (z ^ z >> 27) * 0x94D049BB133111EB & MASK
        return z ^ z >> 31

    def next(self):
        def turned(x, k):
            return (x << k | x >> 64 - k) & MASK

        s = self.state
        result = turned(s[1] * 5 & MASK, 7) * 9 & MASK
        shifted = s[1] << 17 & MASK
        s[2] ^= s[0]
        s[3] ^= s[1]
        s[1] ^= s[2]
        s[0] ^= s[3]
        s[2] ^= shifted
        s[3] = turned(s[3], 45)
        return result

    def uniform(self):
        return (self.next() >> 11) * 2.0**-53

    def below(self, bound):
        draw = self.next()
        while draw < (1 << 64) % bound:
            draw = self.next()
        return draw % bound


def min_max(field):
    low, high = field.min(), field.max()
    return field if low == high else (field - low) / (high - low)


def constant(field, weights):
    return len(np.unique(field[weights > 0])) <= 1


# --- correlations -----------------------------------------------------------------------------------------------


def pearson(a, b, weights):
    if constant(a, weights) or constant(b, weights):
        return 0.0
    if (weights == 1).all():
        return stats.pearsonr(a, b)[0]
    covariance = np.cov(a, b, aweights=weights, ddof=0)
    return covariance[0, 1] / math.sqrt(covariance[0, 0] * covariance[1, 1])


def mid_distribution(field, weights):
    """Weight of the smaller values and half of the equal ones: n times what scipy.stats.rankdata gives, less one half."""
    return np.array([weights[field < v].sum() + weights[field == v].sum() / 2 for v in field])


def spearman(a, b, weights):
    if constant(a, weights) or constant(b, weights):
        return 0.0
    if (weights == 1).all():
        return stats.spearmanr(a, b)[0]
    return pearson(mid_distribution(a, weights), mid_distribution(b, weights), weights)


# --- distributions ----------------------------------------------------------------------------------------------


def density(field, weights, unit, is_map, added=0.0):
    """Per vertex the field over its sum; by area relative to the uniform one. None where there is none."""
    if is_map and constant(field, weights):
        field = np.ones_like(field)
        added = 0.0
    if not is_map and not field[weights > 0].any():
        return None
    return (field + added) * unit / np.sum((field + added) * weights)


def divergence(map_, truth, weights, unit):
    """Bylinskii et al. 2019: sum g ln(eps + g / (p + eps)); code_forMetrics/KLdiv.m of the MIT benchmark."""
    p, g = density(map_, weights, unit, True), density(truth, weights, unit, False)
    if g is None:
        return math.nan
    return np.sum(weights / unit * g * np.log(EPS + g / (p + EPS)))


def smoothed_divergence(map_, truth, weights, unit):
    """As distributions of (x + 1e-12) / (sum + n 1e-12): scipy.stats.entropy of the two."""
    p, g = density(map_, weights, unit, True, 1e-12), density(truth, weights, unit, False, 1e-12)
    if g is None:
        return math.nan
    seen = weights > 0
    return stats.entropy((weights * g)[seen], (weights * p)[seen])


def general_divergence(map_, truth, weights, unit, values=0.0, quotient=0.0, densities=0.0):
    """sum (g + d) ln(q + (g + d) / (p + d + q)): loss.py of alexanderkroner/saliency (q = 1e-7), the loss layer of
    nian-liu/DSCLRCN (q = 1e-6), image_based_kl_divergence of pysaliency (1e-20 added to values), and the evaluators of
    Danchik757/Mesh-Saliency-Projection (d = 1e-12)."""
    p, g = density(map_, weights, unit, True, values), density(truth, weights, unit, False, values)
    if g is None:
        return math.nan
    p, g = p + densities, g + densities
    return np.sum(weights / unit * g * np.log(quotient + g / (p + quotient)))


def cosine(map_, truth, weights):
    norms = math.sqrt(np.sum(weights * map_**2) * np.sum(weights * truth**2))
    return np.sum(weights * map_ * truth) / norms if norms else math.nan


def similarity(map_, truth, weights):
    """Judd, Durand, Torralba 2012: sum min(p, g)."""
    p, g = density(map_, weights, 1, True), density(truth, weights, 1, False)
    return math.nan if g is None else np.minimum(p * weights, g * weights).sum()


def information_gain(map_, baseline, picks, weights, unit):
    """Kuemmerer, Wallis, Bethge 2015: mean of log2(p) - log2(baseline) over the fixations, eps as in the MIT benchmark."""
    p, b = density(map_, weights, unit, True), density(baseline, weights, unit, True)
    return np.mean(np.log2(EPS + p[picks]) - np.log2(EPS + b[picks]))


# --- ROC curves -------------------------------------------------------------------------------------------------


def roc_auc(positives, negatives, positive_weights, negative_weights):
    labels = np.r_[np.ones(len(positives)), np.zeros(len(negatives))]
    return sk.roc_auc_score(labels, np.r_[positives, negatives], sample_weight=np.r_[positive_weights, negative_weights])


def unpicked(case, by_area):
    keep = np.ones(len(case["map"]), bool)
    if not by_area:
        keep[case["picks"]] = False
    return keep


def exact(case, picks, weights, by_area):
    keep = unpicked(case, by_area)
    if not weights[keep].sum():
        return math.nan
    return roc_auc(case["map"][picks], case["map"][keep], np.ones(len(picks)), weights[keep])


def shuffled(case, picks, weights):
    """Tatler, Baddeley, Gilchrist 2005: negatives where other shapes are marked, here all points by that density."""
    weights = weights * case["negatives"]
    if not weights.sum():
        return math.nan
    return roc_auc(case["map"][picks], case["map"], np.ones(len(picks)), weights)


def area_below(thresholds, positives, negatives, negative_weights):
    """Trapezoids through the rates at the thresholds, from (0, 0) to (1, 1)."""
    reach = np.sort(thresholds)[::-1, None]
    false_rates = (negatives >= reach) @ negative_weights / negative_weights.sum()
    true_rates = (positives >= reach).mean(axis=1)
    heights, places = np.r_[0, true_rates, 1], np.r_[0, false_rates, 1]
    return (np.diff(places) * (heights[1:] + heights[:-1]) / 2).sum()


def judd(case, picks, weights, by_area):
    """Judd et al. 2009: thresholds at the fixated values; ties counted as pysaliency's general_roc does, by >=."""
    keep = unpicked(case, by_area)
    if not weights[keep].sum():
        return math.nan
    positives = case["map"][picks]
    return area_below(np.unique(positives), positives, case["map"][keep], weights[keep])


def sampled(case, picks, draw, thresholds_of):
    """Mean over the splits of the area with as many drawn negatives as positives."""
    rng = Rng(1, "scores", case["item"])
    positives = case["map"][picks]
    areas = []
    for _ in range(case["splits"]):
        negatives = np.array([draw(rng) for _ in positives])
        thresholds = thresholds_of(max(positives.max(), negatives.max()))
        areas.append(area_below(thresholds, positives, negatives, np.ones(len(negatives))))
    return np.mean(areas)


def quantile(case, weights):
    order = np.argsort(case["map"], kind="stable")
    reached = np.cumsum(weights[order])
    return lambda rng: case["map"][order][min(np.searchsorted(reached, rng.uniform() * reached[-1], "right"), len(order) - 1)]


def paper_auc(case, picks, weights, by_area):
    """Tasse, Kosinka, Dodgson 2016."""
    n = len(case["map"])
    draw = quantile(case, weights) if by_area else lambda rng: case["map"][1 + rng.below(n - 1)]
    count = case["thresholds"]
    return sampled(case, picks, draw, lambda top: [top * t / (count - 1) for t in range(count - 1)] + [top])


def borji(case, picks, weights):
    """Borji, Tavakoli, Sihite, Itti 2013: fixed steps of a tenth over the min-max-normalised map."""
    low, high = case["map"].min(), case["map"].max()
    return sampled(case, picks, quantile(case, weights), lambda top: [low + (high - low) * k / 10 for k in range(11)])


# --- the upper part of the ground truth -------------------------------------------------------------------------


def on_top(truth, weights, percent):
    above = np.array([weights[truth > v].sum() for v in truth])
    return (100 * above < percent * weights.sum() * (1 - 1e-9)) & (truth > truth[weights > 0].min())


def height(map_, points, weights, point_weights, of_constant):
    if constant(map_, weights):
        return of_constant
    mean = np.average(map_, weights=weights)
    deviation = math.sqrt(np.average((map_ - mean) ** 2, weights=weights))
    return np.average((map_[points] - mean) / deviation, weights=point_weights)


def reference(case, by_area):
    weights = case["areas"] if by_area else np.ones(len(case["map"]))
    unit = weights.sum() if by_area else 1.0
    map_, truth = case["map"], case["saliency"]
    normalised_map = np.full_like(map_, 0.5) if len(np.unique(map_)) == 1 else min_max(map_)
    normalised_truth = min_max(truth)
    as_density, normalised_density = np.maximum(map_, case["floor"]), np.maximum(normalised_map, case["floor"])
    levels = len(np.unique(truth)) > 1 or not truth.any()
    cc = pearson(map_, normalised_truth, weights)
    values = {
        "cc": cc,
        "lcc": abs(cc),
        "spearman": spearman(map_, truth, weights),
        "kl": divergence(as_density, truth, weights, unit),
        "kl_smoothed": smoothed_divergence(as_density, truth, weights, unit),
        "sim": similarity(as_density, truth, weights),
        "sim_minmax": similarity(normalised_density, normalised_truth, weights),
        "cosine": cosine(np.full_like(map_, 0.5) if len(np.unique(map_)) == 1 else map_, truth, weights),
        "kl_keras": general_divergence(as_density, truth, weights, unit, quotient=1e-7),
        "kl_caffe": general_divergence(as_density, truth, weights, unit, quotient=1e-6),
        "kl_pysaliency": general_divergence(as_density, truth, weights, unit, values=1e-20),
        "kl_shifted": general_divergence(as_density, truth, weights, unit, densities=1e-12),
        "mse": sk.mean_squared_error(normalised_truth, normalised_map, sample_weight=weights) if levels else math.nan,
        "mae": sk.mean_absolute_error(normalised_truth, normalised_map, sample_weight=weights) if levels else math.nan,
    }
    for percent in (20, 10, 5, 1):
        top = on_top(truth, weights, percent) if not constant(truth, weights) else np.zeros(len(truth), bool)
        defined = weights[top].sum() > 0
        values[f"nss_top{percent}"] = height(map_, top, weights, weights[top], case["constant_nss"]) if defined else math.nan
        values[f"auc_top{percent}"] = (
            roc_auc(map_[top], map_[~top], weights[top], weights[~top]) if defined else math.nan
        )
    for suffix, picks in (("", np.unique(case["picks"])), ("_multiplicity", np.sort(case["picks"]))):
        names = ("auc", "auc_exact", "auc_judd", "auc_borji", "nss", "ig", "ig_centre", "sauc")
        if not len(picks):
            values.update({name + suffix: math.nan for name in names})
            continue
        values["auc" + suffix] = paper_auc(case, picks, weights, by_area)
        values["auc_exact" + suffix] = exact(case, picks, weights, by_area)
        values["auc_judd" + suffix] = judd(case, picks, weights, by_area)
        values["auc_borji" + suffix] = borji(case, picks, weights)
        values["nss" + suffix] = height(map_, picks, weights, np.ones(len(picks)), case["constant_nss"])
        values["ig" + suffix] = information_gain(as_density, np.ones_like(map_), picks, weights, unit)
        values["ig_centre" + suffix] = information_gain(as_density, case["centre_bias"], picks, weights, unit)
        values["sauc" + suffix] = shuffled(case, picks, weights)
    if not by_area:
        heights = [(map_ < map_[pick]).mean() + (map_ == map_[pick]).mean() / 2 for pick in case["picks"]]
        picks = np.sort(case["picks"])  # of the map as a density, which has no floor
        values.update(ig_fitted=information_gain(map_, np.ones_like(map_), picks, weights, unit) if len(picks) else math.nan,
                      kl_fitted=divergence(map_, truth, weights, unit), sim_fitted=similarity(map_, truth, weights))
        values["auc_all"] = np.mean(heights) if heights else math.nan
        values.update(interest_reference.interest_points({**case, "map": normalised_map}))
    return values


def difference(ours, theirs):
    if math.isnan(ours) or math.isnan(theirs):
        return 0 if math.isnan(ours) and math.isnan(theirs) else math.inf
    return abs(ours - theirs) / max(1, abs(theirs))


def main():
    warnings.simplefilter("error")
    program, count = sys.argv[1], sys.argv[2] if len(sys.argv) > 2 else "1000"
    largest, failures = {}, []
    lines = subprocess.run([program, "7", count], check=True, capture_output=True, text=True).stdout.splitlines()
    for line in lines:
        case = json.loads(line)
        for name in ("map", "saliency", "areas", "centre_bias", "negatives", "points"):
            case[name] = np.array(case[name], float)
        case["picks"] = np.array(case["picks"], int)
        case["points"] = case["points"].reshape(-1, 3)
        case["edges"] = interest_reference.edges_of(case["faces"])
        case["radius"], case["diameter"] = interest_reference.extent(case["points"])
        expected = reference(case, False)
        if case["areas"].sum() > 0:
            expected.update({f"{name}_area": value for name, value in reference(case, True).items()})
        else:
            expected.update({name: math.nan for name in case["values"] if name.endswith("_area")})
        if set(expected) != set(case["values"]):
            sys.exit(f"metrics without a reference, or the reverse: {sorted(set(expected) ^ set(case['values']))}")
        for name, value in expected.items():
            off = difference(case["values"][name], value)
            largest[name] = max(largest.get(name, 0), off)
            if off > TOLERANCE:
                failures.append(f"case {case['item']}: {name} is {case['values'][name]!r}, the reference {value!r}")
    for name, off in largest.items():
        print(f"{name:32} {off:.1e}")
    for failure in failures[:20]:
        print(failure)
    sys.exit(f"{len(failures)} values differ" if failures else 0)


if __name__ == "__main__":
    main()
