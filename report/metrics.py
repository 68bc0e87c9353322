# SPDX-License-Identifier: GPL-3.0-or-later
"""Metrics by name: label, unit, direction, and which are conventions of the same measurement."""

import math
from dataclasses import dataclass

PAPER = {"auc": "AUC", "nss": "NSS", "lcc": "LCC"}
TIE = 1e-12  # relative difference of equal means: the same scores summed in another order
LEADING = 3  # metrics that every page shows; the others stand behind a menu

_LABELS = {**PAPER, "auc_exact": "AUC (exact)", "auc_judd": "AUC (Judd)", "auc_borji": "AUC (Borji)", "cc": "CC",
           "ig": "Information gain", "ig_centre": "Information gain (centre bias)", "spearman": "Spearman", "kl": "KL", "kl_smoothed": "KL (smoothed)", "sim": "SIM",
           "sim_minmax": "SIM (min-max)", "mse": "MSE", "mae": "MAE", "cosine": "Cosine", "kl_keras": "KL (Keras)", "kl_caffe": "KL (Caffe)",
           "kl_pysaliency": "KL (pysaliency)", "kl_shifted": "KL (shifted)", "sauc": "AUC (shuffled)", "fne": "FNE", "fpe": "FPE",
           "wme": "WME", "precision": "Precision", "recall": "Recall"}
_ENDINGS = {"_multiplicity": "with multiplicity", "_area": "by area"}
_DISTANCES = ("kl", "kl_smoothed", "mse", "mae", "kl_keras", "kl_caffe", "kl_pysaliency", "kl_shifted", "fne", "fpe", "wme")  # for results of a run.yaml that does not say what is better
_FAMILIES = {"auc": "AUC", "nss": "NSS", "lcc": "Correlation", "kl": "KL", "sim": "SIM", "mse": "Error",
             "ig": "Information gain"}
_FAMILY_OF = {"cc": "lcc", "spearman": "lcc", "mae": "mse"}


def split(name):
    """("nss", ["_multiplicity", "_area"]) of nss_multiplicity_area."""
    endings = []
    while found := [ending for ending in _ENDINGS if name.endswith(ending)]:
        endings.insert(0, found[0])
        name = name.removesuffix(found[0])
    return name, endings


def label_of(name):
    base, endings = split(name)
    kind, top, share = base.partition("_top")
    label = f"{_LABELS[kind]} (top {share} %)" if top and kind in _LABELS else _LABELS.get(base, base)
    return ", ".join([label] + [_ENDINGS[ending] for ending in endings])


def family_of(name):
    """The metric that the others of its family are variants of: "auc" of auc_judd_area, "lcc" of cc."""
    base = split(name)[0]
    base = base if base in _FAMILY_OF else base.partition("_")[0]
    return _FAMILY_OF.get(base, base)


def family_label(family):
    return _FAMILIES.get(family, family)


@dataclass(frozen=True)
class Metric:
    """A column of the tables, as run.yaml describes it."""
    name: str
    label: str
    unit: str = "1"
    lower: bool = False  # better
    matching: str = ""   # of the maps that it reads: "histogram", "none"; empty if run.yaml does not say

    @property
    def maps(self):
        """Which maps it reads, in words; empty where nobody said."""
        return {"histogram": "matched", "none": "as they are"}.get(self.matching, "")

    @property
    def below(self):
        """What stands below the label in tables: the paper's metrics read matched maps, which goes without saying."""
        return "maps as they are" if self.matching == "none" else ""

    def best(self, scores):
        """The keys of the best scores: what every page and table sets in bold. Several where scores tie; none where no score
        is a finite number."""
        known = {key: value for key, value in scores.items() if value is not None and math.isfinite(value)}
        top = (min if self.lower else max)(known.values(), default=0)
        return {key for key, value in known.items() if abs(value - top) <= TIE * abs(top)}


def described(name, entry=None):
    """entry: {"unit": ..., "better": ..., "matching": ...} of run.yaml, if it has one."""
    entry = entry if isinstance(entry, dict) else {}
    better = entry.get("better") or ("lower" if split(name)[0] in _DISTANCES else "higher")
    return Metric(name, label_of(name), str(entry.get("unit") or "1"), better == "lower", str(entry.get("matching") or ""))


def leading(names):
    """The paper's metrics among some, filled up to three with the first of the others."""
    papers = [name for name in PAPER if name in names]
    return (papers + [name for name in names if name not in PAPER])[:max(LEADING, len(papers))]
