# SPDX-License-Identifier: GPL-3.0-or-later
"""Sentences on who leads say what the intervals of the ranks allow and no more; compact intervals stay within the range of their metric.
Unusual scores have their whole sentences: few shapes, copies, constants, nobody ahead of chance, missing scores."""

import collections
import unittest

import numpy as np

from salbench.conclusions.chance import ahead
from salbench.conclusions.leaders import find_leaders, leaders
from salbench.conclusions.means import compact, ranking, summary
from salbench.conclusions.metrics import leading_metrics, of_program
from salbench.conclusions.study import Study
from salbench.conclusions.units import Scores, levels
from salbench.conclusions.words import Brief, brief, brief_of, observation
from support import NAN, row, scores_of, study_of


def scored(models, meshes, noise=.01, split="", dataset=""):
    """Scores of meshes that differ much between meshes and little between models, which are named with their means."""
    rng = np.random.default_rng(7)
    of_mesh = .05 * rng.normal(size=meshes)
    return [row(f"{split}{mesh}", "", model, mean + of_mesh[mesh] + noise * rng.normal(), split=split)
            for mesh in range(meshes) for model, mean in models.items()]


def level_of(rows, metrics=("auc",)):
    (level,) = find_leaders(study_of(rows, metrics))
    return level


def on_scans(rows):
    return [("scans", *cells[1:4], view, *cells[5:]) for cells in rows for view in "01"]


def noisy():
    """A is ahead of B, but not of C, which varies much."""
    rng = np.random.default_rng(3)
    return [row(mesh, "", model, mean + .001 * rng.normal()) for mesh in range(12)
            for model, mean in (("A", .6), ("B", .55), ("C", .9 if mesh % 2 == 0 else .1))]


LED = {  # scores, metric, and: verdict, models, second, part of the sentence
    "ahead of all": (scored({"A": .6, "B": .5, "C": .45}, 20), "auc", "leads", "A", "B", r"^On 20 meshes, A leads by AUC \(mean 0\.\d{3}, 95 % interval "),
    "equal models": (scored({"A": .7, "B": .7, "C": .2}, 20), "auc", "not told apart", "AB", "AB", r"mean .*\), [AB] or [AB] may be best; C is behind at least"),
    "a noisy model": (noisy(), "auc", "not told apart", "AC", "B", "A or C may be best; B is behind at least one of them"),
    "lower is better": (scored({"A": .6, "B": .5}, 20), "kl", "leads", "B", "A", "B leads by KL"),
    "references are no candidates": (scored({"HS": .9, "A": .6, "B": .5, "RS": .4}, 20), "auc", "leads", "A", "B", "A leads by AUC"),
    "views are counted beside their meshes": (on_scans(scored({"A": .6, "B": .5}, 20)), "auc", "leads", "A", "B", "^On 40 scans of 20 meshes, A leads"),
}


class LeadersTest(unittest.TestCase):
    def test_who_leads(self):
        for name, (rows, metric, verdict, models, second, sentence) in LED.items():
            with self.subTest(name):
                level = level_of(rows, (metric,))
                leader = level.leaders[0]
                self.assertEqual((leader.verdict, sorted(leader.models)), (verdict, sorted(models)))
                self.assertIn(leader.second, second)
                self.assertEqual(leader.lead_interval[0] > 0, leader.second not in leader.models)
                self.assertRegex(level.sentence, sentence)
        self.assertAlmostEqual(level_of(LED["ahead of all"][0]).leaders[0].lead, .1, delta=.02)

    def test_metrics_that_say_the_same_share_a_clause(self):
        rows = [(*cells, cells[-1], .5) for cells in scored({"A": .6, "B": .5}, 20)]
        sentence = level_of(rows, ("auc", "nss", "lcc")).sentence
        self.assertRegex(sentence, r"A leads by AUC \(mean [0-9., a-z%]*\) and NSS \(0.*\)\. Beside it, by LCC \(A 0\.500 on each\), A or B may be best\.$")

    def test_the_metric_of_the_protocol_is_spoken_of_first(self):
        rows = [(*cells, 1 - cells[-1]) for cells in scored({"A": .7, "B": .6}, 20)]
        for chief, begin in (("", "A leads by AUC"), ("cc", "B leads by CC")):
            (level,) = find_leaders(study_of(rows, ("auc", "cc"), chief=chief))
            self.assertRegex(level.sentence, f"^On 20 meshes, {begin} .* Beside it, [AB] leads by (AUC|CC) ")

    def test_a_metric_without_scores_is_not_spoken_of(self):
        rows = [(*cells[:-1], NAN, cells[-1]) for cells in scored({"A": .7, "B": .6}, 20)]
        self.assertRegex(level_of(rows, ("auc", "sim")).sentence, "^On 20 meshes, A leads by SIM ")

    def test_each_split_has_a_sentence_of_its_own(self):
        study = study_of(scored({"A": .6, "B": .5}, 10, split="train") + scored({"A": .5, "B": .6}, 10, split="test"))
        both, train, test = find_leaders(study)
        self.assertRegex(both.sentence, "^On 20 meshes of all splits, ")
        self.assertRegex(train.sentence, "^On 10 meshes of split train, A leads")
        self.assertRegex(test.sentence, "^On 10 meshes of split test, B leads")
        table = leaders(study)
        self.assertEqual([list(table[name]) for name in ("split", "metric", "sentence")],
                         [["", "", "train", "train", "test", "test"], ["", "auc"] * 3, [level.sentence for level in (both, both, train, train, test, test)]])

    def test_long_lists_are_cut_and_leading_metrics_are_the_papers(self):
        self.assertIn(" or 8 others may be best.", level_of(scored(dict.fromkeys("ABCDEFGHIJKL", .7), 20)).sentence)
        self.assertEqual(leading_metrics(("lcc", "kl", "auc", "sim", "ig")), ["lcc", "kl", "auc"], "in the order of the run")
        self.assertEqual(leading_metrics(("lcc", "kl", "auc", "sim", "ig"), "sim"), ["sim", "lcc", "kl"], "the metric of the protocol first")
        self.assertEqual(leading_metrics(("lcc", "kl"), "nss"), ["lcc", "kl"])

    def test_no_sentence_claims_more_than_its_interval(self):  # over many made-up data sets
        seen = collections.Counter()
        for trial in range(20):
            apart = .0012 * trial
            level = level_of(scored({"A": .7 + apart, "B": .7, "C": .7 - apart}, 8))
            leader = level.leaders[0]
            seen[leader.verdict] += 1
            self.assertEqual(" leads " in level.sentence, leader.verdict == "leads")
            self.assertTrue(leader.second not in leader.models or leader.lead_interval[0] <= 0, level.sentence)
        self.assertTrue(seen["leads"] and seen["not told apart"], seen)


def in_classes(of_class, meshes=3, classes=8):
    """Scores of models on classes that differ much in what a model gains there: {model: (mean, deviation from class to class)}."""
    rng = np.random.default_rng(5)
    gains = {model: mean + deviation * rng.permutation(np.linspace(-1, 1, classes)) for model, (mean, deviation) in of_class.items()}
    return [row(f"{group}_{mesh}", "", model, gain[group] + .01 * rng.normal(), category=f"class {group}")
            for group in range(classes) for mesh in range(meshes) for model, gain in gains.items()]


class NewClassesTest(unittest.TestCase):
    def sentence(self, rows, metrics=("auc",), unit="mesh"):
        return find_leaders(study_of(rows, metrics, unit))[0].sentence

    def test_a_lead_on_these_classes_may_be_none_on_new_ones(self):
        clear, unclear = in_classes({"A": (.7, .02), "B": (.5, .02)}), in_classes({"A": (.8, .12), "B": (.7, .12)})
        begin = r"^On 24 meshes of these 8 classes, A leads by AUC \(.*\)"
        self.assertRegex(self.sentence(clear), begin + r"\. New classes: the same\.$")
        self.assertRegex(self.sentence(unclear), begin + r"\. New classes: by AUC, A or B may be best\.$")
        both = [(*one, other[-1]) for one, other in zip(clear, unclear)]
        self.assertRegex(self.sentence(both, ("auc", "nss")), begin[:-2] + r".*\) and NSS \(.*\)\. New classes: AUC only\.$")
        table = leaders(study_of(unclear))
        self.assertEqual([list(table[name]) for name in ("verdict", "new_classes", "new_classes_leaders")],
                         [["", "leads"], ["", "not told apart"], ["", "A, B"]])

    def test_it_takes_six_classes_of_several_meshes_and_another_unit(self):
        models = {"A": (.7, .02), "B": (.5, .02)}
        few = in_classes(models, classes=5)
        single = few + [row(f"9{group}", "", model, .6, category=f"single {group}") for group in range(9) for model in "AB"]
        for rows in (few, single, [cells[:3] + ("",) + cells[4:] for cells in in_classes(models)]):
            self.assertNotIn("classes", self.sentence(rows))
        self.assertRegex(self.sentence(in_classes(models), unit="class"), r"^On 24 meshes of 8 classes, A leads by AUC \([^)]*\)\.$")

    def test_a_lead_that_new_classes_turn_round_is_no_same_lead(self):
        def of(better, worse):  # one class of 80 meshes says this, and 13 of 2 say the other
            rng = np.random.default_rng(1)
            many = [("many", item, .7, .5) for item in range(80)]
            few = [(f"few {group}", f"{group} {item}", .5, .7) for group in range(13) for item in range(2)]
            return [row(f"{group}/{item}", "", model, value + .01 * rng.normal(), category=group) for group, item, high, low in many + few
                    for model, value in ((better, high), (worse, low))]
        turned = [(*one, other[-1]) for one, other in zip(sorted(of("A", "B"), key=str), sorted(of("B", "A"), key=str))]
        said = self.sentence(turned, ("auc", "nss"))
        self.assertRegex(said, "A leads by AUC .*Beside it, B leads by NSS")
        self.assertTrue(said.endswith("New classes: B leads by AUC. Beside it, A leads by NSS."), said)

    def test_classes_that_not_all_meshes_have_are_not_what_it_is_over(self):
        rows = in_classes({"A": (.7, .02), "B": (.5, .02)})
        more = [row(f"9{item}", "", model, value, category="") for item in range(40) for model, value in (("A", .7), ("B", .5))]
        self.assertRegex(self.sentence(rows + more), r"^On 64 meshes, A leads")

    def test_too_few_units_are_counted_by_metric(self):
        rows = [(*row(str(item), "", model, .5 + item / 10), .4 if item < 3 else NAN) for item in range(5) for model in "AB"]
        said = self.sentence(rows, ("auc", "nss"))
        self.assertIn("5 observations are too few to tell how the models rank by AUC", said)
        self.assertIn("3 observations are too few to tell how the models rank by NSS", said)


class BriefTest(unittest.TestCase):
    """Sentences without figures."""

    def said(self, *found, **more):
        return brief([Brief(label, verdict, models.split(), "A B C D".split(), **more) for label, verdict, models in found])

    def test_metrics_that_say_the_same_stand_in_one_bracket(self):
        self.assertEqual(self.said(("AUC", "leads", "A"), ("NSS", "leads", "A")), "A leads (AUC, NSS).")
        self.assertEqual(self.said(("AUC", "not told apart", "A B C")), "A, B or C may be best; D is not (AUC).")
        self.assertEqual(self.said(("AUC", "not told apart", "B A"), ("LCC", "not told apart", "A B C D")),
                         "B or A may be best (AUC); any model may be best (LCC).")
        self.assertEqual(self.said(("AUC", "not told apart", "A B C D E"), shows_all=False), "A, B, C, D or E may be best (AUC).")
        self.assertEqual(self.said(("AUC", "not behind", "A")), "no model is ahead of A (AUC).")
        self.assertEqual(self.said(("AUC", "too few units", "")), "too few observations to rank (AUC).")

    def test_new_classes_and_missing_scores_are_named(self):
        both = [Brief("AUC", "leads", ["A"], ["A", "B"], 0, "leads", ["A"]),
                Brief("NSS", "leads", ["A"], ["A", "B"], 2, "not told apart", ["A", "B"])]
        self.assertEqual(brief(both), "A leads on these classes (AUC, NSS). New classes: AUC only. (2 shapes left out: some model has no score there.)")
        self.assertEqual(brief(both[1:]).split(". ")[1], "New classes: not the same")


class MissingScoresTest(unittest.TestCase):
    def without(self, worst, models, chance=True):
        """60 meshes; the first model has no score on those where it would be worst."""
        rows = [cells for cells in scored(models | ({"RS": .1} if chance else {}), 60)]
        of_first = sorted((cells for cells in rows if cells[5] == "A"), key=lambda cells: cells[-1])
        return [(*cells[:-1], NAN) if cells in of_first[:worst] else cells for cells in rows]

    def test_a_model_that_lacks_scores_leads_with_a_remark_and_its_rank_at_chance(self):
        rows = self.without(12, {"A": .52, "B": .5})
        study = study_of(rows)
        self.assertRegex(find_leaders(study)[0].sentence, r"^On 48 of 60 meshes \(A has no score on 12\), A leads by AUC \(.*\)\. "
                         r"With missing scores at chance, A ranks 2 by AUC\.$")
        self.assertEqual(list(ranking(study)["rank_at_chance"]), [2, 1])
        self.assertEqual(leaders(study)["n_missing"][1], 12)
        self.assertTrue(ranking(study_of(scored({"A": .52, "B": .5}, 60)))["rank_at_chance"].isna().all())

    def test_chance_is_rs_on_the_shape_or_what_is_known_of_the_metric(self):
        for chance, metric, rank in ((False, "auc", "ranks 1"), (True, "kl", "ranks 1"), (False, "kl", None)):  # lower kl is better
            sentence = find_leaders(study_of(self.without(12, {"A": .48, "B": .45}, chance), (metric,)))[0].sentence
            self.assertEqual(f"at chance, A {rank}" in sentence, rank is not None, sentence)
            self.assertIn("(A has no score on 12)", sentence)

    def test_many_that_lack_scores_are_cut_behind_the_best(self):
        rows = [(*cells[:-1], NAN) if int(cells[2]) == "ABCDEFGH".index(cells[5]) else cells
                for cells in scored({model: .9 - .05 * place for place, model in enumerate("ABCDEFGH")}, 20)]
        self.assertRegex(find_leaders(study_of(rows))[0].sentence, r"^On 12 of 20 meshes \(A has no score on 1, B .*, D has no score on 1 and 4 others\), A")


class AgainstChanceTest(unittest.TestCase):
    """Nobody leads who is not shown to be ahead of chance and of a constant map."""

    def test_the_best_of_models_behind_chance_does_not_lead(self):
        (leader,) = level_of(scored({"N1": -.28, "N2": -.4, "RS": -.01}, 20), ("cc",)).leaders
        self.assertEqual((leader.verdict, leader.models, leader.best, leader.second), ("at chance", [], "N1", "N2"))

    def test_a_constant_map_is_told_from_chance(self):  # lower is better
        rows = scored({"A": 1.7, "B": 1.75, "RS": 3}, 20)
        constant = scores_of([row(mesh, "", "constant", 1.6) for mesh in range(20)], ("kl",)).frame
        (level,) = find_leaders(study_of(rows, ("kl",), constant=constant))
        self.assertTrue(level.sentence.endswith("no model is shown to be ahead of a constant map."), level.sentence)
        self.assertEqual(level_of(rows, ("kl",)).leaders[0].verdict, "leads")
        table = leaders(study_of(rows, ("kl",), constant=constant))
        self.assertEqual([list(table[name]) for name in ("verdict", "leaders", "not_ahead", "baseline")],
                         [["", "at chance"], ["", ""], ["", ""], ["", "a constant map"]])

    def test_those_that_may_be_best_are_named_where_they_are_not_ahead(self):
        rng = np.random.default_rng(3)
        rows = [row(mesh, "", model, value) for mesh in range(12) for model, value in
                (("A", .6 + .01 * rng.normal()), ("C", .95 if mesh % 2 == 0 else .15), ("RS", .5 + .01 * rng.normal()))]
        self.assertTrue(level_of(rows).sentence.endswith("A or C may be best; C is not shown to be ahead of chance."))
        table = leaders(study_of(rows))
        self.assertEqual(brief([brief_of(table.iloc[1], "AUC", ["A", "C"])]), "A or C may be best (AUC). (Not shown to be ahead of chance by AUC: C.)")
        self.assertEqual(brief([Brief("CC", "at chance", [], ["A"], baseline="chance")]), "no model is shown to be ahead of chance (CC).")

    def test_what_was_shown_is_not_denied(self):  # C is ahead of the constant map alone, D of nothing, A of both
        rng = np.random.default_rng(3)
        rows = [row(mesh, "", model, mean + noise * rng.normal()) for mesh in range(12) for model, mean, noise in
                (("A", .6, .01), ("C", .52, .15), ("D", .55, .4), ("RS", .5, .01))]
        constant = scores_of([row(mesh, "", "constant", .3) for mesh in range(12)]).frame
        (leader,) = find_leaders(study_of(rows, constant=constant))[0].leaders
        self.assertEqual((sorted(leader.not_ahead), leader.baseline), (["C", "D"], "both chance and a constant map"))

    def test_lcc_is_compared_with_chance_only_through_rs(self):  # that of noise is above 0
        rows = scored({"N1": .03, "N2": .02}, 20, .001)
        rows = [(*cells[:-1], abs(cells[-1])) for cells in rows]
        self.assertEqual(list(ahead(levels(scores_of(rows, ("lcc",)), "mesh")[0], 0)), [])
        rows += [(*cells[:5], "RS", cells[-1]) for cells in rows if cells[5] == "N1"]
        self.assertEqual(list(ahead(levels(scores_of(rows, ("lcc",)), "mesh")[0], 0)), ["chance"])


class CompactTest(unittest.TestCase):
    def test_intervals_stay_within_the_range_of_the_metric(self):
        study = study_of(scored({"A": .99, "B": .5}, 3, .002))
        a, b = (found for _, found in compact(study).iterrows())
        self.assertEqual(a["high"], max(1, a["mean"]))
        self.assertTrue(np.isnan(a["half"]))  # not the same on both sides
        self.assertLess(b["high"], 1)
        self.assertAlmostEqual(b["half"], b["high"] - b["mean"], delta=1e-12)
        self.assertGreater(summary(study)["ci95_high"][0], 1)  # which has the whole interval

    def test_a_model_that_failed_is_compared_on_the_common_shapes_and_counted(self):
        rows = scored({"A": .6, "B": .5, "HS": .7}, 10)
        rows[0] = (*rows[0][:-1], NAN)  # A on the first mesh
        table = compact(study_of(rows))
        self.assertEqual({name: list(table[name]) for name in ("model", "kind", "n_missing", "n_shapes", "best")}, {
            "model": ["A", "B", "HS"], "kind": ["model", "model", "reference"], "n_missing": [1, 0, 0], "n_shapes": [9, 9, 9], "best": [1, 0, 0]})
        self.assertTrue(table["rank"].isna()[2])

    def test_every_metric_of_the_unit_1_is_bounded(self):
        from salbench import metrics

        units = {metric.name: metric.unit for metric in metrics.table()}
        for name, metric in of_program().items():
            self.assertLess(metric.low, metric.high)
            self.assertEqual(np.isfinite([metric.low, metric.high]).all(), units[name] == "1", name)
        self.assertEqual((of_program()["kl_shifted"].low, of_program()["cc"].low), (0, -1))


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
                levels = find_leaders(study_of(rows))
                self.assertEqual([level.sentence for level in levels], [sentence])
                self.assertNotIn("no interval", sentence)
                for leader in levels[0].leaders:
                    self.assertFalse(leader.verdict == "leads" and np.isnan([*leader.interval, *leader.lead_interval]).all())


class Units(unittest.TestCase):
    def test_an_observation_is_what_there_is(self):
        for unit, datasets, in_views, words in (("mesh", ("meshes",), (), "mesh"), ("mesh", ("clouds",), ("clouds",), "point cloud"),
                                                ("mesh", ("meshes", "scans"), ("scans",), "mesh"),
                                                ("mesh", ("scans", "clouds"), ("scans",), "mesh or point cloud"),
                                                ("shape", ("meshes", "scans"), ("scans",), "mesh or scan"),
                                                ("shape", ("meshes",), ("meshes",), "view"), ("shape", ("clouds",), (), "point cloud"),
                                                ("class", ("clouds",), (), "class of shapes"), ("mesh", (), (), "")):
            self.assertEqual(observation(unit, datasets, in_views), words)

    def test_views_of_a_mesh_are_not_counted_as_meshes(self):
        rows = [("meshes", *row(mesh, view, model, value + mesh / 100)[1:])
                for mesh in range(7) for view in "ab" for model, value in (("A", .6), ("B", .5))]
        for unit, words in (("mesh", "On 14 views of 7 meshes,"), ("shape", "On 14 views,")):
            (level,) = find_leaders(study_of(rows, unit=unit))
            self.assertTrue(level.sentence.startswith(words), level.sentence)


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

    def test_they_count_once_within_their_class(self):
        classes = ("cup", "cup", "cup", *"bcdefg")  # m1 is a copy of m0
        rows = [row(f"m{mesh}", "", model, value + shift, category=category)
                for mesh, (category, value) in enumerate(zip(classes, (.1, .1, .4, .5, .6, .7, .8, .9, .2)))
                for model, shift in (("A", .05), ("B", 0))]
        leader = self.said(rows, [["m0", "m1"]], "class").leaders[0]
        self.assertEqual((leader.n, leader.n_shapes), (7, 9))
        self.assertAlmostEqual(leader.mean, (.25 + .5 + .6 + .7 + .8 + .9 + .2) / 7 + .05, delta=1e-12)
        rows = scored({"A": .7, "B": .5}, 14)
        rows = [(*cells[:3], f"class {int(cells[2]) % 7}", *cells[4:]) for cells in rows]
        for copies, has_new in (([], True), ([["0", "7"], ["1", "8"]], False)):
            self.assertEqual("New classes" in self.said(rows, copies).sentence, has_new)
