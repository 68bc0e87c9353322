# SPDX-License-Identifier: GPL-3.0-or-later
"""Numbers from papers are beside the means of a leaderboard or in a separate table, and are not ranked."""

import unittest
from dataclasses import replace

import pandas

from salbench.conclusions import tables_of
from salbench.conclusions.metrics import of_program
from salbench.conclusions.study import Study
from salbench.conclusions.units import TEXTS, Scores
from salbench.leaderboard import site
from salbench.leaderboard.board import Board

ROW = {"model": "OTHER", "dataset": "meshes", "split": "", "class": "", "metric": "auc", "value": .99, "ci95": float("nan"), "n": 12.0,
       "rounding": .005, "paper": "zhang2025", "table": "3", "page": "", "first_hand": "no", "remark": "", "source": "zhang2025, table 3, second-hand"}
REPORTED = pandas.DataFrame([ROW, {**ROW, "model": "LS", "value": .6}, {**ROW, "metric": "nss"}, {**ROW, "split": "test"}, {**ROW, "class": "ant"}])


def board(reported):
    rows = [("meshes", "", str(item), "ant", "", model, mean + item / 1000) for item in range(12) for model, mean in (("LS", .6), ("CS", .5))]
    scores = Scores(pandas.DataFrame(rows, columns=[*TEXTS, "auc"]), (of_program()["auc"],))
    study = replace(Study(scores), reported=reported)
    made = {name: frame for name, frame in tables_of(study) if frame is not None}
    made["metrics"] = pandas.DataFrame({"metric": ["auc"], "unit": ["1"], "better": ["higher"]})
    return Board([], {}, study, made["compact"][:0], [], [], "", made)


class Reported(unittest.TestCase):
    def test_it_stands_below_a_mean_over_the_same_shapes_or_in_a_table_of_its_own(self):
        table, _, others = site.ranking(board(REPORTED))
        self.assertEqual([row[0].text for row in table.rows], ["LS", "CS"])
        self.assertEqual([row[2].below for row in table.rows], ["reported 0.60 (zhang2025, table 3, second-hand): outside", ""])
        self.assertEqual([[row[0].text, row[4].text, row[5].text, row[6].text] for row in others.rows],
                         [["OTHER", "0.99", "12", "zhang2025, table 3, second-hand"]])

    def test_nothing_else_on_the_site_knows_of_it(self):
        """A model that was not submitted has no row anywhere, and every other table is unchanged."""
        with_it, without = board(REPORTED), board(None)
        for name, table in without.tables.items():
            self.assertTrue(table.equals(with_it.tables[name]), name)
        self.assertEqual(set(with_it.tables) - set(without.tables), {"published"})
        for blocks in (site.by_metric, site.by_class):
            self.assertNotIn("OTHER", {cell.text for table in blocks(with_it) for row in table.rows for cell in row})
        self.assertEqual(len(site.ranking(without)), 2)
