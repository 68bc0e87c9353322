# SPDX-License-Identifier: GPL-3.0-or-later
"""Numbers that papers report: every row has a source and names one of our columns."""

import os
import re
import tempfile
import unittest
from pathlib import Path

import pandas

from salbench.conclusions import papers
from salbench.conclusions.metrics import of_program
from salbench.conclusions.units import DATASETS
from salbench.datasets.sets import LAYOUTS
from salbench.system.csv import read_csv

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


if __name__ == "__main__":
    unittest.main()
