# SPDX-License-Identifier: GPL-3.0-or-later
"""Every figure and table of the paper has an element of the report that shows it."""

import re
import unittest
from pathlib import Path

import support
from salbench.conclusions.metrics import PAPERS
from salbench.report.elements import ELEMENTS

# As numbered in the paper, with its LaTeX labels.
PAPERS_ELEMENTS = {
    "Figure 1": "fig:teaser", "Figure 2": "fig:saliency_maps_avg_distribution", "Figure 3": "fig:maps_after_matching_hist",
    "Figure 4": "fig:saliency_performance", "Figure 5": "fig:human_performance", "Figure 6": "fig:scans_saliency_performance",
    "Figure 7": "fig:scans_saliency", "Table 1": "table:params_per_method", "Table 2": "auc_per-class",
}
SOURCE = Path(__file__).resolve().parents[2].parent / "shared/paper/quantitative-analysis-of-saliency-models.tex"

# Required content of each element when nothing is missing.
SHOWS = {
    "figure-1": ["pictures/", "figures/examples-meshes-", "colourbar"],
    "figure-2": ["figures/distributions-meshes-", "figures/distributions-scans-"],
    "figure-3": ["LS-before", "LS-after", "figures/matching-"],
    "table-1": ["table-parameters", "r_low", "epsilon"],
    "figure-4": [f"figures/{name}-" for metric in PAPERS
                 for name in (f"performance-meshes-{metric}", f"difficult-meshes-{metric}")],
    "figure-5": ["figures/human-curves-", "table-worth", "table-more-participants"],
    "table-2": [f"table-classes-meshes-{metric}" for metric in PAPERS] + ["data/classes-meshes-auc.tex"],
    "figure-6": ["figures/ranking-scans-"],
    "figure-7": ["figures/examples-scans-", "Scan "],
}


class Checklist(support.ReportTest):
    def test_every_figure_and_table_has_an_element(self):
        self.assertEqual({element.paper for element in ELEMENTS if element.paper}, set(PAPERS_ELEMENTS))

    @unittest.skipUnless(SOURCE.is_file(), "the paper's source does not lie beside the checkout")
    def test_the_paper_has_no_other(self):
        labels = re.findall(r"\\label\{((?:fig|table):[^}]*|auc_per-class)\}", SOURCE.read_text(encoding="utf-8"))
        self.assertEqual(sorted(labels), sorted(PAPERS_ELEMENTS.values()))

    def test_elements_show_what_the_paper_shows(self):
        to = self.report("full", out=support.make_full(self.folder))
        index = support.page(to)
        for identifier, expected in SHOWS.items():
            part = support.section(index, identifier)
            if identifier != "table-1":  # there the program is asked, which these tests do without
                self.assertNotIn("Missing:", part)
            for text in expected:
                self.assertIn(text, part, identifier)
        self.assertEqual(set(SHOWS), {element.id for element in ELEMENTS if element.paper})
        for name in ("index.html", "scores.html"):
            self.assertNotIn("cloud", support.page(to, name).lower(), "of clouds nothing is said where there are none")
