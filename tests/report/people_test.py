# SPDX-License-Identifier: GPL-3.0-or-later
"""People beside models: the pages show the numbers of the files, with bounds and remarks in place of numbers that there are not."""

import tempfile
import unittest
from pathlib import Path
from types import SimpleNamespace

import pandas

import fixture
import support
from salbench.pages.blocks import Missing
from salbench.report import people
from salbench.report.results import Shown

NAN = float("nan")


def shop_of(name, table):
    """A workshop whose results have this table alone."""
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, "run.yaml").touch()
        results = Shown(folder)
    results._known[name] = table
    return SimpleNamespace(results=results)


def shown(row):
    """A row of human_share.csv as the ranking shows it."""
    if row["share"] != row["share"]:
        return "–" if row["remark"].startswith("no scores") else f"– {row['remark']}"
    mark = ", above HS" if row["ci95_low"] > 1 else ", undecided" if row["ci95_high"] >= 1 else ""
    text = f"{row['share']:.2f} {row['ci95_low']:.2f} to {row['ci95_high']:.2f}{mark}"
    return text.replace("-", "−")


class Shares(unittest.TestCase):
    def cell(self, share, low=NAN, high=NAN, remark=""):
        made = people.share_cell({"share": share, "ci95_low": low, "ci95_high": high, "remark": remark})
        return made.text, made.below, made.bold

    def test_cells(self):
        """A model is marked where the data do not show it behind one participant; without an interval or a share there is no mark."""
        few, not_better = "no interval: fewer than 6 units", "HS is not clearly better than RS"
        for share, cell in (((0.7, 0.5, 0.9), ("0.70", "0.50 to 0.90", False)), ((0.9, 0.7, 1.1), ("0.90", "0.70 to 1.10, undecided", False)),
                            ((1.1, 0.9, 1.0), ("1.10", "0.90 to 1.00, undecided", False)), ((2.1, 1.6, 2.5), ("2.10", "1.60 to 2.50, above HS", True)),
                            ((2.1, NAN, NAN, few), ("2.10", few, False)), ((NAN, NAN, NAN, not_better), ("–", not_better, False)),
                            ((NAN, NAN, NAN, "no scores of HS"), ("–", "", False))):
            self.assertEqual(self.cell(*share), cell)
        self.assertEqual(people.share_cell(None).text, "–")


class Worth(unittest.TestCase):
    def rows(self, **columns):
        row = {"dataset": "meshes", "metric": "auc", "model": "LS", "n": 19.0, "n_shapes": 19.0, "largest_group": 11.0, "mean": 0.6,
               "k": NAN, "ci95_low": NAN, "ci95_high": NAN, "k_bound": "", "low_bound": "", "high_bound": "", "crossings": 1.0,
               "remark": ""} | columns
        shop = shop_of("human_equivalents", pandas.DataFrame([row]))
        return people.worth(shop, "worth", ["auc"]).rows[0]

    def test_numbers_bounds_and_both(self):
        for columns, place, between in (({"k": 2.83, "ci95_low": 1.93, "ci95_high": 4.19}, "2.8", "1.9 to 4.2"),
                                        ({"k": 1.54, "low_bound": "<1", "ci95_high": 2.88}, "1.5", "less than 1 to 2.9"),
                                        ({"k_bound": "<1", "low_bound": "<1", "high_bound": "<1"}, "less than 1", "less than 1"),
                                        ({"k_bound": ">11", "ci95_low": 8.2, "high_bound": ">11"}, "more than 11", "8.2 to more than 11"),
                                        ({"k": 2.83, "remark": "no interval: fewer than 6 units"}, "2.8", "–"),
                                        ({"k": 2.83, "ci95_low": 1.9, "high_bound": ">11", "remark": "not a number of people: one participant"}, "–", "–"), ({}, "–", "–")):
            row = self.rows(**columns)
            self.assertEqual((row[2].text, row[3].text, row[6].text), (place, between, columns.get("remark", "")))

    def test_rows_sort_by_their_place(self):
        places = [{"k_bound": "<1"}, {"k": 1.0}, {"k": 10.5}, {"k_bound": ">11"}]
        keys = [self.rows(**columns)[2].key for columns in places]
        self.assertEqual(keys, sorted(keys))

    def test_a_curve_that_passes_several_times_says_so(self):
        self.assertEqual(self.rows(k=2.0, crossings=3.0)[2].below, "the first of 3 places")


class Pages(support.ReportTest):
    def made(self, name, items, **options):
        fixture.write_results(self.folder / name, items, **options)
        return support.page(self.report(name))

    def test_the_section_shows_the_files(self):
        part = support.section(self.made("whole", fixture.eight_meshes()), "figure-5")
        steps = pandas.read_csv(self.folder / "whole/human_curve_differences.csv")
        steps = steps[steps["metric"].isin(["auc", "nss", "lcc"]) & (steps["to_participants"] == steps["from_participants"] + 1)]
        rows = support.rows(part, "more-participants")
        self.assertEqual(len(rows), len(steps))
        for row, step in zip(sorted(rows[:10], key=lambda row: int(row[0])), steps[steps["metric"] == "auc"].itertuples()):
            self.assertEqual(row[:4], [f"{step.from_participants}", f"{step.to_participants}", "AUC", "8 meshes"])
            self.assertEqual(row[4].replace("−", "-"), f"{step.mean_difference:+.3f}")
            self.assertEqual(row[5].replace("−", "-"), f"{step.ci95_low:.3f} to {step.ci95_high:.3f}")
        self.assertEqual(len(support.rows(part, "worth")), 3 * 6)
        reliability = pandas.read_csv(self.folder / "whole/human_reliability.csv").iloc[0]
        self.assertIn(f"Reliability of the ground truth of 22 participants: {reliability['mean']:.2f} (95 % interval "
                      f"{reliability['ci95_low']:.2f} to {reliability['ci95_high']:.2f}) over 8 meshes, from two halves that correlate by "
                      f"{reliability['split_half']:.2f}", part)
        self.assertIn("HS is one participant against all others", part)
        others = support.rows(support.page(self.folder / "whole-report", "metrics.html"), "worth-others")
        self.assertEqual({row[1] for row in others}, {"AUC (exact)", "CC"})

    def test_one_mesh_has_no_interval_and_says_so(self):
        index = self.made("one", fixture.eight_meshes()[:1])
        rows = support.rows(index, "worth")
        self.assertEqual({row[3] for row in rows}, {"–"})
        self.assertEqual({row[6] for row in rows}, {"no interval: fewer than 6 units"})
        self.assertEqual({row[5] for row in support.rows(index, "more-participants")}, {"–"})
        self.assertRegex(support.section(index, "figure-5"), r"participants: 0\.\d\d over 1 mesh, from")
        self.assertIn("one unit: it does not show that HS is better than RS", support.section(index, "ranking"))

    def test_without_human_performance_there_are_no_shares(self):
        index = self.made("nobody", fixture.eight_meshes(), models=("LS", "CS", "RS"))
        self.assertEqual({row[8] for row in support.rows(index, "ranking")}, {"–"})

    def test_without_the_scores_of_people_pages_name_what_makes_them(self):
        out = self.folder / "no-people"
        fixture.write_results(out, fixture.eight_meshes())
        for path in (out / "people.csv", *out.glob("human_[cer]*.csv")):
            path.unlink()
        self.assertRegex(support.page(self.report("no-people")), "human_reliability.csv is not in the results folder: [^.]*people.csv[^.]* HS ")
        (out / "run.yaml").unlink()
        (out / "results.csv").unlink()
        self.assertNotIn("run salbench again", support.page(self.report("no-people")))

    def test_reliability_without_cc_or_people_is_missing(self):
        empty = pandas.DataFrame(columns=["n", "n_shapes", "fewest_participants", "most_participants", "split_half", "mean", "ci95_low",
                                          "ci95_high"], dtype=float)
        shop = shop_of("human_reliability", empty)
        with self.assertRaisesRegex(Missing, "takes the metric cc"):
            people.reliability(shop)
