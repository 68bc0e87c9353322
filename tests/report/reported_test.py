# SPDX-License-Identifier: GPL-3.0-or-later
"""Numbers from papers are in grey beside measured ones, and no page ranks them."""

import re
from unittest import mock

import pandas

import fixture
import support
from salbench.conclusions import papers
from salbench.pages.reported import WORDS

RIGHT = dict(zip(papers.COLUMNS, "tasse2016,2,5,LS,schelling,meshes,,,auc,histogram,equal,vertices,8,0.87654,0.002,yes,".split(",")))
NUMBERS = [RIGHT, {**RIGHT, "model": "NOTRUN", "value": "0.98765"}, {**RIGHT, "model": "NOTRUN", "metric": "nss", "value": "9.8765", "ci95": "", "n": ""},
           {**RIGHT, "class": "spring", "n": "2", "value": "0.7654"}, {**RIGHT, "dataset": "scans", "n": "96", "value": "0.65432"},
           {**RIGHT, "paper": "other2020", "dataset": "scans", "n": "95", "value": "0.5497531"}]
VALUES = ("0.5497531", "0.87654", "0.98765", "9.8765", "0.7654", "0.65432")
GREY = re.compile(r'<div class="sheet" id="sheet-reported">.*?</table>|<span class="reported">.*?</span>|'
                  r'<span class="below">reported .*?</span>', flags=re.S)


def as_rows(numbers):
    rows = pandas.DataFrame(numbers).assign(
        rounding=[.5 * 10 ** -len(of["value"].partition(".")[2]) for of in numbers], source="tasse2016, table 2, p. 5")
    return rows.assign(**{name: pandas.to_numeric(rows[name]) for name in ("value", "ci95", "n")})


class Reported(support.ReportTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        with mock.patch.object(papers, "reported", return_value=as_rows(NUMBERS)):
            fixture.write_results(cls.folder / "whole", fixture.eight_meshes())
            cls.to = cls.report("whole")
        cls.pages = {path.relative_to(cls.to): path.read_text(encoding="utf-8") for path in cls.to.rglob("*.html")}
        cls.index = support.page(cls.to)

    def test_a_mean_has_it_beside(self):
        means = {(row[0], row[1], row[2]): row for row in support.rows(self.index, "means")}
        self.assertRegex(means["LS", "Meshes", "AUC"][-1], r"^0\.87654 +± 0\.00200 +[−+]0\.\d{3}, outside +tasse2016$")
        self.assertRegex(means["LS", "Scans", "AUC"][-1], r"^0\.65432")
        self.assertEqual(means["CS", "Meshes", "AUC"][-1], "–")
        self.assertIn(f"{WORDS}, in grey (tasse2016, table 2, p. 5)", self.index)

    def test_a_class_has_it_below(self):
        row = next(row for row in support.rows(self.index, "classes-meshes-auc") if row[0] == "spring")
        self.assertRegex(row[3], r"reported 0\.7654 ± 0\.0020, [−+]0\.\d\d$")

    def test_other_shapes_and_models_that_were_not_run_have_a_table_of_their_own(self):
        """With their shapes and source, and why they cannot be compared; a mean over other shapes stands beside none of ours."""
        others = support.rows(self.index, "reported")
        source = "tasse2016, table 2, p. 5"
        self.assertEqual([[row[0], *row[2:]] for row in others if row[0] == "NOTRUN"],
                         [["NOTRUN", "all", "AUC", "0.98765   ± 0.00200", "8", source], ["NOTRUN", "all", "NSS", "9.8765", "not said", source]])
        self.assertEqual([[row[1], row[4]] for row in others if row[0] == "LS"], [["Scans", "0.5497531   ± 0.0020000"]])
        self.assertIn("Scores differ from shape to shape", self.index)
        self.assertNotIn("0.5497531", "".join(cell for name in ("means", "compact-scans") for row in support.rows(self.index, name) for cell in row))

    def test_no_page_ranks_it(self):
        """It is in grey and nowhere else: in no row that sorts, in no figure, in no file of numbers."""
        for path, text in self.pages.items():
            rest = GREY.sub("", text)
            for what in ("NOTRUN", *VALUES):
                self.assertNotIn(what, rest, path)
            for cell in re.findall(r'<td[^>]*>\s*<span class="reported">', text):
                self.assertRegex(cell, r'data-key=""|^<td[^>]*class="number">')  # no key to sort by, or behind the rows that sort
        for path in self.to.rglob("*"):
            if path.suffix in (".csv", ".tex", ".json", ".js"):
                self.assertNotIn("NOTRUN", path.read_text(encoding="utf-8"), path)

    def test_the_first_page_says_how_many_agree(self):
        self.assertIn("0 of 3 means over the same shapes lie within the interval or rounding of papers", support.page(self.to, "index.html"))

    def test_no_table_of_conclusions_has_it_but_its_own(self):
        for path in (self.folder / "whole").glob("*.csv"):
            text = path.read_text(encoding="utf-8")
            self.assertEqual("0.87654" in text, path.name == "published.csv", path.name)
            self.assertNotIn("NOTRUN", text)

    def test_models_that_were_chosen_stand_alone(self):
        with mock.patch.object(papers, "reported", return_value=as_rows(NUMBERS)):
            chosen = self.report("chosen", "--models", "LS,CS", "--metrics", "auc", out=self.folder / "whole")
        self.assertNotIn("NOTRUN", support.page(chosen))


class Nothing(support.ReportTest):
    def test_simulated_participants_have_no_number_in_a_paper(self):
        fixture.write_results(self.folder / "simulated", fixture.eight_meshes()[:4], simulated=True)
        self.assertFalse((self.folder / "simulated/published.csv").exists())
        self.assertNotIn(WORDS, support.page(self.report("simulated", "--metrics", "auc")))
