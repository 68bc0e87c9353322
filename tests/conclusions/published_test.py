# SPDX-License-Identifier: GPL-3.0-or-later
"""Numbers from papers beside our means: which agree, which are of other shapes; no other result depends on them."""

import unittest
from dataclasses import replace

import pandas
from support import row, scores_of

from salbench import conclusions
from salbench.conclusions import papers
from salbench.conclusions.published import COLUMNS, INTERVAL, NO, OTHERS, ROUNDING, published, sentences
from salbench.conclusions.study import Study

MEANS = {"LS": .62, "CS": .60, "RS": .5}


def study(reported=None, views=("",), metrics=("auc",)):
    """Ten meshes of two classes; the mean of each model is exactly that of MEANS."""
    rows = [row(mesh, view, model, *[mean + (.01 if mesh % 2 else -.01)] * len(metrics), category="ant" if mesh < 6 else "cup")
            for mesh in range(10) for view in views for model, mean in MEANS.items()]
    return Study(scores_of(rows, metrics), reported=reported)


def number(value, model="LS", n=10, ci95="", **more):
    cells = {"paper": "tasse2016", "table": "2", "page": "5", "dataset": "meshes", "split": "", "class": "", "metric": "auc", "first_hand": "yes", "remark": ""}
    return cells | {"model": model, "value": float(value), "n": float(n or "nan"), "ci95": float(ci95 or "nan"),
                    "rounding": .5 * 10 ** -len(value.partition(".")[2])} | more


def found(*numbers, **of):
    return published(study(pandas.DataFrame(list(numbers)), **of))


class Published(unittest.TestCase):
    def test_a_mean_agrees_within_the_interval_or_the_rounding_or_not(self):
        for value, ci95, agrees in (("0.60", ".02", INTERVAL), ("0.600", ".02", INTERVAL), ("0.60", ".0199", NO), ("0.62", ".00", INTERVAL),
                                    ("0.616", ".003", NO), ("0.6199", "", NO), ("0.62", "", ROUNDING), ("0.6", "", ROUNDING), ("0.625", "", NO)):
            with self.subTest(value, ci95=ci95):
                of = found(number(value, ci95=ci95)).iloc[0]
                self.assertEqual(of["agrees"], agrees)
                self.assertAlmostEqual(of["difference"], .62 - float(value), 12)
                self.assertAlmostEqual(of["mean"], .62, 12)

    def test_over_other_shapes_there_is_no_verdict(self):
        for n in (400, 9, ""):
            self.assertEqual(found(number("0.62", n=n)).iloc[0]["agrees"], OTHERS)

    def test_a_class_is_held_against_its_own_mean(self):
        of = found(number("0.62", n=6, **{"class": "ant"}), number("0.62", n=10, **{"class": "cup"}), number("0.62", n=6, **{"class": "vase"}))
        self.assertEqual(of[["class", "n_shapes", "agrees"]].values.tolist(), [["ant", 6, ROUNDING], ["cup", 4, OTHERS]])

    def test_scans_are_counted_as_shapes(self):
        of = found(number("0.62", n=20, dataset="scans"), views=(0, 1)).iloc[0]
        self.assertEqual((of["n"], of["n_shapes"], of["n_reported"], of["agrees"]), (10, 20, 20, ROUNDING))

    def test_it_has_its_columns_and_its_source(self):
        of = found(number("0.62"))
        self.assertEqual(list(of), [column.name for column in COLUMNS if column.name != "split"])
        self.assertEqual(of.iloc[0][["paper", "table", "page", "first_hand"]].tolist(), ["tasse2016", "2", "5", "yes"])

    def test_only_what_is_here_has_a_row(self):
        self.assertIsNone(study().published)
        for other in (number("0.62", "MS"), number("0.62", metric="nss"), number("0.62", dataset="scans"), number("0.62", split="test"),
                      number("0.62", **{"class": "vase"})):
            made = study(pandas.DataFrame([other]))
            self.assertIsNone(made.published)
            self.assertIsNone(dict(conclusions.tables_of(made))["published"])
            self.assertEqual(sentences(made), [])
            self.assertTrue(conclusions.table_of(made, "published").empty)

    def test_no_other_table_knows_of_it(self):
        """Nothing that is only reported is ranked, compared or counted."""
        rows = pandas.DataFrame([number("0.99"), number("0.99", "MS"), number("0.99", "Mesh Mamba")])
        with_it, without = (dict(conclusions.tables_of(made)) for made in (study(rows), study()))
        self.assertEqual(with_it.pop("published")["model"].tolist(), ["LS"])
        self.assertIsNone(without.pop("published"))
        for name, table in without.items():
            self.assertTrue(table is None and with_it[name] is None or table.equals(with_it[name]), name)


class Sentences(unittest.TestCase):
    def said(self, *numbers):
        return sentences(study(pandas.DataFrame(list(numbers))))

    def test_how_many_agree_and_the_largest_difference(self):
        self.assertEqual(self.said(number("0.60", ci95=".03"), number("0.60", "CS"), number("0.51", "RS", ci95=".001"), number("0.7", n=6, **{"class": "ant"})),
                         ["Of 4 means that papers report of these shapes, 1 of ours lie within their interval and 1 within their rounding; the largest "
                          "difference is -0.080 (AUC of LS on meshes of class ant)."])

    def test_other_shapes_are_counted_apart(self):
        self.assertEqual(self.said(number("0.62"), number("0.60", "CS", n=400)),
                         ["Of 1 mean that papers report of these shapes, 0 of ours lie within their interval and 1 within their rounding; the largest "
                          "difference is +0.000 (AUC of LS on meshes). 1 more are of other shapes, which cannot be compared."])
        self.assertEqual(self.said(number("0.62", n=400)),
                         ["Papers report 1 mean of these models, of other shapes, which cannot be compared: published.csv has both."])


class OurOwn(unittest.TestCase):
    def test_the_published_table_beside_itself(self):
        """Scores that are the paper's means, a mesh each, lie within its intervals, but for other shapes."""
        rows = papers.reported()
        rows = rows[(rows["paper"] == "tasse2016") & (rows["dataset"] == "meshes")].assign(n=1)
        classes = rows[rows["class"] != ""]
        scores = scores_of([row(at, "", model, value, category=of) for at, (of, part) in enumerate(classes.groupby("class", sort=False))
                            for model, value in zip(part["model"], part["value"])], ("auc",))
        made = published(replace(study(), scores=scores, reported=rows))
        self.assertEqual(set(made.loc[made["class"] != "", "agrees"]), {INTERVAL})
        self.assertEqual(set(made.loc[made["class"] == "", "agrees"]), {OTHERS})


if __name__ == "__main__":
    unittest.main()
