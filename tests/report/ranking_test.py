# SPDX-License-Identifier: GPL-3.0-or-later
"""The ranking: its table and its sentences are those of the files."""

import html

import numpy
import pandas

import fixture
import people_test
import support
from salbench.report.ranking import beside


class Ranking(support.ReportTest):
    def test_it_comes_first_and_shows_the_file_and_references_stand_below(self):
        fixture.write_results(self.folder / "run", fixture.eight_meshes())
        index = support.page(self.report("run"))
        models = [row[0].split()[0] for row in support.rows(index, "ranking")]
        self.assertEqual((models[0], models[4:6]), ("LS", ["HS", "RS"]))
        self.assertLess(index.index('<section id="ranking"'), index.index('<section id="means"'))
        shown = {(row[1], row[2], row[0].split()[0]): row[3:] for row in support.rows(index, "ranking")}
        may_be_best = {(row[1].lower(), row[2].lower(), row[0].split()[0]) for row in support.rows(index, "ranking") if "may be best" in row[0]}
        table = pandas.read_csv(self.folder / "run/ranking.csv")
        means = pandas.read_csv(self.folder / "run/summary.csv").set_index(["dataset", "metric", "model"])
        shares = pandas.read_csv(self.folder / "run/human_share.csv").set_index(["dataset", "metric", "model"])
        labels = {"auc": "AUC", "nss": "NSS", "lcc": "LCC"}
        expected = 0
        for row in table[table["metric"].isin(labels)].itertuples():
            mean = means.loc[row.dataset, row.metric, row.model]
            cells = [" ".join(cell.split()) for cell in shown[row.dataset.capitalize(), labels[row.metric], row.model]]
            first = f" {beside({'first': row.first, 'rank_at_chance': numpy.nan})}" if row.first > 0 else ""
            self.assertEqual(cells[:3], [f"{row.rank}{first}", f"{row.rank_low:.0f} to {row.rank_high:.0f}", row.group])
            self.assertEqual(cells[3:], [f"{row.mean:.3f}", f"{mean['ci95_low']:.3f} to {mean['ci95_high']:.3f}",
                                         people_test.shown(shares.loc[row.dataset, row.metric, row.model]),
                                         "8 meshes" if row.dataset == "meshes" else "8 meshes, 96 scans"])
            expected += 1
        self.assertEqual(expected, 2 * 3 * 4)
        self.assertEqual(may_be_best, {(row.dataset, row.metric, row.model) for row in table.itertuples() if row.metric in labels and row.rank_low == 1})
        for first, share in ((1, "100 %"), (.9963, "more than 99 %"), (.5, "50 %"), (.0033, "less than 1 %")):
            self.assertIn(f" {share} ", beside({"first": first, "rank_at_chance": numpy.nan}))
        self.assertIn("3", beside({"first": 0, "rank_at_chance": 3}), "the rank with missing scores at chance")
        self.assertEqual(shown["Meshes", "AUC", "HS"][:3], ["–", "–", "reference"])
        self.assertEqual({key[2] for key in shown if key not in [
            (row.dataset.capitalize(), labels.get(row.metric), row.model) for row in table.itertuples()]}, {"HS", "RS"})
        self.assertEqual(len(shown), expected + 3 * 2 + 3)

    def test_sentences_are_the_programs_with_a_line_per_split(self):
        fixture.write_results(self.folder / "splits", fixture.eight_meshes())
        file = self.folder / "splits/leaders.csv"
        table = pandas.read_csv(file, keep_default_na=False)
        table = table[(table["dataset"] == "meshes") & (table["metric"] == "")]
        said = ["A & B lead.", "A leads on split train.", "B leads on split test."]
        pandas.concat([table.assign(split=split, sentence=text) for split, text in zip(("", "train", "test"), said)]).to_csv(file, index=False)
        to = self.report("splits", "--metrics", "auc")
        for text in said:
            self.assertIn(f">{html.escape(text)}<", support.section(support.page(to, "ranking.html"), "ranking"))
            self.assertNotIn(html.escape(text), support.page(to, "index.html"), "the first screen has a sentence without figures")

    def test_without_means_the_ranking_still_stands(self):
        fixture.write_results(self.folder / "no-means", fixture.eight_meshes())
        for name in ("summary.csv", "results.csv"):  # of scores, the report would draw them again
            (self.folder / "no-means" / name).unlink()
        shown = support.rows(support.page(self.report("no-means", "--metrics", "auc")), "ranking")
        self.assertEqual({row[7] for row in shown}, {"–"})

    def test_one_mesh_has_no_ranks_and_says_why(self):
        items = fixture.eight_meshes()[:1]
        fixture.write_results(self.folder / "one", items, results=fixture.results_table(items, views=2))
        index = support.page(self.report("one", "--metrics", "auc"))
        self.assertRegex(support.section(index, "ranking"), "On 1 mesh, one observation does not tell how the models rank by AUC")
        self.assertEqual({tuple(row[3:6]) for row in support.rows(index, "ranking") if row[5] != "reference"}, {("–", "–", "–")})
