# SPDX-License-Identifier: GPL-3.0-or-later
# Imported by scripts/fidelity.py and scripts/scan_readings.
"""What was published about scans, and how near a results folder of ours comes to it."""

from pathlib import Path

import numpy as np
import pandas as pd

MODELS = ["LS", "CS", "PS", "MS"]
METRICS = ["auc", "nss", "cc"]


def results(folder):
    return pd.read_csv(Path(folder) / "results.csv", comment="#", dtype={"item": str, "view": str})


def histogram_distance(ours, published):
    """Kolmogorov-Smirnov distance of two mean density histograms."""
    a, b = np.cumsum(ours), np.cumsum(published)
    return float(np.abs(a / a[-1] - b / b[-1]).max())


def without_failures(histogram):
    """The published mean histogram of MS holds 185 constant maps of 4800, which fill bin 50 alone."""
    rest = histogram.copy()
    rest[50] -= 100 * 185 / 4800
    return rest * 100 / rest.sum()


def mean_histograms(reference, kind):
    table = pd.read_csv(Path(reference) / f"mean_histograms_{kind}.csv")
    histograms = {model: table[model].to_numpy() for model in MODELS}
    if kind == "scans":
        histograms["MS"] = without_failures(histograms["MS"])
    return histograms


def histogram_distances(folder, reference, kind):
    ours = pd.read_csv(Path(folder) / f"mean_histograms_{kind}.csv", comment="#")
    published = mean_histograms(reference, kind)
    return {model: histogram_distance(ours[model].to_numpy(), published[model]) for model in MODELS if model in ours}


def scan_by_scan(folder, reference):
    """Our scores beside the published ones (auc_published ...) of the same scan and model. Published failures of MS
    (AUC .5 and CC 0) are left out, and scans without a pick."""
    published = pd.read_csv(Path(reference) / "published_scan_by_scan.csv", dtype={"item": str, "view": str})
    failed = (published.model == "MS") & (published.auc == 0.5) & (published.cc == 0)
    both = results(folder).merge(published[~failed], on=["item", "view", "model"], suffixes=("", "_published"))
    return both.dropna(subset=["nss"])


def agreement(both, model, metric):
    """Means of both and Pearson's r over the scans of one model."""
    rows = both[both.model == model]
    ours, theirs = rows[metric], rows[f"{metric}_published"]
    return {"n": len(rows), "ours": ours.mean(), "published": theirs.mean(), "r": ours.corr(theirs)}


def ceiling(folder, shifted, model, metric):
    """Pearson's r between our own scores on two grids of rays, half a step apart: no program agrees better with
    another whose grid is not known."""
    keys = ["item", "view", "model"]
    both = results(folder).merge(results(shifted), on=keys, suffixes=("", "_shifted")).dropna(subset=["nss", "nss_shifted"])
    rows = both[both.model == model]
    return rows[metric].corr(rows[f"{metric}_shifted"])
