# SPDX-License-Identifier: GPL-3.0-or-later
"""Numbers that papers report: every row has a source and names one of our columns, and a wrong one is refused with its line."""

import re
import tempfile
import unittest
from pathlib import Path

import pandas

from salbench.system.errors import InputError
from salbench.conclusions import papers
from salbench.conclusions.metrics import of_program
from salbench.datasets.sets import LAYOUTS

HOUSE = Path(__file__).parents[2]
RIGHT = "tasse2016,2,,LS,schelling,meshes,,spring,auc,histogram,equal,vertices,20,0.55,0.01,yes,"
ROW = dict(zip(papers.COLUMNS, RIGHT.split(",")))


class Rows(unittest.TestCase):
    def test_every_paper_is_in_the_bibliography(self):
        keys = set(re.findall(r"^@\w+\{(\w+),", (HOUSE / "docs/bibliography.bib").read_text(encoding="utf-8"), flags=re.M))
        self.assertLessEqual(set(papers.reported()["paper"]), keys)
        for remark in papers.reported()["remark"]:
            self.assertLessEqual(set(re.findall(r"\[(\w+)\]", remark)), keys)

    def test_every_row_names_one_of_our_columns_and_data_sets(self):
        rows = papers.reported()
        self.assertLessEqual(set(rows["metric"]), set(of_program()))
        self.assertLessEqual(set(rows["layout"]) | set(papers.LAYOUTS), set(LAYOUTS))
        self.assertFalse(set(rows["layout"]) & set(papers.LAYOUTS))

    def test_no_paper_has_a_number_twice(self):
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

    def test_a_wrong_row_is_refused_with_its_line(self):
        for name, value, said in (
                ("metric", "auk", 'metric is "auk", expected a metric of the program'), ("matching", "", "expected one of histogram, none, raw"),
                ("weighting", "faces", "expected one of equal, area"), ("score_on", "", "expected one of vertices, faces"),
                ("dataset", "mesh", "expected one of meshes, scans, clouds"), ("paper", "chen2012", "expected the name of the file, tasse2016"),
                ("value", ".55", "expected digits as the paper prints them"), ("value", "1e3", "expected digits as the paper prints them"),
                ("value", "", "expected digits"), ("n", "0", "n counts shapes"), ("n", "2.5", "n counts shapes"), ("n", "many", "is not a number"),
                ("ci95", "-0.1", "half of an interval"), ("first_hand", "maybe", "expected one of yes, no"),
                ("first_hand", "no", "say in the remark where"), ("model", "", "model, layout or table is empty")):
            with self.subTest(name, value=value), self.assertRaises(InputError) as raised:
                self.read(RIGHT, ",".join({**ROW, "model": "CS", name: value}.values()))
            self.assertIn("tasse2016.csv:4: ", str(raised.exception))
            self.assertIn(said, str(raised.exception))

    def test_a_number_twice_is_refused(self):
        with self.assertRaisesRegex(InputError, r"tasse2016.csv:4: a second row of the same number"):
            self.read(RIGHT, RIGHT.replace("0.55", "0.56"))

    def test_a_file_without_a_column_is_refused(self):
        self.path.write_text("paper,table\ntasse2016,2\n", encoding="utf-8")
        with self.assertRaisesRegex(InputError, "page"):
            papers.read(self.path)


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
