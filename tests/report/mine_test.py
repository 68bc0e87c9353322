# SPDX-License-Identifier: GPL-3.0-or-later
"""A report about one model: first and marked in tables, compared with each other one; and reports of some models and metrics."""

import re
import unittest.mock

import fixture
import support
from salbench import conclusions
from salbench.conclusions.against import against
from salbench.report.results import Shown

MINE = "PN-without-transform-net-and-normals"
MODELS = ("LS", "CS", MINE, "MS", "HS", "RS")


class Mine(support.ReportTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        items = fixture.eight_meshes()
        fixture.write_results(cls.folder / "run", items, MODELS, results=fixture.results_table(items, MODELS, views=1))
        fixture.write_export(cls.folder / "run/shapes.h5", items[:3], MODELS, views=0, size=48)
        with unittest.mock.patch("salbench.report.front.MODELS", 2):  # it is behind more of them
            cls.to = cls.report("run", "--mine", MINE)
        cls.front, cls.ranking = (support.page(cls.to, page) for page in ("index.html", "ranking.html"))

    def test_it_is_compared_with_each_other_model(self):
        table = against(conclusions.source_of(str(self.folder / "run")).study, MINE)
        shown = {(row[2].lower(), row[3].lower(), row[0]): row for row in support.rows(self.ranking, "mine")}
        rows = table[table["metric"].isin(["auc", "nss", "lcc"])]
        self.assertEqual(len(shown), len(rows))
        for line in rows.itertuples():
            row = shown[line.dataset, line.metric, line.other]
            self.assertEqual(row[1], line.verdict)
            self.assertEqual(row[5:], [f"{line.mean_difference:+.3f}".replace("-", "−"), f"{line.low:.3f} to {line.high:.3f}".replace("-", "−")])
        lines = (self.to / "data/mine.tex").read_text(encoding="utf-8").splitlines()
        self.assertEqual([line.split(" & ")[1] for line in lines if line.endswith(r"\\")][1:], list(rows["verdict"]))

    def test_it_is_first_and_marked_in_tables(self):
        for identifier in ("compact-meshes", "ranking"):
            start = self.ranking.index(f'id="table-{identifier}"')
            self.assertEqual(self.ranking[start:].split("<tbody>")[1].split()[:2], ["<tr", 'class="mine">'], identifier)
            self.assertTrue(support.rows(self.ranking, identifier)[0][0].startswith(MINE))
        statistics = support.page(self.to, "statistics.html")
        self.assertIn(MINE, support.rows(statistics, "pairs")[0][0])

    def test_the_first_page_has_its_sentence_its_shapes_and_its_whole_name(self):
        self.assertIn(f"<strong>{MINE}:</strong> On meshes it is by", re.sub("</?abbr[^>]*>", "", self.front))
        self.assertIn(f"{MINE} on its best, median and worst mesh", self.front)
        panels = re.findall(r'<table class="dots">.*?</tbody>', self.front, re.DOTALL)
        self.assertEqual({panel.count(f'<span class="whole">{MINE}</span>') for panel in panels}, {1})

    def test_other_names_are_refused(self):
        for option, name in (("--mine", "PN"), ("--models", "LS,PN"), ("--metrics", "aux")):
            status, errors = support.make(self.folder / "run", self.folder / "refused", option, name)
            self.assertEqual((status, errors.count("\n"), f"{option} {name.split(',')[-1]}" in errors), (2, 1, True), errors)

    def test_some_models_and_metrics(self):
        to = self.report("some", "--models", "CS,MS,HS,RS", "--metrics", "cc,auc", out=self.folder / "run")
        page = support.page(to, "ranking.html")
        self.assertEqual({row[2] for row in support.rows(page, "ranking")}, {"CC", "AUC"})
        self.assertEqual({row[0].split()[0] for row in support.rows(page, "ranking")}, {"CS", "MS", "HS", "RS"})
        self.assertNotIn(">LS<", re.sub("</?abbr[^>]*>", "", page))
        front = support.page(to)
        self.assertIn("behind the best mean of the models shown", front)
        self.assertNotRegex(front, "best mean(?! of the models shown)[.,<]")
        self.assertNotIn("of the models shown", self.front)

    def test_models_left_out_are_not_any_and_the_shapes_are_of_one_shown(self):
        leaders = Shown(self.folder / "run").rows("leaders", "meshes", "auc")["leaders"][0].split(", ")
        shown = [model for model in ("LS", "CS", "MS") if model != leaders[0]]
        front = support.page(self.report("others", "--models", ",".join(shown), out=self.folder / "run"), "index.html")
        self.assertNotIn("any model may be best", front)
        self.assertRegex(front, f"({'|'.join(shown)}) on its best, median and worst mesh")
