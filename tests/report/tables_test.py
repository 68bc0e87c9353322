# SPDX-License-Identifier: GPL-3.0-or-later
"""Numbers of tables on the page equal those of the files that they are from; the LaTeX file is what LaTeX can read."""

import re

import fixture
import support
from salbench.report.latex import escape


METRICS = ("--metrics", "auc,nss")


class Tables(support.ReportTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.out = cls.folder / "tables"
        cls.results = fixture.write_results(cls.out, fixture.eight_meshes())
        cls.to = cls.report("tables", *METRICS)
        cls.index = support.page(cls.to)

    def test_best_is_bold_in_classes_of_five_and_in_none_of_fewer(self):
        items = [(f"{name}{number}", name) for name, count in (("five", 5), ("four", 4)) for number in range(count)]
        fixture.write_results(self.folder / "few", items)
        to = self.report("few", *METRICS)
        for line in support.bold(support.page(to, "classes.html"), "classes-meshes-nss"):
            cells, bold = line
            means = [float(text.split()[0].replace("−", "-")) for text in cells[3:]]  # without shapes and average
            best = [mean == max(means) for mean in means]
            self.assertEqual((cells[1], bold[3:]), ("5 meshes", best) if cells[0] == "five" else ("4 meshes", [False] * len(means)))
        self.assertEqual(len(re.findall(r"\\mathbf", (to / "data/classes-meshes-auc.tex").read_text())), 1)

    def test_intervals_of_classes_are_cut_at_the_range_of_the_metric(self):
        items = [(f"{name}{number}", name) for name, count in (("teddy", 4), ("glasses", 2)) for number in range(count)]
        results = fixture.results_table(items, views=1)
        results.loc[results["class"] == "teddy", "auc"] = [0.2, 0.99] * ((results["class"] == "teddy").sum() // 2)
        fixture.write_results(self.folder / "wide", items, results=results)
        rows = support.rows(support.page(self.report("wide", *METRICS), "classes.html"), "classes-meshes-auc")
        cell = next(row for row in rows if row[0] == "teddy")[3]
        self.assertRegex(cell, r"^0\.595 +\(0\.000 to 1\.000\)")
        self.assertRegex(next(row for row in rows if row[0] == "glasses")[3], r"^0\.\d{3}$")  # no interval of two

    def test_models_are_compared_where_all_have_scores_and_their_own_mean_stands_beside(self):
        results = self.results[self.results["dataset"] == "meshes"].copy()
        results.loc[(results["model"] == "MS") & results["item"].isin(["1", "2", "3"]), "auc"] = float("nan")
        fixture.write_results(self.folder / "failing", [], results=results)
        rows = {(row[0], row[2]): row for row in support.rows(support.page(self.report("failing", *METRICS)), "means")}
        own = results[results["model"] == "LS"]["auc"]
        self.assertEqual(rows["LS", "AUC"][3], "5 meshes")
        self.assertEqual(" ".join(rows["LS", "AUC"][4].split()),
                         f"{own.iloc[3:].mean():.3f} {own.mean():.3f} over all 8 meshes that it has a score for")
        self.assertEqual(rows["MS", "AUC"][3:5], ["5 meshes", f"{results[results['model'] == 'MS']['auc'].mean():.3f}"])
        self.assertEqual(rows["LS", "NSS"][3], "8 meshes")

    def test_folds_are_compared_where_all_have_scores_and_untimed_trainings_are_no_warning(self):
        results = self.results[self.results["dataset"] == "meshes"].copy()
        results.loc[(results["model"] == "MS") & results["item"].isin(["1", "2", "3"]), "auc"] = float("nan")
        out = self.folder / "folds"
        fixture.write_results(out, [], results=results)
        (out / "run.yaml").write_text(re.sub("( (LS|MS): {)", r'\1trained: "cross-validated, 3 folds by mesh", ', (out / "run.yaml").read_text()))
        (out / "folds.csv").write_text("fold,item,role\n" + "".join(f"{(item - 1) // 3},{item},scored\n" for item in range(1, 9)))
        (out / "training.csv").write_text("model,fold,shapes,key,seconds\nLS,0,5,a,\nMS,0,5,b,\n")
        with self.figures():
            self.assertEqual(support.make(out, self.folder / "folds-report", *METRICS), (0, ""))
        page = support.page(self.folder / "folds-report", "folds.html")
        means = results.pivot(index="item", columns="model", values="auc")
        rows = {row[0]: row[3:] for row in support.rows(page, "fold-means") if row[2] == "AUC"}
        self.assertEqual(rows, {model: [f"{means[model].iloc[at].mean():.3f}" if at.start else "–" for at in (slice(3, 8), slice(0, 3), slice(3, 6), slice(6, 8))]
                                for model in ("LS", "MS")})
        self.assertEqual({row[2] for row in support.rows(page, "training")}, {"0"})

    def test_what_the_paper_reports_of_20_shapes_of_a_class_does_not_stand_below_ours(self):
        row = next(row for row in support.rows(self.index, "classes-meshes-auc") if row[0] == "teddy")
        self.assertRegex(row[3], r"^0\.\d{3}$")
        self.assertIn(["LS", "Meshes", "teddy", "AUC", "0.56   ± 0.01", "20", "tasse2016, table 2"], support.rows(self.index, "reported"))

    def test_latex_has_a_line_per_class_and_balanced_braces(self):
        text = (self.to / "data/classes-meshes-auc.tex").read_text()
        self.assertEqual(text.count("{"), text.count("}"))
        self.assertEqual(len(re.findall(r"^\\emph", text, flags=re.M)), 4)
        columns = re.search(r"\\begin\{tabular\}\{(\w+)\}", text)[1]
        self.assertEqual({line.count("&") for line in text.splitlines() if line.endswith(r"\\")}, {len(columns) - 1})

    def test_latex_escapes_what_latex_reads_otherwise(self):
        self.assertEqual(escape("a_b & 50% {x}|<y>"), r"a\_b \& 50\% \{x\}\textbar{}\textless{}y\textgreater{}")

    def test_ranks_on_a_shapes_page(self):
        meshes = self.results[(self.results["dataset"] == "meshes") & (self.results["model"] == "LS")]
        rank = int(meshes["auc"].rank(ascending=False)[meshes["item"] == "5"].iloc[0])
        row = support.rows(support.page(self.to, "shapes/5.html"), "mesh-scores")[0]
        self.assertEqual([row[0], row[1].split(None, 1)], ["LS", [f"{meshes.loc[meshes['item'] == '5', 'auc'].iloc[0]:.3f}", f"{rank} of 8"]])
