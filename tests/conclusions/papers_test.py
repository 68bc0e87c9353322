# SPDX-License-Identifier: GPL-3.0-or-later
"""Numbers that papers report: every row has a source and names one of our columns. Beside our means they agree or are of other shapes; no other
result depends on them."""

import os
import re
import tempfile
import unittest
from dataclasses import replace
from pathlib import Path

import pandas

from salbench import conclusions
from salbench.conclusions import papers
from salbench.conclusions.metrics import of_program
from salbench.conclusions.published import COLUMNS, INTERVAL, NO, OTHERS, ROUNDING, published, sentences
from salbench.conclusions.study import Study
from salbench.conclusions.units import DATASETS
from salbench.datasets.sets import LAYOUTS
from salbench.system.csv import read_csv
from support import row, scores_of

HOUSE = Path(__file__).parents[2]
DATA = Path(os.environ.get("SALBENCH_DATA", ""), "reference")
RIGHT = "tasse2016,2,,LS,schelling,meshes,,spring,auc,histogram,equal,vertices,20,0.55,0.01,yes,"
ROW = dict(zip(papers.COLUMNS, RIGHT.split(",")))


# Allowed values by column.
WORDS = {"metric": set(of_program()), "layout": set(LAYOUTS) - set(papers.LAYOUTS), "dataset": set(DATASETS),
         "matching": {"histogram", "none", "raw", "shifted"}, "weighting": {"equal", "area"}, "score_on": {"vertices", "faces"},
         "first_hand": {"yes", "no"}}


@unittest.skipUnless((DATA / "published_all_scores.csv").is_file(), "SALBENCH_DATA has no reference/")
class Release(unittest.TestCase):
    def test_its_figures_are_means_of_as_many_scores(self):
        rows = papers.reported()[lambda frame: frame["table"] == "release"]
        for dataset, name in (("meshes", "published_all_scores.csv"), ("scans", "published_all_scans.csv")):
            scores = pandas.read_csv(DATA / name).groupby("model")
            for row in rows[rows["dataset"] == dataset].itertuples():
                of_model = scores.get_group(row.model)[row.metric]
                self.assertEqual(len(of_model), row.n)
                self.assertAlmostEqual(of_model.mean(), row.value, delta=.007)


class Rows(unittest.TestCase):
    def test_every_paper_is_in_the_bibliography(self):
        keys = set(re.findall(r"^@\w+\{(\w+),", (HOUSE / "docs/bibliography.bib").read_text(encoding="utf-8"), flags=re.M))
        self.assertLessEqual(set(papers.reported()["paper"]), keys)
        for remark in papers.reported()["remark"]:
            self.assertLessEqual(set(re.findall(r"\[(\w+)\]", remark)), keys)

    def test_every_row_says_what_a_number_is_of(self):
        for path in papers.FOLDER.glob("*.csv"):
            table = read_csv(path)
            self.assertEqual(tuple(table), papers.COLUMNS, path.name)
            for line, row in table.iterrows():
                with self.subTest(f"{path.name}:{line}"):
                    for column, words in WORDS.items():
                        self.assertIn(row[column], words, column)
                    self.assertEqual(row["paper"], path.stem)
                    self.assertTrue(row["model"] and row["table"])
                    self.assertRegex(row["value"], r"^-?\d+(\.\d+)?$", "digits as the paper prints them")
                    self.assertRegex(row["n"], r"^([1-9]\d*)?$", "shapes, if the paper says how many")
                    self.assertRegex(row["ci95"], r"^(\d*\.\d+)?$", "half of an interval, if the paper has one")

    def test_no_number_stands_twice(self):
        self.assertFalse(papers.reported().duplicated(["paper", *papers.WHERE]).any())

    def test_what_was_read_elsewhere_says_where(self):
        rows = papers.reported()
        self.assertTrue((rows.loc[rows["first_hand"] == "no", "remark"].str.len() > 20).all())

    def test_files_are_installed_with_the_package(self):
        self.assertEqual([path.name for path in sorted(papers.FOLDER.glob("*.csv"))], [f"{key}.csv" for key in sorted(set(papers.reported()["paper"]))])


class Reader(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = Path(folder.name) / "tasse2016.csv"

    def read(self, *rows):
        self.path.write_text("# A paper.\n" + "\n".join([",".join(papers.COLUMNS), *rows]) + "\n", encoding="utf-8")
        return papers.read(self.path)

    def test_a_value_has_half_a_unit_of_its_last_digit_for_rounding(self):
        for text, rounding in (("0.55", .005), ("0.550", .0005), ("1", .5), ("-0.2", .05)):
            found = self.read(RIGHT.replace("0.55", text)).iloc[0]
            self.assertEqual(found["value"], float(text))
            self.assertAlmostEqual(found["rounding"], rounding, 12)

    def test_what_a_paper_does_not_say_is_empty(self):
        found = self.read(RIGHT.replace(",20,", ",,").replace("0.01", "")).iloc[0]
        self.assertTrue(pandas.isna(found["n"]) and pandas.isna(found["ci95"]))


class OfRun(unittest.TestCase):
    """Which numbers are of a run."""

    def record(self, **changed):
        return {"data_set": {"layout": "schelling"}, "metrics": {"auc": {"matching": "histogram", "weighting": "equal"}}} | changed

    def of(self, record, remarks=(), **row):
        rows = pandas.DataFrame([{**ROW, **row}])
        return len(papers.of_run(record, remarks, rows))

    def test_data_set_metric_and_reading_are_the_same(self):
        self.assertEqual(self.of(self.record()), 1)
        self.assertEqual(self.of(self.record(data_set={"layout": "gs"})), 1)
        for layout in ("folder", "3dva", ""):
            self.assertEqual(self.of(self.record(data_set={"layout": layout})), 0)
        for metrics in ({}, {"auc": {"matching": "none"}}, {"auc": {"matching": "histogram", "weighting": "area"}}, {"nss": {"matching": "histogram"}}):
            self.assertEqual(self.of(self.record(metrics=metrics)), 0)
        self.assertEqual(self.of(self.record(configuration={"dataset": {"score_on": "faces"}})), 0)
        self.assertEqual(self.of(self.record(configuration={"dataset": {"score_on": "faces"}}), score_on="faces"), 1)
        self.assertEqual(self.of({}), 0)

    def test_raw_is_shifted_where_it_has_a_score(self):
        for reading, n in (("raw", 1), ("shifted", 1), ("none", 0)):
            self.assertEqual(self.of(self.record(metrics={"auc": {"matching": reading}}), matching="raw"), n)
        self.assertEqual(self.of(self.record(metrics={"auc": {"matching": "raw"}}), matching="shifted"), 0)

    def test_another_ground_truth_has_none(self):
        self.assertEqual(self.of(self.record(configuration={"dataset": {"participants": "simulated"}})), 0)
        for remark in ("SIMULATED participants", "TRUTH: not the published one"):
            self.assertEqual(self.of(self.record(), [remark]), 0)
        self.assertEqual(self.of(self.record(), ["LS: cross-validated"]), 1)


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
        for numbers, begin, end in (([number("0.62"), number("0.60", "CS", n=400)], "Of 1 mean", " 1 more are of other shapes, which cannot be compared."),
                                    ([number("0.62", n=400)], "Papers report 1 mean of these models, of other shapes", "published.csv has both.")):
            (sentence,) = self.said(*numbers)
            self.assertEqual((sentence[:len(begin)], sentence[-len(end):]), (begin, end))


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
