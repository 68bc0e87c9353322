#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Every metric of random cases against other implementations: metrics_reference.py METRIC_CASES [COUNT]

SciPy has correlations and entropies, scikit-learn exact ROC areas. What neither has is written here from
the published formulas, each beside its source. Metrics of random draws have their twin in sampled_auc_test.cpp. Prints
the largest difference of each metric, and fails beyond 1e-9.
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
TOLERANCE = 1e-9  # times the value where that is larger than 1
DRAWN = {"auc", "auc_borji"}


def min_max(field):
    low, high = field.min(), field.max()
    return field if low == high else (field - low) / (high - low)


def constant(field):
    return len(np.unique(field)) <= 1


# --- correlations -----------------------------------------------------------------------------------------------


def pearson(a, b, weights):
    if constant(a[weights > 0]) or constant(b[weights > 0]):
        return 0.0
    if (weights == 1).all():
        return stats.pearsonr(a, b)[0]
    covariance = np.cov(a, b, aweights=weights, ddof=0)
    return covariance[0, 1] / math.sqrt(covariance[0, 0] * covariance[1, 1])


# --- distributions ----------------------------------------------------------------------------------------------


def density(field, is_map, added=0.0):
    """The field over its sum. None where there is none."""
    if is_map and constant(field):
        field = np.ones_like(field)
        added = 0.0
    if not is_map and not field.any():
        return None
    return (field + added) / np.sum(field + added)


def divergence(map_, truth):
    """Bylinskii et al. 2019: sum g ln(eps + g / (p + eps)); code_forMetrics/KLdiv.m of the MIT benchmark."""
    p, g = density(map_, True), density(truth, False)
    return math.nan if g is None else np.sum(g * np.log(EPS + g / (p + EPS)))


def smoothed_divergence(map_, truth):
    """As distributions of (x + 1e-12) / (sum + n 1e-12): scipy.stats.entropy of the two."""
    p, g = density(map_, True, 1e-12), density(truth, False, 1e-12)
    return math.nan if g is None else stats.entropy(g, p)


def general_divergence(map_, truth, values=0.0, densities=0.0):
    """sum (g + d) ln((g + d) / (p + d)): image_based_kl_divergence of pysaliency (1e-20 added to values), and the evaluators of
    Danchik757/Mesh-Saliency-Projection (d = 1e-12)."""
    p, g = density(map_, True, values), density(truth, False, values)
    if g is None:
        return math.nan
    p, g = p + densities, g + densities
    return np.sum(g[g > 0] * np.log(g[g > 0] / p[g > 0]))


def similarity(map_, truth):
    """Judd, Durand, Torralba 2012: sum min(p, g)."""
    p, g = density(map_, True), density(truth, False)
    return math.nan if g is None else np.minimum(p, g).sum()


def information_gain(map_, baseline, picks):
    """Kuemmerer, Wallis, Bethge 2015: mean of log2(p) - log2(baseline) over the fixations, eps as in the MIT benchmark."""
    p, b = density(map_, True), density(baseline, True)
    return np.mean(np.log2(EPS + p[picks]) - np.log2(EPS + b[picks]))


# --- ROC curves -------------------------------------------------------------------------------------------------


def roc_auc(positives, negatives, negative_weights=None):
    labels = np.r_[np.ones(len(positives)), np.zeros(len(negatives))]
    weights = np.r_[np.ones(len(positives)), np.ones(len(negatives)) if negative_weights is None else negative_weights]
    return sk.roc_auc_score(labels, np.r_[positives, negatives], sample_weight=weights)


def exact(case, picks):
    unpicked = np.delete(case["map"], picks)
    return roc_auc(case["map"][picks], unpicked) if len(unpicked) else math.nan


def area_below(thresholds, positives, negatives):
    """Trapezoids through the rates at the thresholds, from (0, 0) to (1, 1)."""
    reach = np.sort(thresholds)[::-1, None]
    false_rates, true_rates = (negatives >= reach).mean(axis=1), (positives >= reach).mean(axis=1)
    heights, places = np.r_[0, true_rates, 1], np.r_[0, false_rates, 1]
    return (np.diff(places) * (heights[1:] + heights[:-1]) / 2).sum()


def judd(case, picks):
    """Judd et al. 2009: thresholds at the fixated values; ties counted as pysaliency's general_roc does, by >=."""
    positives, unpicked = case["map"][picks], np.delete(case["map"], picks)
    return area_below(np.unique(positives), positives, unpicked) if len(unpicked) else math.nan


# --- the upper part of the ground truth -------------------------------------------------------------------------


def on_top(truth):
    above = np.array([(truth > v).sum() for v in truth])
    return (100 * above < 20 * len(truth) * (1 - 1e-9)) & (truth > truth.min())


def height(map_, points, of_constant):
    if constant(map_):
        return of_constant
    return ((map_[points] - map_.mean()) / map_.std()).mean()


def reference(case):
    map_, truth = case["map"], case["saliency"]
    normalised_map = np.full_like(map_, 0.5) if constant(map_) else min_max(map_)
    normalised_truth = min_max(truth)
    as_density, normalised_density = np.maximum(map_, case["floor"]), np.maximum(normalised_map, case["floor"])
    ones, top = np.ones_like(map_), on_top(truth)
    cc = pearson(map_, normalised_truth, ones)
    values = {
        "cc": cc,
        "lcc": abs(cc),
        "cc_area": pearson(map_, normalised_truth, case["areas"]) if case["areas"].sum() > 0 else math.nan,
        "spearman": 0.0 if constant(map_) or constant(truth) else stats.spearmanr(map_, truth)[0],
        "kl": divergence(as_density, truth),
        "kl_smoothed": smoothed_divergence(as_density, truth),
        "kl_pysaliency": general_divergence(as_density, truth, values=1e-20),
        "kl_shifted": general_divergence(as_density, truth, densities=1e-12),
        "sim": similarity(as_density, truth),
        "sim_minmax": similarity(normalised_density, normalised_truth),
        "auc_top20": roc_auc(map_[top], map_[~top]) if top.any() else math.nan,
        **interest_reference.interest_points({**case, "map": normalised_map}),
    }
    names = ("auc_exact", "auc_judd", "nss", "ig", "ig_centre", "sauc", "auc_all", "nss_multiplicity", "ig_centre_multiplicity")
    if not len(case["picks"]):
        return values | dict.fromkeys(names, math.nan)
    picks, every_pick = np.unique(case["picks"]), np.sort(case["picks"])
    values["auc_exact"] = exact(case, picks)
    values["auc_judd"] = judd(case, picks)
    values["auc_all"] = roc_auc(map_[every_pick], map_)
    values["sauc"] = roc_auc(map_[picks], map_, case["negatives"]) if case["negatives"].any() else math.nan
    values["ig"] = information_gain(as_density, ones, picks)
    for suffix, points in (("", picks), ("_multiplicity", every_pick)):
        values["nss" + suffix] = height(map_, points, case["constant_nss"])
        values["ig_centre" + suffix] = information_gain(as_density, case["centre_bias"], points)
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
        expected = reference(case)
        if set(expected) | DRAWN != set(case["values"]):
            sys.exit(f"metrics without a reference, or the reverse: {sorted((set(expected) | DRAWN) ^ set(case['values']))}")
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
