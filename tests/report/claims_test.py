# SPDX-License-Identifier: GPL-3.0-or-later
"""Verdicts of every kind of claim, where it holds, where it does not and where it is left open; and which runs get verdicts."""

import dataclasses
import html
import itertools
import unittest
from pathlib import Path

import numpy
import pandas
from scipy import stats

import fixture
import support
from salbench.conclusions import papers
from salbench.conclusions.samples import summarise
from salbench.conclusions.units import REFERENCES
from salbench.pages.blocks import Missing
from salbench.report import checks, claims, paper
from salbench.report.results import Results, columns_of, read_results

HOLDS, FAILS, OPEN = checks.HOLDS, checks.FAILS, checks.UNDECIDED
NAN = float("nan")
CLASSES = [name for name in papers.reported()["class"].unique() if name]
RECORD = {"configuration": {"statistics": {"unit": "mesh"}, "protocol": "published"}, "data_set": {"layout": "schelling"}}


def verdict(check, tables, a="", b="", margin=NAN, dataset="meshes"):
    results = Results(Path("nowhere"), RECORD, _tables={name: table.reindex(columns=dict.fromkeys([*table, *columns_of(name)]))
                                                        for name, table in tables.items()})
    return claims.find(results, {"dataset": dataset, "metric": "auc", "check": check, "a": a, "b": b, "margin": margin})


def pairs(**intervals):
    """significance.csv of pairs such as LS_CS: the two ends of the 95 % interval, the 90 % one being 0.84 as wide."""
    rows = []
    for pair, (low, high) in intervals.items():
        middle, half = (low + high) / 2, 0.42 * (high - low)
        rows.append(("meshes", "auc", *pair.split("_"), 19, 19, middle, low, high, middle - half, middle + half, 0.5))
    return {"significance": pandas.DataFrame(rows, columns=[
        "dataset", "metric", "model_a", "model_b", "n", "n_shapes", "mean_difference", "ci95_low", "ci95_high", "ci90_low", "ci90_high",
        "t_p"])}


def classes(rows, n=20):
    """per_class.csv. rows: (class, model) -> (mean, half of the interval)"""
    return {"per_class": pandas.DataFrame(
        [("meshes", name, model, "auc", n, n, mean, mean - half, mean + half) for (name, model), (mean, half) in rows.items()],
        columns=["dataset", "class", "model", "metric", "n", "n_shapes", "mean", "ci95_low", "ci95_high"])}


def human_curve(means, half=0.01, n=20):
    """human_curve_differences.csv of a curve with these means, the half of each 95 % interval, and of its 90 % one 0.84 of that."""
    rows = [("auc", float(a + 1), float(b + 1), n, n, means[b] - means[a], means[b] - means[a] - half, means[b] - means[a] + half, 0.5,
             means[b] - means[a] - 0.84 * half, means[b] - means[a] + 0.84 * half)
            for a, b in itertools.combinations(range(len(means)), 2)]
    return {"human_curve_differences": pandas.DataFrame(rows, columns=["metric", "from_participants", "to_participants", "n", "n_shapes", "mean_difference", "ci95_low", "ci95_high", "t_p", "ci90_low",
                                         "ci90_high"])}


def distributions(**densities):
    """mean_histograms_meshes.csv of functions of the middles of the bins."""
    middles = (numpy.arange(100) + 0.5) / 100
    return {"mean_histograms_meshes": pandas.DataFrame(
        {"bin_left": numpy.arange(100) / 100, **{model: density(middles) for model, density in densities.items()}})}


class Verdicts(unittest.TestCase):
    def expect(self, check, cases, **claim):
        """cases: verdict -> tables"""
        for expected, tables in cases.items():
            with self.subTest(check, expected=expected):
                self.assertEqual(verdict(check, tables, **claim).verdict, expected)

    def test_above(self):
        cases = {HOLDS: pairs(LS_CS=(0.01, 0.05)), FAILS: pairs(LS_CS=(-0.05, -0.01)), OPEN: pairs(LS_CS=(-0.01, 0.05))}
        self.expect("above", cases, a="LS", b="CS")

    def test_a_pair_is_turned_to_the_claim(self):
        tables = pairs(CS_LS=(-0.05, -0.01))
        finding = verdict("above", tables, "LS", "CS")
        self.assertEqual((finding.verdict, finding.figure), (HOLDS, "LS − CS"))
        numpy.testing.assert_allclose([finding.value, finding.low, finding.high, finding.low90, finding.high90],
                                      [0.03, 0.01, 0.05, 0.0132, 0.0468])
        self.assertEqual((finding.count, finding.test), ("19 meshes", "paired t by mesh"))

    def test_above_in_several_pairs_takes_each_of_them(self):
        clear, open_, other = (0.01, 0.05), (-0.01, 0.05), (-0.05, -0.01)
        cases = {HOLDS: pairs(LS_PS=clear, CS_PS=clear), FAILS: pairs(LS_PS=other, CS_PS=open_), OPEN: pairs(LS_PS=open_, CS_PS=clear)}
        self.expect("above", cases, a="LS CS", b="PS")
        finding = verdict("above", cases[OPEN], "LS CS", "PS")
        self.assertEqual((finding.figure, finding.others), ("LS − PS", "of 2: 1 holds, 1 undecided"))

    def test_same(self):
        cases = {HOLDS: pairs(LS_CS=(-0.004, 0.008)), FAILS: pairs(LS_CS=(0.005, 0.03)), OPEN: pairs(LS_CS=(-0.01, 0.02))}
        self.expect("same", cases, a="LS", b="CS", margin=0.009)

    def test_same_holds_within_the_margin_even_if_0_is_left_out(self):
        self.expect("same", {HOLDS: pairs(LS_CS=(0.002, 0.006))}, a="LS", b="CS", margin=0.009)

    def test_no_significant_difference_is_not_sameness(self):
        """However many shapes: the interval decides, not their number."""
        tables = pairs(LS_CS=(-0.02, 0.02))
        tables["significance"][["n", "n_shapes"]] = 400
        self.expect("same", {OPEN: tables}, a="LS", b="CS", margin=0.009)

    def test_differ(self):
        cases = {HOLDS: pairs(LS_CS=(-0.03, -0.02)), FAILS: pairs(LS_CS=(-0.004, 0.008)), OPEN: pairs(LS_CS=(-0.01, 0.02))}
        self.expect("differ", cases, a="LS", b="CS", margin=0.009)

    def test_an_interval_that_is_not_known_decides_nothing(self):
        for check in ("above", "same", "differ"):
            self.expect(check, {OPEN: pairs(LS_CS=(NAN, NAN))}, a="LS", b="CS", margin=0.009)

    def test_leads_class(self):
        def of(best, half):
            return classes({("teddy", "HS"): (best, half), ("teddy", "LS"): (0.5, half), ("teddy", "CS"): (0.45, half)})
        self.expect("leads_class", {HOLDS: of(0.6, 0.04), FAILS: of(0.4, 0.04), OPEN: of(0.6, 0.06)}, a="HS teddy", b="LS CS")

    def test_leads_class_takes_the_same_shapes(self):
        tables = classes({("teddy", "HS"): (0.6, 0.01), ("teddy", "LS"): (0.5, 0.01)})
        tables["per_class"].loc[1, "n"] = 19
        with self.assertRaisesRegex(Missing, "different shapes"):
            verdict("leads_class", tables, "HS teddy", "LS")

    def test_the_interval_of_a_class_contains_the_paired_one(self):
        random = numpy.random.default_rng(3)
        for _ in range(50):
            a, b = random.normal(size=(2, 8))
            found = summarise(numpy.stack([a, b, a - b], axis=1))
            of_a, of_b, paired = found.high - found.low
            self.assertLessEqual(paired, of_a + of_b + 1e-12)

    def test_class_above(self):
        def of(mean):
            return classes({("vase", "Avg"): (mean, 0.03), ("fish", "Avg"): (0.5, 0.04)})
        cases = {HOLDS: of(0.56), FAILS: of(0.44), OPEN: of(0.54)}
        self.expect("class_above", cases, a="vase", b="fish")
        finding = verdict("class_above", cases[HOLDS], "vase", "fish")
        numpy.testing.assert_allclose([finding.low, finding.high], [0.01, 0.11])
        self.assertEqual(finding.count, "20 and 20 meshes")

    def test_classes_are_not_decided_by_their_models(self):
        """One shape has no interval, whatever number of models agree on it."""
        rows = {("vase", "Avg"): (0.9, NAN), ("fish", "Avg"): (0.1, NAN), **{("vase", model): (0.9, NAN) for model in REFERENCES}}
        self.expect("class_above", {OPEN: classes(rows, 1)}, a="vase", b="fish")
        self.expect("classes_above_mean", {OPEN: classes(rows, 1)}, a="vase")
        self.expect("hardest_class", {OPEN: classes(rows, 1)}, a="fish")

    def test_classes_above_mean(self):
        def of(first, second):
            return classes({("vase", "Avg"): (first, 0.02), ("ant", "Avg"): (second, 0.02), ("fish", "Avg"): (0.4, 0.02),
                            ("cup", "Avg"): (0.4, 0.02)})
        self.expect("classes_above_mean", {HOLDS: of(0.6, 0.6), FAILS: of(0.8, 0.4), OPEN: of(0.6, 0.48)}, a="vase ant")

    def test_the_mean_of_classes_contains_the_class(self):
        finding = verdict("classes_above_mean", classes({("vase", "Avg"): (0.6, 0.04), ("fish", "Avg"): (0.4, 0.03)}), "vase")
        numpy.testing.assert_allclose([finding.value, finding.high - finding.value], [0.1, 0.025])  # half of the difference

    def test_hardest_class(self):
        def of(names, lowest, half=0.01):
            return classes({(name, "Avg"): (0.6, half) for name in names} | {("spring", "Avg"): (lowest, half)})
        cases = {HOLDS: of(CLASSES, 0.5), FAILS: of(CLASSES, 0.7), OPEN: of(CLASSES, 0.59)}
        self.expect("hardest_class", cases, a="spring")
        finding = verdict("hardest_class", of(CLASSES[:4], 0.5), "spring")
        self.assertEqual((finding.verdict, finding.others), (OPEN, "5 of 20 classes"), "a class that is missing may be harder")

    def test_rises(self):
        cases = {HOLDS: human_curve([0.5, 0.6]), FAILS: human_curve([0.6, 0.5]), OPEN: human_curve([0.5, 0.505])}
        self.expect("rises", cases, a="1", b="2")
        finding = verdict("rises", human_curve([0.5, 0.6, 0.7]), "1", "2")
        numpy.testing.assert_allclose([finding.value, finding.low, finding.high], [0.1, 0.09, 0.11])
        self.assertEqual((finding.figure, finding.count, finding.test), ("n = 1 to 2", "20 meshes", "paired t by mesh"))

    def test_no_rise_beyond(self):
        cases = {HOLDS: human_curve([0.5, 0.6, 0.6, 0.595]), FAILS: human_curve([0.5, 0.6, 0.6, 0.65]),
                 OPEN: human_curve([0.5, 0.6, 0.6, 0.606])}
        self.expect("no_rise_beyond", cases, a="2", margin=0.009)

    def test_no_rise_beyond_looks_at_all_later_numbers(self):
        """No step is large; together they are."""
        slow = human_curve([0.5, 0.6, 0.604, 0.608, 0.612, 0.616])
        finding = verdict("no_rise_beyond", slow, "2", margin=0.009)
        self.assertEqual((finding.verdict, finding.figure), (FAILS, "n = 2 to 6"))

    def test_same_beyond(self):
        cases = {HOLDS: human_curve([0.5, 0.6, 0.6005, 0.5997]), FAILS: human_curve([0.5, 0.6, 0.6, 0.57]),
                 OPEN: human_curve([0.5, 0.6, 0.599, 0.594])}
        self.expect("same_beyond", cases, a="2", margin=0.009)

    def test_same_beyond_looks_at_all_later_numbers(self):
        """A curve that turns is not flat because it ends where it was."""
        finding = verdict("same_beyond", human_curve([0.5, 0.6, 0.65, 0.6]), "2", margin=0.009)
        self.assertEqual((finding.verdict, finding.figure, finding.others), (FAILS, "n = 2 to 3", "of 2: 1 holds, 1 does not"))

    def test_keeps_rising(self):
        cases = {HOLDS: human_curve([0.5, 0.52, 0.54]), FAILS: human_curve([0.5, 0.52, 0.5]), OPEN: human_curve([0.5, 0.52, 0.523])}
        self.expect("keeps_rising", cases)

    def test_a_rise_whose_interval_contains_0_does_not_hold(self):
        finding = verdict("keeps_rising", human_curve([0.5, 0.52, 0.54, 0.56], half=0.03))
        self.assertLess(finding.low, 0)
        self.assertEqual(finding.verdict, OPEN)

    def test_a_curve_over_one_mesh_or_without_spread_decides_nothing(self):
        for check in ("rises", "no_rise_beyond", "same_beyond", "keeps_rising"):
            self.expect(check, {OPEN: human_curve([0.5, 0.6], half=NAN, n=1)}, a="1", b="2", margin=0.009)

    def test_a_curve_that_ends_before_is_missing(self):
        for check, a, b in (("rises", "1", "4"), ("rises", "3", "4"), ("no_rise_beyond", "3", ""), ("same_beyond", "4", "")):
            with self.assertRaisesRegex(Missing, "the human curve does not"):
                verdict(check, human_curve([0.5, 0.6, 0.7]), a, b, margin=0.009)
        with self.assertRaisesRegex(Missing, "takes four participants"):
            verdict("keeps_rising", human_curve([0.5]))

    def test_near_uniform(self):
        cases = {HOLDS: distributions(RS=numpy.ones_like), FAILS: distributions(RS=lambda x: x),
                 OPEN: distributions(RS=lambda x: 1 + 0.6 * (x - 0.5))}
        self.expect("near_uniform", cases, a="RS")

    def test_near_normal(self):
        def normal(x, middle=0.5):
            return stats.norm.pdf(x, middle, 0.1)
        cases = {HOLDS: distributions(MS=normal), FAILS: distributions(MS=lambda x: normal(x, 0.2) + normal(x, 0.8)),
                 OPEN: distributions(MS=numpy.ones_like)}
        self.expect("near_normal", cases, a="MS")

    def test_distributions_differ(self):
        def of(slope):
            return distributions(LS=numpy.ones_like, CS=lambda x: 1 + slope * (x - 0.5), PS=lambda x: x ** 8)
        self.expect("distributions_differ", {HOLDS: of(1.6), FAILS: of(0.1), OPEN: of(0.6)}, a="LS CS PS")


class Rows(unittest.TestCase):
    def test_every_claim_names_a_check_and_every_sameness_a_margin_with_its_reason(self):
        with_margin = {"same", "differ", "no_rise_beyond", "same_beyond"}
        for claim in paper.read("claims.csv").to_dict("records"):
            self.assertTrue(callable(getattr(checks, claim["check"], None)), claim["check"])
            self.assertEqual(claim["margin"] > 0, claim["check"] in with_margin, claim["claim"])
            self.assertEqual(bool(claim["reason"]), claim["check"] in with_margin, claim["claim"])

    def test_every_kind_of_claim_has_a_test(self):
        kinds = set(paper.read("claims.csv")["check"])
        tested = {name.removeprefix("test_") for name in dir(Verdicts)}
        self.assertLessEqual(kinds, tested)

    def test_the_margin_of_auc_is_a_tenth_of_what_separates_people_from_chance(self):
        """The paper prints no table of the other metrics."""
        margins = paper.read("claims.csv").groupby("metric")["margin"].unique()
        self.assertEqual([list(values[values > 0]) for values in margins[["auc", "nss", "lcc"]]], [[0.009, 0.013], [0.095], [0.045, 0.025]])
        means = papers.reported().query("table == 'release' and dataset == 'meshes' and metric == 'auc'").set_index("model")["value"]
        self.assertAlmostEqual(min(values for values in margins["auc"] if values > 0), (means["HS"] - means["RS"]) / 10, places=3)


class Table(support.ReportTest):
    def made(self, name, old="", new=""):
        """The index of a report whose run.yaml has a text replaced."""
        out = self.folder / name
        fixture.write_results(out, fixture.eight_meshes()[:4])
        text = (out / "run.yaml").read_text()
        self.assertIn(old, text)
        (out / "run.yaml").write_text(text.replace(old, new))
        return support.page(self.report(name))

    def test_each_verdict_stands_beside_its_effect_interval_margin_and_test(self):
        index = self.made("paper")
        results = read_results(self.folder / "paper")
        rows = support.rows(index, "claims")
        listed = paper.read("claims.csv").to_dict("records")
        self.assertEqual(len(rows), len(listed))
        shown = 0
        for row, claim in zip(rows, listed):
            try:
                finding = claims.find(results, claim)
            except Missing as reason:
                self.assertIn(str(reason).rstrip("."), row[4])
                self.assertEqual(row[0], "no verdict")
                continue
            shown += 1
            self.assertEqual(row[0], finding.verdict)
            self.assertIn(", ".join(filter(None, (finding.test, finding.count))), row[4])
            for text, value in ((row[5], finding.value), (row[6], finding.low), (row[7], claim["margin"])):
                self.assertEqual(text.split()[0], "–" if value != value else f"{value:.3f}".replace("-", "−"))
        self.assertGreater(shown, 20)
        counts = support.section(index, "claims")
        self.assertRegex(counts, rf"Of {len(rows)} claims: \d+ hold, \d+ do(es)? not, \d+ undecided; {len(rows) - shown} without the ")

    def test_other_data_get_no_verdict_and_nothing_of_the_papers(self):
        index = self.made("other", "layout: schelling", "layout: sal3d")
        self.assertFalse((self.folder / "other-report/claims.html").exists())
        self.assertIn("a check of the paper: these are not the paper's data, but of the layout sal3d", html.unescape(index))
        self.assertEqual({len(row) for row in support.rows(index, "means")}, {9})
        self.assertNotIn("paper 0.", support.section(index, "table-2"))

    def test_a_record_that_does_not_name_them_gets_no_verdict(self):
        self.assertIn("No verdicts on the paper: run.yaml does not name the protocol",
                      support.section(self.made("unnamed", "  protocol: published\n", ""), "claims"))

    def test_changed_options_are_not_the_papers_protocol(self):
        protocols = {"published": {"protocol": "published", "fpfh": {"radius": "0.01"}, "metrics": {"names": ["auc"]},
                                   "models": {"LS": {"radius": "0.02"}, "MINE": {"command": "a"}}}}
        results = Results(Path("nowhere"), {"configuration": protocols["published"]})
        self.assertEqual(paper.other_protocol(results, protocols), "")
        self.assertEqual(paper.other_protocol(results, {}), "")
        changed = {"protocol": "published", "fpfh": {"radius": "0.05"}, "metrics": {"names": ["kl"]}, "models": {"LS": {"radius": "0.02"}}}
        results = dataclasses.replace(results, record={"configuration": changed})
        self.assertEqual(paper.other_protocol(results, protocols),
                         "this is not the paper's protocol: fpfh.radius is 0.05 and not 0.01")
        self.assertIn("does not name the protocol", paper.other_protocol(Results(Path("nowhere")), protocols))
        read = {"auc": {"matching": "histogram"}, "nss": {"matching": "none"}, "kl": {"matching": "none"}}
        results = dataclasses.replace(results, record={"configuration": protocols["published"], "metrics": read})
        self.assertEqual(paper.other_protocol(results, protocols), "this is not the paper's protocol: metrics.matching of nss is none and not histogram")


class Paper(unittest.TestCase):
    """Table 2 in configs/published/tasse2016.csv."""

    def setUp(self):
        rows = papers.reported()
        self.table = rows[(rows["paper"] == "tasse2016") & (rows["table"] == "2")]

    def test_the_table_of_classes_is_complete(self):
        self.assertEqual(len(self.table), 20 * 7)
        self.assertEqual(set(self.table["model"]), {"LS", "PS", "CS", "HS", "MS", "RS", "Avg of six"})
        self.assertEqual((self.table["remark"] == "bold there").sum(), 20)

    def test_the_average_is_that_of_the_models_as_printed(self):
        """A slip of the typist would show: the paper's averages are those of the other columns, but for rounding."""
        wide = self.table.pivot(index="class", columns="model", values="value")
        self.assertLess((wide.drop(columns="Avg of six").mean(axis=1) - wide["Avg of six"]).abs().max(), 0.0101)

    def test_bold_is_a_best_value(self):
        best = self.table[self.table["model"] != "Avg of six"].groupby("class")["value"].max()
        for row in self.table[self.table["remark"] == "bold there"].to_dict("records"):
            self.assertGreaterEqual(row["value"], best[row["class"]])
