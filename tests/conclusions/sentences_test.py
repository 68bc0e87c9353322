# SPDX-License-Identifier: GPL-3.0-or-later
"""Sentences on unusual scores: few shapes, copies, constants, nobody ahead of chance, missing scores. Each case with its whole sentence."""

import unittest

import numpy as np
from support import NAN, row, scores_of, study_of

from salbench.conclusions.leaders import find_leaders
from salbench.conclusions.study import Study
from salbench.conclusions.units import Scores
from salbench.conclusions.words import observation

WAVE = np.array([.01, -.02, .03, -.01, .02, -.03, .015, -.015])  # from shape to shape


def scores(shapes, **of_models):
    """Scores of so many meshes: a mean with a small wave of its own, or a list."""
    return [row(f"m{mesh}", "", model, mean[mesh] if isinstance(mean, list) else mean + float(np.roll(WAVE, at)[mesh]))
            for mesh in range(shapes) for at, (model, mean) in enumerate(of_models.items())]


def clouds(rows):
    return [("clouds", *cells[1:]) for cells in rows]


CASES = {
    "one mesh": (scores(1, A=.7, B=.6), "On 1 mesh, one observation does not tell how the models rank by AUC."),
    "two": (scores(2, A=.7, B=.6), "On 2 meshes, 2 observations are too few to tell how the models rank by AUC: it takes 6."),
    "five": (scores(5, A=.7, B=.6), "On 5 meshes, 5 observations are too few to tell how the models rank by AUC: it takes 6."),
    "six": (scores(6, A=.7, B=.6), "On 6 meshes, A leads by AUC (mean 0.700, 95 % interval 0.675 to 0.725). 6 observations tell two models apart only if "
                                   "all of them agree (p = 0.031)."),
    "six that do not agree": (scores(6, A=.605, B=.6), "On 6 meshes, by AUC (A mean 0.605, 95 % interval 0.580 to 0.630), A or B may be best. 6 "
                                                       "observations tell two models apart only if all of them agree (p = 0.031)."),
    "seven": (scores(7, A=.7, B=.6), "On 7 meshes, A leads by AUC (mean 0.702, 95 % interval 0.681 to 0.723)."),
    "point clouds": (clouds(scores(7, A=.7, B=.6)), "On 7 point clouds, A leads by AUC (mean 0.702, 95 % interval 0.681 to 0.723)."),
    "one model": (scores(7, A=.7), "On 7 meshes, A is the only model that is scored by AUC (mean 0.702, 95 % interval 0.681 to 0.723)."),
    "one that knows nothing": (scores(7, A=.5), "On 7 meshes, by AUC (A mean 0.502, 95 % interval 0.481 to 0.523), no model is shown to be ahead of chance."),
    "a perfect map": (scores(7, A=[1.0] * 7, B=.6), "On 7 meshes, A leads by AUC (mean 1.000 on each)."),
    "constant scores": (scores(8, A=[.7] * 8, B=[.6] * 8), "On 8 meshes, by AUC (A mean 0.700 on each), the scores of A and of B do not vary, "
                                                           "and all observations show no more than one."),
    "a constant lead": (scores(7, A=[.7 + wave for wave in WAVE], B=[.6 + wave for wave in WAVE]), "On 7 meshes, A leads by AUC (mean 0.702, 95 % interval "
                                                                                               "0.681 to 0.723)."),
    "two constant maps": (scores(8, K=[.5] * 8, K2=[.5] * 8), "On 8 meshes, by AUC (K mean 0.500 on each), no model is shown to be ahead of chance."),
    "all below chance": (scores(8, A=.4, B=.3, RS=.5), "On 8 meshes, by AUC (A mean 0.400, 95 % interval 0.382 to 0.418), no model is shown to be ahead "
                                                       "of chance."),
    "missing scores": (scores(8, A=[NAN] + [.7, .72, .71, .69, .7, .73, .7], B=.6),
                       "On 7 of 8 meshes (A has no score on 1), A leads by AUC (mean 0.707, 95 % interval 0.694 to 0.720). With missing scores at chance, A "
                       "ranks 1 by AUC."),
    "no common shape": ([row(1, "", "A", .5), row(2, "", "B", .6)], "On meshes, no shape has scores of all models by AUC."),
    "references alone": (scores(8, HS=.7, RS=.5), "On meshes, no model has scores but references."),
}


class Sentences(unittest.TestCase):
    def test_of_odd_scores(self):
        for name, (rows, sentence) in CASES.items():
            with self.subTest(name):
                self.assertEqual([level.sentence for level in find_leaders(study_of(rows))], [sentence])

    def test_leads_never_stands_beside_no_interval(self):
        for name, (rows, _) in CASES.items():
            for level in find_leaders(study_of(rows)):
                for leader in level.leaders:
                    self.assertFalse(leader.verdict == "leads" and np.isnan([*leader.interval, *leader.lead_interval]).all(), name)
                    self.assertNotIn("no interval", level.sentence)


class Units(unittest.TestCase):
    def test_an_observation_is_what_there_is(self):
        for unit, datasets, words in (("mesh", ("meshes",), "mesh"), ("mesh", ("clouds",), "point cloud"), ("mesh", ("meshes", "scans"), "mesh"),
                                      ("mesh", ("scans", "clouds"), "mesh or point cloud"), ("shape", ("meshes", "scans"), "mesh or scan"),
                                      ("shape", ("clouds",), "point cloud"), ("class", ("clouds",), "class of shapes"), ("mesh", (), "")):
            self.assertEqual(observation(unit, datasets), words)


class Copies(unittest.TestCase):
    """Items that are equal in shape and ground truth are one observation."""

    def said(self, rows, copies, unit="mesh"):
        scores = scores_of(rows)
        (level,) = find_leaders(Study(Scores(scores.frame, scores.metrics, {name: names[0] for names in copies for name in names}), unit))
        return level

    def test_eight_copies_are_one(self):
        rows = scores(8, A=[.705] * 8, B=[.6] * 8)
        for unit in ("mesh", "shape"):
            self.assertEqual(self.said(rows, [[f"m{mesh}" for mesh in range(8)]], unit).sentence,
                             "On 8 meshes (1 without copies), one observation does not tell how the models rank by AUC. Copies, counted once: m0, m1, "
                             "m2, m3 and 4 others.")

    def test_some_copies_among_others(self):
        level = self.said(scores(8, A=.7, B=.6), [["m0", "m3"], ["m1", "m2", "gone"], ["m9", "m10"]])
        self.assertEqual(level.leaders[0].n, 6)
        self.assertRegex(level.sentence, r"^On 8 meshes \(6 without copies\), A leads .*\. Copies, counted once: m0 and m3; m1 and m2\.$")


if __name__ == "__main__":
    unittest.main()
