# SPDX-License-Identifier: GPL-3.0-or-later
"""The ranking: its table is that of the file, and its sentence says what the intervals of the ranks allow and no more."""

import unittest

import pandas

import fixture
import people_test
import support
from report import ranking

NAN = float("nan")


def rows(**models):
    """Rows of ranking.csv. models: name -> (rank_low, rank_high, group), best first."""
    made = [(name, rank, *of) for rank, (name, of) in enumerate(models.items(), start=1)]
    return pandas.DataFrame(made, columns=["model", "rank", "rank_low", "rank_high", "group"])


LEADS = rows(LS=(1, 1, "a"), CS=(2, 3, "b"), PS=(2, 3, "b"))
EQUAL = rows(LS=(1, 3, "a"), CS=(1, 3, "a"), PS=(1, 3, "a"))
ONE_BEHIND = rows(LS=(1, 3, "a"), PS=(1, 3, "a"), CS=(1, 4, "ab"), MS=(3, 4, "b"))


class Sentence(unittest.TestCase):
    def said(self, *rankings):
        return ranking.sentence("meshes", [(label, table) for label, table in zip(("AUC", "NSS", "LCC"), rankings)])

    def test_a_leader_is_ahead_of_every_other_model(self):
        self.assertEqual(self.said(LEADS), "On meshes, LS leads by AUC.")

    def test_metrics_that_say_the_same_share_a_clause(self):
        self.assertEqual(self.said(LEADS, EQUAL, LEADS),
                         "On meshes, LS leads by AUC and LCC; by NSS, no two of LS, CS and PS can be told apart.")
        turned = rows(CS=(1, 3, "a"), PS=(1, 3, "a"), LS=(1, 3, "a"))
        self.assertEqual(self.said(EQUAL, turned), "On meshes, by AUC and NSS, no two of LS, CS and PS can be told apart.")

    def test_some_may_be_first_and_others_may_not(self):
        self.assertEqual(self.said(ONE_BEHIND),
                         "On meshes, by AUC, LS, PS and CS cannot be told apart, and MS is behind at least one other model.")
        more = rows(LS=(1, 2, "a"), CS=(1, 2, "a"), PS=(3, 4, "b"), MS=(3, 4, "b"))
        self.assertEqual(self.said(more),
                         "On meshes, by AUC, LS and CS cannot be told apart, and PS and MS are behind at least one other model.")

    def test_the_highest_mean_does_not_lead_where_a_model_is_near_it(self):
        near = rows(LS=(1, 2, "a"), CS=(2, 4, "b"), PS=(2, 4, "ab"))
        self.assertEqual(self.said(near), "On meshes, by AUC, LS is behind no other model, but cannot be told apart from PS.")

    def test_two_models_one_model_one_mesh_and_none(self):
        self.assertEqual(self.said(rows(LS=(1, 2, "a"), CS=(1, 2, "a"))), "On meshes, by AUC, LS and CS cannot be told apart.")
        self.assertEqual(self.said(rows(LS=(1, 1, "a"))), "On meshes, LS is the only model that is scored by AUC.")
        unknown = rows(LS=(NAN, NAN, ""), CS=(NAN, NAN, ""))
        self.assertEqual(self.said(unknown), "On meshes, one observation does not tell how the models rank by AUC.")
        self.assertEqual(self.said(rows()), "")

    def test_a_letter_beyond_z_is_another_one(self):
        self.assertFalse(ranking.share("a", "a'"))
        self.assertTrue(ranking.share("za'", "a'"))

    def test_names_with_braces(self):
        self.assertEqual(ranking.sentence("scans", [("AUC", LEADS.replace("LS", "{}"))]), "On scans, {} leads by AUC.")


class Ranking(support.ReportTest):
    def setUp(self):
        figures = support.without_figures()
        figures.__enter__()
        self.addCleanup(figures.__exit__, None, None, None)

    def test_it_comes_first_and_shows_the_file(self):
        fixture.write_results(self.folder / "run", fixture.eight_meshes())
        index = support.page(self.report("run"))
        self.assertLess(index.index('<section id="ranking"'), index.index('<section id="means"'))
        shown = {tuple(row[:3]): row[3:] for row in support.rows(index, "ranking")}
        table = pandas.read_csv(self.folder / "run/ranking.csv")
        means = pandas.read_csv(self.folder / "run/summary.csv").set_index(["dataset", "metric", "model"])
        shares = pandas.read_csv(self.folder / "run/human_share.csv").set_index(["dataset", "metric", "model"])
        labels = {"auc": "AUC", "nss": "NSS", "lcc": "LCC"}
        expected = 0
        for row in table[table["metric"].isin(labels)].itertuples():
            mean = means.loc[row.dataset, row.metric, row.model]
            cells = [" ".join(cell.split()) for cell in shown[row.dataset.capitalize(), labels[row.metric], row.model]]
            self.assertEqual(cells[:4], [str(row.rank), f"{row.rank_low:.0f} to {row.rank_high:.0f}", f"{row.first:.2f}", row.group])
            self.assertEqual(cells[4:], [f"{row.mean:.3f}", f"{mean['ci95_low']:.3f} to {mean['ci95_high']:.3f}",
                                         people_test.shown(shares.loc[row.dataset, row.metric, row.model]),
                                         "8 meshes" if row.dataset == "meshes" else "8 meshes, 96 scans"])
            expected += 1
        self.assertEqual(expected, 2 * 3 * 4)
        self.assertEqual(shown["Meshes", "AUC", "HS"][:4], ["–", "–", "–", "reference"])
        self.assertEqual({key[2] for key in shown if key not in [
            (row.dataset.capitalize(), labels.get(row.metric), row.model) for row in table.itertuples()]}, {"HS", "RS"})
        self.assertEqual(len(shown), expected + 3 * 2 + 3)

    def test_references_stand_below_the_ranked(self):
        fixture.write_results(self.folder / "order", fixture.eight_meshes())
        models = [row[2] for row in support.rows(support.page(self.report("order")), "ranking")]
        self.assertEqual(models[4:6], ["HS", "RS"])
        self.assertEqual(models[0], "LS")

    def test_without_means_the_ranking_still_stands(self):
        fixture.write_results(self.folder / "no-means", fixture.eight_meshes())
        (self.folder / "no-means/summary.csv").unlink()
        shown = support.rows(support.page(self.report("no-means")), "ranking")
        self.assertEqual({row[8] for row in shown}, {"–"})

    def test_one_mesh_has_ranks_and_says_why_they_have_no_interval(self):
        items = fixture.eight_meshes()[:1]
        fixture.write_results(self.folder / "one", items, results=fixture.results_table(items, views=2))
        index = support.page(self.report("one"))
        self.assertIn("On meshes, one observation does not tell how the models rank by AUC, NSS and LCC.",
                      support.section(index, "ranking"))
        self.assertEqual({tuple(row[4:7]) for row in support.rows(index, "ranking") if row[3] != "–"}, {("–", "–", "–")})


if __name__ == "__main__":
    unittest.main()
