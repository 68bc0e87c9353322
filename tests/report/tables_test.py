# SPDX-License-Identifier: GPL-3.0-or-later
"""Numbers of tables on the page equal those of the files that they are from; the LaTeX file is what LaTeX can read."""

import re
import unittest

import fixture
import support
from salbench.report.latex import escape


class Tables(support.ReportTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.out = cls.folder / "tables"
        cls.results = fixture.write_results(cls.out, fixture.eight_meshes())
        with support.without_figures():
            status, errors = support.make(cls.out, cls.folder / "report")
        assert status == 0, errors
        cls.to = cls.folder / "report"
        cls.index = support.page(cls.to)

    def test_best_of_each_class_is_bold(self):
        part = support.section(self.index, "table-2")
        body = part[part.index('id="table-classes-meshes-nss"'):]
        for line in re.findall(r"<tr>(.*?)</tr>", body[:body.index("</tbody>")], flags=re.S)[1:]:
            models = re.findall(r'data-key="([-.0-9e]+)">(<strong>)?', line)[1:-1]  # without shapes and average
            best = max(float(key) for key, _ in models)
            self.assertEqual([float(key) for key, bold in models if bold], [best])

    def test_models_are_compared_where_all_have_scores_and_their_own_mean_stands_beside(self):
        results = self.results[self.results["dataset"] == "meshes"].copy()
        results.loc[(results["model"] == "MS") & results["item"].isin(["1", "2", "3"]), "auc"] = float("nan")
        fixture.write_results(self.folder / "failing", [], results=results)
        with support.without_figures():
            rows = {tuple(row[1:3]): row for row in support.rows(support.page(self.report("failing")), "means")}
        own = results[results["model"] == "LS"]["auc"]
        self.assertEqual(rows["LS", "AUC"][3], "5 meshes")
        self.assertEqual(" ".join(rows["LS", "AUC"][4].split()),
                         f"{own.iloc[3:].mean():.3f} {own.mean():.3f} over all 8 meshes that it has a score for")
        self.assertEqual(rows["MS", "AUC"][3:5], ["5 meshes", f"{results[results['model'] == 'MS']['auc'].mean():.3f}"])
        self.assertEqual(rows["LS", "NSS"][3], "8 meshes")

    def test_the_papers_value_and_the_difference_stand_below_ours(self):
        row = next(row for row in support.rows(self.index, "classes-meshes-auc") if row[0] == "teddy")
        ours = float(row[2].split()[0])
        self.assertIn(f"paper 0.56 ± 0.01, {ours - 0.56:+.2f}".replace("-", "−"), row[2])

    def test_latex_has_a_line_per_class_and_balanced_braces(self):
        text = (self.to / "data/classes-meshes-auc.tex").read_text()
        self.assertEqual(text.count("{"), text.count("}"))
        self.assertEqual(len(re.findall(r"^\\emph", text, flags=re.M)), 4)
        self.assertEqual(len(re.findall(r"\\mathbf", text)), 4)
        columns = re.search(r"\\begin\{tabular\}\{(\w+)\}", text)[1]
        self.assertEqual({line.count("&") for line in text.splitlines() if line.endswith(r"\\")}, {len(columns) - 1})

    def test_latex_escapes_what_latex_reads_otherwise(self):
        self.assertEqual(escape("a_b & 50% {x}"), r"a\_b \& 50\% \{x\}")

    def test_ranks_on_a_shapes_page(self):
        meshes = self.results[(self.results["dataset"] == "meshes") & (self.results["model"] == "LS")]
        rank = int(meshes["auc"].rank(ascending=False)[meshes["item"] == "5"].iloc[0])
        row = support.rows(support.page(self.to, "shapes/5.html"), "mesh-scores")[0]
        self.assertEqual(row[:3], ["LS", f"{meshes.loc[meshes['item'] == '5', 'auc'].iloc[0]:.3f}", f"{rank} of 8"])


if __name__ == "__main__":
    unittest.main()
