# SPDX-License-Identifier: GPL-3.0-or-later
"""Every area under a ROC curve is what docs/metrics.md says: its positives and negatives, and what a perfect map and its negation get."""

import re
import unittest

import numpy as np

import salbench
from salbench import metrics
from tests.docs import pages

N = 300
DRAW = np.random.default_rng(5)
G = DRAW.random(N) ** 4
PICKS = np.append(DRAW.choice(np.arange(1, N), 14, replace=False), [40, 40, 41, 41])  # points that several people picked
F = np.bincount(PICKS, minlength=N) > 0
OF_OTHERS = DRAW.random(N)  # density of the other shapes' ground truth
TOP = G > np.sort(G)[-61]
ALL = np.ones(N)
WEIGHTS = {"auc": (F, ALL), "auc_exact": (F, ~F), "auc_all": (np.bincount(PICKS, minlength=N), ALL), "auc_judd": (F, ~F), "auc_borji": (F, ALL),
           "auc_top20": (TOP, ~TOP), "sauc": (F, OF_OTHERS)}  # positives, negatives
PAIRS = ("auc_exact", "auc_all", "auc_top20", "sauc")  # shares of pairs; others are areas of coarser curves
DRAWN = ("auc", "auc_borji")


def score(name, saliency):
    own = {"ground_truth": G} if name == "auc_top20" else {"picks": PICKS}
    return salbench.score(saliency, metrics=name, splits=4000 if name in DRAWN else 1, **own, **({"negatives": OF_OTHERS} if name == "sauc" else {}))[name]


def share_of_pairs(saliency, positive, negative):
    higher = np.sign(saliency[:, None] - saliency) / 2 + .5
    return positive @ higher @ negative / (np.sum(positive) * np.sum(negative))


def page():
    """Name -> what a perfect map and its negation get, as the page says."""
    text = (pages.ROOT / "docs/metrics.md").read_text(encoding="utf-8").split("### Areas under ROC curves")[1].split("\n### ")[0]
    return {name: ends for name, *ends in re.findall(r"^\| `(\w+)` \|.*\| ([^|]+) \| ([^|]+) \|$", text, re.MULTILINE)}


class Areas(unittest.TestCase):
    def test_the_page_has_all(self):
        self.assertEqual(set(page()), {row.name for row in metrics.table() if "auc" in row.name})
        self.assertEqual(set(WEIGHTS), set(page()))

    def test_a_perfect_map_and_its_negation_get_what_the_page_says(self):
        for name, said in page().items():
            positive, negative = (np.asarray(weights, dtype=float) for weights in WEIGHTS[name])
            q = negative[positive > 0].sum() / negative.sum()
            perfect = G if name == "auc_top20" else F.astype(float)
            for saliency, words in zip((perfect, -perfect), said):
                expected = {"1 - q/2": 1 - q / 2, "q/2": q / 2, "1": 1, "0": 0, "1/2": .5}[words]
                self.assertAlmostEqual(score(name, saliency), expected, delta=.002 if name in DRAWN else 1e-12, msg=(name, words))

    def test_shares_of_pairs_have_the_negatives_that_the_page_says(self):
        saliency = np.round(DRAW.random(N) + .3 * F, 1)  # with ties
        for name in PAIRS:
            self.assertAlmostEqual(score(name, saliency), share_of_pairs(saliency, *WEIGHTS[name]), delta=1e-12, msg=name)

    def test_curves_are_near_the_share_of_pairs(self):
        saliency = DRAW.random(N) + .3 * F
        for name in set(WEIGHTS) - set(PAIRS):
            self.assertAlmostEqual(score(name, saliency), share_of_pairs(saliency, *WEIGHTS[name]), delta=.03, msg=name)

    def test_judds_curve_of_picks_without_ties_ends_above_0(self):
        saliency = np.where(F, -1 - DRAW.random(N), 0)
        self.assertAlmostEqual(score("auc_judd", saliency), 1 / (2 * F.sum()), delta=1e-12)


if __name__ == "__main__":
    unittest.main()
