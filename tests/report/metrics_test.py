# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs with other metrics than the paper's: names, units and directions are those of run.yaml and of the tables."""

import json
import re
import unittest
import unittest.mock

import numpy
import pandas

import fixture
import support
from salbench import conclusions
from salbench.conclusions.metrics import label_of, lower_is_better
from salbench.report import metrics, mine, statistics
from salbench.report.results import Shown

LEADING = ("AUC", "NSS", "LCC")
MODELS = ("LS", "CS", "PS", "RS")
NAN = float("nan")


class Names(unittest.TestCase):
    def test_labels(self):
        self.assertEqual(label_of("nss_multiplicity"), "NSS, with multiplicity")
        self.assertEqual(label_of("auc_top20"), "AUC (top 20 %)")
        self.assertEqual(label_of("of_tomorrow"), "of_tomorrow")

    def test_every_metric_of_the_program_has_its_own_label(self):
        labels = [label_of(name) for name in fixture.ALL_METRICS]
        self.assertEqual(len(set(labels)), len(fixture.ALL_METRICS))
        self.assertFalse([label for label in labels if "_" in label])

    def test_better_is_what_run_yaml_says_else_known_by_name(self):
        self.assertTrue(metrics.described("kl").lower)
        self.assertFalse(metrics.described("kl", {"better": "higher"}).lower)
        self.assertTrue(metrics.described("of_tomorrow", {"better": "lower", "unit": "bits"}).lower)

    def test_labels_say_what_their_metrics_read(self):
        forms = {"auc": "histogram", "nss": "histogram", "cc": "none", "kl": "shifted", "of_tomorrow": ""}
        self.assertEqual(metrics.labels_with_maps(metrics.described(name, {"matching": form}) for name, form in forms.items()),
                         "AUC, NSS of the matched map; CC of the map as it is; KL of the raw map, shifted to 0; of_tomorrow")

    def test_best_are_all_that_tie_in_the_direction_of_the_metric_and_no_nan(self):
        inf = float("inf")
        higher, lower = metrics.described("nss"), metrics.described("kl")
        scores = {"A": 0.1 + 0.2, "B": 0.3, "C": NAN, "D": 0.1, "E": None, "F": 0.1}
        self.assertEqual(higher.best(scores), {"A", "B"})
        self.assertEqual(lower.best(scores), {"D", "F"})
        self.assertEqual(higher.best({"A": -2.0, "B": -1.0, "C": inf}), {"B"})
        self.assertEqual(lower.best({"A": -2.0, "B": -1.0, "C": -inf}), {"A"})
        self.assertEqual(higher.best({"A": 0.0, "B": 0.0, "C": -1e-300}), {"A", "B"})
        self.assertEqual(higher.best({"A": NAN, "B": None}), set())
        self.assertEqual(higher.best({}), set())


class BestInBold(support.ReportTest):
    """Two meshes of one class, human performance best on the first: each page says the same of the same scores."""

    def bold_models(self, metric, scores, lower):
        """Per page the models that are bold: in the means, the classes, the LaTeX table, on the page of mesh 1, under its
        pictures, and in the gallery of examples. scores: model -> score of mesh 1 and of mesh 2."""
        items = [("1", "human"), ("2", "human")]
        table = fixture.results_table(items, tuple(scores), views=0)
        table = table[["dataset", "item", "class", "view", "model", "n_points", "n_picks"]].assign(
            **{metric: [scores[model][int(item) - 1] for model, item in zip(table["model"], table["item"])]})
        out = self.folder / metric
        better = "lower" if lower else "higher"
        fixture.write_results(out, items, tuple(scores), results=table,
                              extra=f'metrics:\n  {metric}: {{unit: "1", better: {better}}}\n')
        fixture.write_export(out / "shapes.h5", items[:1], tuple(scores), views=0)
        with unittest.mock.patch("salbench.report.classes.FEW", 2):  # units below which no class has a best
            to = self.report(metric)
        index, shape = support.page(to), support.page(to, "shapes/1.html")
        models = list(scores)
        texts = support.bold(index, "means")
        found = {"means": {row[0] for row, bold in texts if any(bold)}}
        for row, bold in support.bold(index, f"classes-meshes-{metric}"):
            found["classes"] = {model for model, is_bold in zip(models, bold[3:]) if is_bold}
        tex = (to / f"data/classes-meshes-{metric}.tex").read_text()
        line = next(line for line in tex.splitlines() if line.startswith("\\emph{human}")).split(" & ")
        found["LaTeX"] = {model for model, cell in zip(models, line[2:]) if "mathbf" in cell}
        found["shape"] = {row[0] for row, bold in support.bold(shape, "mesh-scores") if any(bold)}
        found["pictures"] = {model for model in models if re.search(
            rf">{model}, after matching</p>(?:(?!</li>).)*<strong>", shape, flags=re.S)}
        found["examples"] = {model for model in models if re.search(
            rf'<p class="head">{model}</p>(?:(?!</li>).)*<strong>', support.section(index, "figure-1"), flags=re.S)}
        return found

    def expect(self, metric, lower, scores, means, first, pictured):
        """The models that are bold where means over both meshes stand, where scores of the mesh alone do, and below its pictures."""
        self.assertEqual(self.bold_models(metric, scores, lower),
                         {"means": means, "classes": means, "LaTeX": means, "shape": first, "pictures": pictured, "examples": pictured})

    def test_higher_is_better_and_two_tie(self):
        self.expect("tied", False, {"LS": (0.1 + 0.2, 0.5), "CS": (0.3, 0.5), "PS": (0.1, 0.1), "RS": (NAN, NAN)},
                    {"LS", "CS"}, {"LS", "CS"}, {"LS", "CS"})

    def test_lower_is_better_and_the_lowest_is_not_a_number(self):
        self.expect("short", True, {"LS": (0.25, 0.75), "CS": (0.5, 0.25), "PS": (NAN, NAN), "RS": (1.0, 1.0)}, {"CS"}, {"LS"}, {"LS"})

    def test_people_are_best(self):
        self.expect("people", False, {"LS": (0.25, 0.75), "CS": (0.25, 0.25), "HS": (0.5, 0.0)}, {"LS"}, {"HS"}, {"LS", "CS"})

    def test_chance_is_best_and_one_model_has_no_other(self):
        self.expect("chance", False, {"LS": (0.25, 0.25), "CS": (0.2, 0.2), "RS": (0.5, 0.5)}, {"RS"}, {"RS"}, {"LS"})
        self.expect("alone", False, {"LS": (0.25, 0.25), "RS": (0.5, 0.5)}, {"RS"}, {"RS"}, set())


class ScoresBelowPictures(support.ReportTest):
    """Stand below what they were read from, under a caption that says so."""

    def lines_of(self, matching):
        return "metrics:\n" + "".join(f'  {name}: {{unit: "1", better: higher, matching: {matching}}}\n' for name in fixture.METRICS)

    def below_pictures(self, matching):
        """Captions of the first page, and the pictures of a shape's page that have scores."""
        items, models = [("1", "human"), ("2", "human")], ("LS", "CS")
        out = self.folder / matching
        fixture.write_results(out, items, models, results=fixture.results_table(items, models, views=0),
                              extra=self.lines_of(matching))
        fixture.write_export(out / "shapes.h5", items, models, views=0, size=48)
        to = self.report(matching, "--metrics", "auc,nss,lcc")
        captions = re.findall(r"<figcaption>(.*?)\n", "".join(support.page(to, page) for page in ("paper.html", "gallery.html", "shapes/1.html")))
        scored = re.findall(r'<p class="head">([^<]*)</p>(?:(?!</li>).)*<p class="scores">[^<]*(?:<strong>)?[0-9−]', support.page(to, "shapes/1.html"), flags=re.S)
        return " ".join(captions), {title.partition(", ")[2] for title in scored}

    def test_of_matched_maps_and_of_maps_as_they_are(self):
        captions, scored = self.below_pictures("histogram")
        self.assertIn("AUC, NSS, LCC of the matched map", captions)
        self.assertEqual(scored, {"after matching"})
        captions, scored = self.below_pictures("none")
        self.assertIn("AUC, NSS, LCC of the map as it is", captions)
        self.assertNotIn("of the matched map", captions)
        self.assertIn("scores best there, before matching", captions)
        self.assertEqual(scored, {"before matching"})


class AllMetrics(support.ReportTest):
    figures = staticmethod(support.without_drawing)

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.out = cls.folder / "all"
        table = fixture.results_table(fixture.eight_meshes()[:6], MODELS, views=2)
        cls.table = fixture.with_metrics(table, fixture.ALL_METRICS)
        remarks = "remarks:\n  - {item: \"1\", remark: \"odd\"}\n"
        fixture.write_results(cls.out, [], MODELS, results=cls.table, extra=fixture.metric_lines(fixture.ALL_METRICS) + remarks)
        (cls.out / "chance.csv").write_text("dataset,metric,remark\nmeshes,nss,a constant map is level with or ahead of LS (level)\n"
                                            "scans,kl,chance (RS) is level with or ahead of PS (by 3.1)\n")
        cls.to = cls.report("all")
        cls.index, cls.other = support.page(cls.to), support.page(cls.to, "metrics.html")
        cls.results = Shown(cls.out)

    def test_the_index_shows_the_papers_three(self):
        for identifier in ("means", "pairs"):
            self.assertEqual({row[2] for row in support.rows(self.index, identifier)}, set(LEADING))
        self.assertNotIn("table-classes-meshes-kl", self.index)
        self.assertLess(len(self.index), 400_000)

    def test_all_others_stand_behind_a_menu(self):
        self.assertIn('href="metrics.html"', self.index)
        options = re.findall(r"<option>(.*?)</option>", self.other[:self.other.index("</form>")])
        self.assertEqual(len(options), len(fixture.ALL_METRICS) - len(LEADING))
        self.assertEqual({row[2] for row in support.rows(self.other, "means-others")}, set(options))
        self.assertEqual({row[1] for row in support.rows(self.other, "classes-scans-others")}, set(options))
        self.assertEqual(len(support.rows(self.other, "metrics")), len(fixture.ALL_METRICS))

    def test_metrics_are_listed_with_the_maps_that_they_read(self):
        maps = {row[1]: row[4] for row in support.rows(self.other, "metrics")}
        self.assertEqual({maps[name] for name in ("kl", "sim", "ig_centre_multiplicity")}, {"as they are"})
        self.assertEqual({maps[name] for name in ("auc", "cc_area", "auc_top20")}, {"matched"})
        self.assertIn("maps as they are", next(row[2] for row in support.rows(self.other, "ranking-others") if row[2].startswith("KL")))

    def test_remarks_on_chance_stand_below_the_ranking_of_their_metric(self):
        on_index = "By the means of NSS on meshes, a constant map is level with or ahead of LS (level)."
        on_other = "By the means of KL on scans, chance (RS) is level with or ahead of PS (by 3.1)."
        self.assertEqual([on_index in self.index, on_other in self.index], [True, False])
        self.assertEqual([on_index in self.other, on_other in self.other], [False, True])

    def test_best_of_a_distance_is_the_lowest(self):
        body = self.other[self.other.index('id="table-means-others"'):]
        found = {}
        for line in re.findall(r"<tr>(.*?)</tr>", body[:body.index("</tbody>")], flags=re.S)[1:]:
            cells = re.findall(r"<t[hd]([^>]*)>(.*?)</t[hd]>", line, flags=re.S)
            key = tuple(re.sub("<[^>]*>", "", cells[at][1]).strip() for at in (1, 2))
            found.setdefault(key, []).append((float(re.search('data-key="([^"]*)"', cells[4][0])[1]), "<strong>" in cells[4][1]))
        for metric, pick in (("KL", min), ("KL (shifted)", min), ("SIM", max), ("AUC (Judd)", max)):
            values = found["Meshes", metric]
            self.assertEqual([value for value, bold in values if bold], [pick(values)[0]], metric)

    def test_classes_are_those_of_the_file(self):
        file = pandas.read_csv(self.out / "per_class.csv")
        row = file[(file["dataset"] == "meshes") & (file["class"] == "human") & (file["model"] == "LS")
                   & (file["metric"] == "cc_area")].iloc[0]
        shown = next(row for row in support.rows(self.other, "classes-meshes-others") if row[:2] == ["human", "CC, by area"])
        self.assertEqual([shown[2], shown[4]], ["2 meshes", f"{row['mean']:.3f}"])

    def test_scores_of_the_others_are_scripts_of_their_own(self):
        text = (self.to / "data/scores.js").read_text()
        data = json.loads(text.removeprefix("salbench.scores = ").removesuffix(";\n"))
        self.assertEqual(list(data["scores"]), ["auc", "nss", "lcc"])
        self.assertEqual(len(data["files"]), len(fixture.ALL_METRICS) - len(LEADING))
        self.assertEqual(set(data["lower"]), {name for name in fixture.ALL_METRICS if lower_is_better(name)})
        script = (self.to / data["files"]["kl"]).read_text()
        rows = json.loads(script.removeprefix('salbench.scores.scores["kl"] = ').removesuffix(";\n"))
        expected = statistics.scores(self.results, "meshes", "kl")["LS"].round(5).tolist()
        self.assertEqual([row[0] for row in rows[:6]], expected)

    def test_orders_and_ranks_start_with_the_best(self):
        self.assertTrue(statistics.summary(self.results, "meshes", "kl")["mean"].is_monotonic_increasing)
        self.assertTrue(statistics.mean_per_shape(self.results, "meshes", "kl").is_monotonic_decreasing)
        scores = statistics.Scores(Shown(self.out, metrics=["kl"]))
        of_shapes = {key: scores.of("kl", "meshes", *key)["LS"] for key in statistics.scores(self.results, "meshes", "kl").index}
        self.assertEqual(min(of_shapes, key=lambda key: of_shapes[key][1]), min(of_shapes, key=lambda key: of_shapes[key][0]))


class FewMetrics(support.ReportTest):
    def test_a_run_without_the_papers_metrics(self):
        chosen = ("kl", "sim")
        table = fixture.with_metrics(fixture.results_table(fixture.eight_meshes()[:4], views=1), chosen)
        fixture.write_results(self.folder / "few", [], results=table, extra=fixture.metric_lines(chosen))
        fixture.write_export(self.folder / "few/shapes.h5", fixture.eight_meshes()[:2], views=1, size=32)
        to = self.report("few")
        index = support.page(to)
        self.assertEqual({row[2] for row in support.rows(index, "means")}, {"KL", "SIM"})
        self.assertIn("with KL, SIM of the map as it is;", support.section(index, "figure-1"))
        self.assertIn("highest-scoring meshes by KL", support.section(index, "figure-4"))
        front = support.page(to, "index.html")
        self.assertRegex(front, "on its best and worst mesh by KL, of 2 ")
        self.assertEqual([label for label in ("Best: ", "Typical: ", "Worst: ") if label in front], ["Best: ", "Worst: "])
        self.assertFalse((to / "metrics.html").exists())
        page = support.page(to, "shapes/1.html")
        first = table[(table["dataset"] == "meshes") & (table["model"] == "LS")]
        rank = int(first["kl"].rank()[first["item"] == "1"].iloc[0])
        self.assertEqual(support.rows(page, "mesh-scores")[0][1].split(None, 1)[1], f"{rank} of 4")
        heat = pandas.read_csv(to / "data/performance-meshes-kl.csv")
        self.assertTrue(heat["mean"].is_monotonic_decreasing)
        numpy.testing.assert_array_less(heat[heat.columns[3]].mean() - 1e-12, heat[heat.columns[4:]].mean())

    def test_metrics_without_scores_do_not_lead(self):
        (self.folder / "densities").mkdir()
        (self.folder / "densities/results.csv").write_text("dataset,item,class,view,model,auc,kl\nmeshes,1,,,A,,.5\n")
        self.assertEqual(list(Shown(self.folder / "densities").leading), ["kl"])

    def test_a_table_of_its_own_metric_in_which_lower_is_better(self):
        rows = [f"m{mesh},{model},{mean + .01 * (mesh * place % 5)}" for mesh in range(8)
                for place, (model, mean) in enumerate((("A", 1), ("B", 2), ("C", 3)), start=1)]
        (self.folder / "emd.csv").write_text("\n".join(["item,model,emd", *rows]))
        conclusions.conclude(conclusions.source_of(str(self.folder / "emd.csv"), lower=["emd"]), self.folder / "emd")
        shown = Shown(self.folder / "emd")
        self.assertEqual([(name, metric.lower) for name, metric in shown.leading.items()], [("emd", True)])
        front = support.page(self.report("emd", "--mine", "B"), "index.html")
        self.assertIn("A leads (emd)", front)
        self.assertIn("lower is better", front)

    def test_the_unit_is_that_of_the_conclusions(self):
        fixture.write_results(self.folder / "units", fixture.eight_meshes())
        conclusions.conclude(conclusions.source_of(str(self.folder / "units"), "shape"))
        shown = Shown(self.folder / "units", mine="LS")
        self.assertEqual(shown.unit, "shape")
        self.assertEqual(set(mine.table_of(shown, "scans")["n"]), set(shown.rows("significance", "scans", "auc")["n"]))
