# SPDX-License-Identifier: GPL-3.0-or-later
"""Verdicts on made-up scores whose answer is known."""

import unittest

import numpy
import pandas

import fixture
import support
from report import checks, claims, paper
from report.results import Missing, read_results

CLASSES = list(dict.fromkeys(name for name, _ in paper.per_class()))


def shifted(shifts, shapes, seed=5):
    """A table of results on `shapes` meshes: a common score per shape, noise of 0.01, and a shift per model."""
    random = numpy.random.default_rng(seed)
    common = 0.6 + 0.05 * random.standard_normal(shapes)
    frames = []
    for model, shift in shifts.items():
        frame = pandas.DataFrame({"dataset": "meshes", "item": [str(i) for i in range(shapes)],
                                  "class": [CLASSES[i % len(CLASSES)] for i in range(shapes)], "view": "", "model": model})
        for metric in fixture.METRICS:
            frame[metric] = common + shift + 0.01 * random.standard_normal(shapes)
        frames.append(frame)
    return pandas.concat(frames, ignore_index=True)


class Claims(support.ReportTest):
    def verdict(self, check, a, b, shifts, shapes, metric="auc"):
        name = f"{self.id()}-{shapes}-{len(list(self.folder.iterdir()))}"
        results = shifted(shifts, shapes)
        fixture.write_results(self.folder / name, [], tuple(shifts), results=results)
        claim = {"dataset": "meshes", "metric": metric, "check": check, "a": a, "b": b}
        return claims.find(read_results(self.folder / name), claim).verdict

    def test_a_clear_lead_holds_and_its_opposite_does_not(self):
        for shapes in (60, 400):
            self.assertEqual(self.verdict("above", "LS", "CS", {"LS": 0.1, "CS": 0}, shapes), checks.HOLDS)
            self.assertEqual(self.verdict("above", "CS", "LS", {"LS": 0.1, "CS": 0}, shapes), checks.FAILS)
            self.assertEqual(self.verdict("leads", "LS", "", {"LS": 0.1, "CS": 0, "PS": 0.01}, shapes), checks.HOLDS)
            self.assertEqual(self.verdict("leads", "CS", "", {"LS": 0.1, "CS": 0, "PS": 0.01}, shapes), checks.FAILS)

    def test_no_difference_is_decided_only_over_many_shapes(self):
        equal = {"LS": 0, "CS": 0}
        self.assertEqual(self.verdict("same", "LS", "CS", equal, 19), checks.UNDECIDED)
        self.assertEqual(self.verdict("same", "LS", "CS", equal, 400), checks.HOLDS)
        self.assertEqual(self.verdict("above", "LS", "CS", equal, 19), checks.UNDECIDED)
        self.assertEqual(self.verdict("above", "LS", "CS", equal, 400), checks.FAILS)
        self.assertEqual(self.verdict("differ", "LS", "CS", equal, 19), checks.UNDECIDED)

    def test_a_significant_difference_refutes_equality(self):
        self.assertEqual(self.verdict("same", "LS", "CS", {"LS": 0.1, "CS": 0}, 60), checks.FAILS)

    def test_of_several_pairs_the_worst_decides(self):
        shifts = {"LS": 0.2, "CS": 0.1, "PS": 0.1}
        self.assertEqual(self.verdict("above", "LS CS", "PS", shifts, 19), checks.UNDECIDED)
        self.assertEqual(self.verdict("above", "CS", "PS LS", shifts, 60), checks.FAILS)

    def test_hardest_class_takes_all_classes(self):
        results = shifted({"LS": 0, "CS": 0}, 400)
        results.loc[results["class"] == "spring", "auc"] -= 0.3
        claim = {"dataset": "meshes", "metric": "auc", "check": "hardest_class", "a": "spring", "b": ""}
        for keep, expected in ((CLASSES, checks.HOLDS), (CLASSES[-3:], checks.UNDECIDED)):
            part = results[results["class"].isin(keep)]
            folder = self.folder / f"classes-{len(keep)}"
            fixture.write_results(folder, [], ("LS", "CS"), results=part)
            self.assertEqual(claims.find(read_results(folder), claim).verdict, expected)

    def test_every_claim_names_a_check_and_what_it_needs_may_be_missing(self):
        folder = self.folder / "few"
        fixture.write_results(folder, [("1", "teddy")], ("LS", "RS"))
        results = read_results(folder)
        for claim in paper.read("claims.csv").to_dict("records"):
            self.assertTrue(callable(getattr(checks, claim["check"], None)), claim["check"])
            try:
                self.assertIn(claims.find(results, claim).verdict, claims.STYLES)
            except Missing:
                pass


class Paper(unittest.TestCase):
    def test_the_table_of_classes_is_complete(self):
        table = paper.read("per_class.csv")
        self.assertEqual(len(table), 20 * 7)
        self.assertEqual(set(table["model"]), {"LS", "PS", "CS", "HS", "MS", "RS", "Avg"})
        self.assertEqual((table["bold"] == "yes").sum(), 20)

    def test_the_average_is_that_of_the_models_as_printed(self):
        """A slip of the typist would show: the paper's averages are those of the other columns, but for rounding."""
        wide = paper.read("per_class.csv").pivot(index="class", columns="model", values="mean")
        self.assertLess((wide.drop(columns="Avg").mean(axis=1) - wide["Avg"]).abs().max(), 0.0101)

    def test_bold_is_a_best_value(self):
        table = paper.read("per_class.csv")
        best = table[table["model"] != "Avg"].groupby("class")["mean"].max()
        for row in table[table["bold"] == "yes"].to_dict("records"):
            self.assertGreaterEqual(row["mean"], best[row["class"]])


if __name__ == "__main__":
    unittest.main()
