# SPDX-License-Identifier: GPL-3.0-or-later
"""Two runs side by side, and models of one's own."""

import json
from types import SimpleNamespace
from unittest import mock

import fixture
import pandas
import support
from salbench.report import statistics


class Comparison(support.ReportTest):
    def test_differences_are_ours_less_theirs(self):
        results = fixture.results_table(fixture.eight_meshes())
        fixture.write_results(self.folder / "first", fixture.eight_meshes(), results=results)
        later = results.copy()
        later.loc[later["model"] == "LS", "auc"] -= 0.125
        later = later[later["item"] != "8"]
        fixture.write_results(self.folder / "second", fixture.eight_meshes(), results=later)
        to = self.report("first", "--compare", self.folder / "second")
        page = support.page(to, "comparison.html")
        means = {(row[1], row[0], row[2]): row for row in support.rows(page, "compared-means")}
        self.assertEqual(means["Meshes", "LS", "AUC"][3], "7 meshes")
        self.assertEqual(means["Scans", "LS", "AUC"][3], "7 meshes, 84 scans")
        self.assertEqual(means["Meshes", "LS", "AUC"][6:], ["+0.125", "–"], "equal differences are few or equal shapes, and no sure mean")
        self.assertEqual(means["Meshes", "CS", "AUC"][6], "+0.000")
        data = json.loads((to / "data/comparison.js").read_text().removeprefix("salbench.scores = ").removesuffix(";\n"))
        self.assertEqual(len(data["shapes"]), 7 + 7 * 12)
        at = data["models"].index("LS")
        self.assertEqual({row[at] for row in data["scores"]["auc"]}, {0.125})

    def test_shapes_without_a_class_are_of_no_unit_of_classes(self):
        of_class = {"a": "x", "b": "x", "c": "y", "d": ""}
        values = pandas.Series([1.0, 2, 4, 8], pandas.MultiIndex.from_product([of_class, [""]], names=["item", "view"]))
        with mock.patch.object(statistics, "classes", lambda _: of_class):
            means = {unit: statistics.by_unit(SimpleNamespace(unit=unit), values).tolist() for unit in ("class", "mesh", "shape")}
        self.assertEqual(means, {"class": [1.5, 4], "mesh": [1, 2, 4, 8], "shape": [1, 2, 4, 8]})

    def test_a_folder_to_compare_with_must_be_one(self):
        fixture.write_results(self.folder / "alone", fixture.eight_meshes())
        status, errors = support.make(self.folder / "alone", self.folder / "to", "--compare", self.folder / "nowhere")
        self.assertEqual((status, len(errors.strip().splitlines())), (2, 1))

    def test_a_model_of_ones_own_appears_everywhere(self):
        models = (*fixture.MODELS, "MINE")
        out = self.folder / "own"
        fixture.write_results(out, fixture.eight_meshes(), models,
                              extra='evaluated: {model: MINE, maps: "maps", matched: false}\n')
        fixture.write_export(out / "shapes.h5", fixture.eight_meshes()[:1], models, views=1)
        to = self.report("own")
        index = support.page(to)
        for identifier in ("means", "figure-1", "figure-3", "figure-4", "figure-5", "figure-6", "table-2", "pairs"):
            self.assertIn("MINE", support.section(index, identifier), identifier)
        self.assertIn("MINE, after matching", support.page(to, "shapes/1.html"))
        self.assertIn("MINE", (to / "data/scores.js").read_text())
