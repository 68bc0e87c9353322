# SPDX-License-Identifier: GPL-3.0-or-later
"""Intervals hold and tests err as often as they say, in a few hundred simulated data sets of equal models. scripts/figures
calibration does the same over thousands, with the variances of a run."""

import sys
import unittest
from pathlib import Path

import numpy as np

sys.path.append(str(Path(__file__).resolve().parents[2] / "scripts"))

from studies import calibration as study, joint  # noqa: E402
from studies.calibration import PeopleModel, ScoreModel, calibrate, calibrate_people, score_model  # noqa: E402
from support import AUC
from salbench.conclusions.units import Scores

DATA_SETS = 400


def allowance(rate, data_sets=DATA_SETS):
    """Four standard errors of a rate over the data sets, as if each had one case."""
    return 4 * np.sqrt(rate * (1 - rate) / data_sets)


class Calibration(unittest.TestCase):
    def test_intervals_hold_and_tests_err_as_often_as_they_say(self):
        model = ScoreModel(mesh=.06, view=.03, model_of_mesh=.025, model_of_view=.035, models=4, meshes=25, views=6)
        honest = 0
        for what, expected, rate in calibrate(model, DATA_SETS, 1):
            if what == "unit shape: interval of a difference":
                self.assertLess(rate, expected - allowance(expected), "views pass for meshes")
            elif not what.startswith("unit shape"):
                honest += 1
                self.assertAlmostEqual(rate, expected, delta=allowance(expected), msg=what)
        self.assertEqual(honest, 10)

    def test_intervals_of_people_hold_as_often_as_they_say(self):
        rng = np.random.default_rng(3)
        level = .7 + .1 * rng.normal(size=(24, 1))
        models = level + [-.1, .05, 0, -.5] + .05 * rng.normal(size=(24, 4))
        curve = level + .1 - .1 / np.arange(1, 6) + .02 * rng.normal(size=(24, 5))
        found = list(calibrate_people(PeopleModel(AUC, ["A", "B", "HS", "RS"], np.hstack([models, curve])), 24, 200, 1))
        self.assertEqual(len(found), 3)
        for what, expected, rate in found:
            self.assertAlmostEqual(rate, expected, delta=allowance(expected, 200), msg=what)

    def test_any_pair_of_equal_models_is_told_apart_as_rarely_as_said(self):
        for noise in (study.normal, study.heavy, study.tied):
            for meshes in (6, 19):
                for models, rate in study.any_pair(noise, meshes, 1, 200, 1).items():
                    self.assertLess(rate, .05 + allowance(.05, 200), (noise, meshes, models))
        rates = study.missing(20)
        self.assertEqual(rates["the first model leads"], rates["and its sentence says what it lacks"])

    def test_joint_intervals_hold_all_differences_of_unequal_models(self):
        for means in (np.zeros(6), np.array([0., 0, 0, 0, 2, 4]), np.linspace(0, 4, 6)):
            for units in (6, 10):
                for rate in joint.coverage(units, means, 400):
                    self.assertAlmostEqual(rate, .95, delta=allowance(.95), msg=(units, means))

    def test_a_lead_on_these_classes_is_rarely_one_on_new_classes(self):
        rates = study.new_classes(.03, .03, 40)
        self.assertLess(rates["mesh"], .8)
        self.assertGreater(rates["class"], .95 - allowance(.95, 40))
        self.assertGreater(rates["on these"], rates["new classes"])

    def test_variances_are_found_again(self):
        model = ScoreModel(mesh=3, view=2, model_of_mesh=1.5, model_of_view=1, models=4, meshes=4000, views=6)
        scores = Scores(model.rows().assign(auc=model.draw(np.random.default_rng(1)).ravel()), (AUC,))
        found = score_model(scores, 0)
        for name, value in vars(model).items():
            self.assertAlmostEqual(getattr(found, name), value, delta=.05 * value, msg=name)
