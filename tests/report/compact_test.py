# SPDX-License-Identifier: GPL-3.0-or-later
"""One table of models and metrics: as HTML, LaTeX and CSV it is that of compact.csv."""


import numpy
import pandas

import fixture
import support

METRICS = (*fixture.METRICS, "kl")


class Compact(support.ReportTest):
    @classmethod
    def setUpClass(cls):
        """One model failed on two meshes, and scores are so near 1 that intervals are clipped."""
        super().setUpClass()
        items = fixture.eight_meshes()
        models = ("LS", "CS", "A_B&C", "HS", "RS")
        results = fixture.with_metrics(fixture.results_table(items, models, views=2), METRICS)
        failed = (results["model"] == "A_B&C") & (results["dataset"] == "meshes") & results["item"].isin(["1", "2"])
        results.loc[failed, list(METRICS)] = numpy.nan
        sure = (results["model"] == "LS") & (results["dataset"] == "meshes")
        results.loc[sure, "auc"] = [1, 1, 1, 1, 1, 1, 1, 0.9]
        fixture.write_results(cls.folder / "run", items, models, results=results, extra=fixture.metric_lines(METRICS))
        cls.to = cls.report("run")
        cls.page = support.page(cls.to, "ranking.html")
        table = pandas.read_csv(cls.folder / "run/compact.csv", keep_default_na=False)
        cls.expected = {(row["model"], row["metric"]): row for row in table[table["dataset"] == "meshes"].to_dict("records")}

    def test_cells_are_those_of_the_file(self):
        rows = {row[0]: row[1:] for row in support.rows(self.page, "compact-meshes")}
        self.assertEqual(set(rows), {"LS", "CS", "A_B&C †", "HS", "RS"})
        order = ["auc", "auc_exact", "nss", "cc", "lcc", "kl"]
        for model, cells in rows.items():
            for metric, text in zip(order, cells, strict=True):
                row = self.expected[model.removesuffix(" †"), metric]
                spread = f"± {float(row['half']):.3f}" if row["half"] != "" else f"({float(row['low']):.3f} to {float(row['high']):.3f})"
                expected = f"{float(row['mean']):.3f} {spread} {row['group']}".replace("-", "−").split()
                self.assertEqual(text.split(), expected, (model, metric))
        cut = self.expected["LS", "auc"]
        self.assertEqual((cut["high"], cut["half"]), (1.0, ""))

    def test_best_is_bold_and_heads_say_which_way(self):
        for (cells, bold) in support.bold(self.page, "compact-meshes"):
            model = cells[0].removesuffix(" †")
            self.assertEqual(bold[1:], [self.expected[model, metric]["best"] == 1 for metric in ("auc", "auc_exact", "nss", "cc", "lcc", "kl")])
        head = self.page[self.page.index('id="table-compact-meshes"'):].partition("</thead>")[0]
        self.assertEqual((head.count(">higher is better"), head.count(">lower is better")), (5, 1))
        self.assertEqual(head.count('data-better="lower"'), 1)

    def test_a_model_that_failed_is_marked_with_its_number_of_shapes(self):
        self.assertIn("† has no score on some shapes (A_B&amp;C 2 meshes)", self.page)

    def test_latex_has_arrows_groups_and_marks(self):
        text = (self.to / "data/compact-meshes.tex").read_text(encoding="utf-8")
        lines = text.splitlines()
        self.assertIn(r"Model & AUC $\uparrow$ & AUC (exact) $\uparrow$ & NSS $\uparrow$ & CC $\uparrow$ & LCC $\uparrow$ & KL $\downarrow$ \\", lines)
        self.assertTrue(any(line.startswith(r"A\_B\&C\textsuperscript{\dag} & $") for line in lines))
        best = self.expected["LS", "auc"]
        self.assertIn(rf"$\mathbf{{{best['mean']:.3f}\,({best['low']:.3f},\,{best['high']:.3f})}}^{{\mathrm{{{best['group']}}}}}$", text)
        self.assertEqual(text.count("{"), text.count("}"))
        body = [line for line in lines if line.endswith(r"\\")]
        self.assertEqual({line.count(" & ") for line in body}, {6})

    def test_csv_is_the_programs(self):
        ours = pandas.read_csv(self.to / "data/compact-meshes.csv")
        theirs = pandas.read_csv(self.folder / "run/compact.csv").query("dataset == 'meshes'").reset_index(drop=True)
        pandas.testing.assert_frame_equal(ours, theirs, check_dtype=False, rtol=0, atol=0)


class WhatTablesAreOver(support.ReportTest):
    def test_of_few_meshes_and_chosen_metrics(self):
        fixture.write_results(self.folder / "three", fixture.eight_meshes()[:3])
        to = self.report("three", "--metrics", "nss,auc")
        text = (to / "data/compact-meshes.tex").read_text()
        self.assertIn(r"Model & NSS $\uparrow$ & AUC $\uparrow$ \\", text.splitlines())
        caption = support.page(to, "ranking.html").partition('id="table-compact-meshes"')[2].partition("</caption>")[0]
        for words in (text, caption):
            self.assertNotRegex(words, "bold|letter")

    def test_data_sets_in_different_splits_are_all_there(self):
        meshes = fixture.eight_meshes()
        clouds = [(f"c{item}", name) for item, name in meshes]
        models = ("LS", "CS", "HS", "RS")
        results = pandas.concat([fixture.results_table(meshes, models, datasets=("meshes",)).assign(split="test"),
                                 fixture.results_table(clouds, models, datasets=("clouds",), seed=3).assign(split="")], ignore_index=True)
        fixture.write_results(self.folder / "splits", meshes, models, results=fixture.with_metrics(results, ["auc"]).assign(split=results["split"]),
                              extra=fixture.metric_lines(["auc"]))
        page = support.page(self.report("splits"), "ranking.html")
        self.assertEqual({row[0] for row in support.rows(page, "compact-meshes")} - {"HS"}, {row[0] for row in support.rows(page, "compact-clouds")})
        self.assertNotIn("No model is ranked on point clouds", page)

    def test_metrics_over_other_shapes_say_so(self):
        meshes = fixture.eight_meshes()
        results = fixture.results_table(meshes, ("LS", "CS", "RS"), datasets=("meshes",))
        results.loc[results["item"].isin(["1", "2"]), ["auc", "nss"]] = numpy.nan
        fixture.write_results(self.folder / "few", meshes, ("LS", "CS", "RS"), results=results)
        to = self.report("few")
        over = "6 meshes (AUC, NSS), 8 meshes (AUC (exact), CC, LCC)"
        self.assertIn(over, support.page(to, "ranking.html"))
        self.assertIn(over, (to / "data/compact-meshes.tex").read_text())
        lines = (to / "data/classes-meshes-auc.tex").read_text().splitlines()
        self.assertNotRegex(next(line for line in lines if "teddy" in line), r"pm|\\,", "two units have no interval")
