# SPDX-License-Identifier: GPL-3.0-or-later
"""Scores of smoothed maps: a row per number of steps, and the best of them as a bound."""

import unittest
from math import nan

import numpy as np
import pandas as pd

from support import AUC, KL, row, scores_of
from salbench.conclusions.means import summary
from salbench.conclusions.smoothing import smoothing
from salbench.conclusions.study import Study


def smoothed(by_steps):
    frames = [scores_of(rows, (AUC, KL)).frame.assign(smoothing=steps) for steps, rows in by_steps.items()]
    return pd.concat(frames, ignore_index=True)


def study_of(by_steps, unit="mesh"):
    return Study(scores_of(by_steps["0"], (AUC, KL)), unit, smoothed=smoothed(by_steps))


class Smoothing(unittest.TestCase):
    def setUp(self):
        rng = np.random.default_rng(1)
        self.by_steps = {steps: [row(str(mesh), view, model, *rng.random(2)) for mesh in range(3) for view in ("", "0", "1")
                                 for model in ("LS", "PS")] for steps in ("0", "10", "50")}
        for rows in self.by_steps.values():
            rows.sort(key=lambda one: one[4])

    def test_a_row_per_number_of_steps(self):
        found = smoothing(study_of(self.by_steps))
        self.assertEqual(len(found), 2 * 2 * 2 * 4, "meshes and scans, models, metrics, steps")
        self.assertEqual(found["steps"][:4].tolist(), ["0", "10", "50", "best"])
        self.assertEqual(found["upper_bound"][:4].tolist(), [0, 0, 0, 1])
        self.assertEqual(set(found["n"]), {3}, "meshes are the unit, of scans too")
        self.assertEqual(found.groupby("dataset")["n_shapes"].max().to_dict(), {"meshes": 3, "scans": 6})

    def test_without_steps_it_is_the_summary(self):
        columns = ["dataset", "model", "metric", "n", "n_shapes", "mean", "ci95_low", "ci95_high"]
        study = study_of(self.by_steps)
        plain = smoothing(study).query("steps == '0'").reset_index(drop=True)
        pd.testing.assert_frame_equal(plain[columns], summary(study)[columns])

    def test_where_every_item_failed_there_is_no_row(self):
        study = study_of(self.by_steps)
        none = Study(study.scores, "mesh", smoothed=study.smoothed[:0])
        self.assertEqual(smoothing(none).columns.tolist(), smoothing(study).columns.tolist())
        self.assertEqual(len(smoothing(none)), 0)

    def test_the_best_is_chosen_by_shape_model_and_metric(self):
        rows = {"0": [row("1", "", "A", .2, 5), row("2", "", "A", .9, nan)], "10": [row("1", "", "A", .4, 7), row("2", "", "A", .1, 3)]}
        found = smoothing(study_of(rows)).set_index(["metric", "steps"])["mean"]
        self.assertAlmostEqual(found["auc", "best"], (.4 + .9) / 2, places=14)
        self.assertAlmostEqual(found["kl", "best"], (5 + 3) / 2, places=14)
        self.assertEqual(found["kl", "0"], 5, "one shape has no score")
