# SPDX-License-Identifier: GPL-3.0-or-later
"""Human curves: by mesh, from one number of participants to another, beside models, of the ground truth; and shares of what people reach: places on
a curve, and of the way from chance to people."""

import unittest
from math import isnan, nan

import numpy as np
import pandas as pd
from scipy import stats

from salbench.conclusions.equivalents import crossings, first_reached, human_equivalents
from salbench.conclusions.people import human_curve, human_curve_by_mesh, human_curve_differences, human_reliability
from salbench.conclusions.resampling import Bootstrap, percentile_interval
from salbench.conclusions.shares import human_share, shares
from salbench.conclusions.study import Study
from salbench.conclusions.tables import csv
from support import AUC, CC, KL, curves, row, scores_of, study_of


def of_curves(of_meshes, metric=AUC, unit="mesh", category=None):
    return Study(scores_of([], (metric,)), unit, people=curves(of_meshes, metric, category))


class People:
    """Curves that rise from mesh to mesh by another amount, and scores of A, HS and RS on the same meshes. A lies between one and two
    participants; HS is one of them."""

    def __init__(self, meshes, length=4):
        rng = np.random.default_rng(1)
        self.curves, rows = {}, []
        for i in range(meshes):
            level = .5 + .1 * rng.normal()
            self.curves[str(i)] = [level + .1 * n + .01 * rng.normal() for n in range(length)]
            rows += [row(str(i), "", "A", level + .06 + .02 * rng.normal()),
                     row(str(i), "", "HS", self.curves[str(i)][0] + (.005 if i % 2 == 0 else -.005)), row(str(i), "", "RS", .1 + .01 * rng.normal())]
        self.scores = scores_of(rows)

    @property
    def frame(self):
        return self.scores.frame

    def value(self, model, change):
        """Changes the scores of a model."""
        of_model = self.frame["model"] == model
        self.frame.loc[of_model, "auc"] = change(self.frame.loc[of_model, "auc"])
        return self

    def equivalents(self, unit="mesh", metric=AUC, category=None):
        """By model."""
        of_scores = scores_of([], (metric,)).part([]) if self.frame.empty else type(self.scores)(self.frame.rename(columns={"auc": metric.name}), (metric,))
        return human_equivalents(Study(of_scores, unit, 1, curves(self.curves, metric, category))).set_index("model")


class Curve(unittest.TestCase):
    def test_it_is_over_the_meshes_that_have_so_many(self):
        found = human_curve(of_curves({"1": [.1, .4], "2": [.2, .6], "3": [.6]}))
        self.assertEqual(found["n_meshes"].tolist(), [3, 2])
        np.testing.assert_allclose(found["mean"], [.3, .5])
        half = stats.t.ppf(.975, 2) * stats.sem([.1, .2, .6])
        np.testing.assert_allclose(found.loc[0, ["ci95_low", "ci95_high"]].astype(float), [.3 - half, .3 + half], atol=1e-8)

    def test_by_mesh_it_has_a_row_for_each_point(self):
        found = human_curve_by_mesh(of_curves({"2": [.5, .6], "1": [.25]}, CC, category={"2": "cup"}))
        self.assertEqual(found[["item", "class", "n", "metric", "value"]].values.tolist(),
                         [["2", "cup", 1, "cc", .5], ["2", "cup", 2, "cc", .6], ["1", "", 1, "cc", .25]])
        np.testing.assert_allclose(found["reliability"], [2 * .5 / 1.5, 2 * .6 / 1.6, 2 * .25 / 1.25])

    def test_halves_that_do_not_agree_have_no_reliability_and_other_metrics_none(self):
        self.assertEqual(human_curve_by_mesh(of_curves({"1": [-.9]}, CC))["reliability"][0], 0)
        for people in (of_curves({"1": [nan]}, CC), of_curves({"1": [.5]})):
            self.assertTrue(isnan(human_curve_by_mesh(people)["reliability"][0]))


class Differences(unittest.TestCase):
    def test_they_are_paired_by_mesh(self):
        """Hard meshes are hard for any number of people: the rise is the same on all, and known well."""
        found = human_curve_differences(of_curves({"1": [.1, .2, .35], "2": [.5, .61, .7], "3": [.9, .99, 1.1]}))
        self.assertEqual(found[["from_participants", "to_participants", "n"]].values.tolist(), [[1, 2, 3], [1, 3, 3], [2, 3, 3]])
        rise = np.array([.1, .11, .09])
        self.assertAlmostEqual(found["mean_difference"][0], .1, places=14)
        for ends, level in ((["ci95_low", "ci95_high"], .95), (["ci90_low", "ci90_high"], .9)):
            np.testing.assert_allclose(found.loc[0, ends].astype(float), stats.t.interval(level, 2, .1, stats.sem(rise)), rtol=1e-7)
        self.assertAlmostEqual(found["t_p"][0], stats.ttest_1samp(rise, 0).pvalue, places=12)

    def test_they_take_the_meshes_that_have_both_numbers(self):
        found = human_curve_differences(of_curves({"1": [.1, .2, .4], "2": [.5, .9], "3": [.9, nan, 1.1]}))
        self.assertEqual(found["n"].tolist(), [2, 2, 1])
        np.testing.assert_allclose(found["mean_difference"], [(.1 + .4) / 2, (.3 + .2) / 2, .2])
        self.assertTrue(isnan(found["ci95_low"][2]), "one mesh")

    def test_of_classes_they_are_of_their_means(self):
        found = human_curve_differences(of_curves({"1": [0, 1], "2": [0, 3], "3": [0, 5], "4": [0, 99]}, unit="class",
                                                  category={"1": "cup", "2": "cup", "3": "ant"}))
        self.assertEqual(found[["n", "n_shapes", "mean_difference"]].values.tolist(), [[2, 3, (2 + 5) / 2]])

    def test_of_two_participants_there_are_none(self):
        self.assertEqual(len(human_curve_differences(of_curves({"1": [.5], "2": [.6]}))), 0)


class Equivalents(unittest.TestCase):
    def test_a_model_is_where_the_mean_curve_reaches_its_mean(self):
        found = People(24).equivalents()
        self.assertEqual(list(found.index), ["A", "HS", "RS"])
        a, chance = found.loc["A"], found.loc["RS"]
        self.assertEqual((a["n"], a["largest_group"], a["crossings"]), (24, 4, 1))
        self.assertAlmostEqual(a["k"], 1.6, delta=.1)
        self.assertTrue(a["ci95_low"] < a["k"] < a["ci95_high"])
        for column in ("k_bound", "low_bound", "high_bound"):
            self.assertEqual((a[column], chance[column]), ("", "<1"), column)
        self.assertEqual(a["remark"], "")
        self.assertTrue(isnan(chance["k"]))

    def test_beyond_the_curve_there_is_a_bound_and_no_number(self):
        a = People(10).value("A", lambda _: 5).equivalents().loc["A"]
        self.assertTrue(a[["k", "ci95_low", "ci95_high"]].isna().all())
        self.assertEqual(a[["k_bound", "low_bound", "high_bound"]].tolist(), [">4"] * 3)

    def test_lower_may_be_better(self):
        turned = People(24)
        turned.frame["auc"] *= -1
        turned.curves = {item: [-value for value in values] for item, values in turned.curves.items()}
        columns = ["k", "ci95_low", "ci95_high"]
        pd.testing.assert_frame_equal(turned.equivalents(metric=KL)[columns], People(24).equivalents()[columns])

    def test_they_say_where_one_participant_is_not_worth_one(self):
        """Scores against all participants are others than those against as many: the scale is not of people."""
        people = People(24).value("HS", lambda values: values + .1)  # a second participant's worth
        found = people.equivalents()["remark"]
        self.assertRegex(found["A"], r"^not a number of people: one participant \(HS\) has k [12]\.[0-9]+ here$")
        self.assertEqual(found["HS"], "")

    def test_they_use_the_curve_as_far_as_half_of_the_meshes_have_it(self):
        people = People(9)
        for i in range(3):
            people.curves[str(i)] = people.curves[str(i)][:1]
        self.assertEqual(people.equivalents().loc["A", ["largest_group", "n"]].tolist(), [4, 6])
        for i in range(3, 5):
            people.curves[str(i)] = people.curves[str(i)][:2]
        self.assertEqual(people.equivalents().loc["A", ["largest_group", "n"]].tolist(), [2, 6], "four of nine have more")

    def test_they_follow_the_unit_of_inference(self):
        people = People(24)
        category = {str(i): f"class {i % 8}" for i in range(24)}
        people.frame["class"] = people.frame["item"].map(category)
        by_class, by_mesh = people.equivalents("class", category=category), people.equivalents()
        self.assertEqual(by_class.loc["A", ["n", "n_shapes"]].tolist(), [8, 24])
        self.assertAlmostEqual(by_class["k"]["A"], by_mesh["k"]["A"], places=9, msg="classes of equal size")
        self.assertNotEqual(by_class["ci95_low"]["A"], by_mesh["ci95_low"]["A"])
        pd.testing.assert_frame_equal(people.equivalents("shape"), by_mesh)  # a mesh is a shape

    def test_a_reference_bounds_its_own_row_alone(self):
        people = People(10)
        people.frame.drop(people.frame[(people.frame["model"] == "HS") & (people.frame["item"] == "3")].index, inplace=True)
        self.assertEqual(people.equivalents()["n"].tolist(), [10, 9, 10])

    def test_of_poor_data_they_have_remarks(self):
        """Nothing is thrown, no interval has width 0, and what is empty has its remark."""
        def remark(people):
            return people.equivalents()["remark"]["A"]

        self.assertEqual(remark(People(1)), "no interval: fewer than 6 units")
        self.assertEqual(remark(People(5)), "no interval: fewer than 6 units")
        self.assertEqual(remark(People(7, 1)), "", "two participants")
        self.assertTrue(People(7).equivalents("class").empty, "no mesh has a class")
        undefined = People(8).value("A", lambda _: nan)
        self.assertEqual(remark(undefined), "no scores")
        self.assertEqual(undefined.equivalents()["n"].tolist(), [0, 8, 8])
        elsewhere = People(8)
        elsewhere.curves = {f"other {item}": values for item, values in elsewhere.curves.items()}
        self.assertEqual(remark(elsewhere), "no mesh has a human curve and scores of all models")
        equal = People(8)
        equal.frame["auc"] = .6
        equal.curves = {item: [.5, .7] for item in equal.curves}
        self.assertEqual(remark(equal), "no interval: the values do not vary")


class Reliability(unittest.TestCase):
    def test_it_is_the_mean_over_the_meshes_by_their_largest_groups(self):
        found = human_reliability(of_curves({"1": [.2, .5], "2": [.2, .3, .6], "3": [-.1]}, CC))
        self.assertEqual(found[["n", "fewest_participants", "most_participants"]].values.tolist(), [[3, 2, 6]])
        self.assertAlmostEqual(found["split_half"][0], (.5 + .6 - .1) / 3, places=14)
        self.assertAlmostEqual(found["mean"][0], (1 / 1.5 + 1.2 / 1.6 + 0) / 3, places=14)
        self.assertLess(found["ci95_low"][0], found["ci95_high"][0])

    def test_by_class_it_counts_the_people_of_meshes_with_a_class(self):
        study = of_curves({"1": [.2, .5], "2": [.3, .6], "3": [.1], "4": [.1] * 9}, CC, "class", {"1": "class 1", "2": "class 2"})
        self.assertEqual(human_reliability(study)[["n", "n_shapes", "fewest_participants", "most_participants"]].values.tolist(), [[2, 2, 4, 4]])

    def test_it_takes_the_points_where_it_is_defined(self):
        found = human_reliability(of_curves({"1": [.5, nan], "2": [nan]}, CC))
        self.assertEqual(found[["n", "most_participants"]].values.tolist(), [[1, 2]])
        self.assertTrue(isnan(found["ci95_low"][0]))
        for nothing in (of_curves({"1": [nan]}, CC), of_curves({"1": [.5]}), of_curves({"1": [.5]}, CC, unit="class")):
            self.assertTrue(human_reliability(nothing).empty)


class Share(unittest.TestCase):
    def of(self, people):
        return human_share(Study(people.scores, seed=1))

    def test_it_is_the_way_from_chance_to_people(self):
        found = self.of(People(24))
        self.assertEqual(found["model"].tolist(), ["A"], "HS and RS are the scale")
        a = found.loc[0]
        self.assertEqual((a["n"], a["remark"]), (24, ""))
        self.assertAlmostEqual(a["share"], (a["mean"] - a["mean_rs"]) / (a["mean_hs"] - a["mean_rs"]), places=14)
        self.assertGreater(a["ci95_low"], 1, "A is above one participant on every mesh")

    def test_it_is_of_the_shapes_that_all_have(self):
        people = People(10)
        lost = people.frame[["item", "model"]].apply(tuple, axis=1).isin([("3", "HS"), ("4", "RS")])
        people.frame.drop(people.frame[lost].index, inplace=True)
        self.assertEqual(self.of(people)["n"][0], 8)

    def test_of_poor_data_it_has_remarks(self):
        def remark(rows, *metrics):
            found = human_share(study_of(rows, metrics or (AUC,)))
            self.assertEqual(found["remark"][0] == "", not isnan(found["ci95_low"][0]))
            return found["remark"][0]

        def rows_of(meshes, change=lambda model, value: value):
            return [row(item, "", model, change(model, value)) for item, model, value in
                    People(meshes).frame[["item", "model", "auc"]].itertuples(index=False)]

        def without(lost):
            return [one for one in rows_of(8) if one[5] != lost]

        self.assertEqual(remark(without("HS")), "no scores of HS")
        self.assertEqual(remark(without("RS")), "no scores of RS")
        self.assertEqual(remark([row("1", "0", "A", .5)]), "no scores of RS")
        self.assertEqual(remark(rows_of(1)), "one unit: it does not show that HS is better than RS")
        self.assertEqual(remark(rows_of(4)), "no interval: fewer than 6 units")
        self.assertEqual(remark(rows_of(8), KL), "HS is not clearly better than RS", "lower is better")
        self.assertEqual(remark([row("1", "", "A", .5), row("1", "", "RS", .5), row("2", "", "HS", .5)]), "no shape has scores of HS, RS and all models")
        self.assertEqual(remark(rows_of(8, lambda model, value: nan if model == "A" else value)), "no scores")
        equal = rows_of(8, lambda model, value: {"RS": 0., "HS": 1.}.get(model, .5))
        self.assertEqual(remark(equal), "no interval: the shares do not vary")
        four = rows_of(4, lambda model, value: {"RS": 0., "HS": 1.}.get(model, .5))
        self.assertEqual(remark(four), "HS is not clearly better than RS", "four equal differences have p = .125")
        self.assertEqual(human_share(study_of(equal))["share"][0], .5)
        for rows in ([row("1", "", "RS", .5), row("1", "", "HS", .5)], []):
            self.assertTrue(human_share(study_of(rows)).empty)


class Tables(unittest.TestCase):
    def test_empty_ones_have_their_columns(self):
        self.assertEqual(csv(human_reliability(of_curves({"1": [nan]}, CC))),
                         "metric,n,n_shapes,fewest_participants,most_participants,split_half,mean,sd,ci95_low,ci95_high\n")


INFINITY = np.inf


def reached(curve, level, higher_is_better=True):
    return first_reached(np.array([curve], dtype=float), np.array([level], dtype=float), higher_is_better)[0]


class FirstReached(unittest.TestCase):

    def test_ends_of_the_curve_are_open(self):
        curve = [.5, .6, .65]
        for level, place in ((.499, -INFINITY), (.5, 1), (.65, 3), (.651, INFINITY)):
            self.assertEqual(reached(curve, level), place, level)
        self.assertEqual(reached([.5], .5), 1)

    def test_of_a_curve_that_turns_it_is_the_fewest(self):
        hill, valley, falling = [.5, .7, .6], [.6, .5, .7], [.7, .6, .5]
        self.assertAlmostEqual(reached(hill, .65), 1.75, places=14)
        self.assertEqual([reached(valley, .55), reached(falling, .65), reached(falling, .75)], [-INFINITY, -INFINITY, INFINITY])
        for curve, level, times in ((hill, .65, 2), (valley, .55, 2), (falling, .75, 0), (hill, .7, 0), ([.4, .5, .5, .6], .5, 1)):
            self.assertEqual(crossings(np.array(curve), level), times, (curve, level))

    def test_it_follows_the_direction_of_the_metric(self):
        rng = np.random.default_rng(1)
        for _ in range(200):
            curve, level = rng.normal(size=rng.integers(1, 9)), rng.normal()
            self.assertEqual(reached(curve, level), reached(-curve, -level, higher_is_better=False))
            self.assertEqual(crossings(curve, level), crossings(-curve, -level))

    def test_many_at_once_are_each_by_itself(self):
        """A slow twin: NumPy's interp from the first point that is as good on."""
        rng = np.random.default_rng(2)
        curves, levels = rng.normal(size=(300, 6)), rng.normal(size=300)
        for curve, level, place in zip(curves, levels, first_reached(curves, levels, True)):
            first = next((i for i, value in enumerate(curve) if value >= level), None)
            expected = -INFINITY if first == 0 else INFINITY if first is None else np.interp(level, curve[first - 1:first + 1], [first, first + 1])
            self.assertTrue(place == expected or abs(place - expected) < 1e-12, (curve, level))


def with_people(n, of_models, span, rng):
    """Units x (models at a share of the way from chance to people, chance, people), who differ from unit to unit."""
    chance = 3 + .1 * rng.normal(size=n)
    people = chance + span * (1 + .4 * rng.normal(size=n))
    models = [3 + span * share + .25 * abs(span) * rng.normal(size=n) for share in of_models]
    return np.column_stack([*models, chance, people])


def of_means(values, sign=1.0):
    return shares(values[..., :-2], values[..., -2:-1], values[..., -1:], sign)


def fieller(values, model):
    """The shares of which a paired t-test would not reject that the model is that share of the way ahead [fieller1954]."""
    x, y, n = values[:, model] - values[:, -2], values[:, -1] - values[:, -2], len(values)
    t = stats.t.ppf(.975, n - 1)
    (xx, xy), (_, yy) = np.cov(x, y) * t * t / n
    a, b = y.mean() ** 2 - yy, x.mean() * y.mean() - xy
    root = np.sqrt(b * b - a * (x.mean() ** 2 - xx))
    return (b - root) / a, (b + root) / a


class Shares(unittest.TestCase):
    def test_they_are_the_ratio_of_the_means(self):
        np.testing.assert_allclose(of_means(np.array([[.5, .9, .5, .7]])), [[0, 2]], atol=1e-12)

    def test_chance_is_zero_and_people_are_one_whoever_is_drawn(self):
        values = with_people(30, [0, 0], 1, np.random.default_rng(6))
        values[:, :2] = values[:, 2:]
        found = of_means(Bootstrap(1, 500).means(values))
        self.assertEqual((set(found[:, 0]), set(found[:, 1])), ({0}, {1}))

    def test_they_do_not_depend_on_the_scale_of_the_metric(self):
        means = Bootstrap(1, 500).means(with_people(25, [.5, 1.2], 1, np.random.default_rng(7)))
        np.testing.assert_allclose(of_means(means), of_means(5 - 8 * means, -1.0), atol=1e-9)

    def test_people_below_chance_leave_the_share_open_on_the_side_of_the_model(self):
        self.assertEqual(of_means(np.array([[2., 1., .5], [.5, 1., .5], [1., 1., 1.]])).tolist(), [[INFINITY], [-INFINITY], [0]])

    def test_intervals_of_normal_scores_are_fiellers(self):
        """But for the resamples: 10 000 of them know an end within some percent of the width."""
        for n in (12, 19, 60):
            values = with_people(n, [.4, 1.3], 1, np.random.default_rng(n))
            found = of_means(Bootstrap(1).means(values))
            for model in range(2):
                low, high = fieller(values, model)
                np.testing.assert_allclose(percentile_interval(found[:, model], n), (low, high), atol=.08 * (high - low))
