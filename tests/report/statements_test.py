# SPDX-License-Identifier: GPL-3.0-or-later
"""The paper's statements on its own scores: what the sentence counts and names."""

import unittest

from salbench.report import paper, statements


def row(a, b, by_shapes="holds", by_meshes="holds", by_classes="holds", dataset="scans", metric="auc"):
    return {"dataset": dataset, "metric": metric, "model_a": a, "model_b": b, "n": "9", "by_shapes": by_shapes, "by_meshes": by_meshes,
            "by_classes": by_classes}


class StatementsTest(unittest.TestCase):
    def test_counts_what_holds_by_each_unit(self):
        said = statements.said([row("A", "B"), row("A", "C", "does not hold", "undecided", "undecided")])
        self.assertIn("says of 2 pairs", said)
        self.assertIn("1 follow from the paper's test over shapes, 1 hold with meshes", said)

    def test_names_what_does_not_hold_apart_from_what_is_open(self):
        said = statements.said([row("A", "B", by_meshes="undecided"), row("A", "C", by_meshes="does not hold", metric="nss")])
        self.assertIn("By meshes, what it says of A and C by NSS on scans does not hold.", said)
        self.assertIn("By meshes, what it says of A and B by AUC on scans is undecided.", said)
        self.assertNotIn("By classes", said)

    def test_the_table_has_a_row_per_pair_with_known_verdicts(self):
        rows = paper.read("statements.csv").to_dict("records")
        note, fold = statements.table(None)
        table, = fold.blocks
        self.assertEqual(len(table.rows), len(rows))
        self.assertTrue(all(len(cells) == len(table.columns) == len(table.numeric) for cells in table.rows))
        self.assertTrue(all(row[column] in statements.STYLES for row in rows for column in statements.KINDS))
        self.assertIn(f"of {len(rows)} pairs", note.text)

    def test_every_statement_of_a_word_has_its_rows(self):
        said = {(claim["section"], claim["claim"]) for claim in paper.read("claims.csv").to_dict("records") if claim["word"]}
        self.assertEqual(said, {(row["section"], row["claim"]) for row in paper.read("statements.csv").to_dict("records")})
