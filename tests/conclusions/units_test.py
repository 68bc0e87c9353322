# SPDX-License-Identifier: GPL-3.0-or-later
"""Units of observation, and the shapes that models are compared on; remarks on metrics by which chance or a constant map is as good as a model; and
scores of smoothed maps, with the best of them as a bound."""

import unittest
from math import nan

import numpy as np
import pandas as pd

from salbench.conclusions.chance import chance
from salbench.conclusions.classes import per_class
from salbench.conclusions.means import summary
from salbench.conclusions.significance import significance
from salbench.conclusions.smoothing import smoothing
from salbench.conclusions.study import Study
from salbench.conclusions.units import Level, levels
from support import AUC, KL, NAN, NSS, one, row, scores_of, study_of


def scans(meshes, between, within):
    """Meshes that differ much and views that differ little, two models that differ in nothing but noise."""
    rng = np.random.default_rng(1)
    of_mesh = between * rng.normal(size=(meshes, 2))
    return [row(mesh, view, model, of_mesh[mesh, m] + within * rng.normal())
            for mesh in range(meshes) for view in range(12) for m, model in enumerate("AB")]


class UnitsTest(unittest.TestCase):
    def test_the_views_of_a_mesh_are_one_observation(self):
        rows = scans(10, 1, 0.1)
        by_mesh, by_shape = (significance(study_of(rows, unit=unit)).iloc[0] for unit in ("mesh", "shape"))
        self.assertEqual((by_mesh["n"], by_shape["n"], by_mesh["n_shapes"]), (10, 120, 120))
        self.assertAlmostEqual(by_mesh["mean_difference"], by_shape["mean_difference"], delta=1e-12)
        widths = [of["ci95_high"] - of["ci95_low"] for of in (by_mesh, by_shape)]
        self.assertGreater(widths[0], 3 * widths[1])  # sqrt(12) if views of a mesh were equal
        self.assertEqual(by_mesh["rank_sum_p"], by_shape["rank_sum_p"], "the paper's test takes shapes, whatever the unit")

    def test_a_class_is_one_observation_and_shapes_without_one_are_none(self):
        rows = [row(1, "", "A", 1, category="human"), row(2, "", "A", 2, category="human"), row(3, "", "A", 5, category="cup"), row(4, "", "A", 99)]
        found = summary(study_of(rows, unit="class")).iloc[0]
        self.assertEqual((found["n"], found["n_shapes"], found["mean"]), (2, 3, (1.5 + 5) / 2))

    def test_a_view_without_a_score_leaves_the_others_of_its_mesh(self):
        found = summary(study_of([row(1, 0, "A", 1), row(1, 1, "A", NAN), row(1, 2, "A", 3), row(2, 0, "A", NAN)])).iloc[0]
        self.assertEqual((found["n"], found["n_shapes"], found["mean"]), (1, 2, 2))

    def test_models_are_compared_on_shapes_that_all_competitors_have(self):  # A fails on the hardest, and must not rise by that
        found = summary(study_of([row(1, "", "A", .8), row(1, "", "B", .9), row(2, "", "A", .6), row(2, "", "B", .7),
                                  row(3, "", "A", NAN), row(3, "", "B", .1)]))
        a, b = one(found, model="A"), one(found, model="B")
        np.testing.assert_allclose([a["mean"], b["mean"], b["own_mean"]], [.7, .8, 1.7 / 3], rtol=1e-12)
        self.assertEqual([b["n"], a["n_own_shapes"], b["n_own_shapes"]], [2, 2, 3])

    def test_a_reference_bounds_its_own_row_alone(self):
        study = study_of([row(1, "", "A", .8), row(1, "", "HS", .9), row(2, "", "A", .6), row(2, "", "HS", NAN)])
        self.assertEqual(list(summary(study)["n"]), [2, 1])
        self.assertEqual(one(significance(study), model_a="A", model_b="HS")["n"], 1)

    def test_groups_are_what_single_calls_give(self):
        rng = np.random.default_rng(2)
        values = np.where(rng.random((30, 5)) < .15, NAN, rng.normal(size=(30, 5)))
        level = levels(scores_of([row(i // 3, i % 3, model, values[i, m]) for i in range(30) for m, model in enumerate(["A", "B", "HS", "RS", "C"])]),
                       "mesh")[0]
        sets = [(0, 1), (0, 2), (2, 3), (1, 3), (4,)]
        seen = []
        for places, scores in level.groups(0, sets):
            for place in places:
                alone = level.compared(0, sets[place])
                np.testing.assert_array_equal(scores.values[:, np.searchsorted(scores.models, sets[place])], alone.values)
                np.testing.assert_array_equal(scores.units, alone.units)
                self.assertEqual(scores.n_shapes, alone.n_shapes)
                seen.append(place)
        self.assertEqual(sorted(seen), [0, 1, 2, 3, 4])

    def test_splits_follow_their_data_set_and_one_alone_is_named(self):
        rows = [row(1, "", "A", 1, split="train"), row(2, "", "A", 2, split="test"), row(3, 0, "A", 3, split="test")]
        found = [(level.dataset, level.split, len(level.values)) for level in levels(scores_of(rows), "mesh")]
        self.assertEqual(found, [("meshes", "", 2), ("meshes", "train", 1), ("meshes", "test", 1), ("scans", "test", 1)])

    def test_an_empty_part_has_no_models(self):
        self.assertEqual(levels(scores_of([]), "mesh"), [])
        self.assertEqual(Level(scores_of([]), "meshes", "shape").models, [])

    def test_the_average_of_a_class_is_over_competitors_shape_by_shape(self):  # so models that agree make its interval no narrower
        rows = [row(item, view, model, value, category="cup") for model in "AB" for item, view, value in ((1, 0, .2), (1, 1, .4), (2, 0, .6))]
        rows += [row(1, 0, "RS", .9, category="cup"), row(2, 0, "RS", .9, category="cup")]
        study = study_of(rows)
        per_class(study)["mean"] = 0.0  # changes only the copy
        found = per_class(study)
        a, average = one(found, model="A"), one(found, model="Avg")
        self.assertAlmostEqual(a["mean"], .45)
        for column in ("n", "n_shapes", "mean", "ci95_low", "ci95_high"):
            self.assertAlmostEqual(a[column], average[column], delta=1e-12)
        self.assertAlmostEqual(one(per_class(study_of(rows, unit="shape")), model="A")["mean"], .4)


def remarks(rows, constant=()):
    of_constant = scores_of(list(constant), (NSS, KL)).frame
    found = chance(Study(scores_of(rows, (NSS, KL)), constant=of_constant))
    return [f"{one.dataset}, {one.metric}: {one.remark}" for one in found.itertuples()]


class Chance(unittest.TestCase):
    def test_models_passed_are_named_and_by_how_much(self):
        rows = [row("1", "", "A", .5, 1), row("1", "", "B", .2, 3), row("1", "", "HS", .1, 20), row("1", "", "RS", 0, 2)]
        self.assertEqual(remarks(rows, [row("1", "", "constant", 0, 1.5)]), [
            "meshes, kl: chance (RS) is level with or ahead of B (by 1), HS (by 18); "
            "a constant map is level with or ahead of B (by 1.5), HS (by 18.5)"])

    def test_equal_means_are_level_whatever_the_order_of_their_sums(self):
        self.assertEqual(remarks([row("1", "", "A", .1 + .2, 1), row("1", "", "RS", .3, 2)]),
                         ["meshes, nss: chance (RS) is level with or ahead of A (level)"])
        self.assertEqual(remarks([row("1", "", "A", .31, 1), row("1", "", "RS", .3, 2)]), [])

    def test_they_are_about_the_shapes_that_both_have(self):
        rows = [row("1", "", "A", .5, nan), row("2", "", "A", .5, 3), row("1", "", "RS", 0, 9), row("2", "", "RS", 0, 2.5), row("3", "", "RS", 5, 0)]
        self.assertEqual(remarks(rows), ["meshes, kl: chance (RS) is level with or ahead of A (by 0.5)"])
        self.assertEqual(remarks([row("1", "", "A", nan, nan), row("1", "", "RS", 1, 1)]), [])
        self.assertEqual(remarks([row("1", "", "A", 1, 1)]), [], "no reference")
        self.assertEqual(remarks([]), [])


def smoothed(by_steps):
    frames = [scores_of(rows, (AUC, KL)).frame.assign(smoothing=steps) for steps, rows in by_steps.items()]
    return pd.concat(frames, ignore_index=True)


def smoothed_study(by_steps, unit="mesh"):
    return Study(scores_of(by_steps["0"], (AUC, KL)), unit, smoothed=smoothed(by_steps))


class Smoothing(unittest.TestCase):
    def setUp(self):
        rng = np.random.default_rng(1)
        self.by_steps = {steps: [row(str(mesh), view, model, *rng.random(2)) for mesh in range(3) for view in ("", "0", "1")
                                 for model in ("LS", "PS")] for steps in ("0", "10", "50")}
        for rows in self.by_steps.values():
            rows.sort(key=lambda one: one[4])

    def test_a_row_per_number_of_steps(self):
        found = smoothing(smoothed_study(self.by_steps))
        self.assertEqual(len(found), 2 * 2 * 2 * 4, "meshes and scans, models, metrics, steps")
        self.assertEqual(found["steps"][:4].tolist(), ["0", "10", "50", "best"])
        self.assertEqual(found["upper_bound"][:4].tolist(), [0, 0, 0, 1])
        self.assertEqual(set(found["n"]), {3}, "meshes are the unit, of scans too")
        self.assertEqual(found.groupby("dataset")["n_shapes"].max().to_dict(), {"meshes": 3, "scans": 6})

    def test_without_steps_it_is_the_summary(self):
        columns = ["dataset", "model", "metric", "n", "n_shapes", "mean", "ci95_low", "ci95_high"]
        study = smoothed_study(self.by_steps)
        plain = smoothing(study).query("steps == '0'").reset_index(drop=True)
        pd.testing.assert_frame_equal(plain[columns], summary(study)[columns])

    def test_where_every_item_failed_there_is_no_row(self):
        study = smoothed_study(self.by_steps)
        none = Study(study.scores, "mesh", smoothed=study.smoothed[:0])
        self.assertEqual(smoothing(none).columns.tolist(), smoothing(study).columns.tolist())
        self.assertEqual(len(smoothing(none)), 0)

    def test_the_best_is_chosen_by_shape_model_and_metric(self):
        rows = {"0": [row("1", "", "A", .2, 5), row("2", "", "A", .9, nan)], "10": [row("1", "", "A", .4, 7), row("2", "", "A", .1, 3)]}
        found = smoothing(smoothed_study(rows)).set_index(["metric", "steps"])["mean"]
        self.assertAlmostEqual(found["auc", "best"], (.4 + .9) / 2, places=14)
        self.assertAlmostEqual(found["kl", "best"], (5 + 3) / 2, places=14)
        self.assertEqual(found["kl", "0"], 5, "one shape has no score")
