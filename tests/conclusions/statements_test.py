# SPDX-License-Identifier: GPL-3.0-or-later
"""What a text says of pairs of models, beside what scores say."""

import tempfile
import unittest
from math import isnan
from pathlib import Path

import numpy as np

from support import AUC, KL, row, scores_of
from salbench.conclusions.csv_file import InputError
from salbench.conclusions.statements import read_statements, statements
from salbench.conclusions.study import Study

HEAD = "section,claim,word,dataset,metric,check,a,b,margin\n"


def read(text):
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "claims.csv"
        path.write_text(text)
        return read_statements(path)


def paired(ahead, noise, metric=AUC):
    """40 scans of meshes whose scores differ much; model B is A with `ahead` taken off and noise of its own."""
    rng = np.random.default_rng(1)
    rows = []
    for mesh in range(20):
        of_mesh, of_pair = rng.normal(), noise * rng.normal()
        for view in "01":
            rows += [row(str(mesh), view, "A", of_mesh), row(str(mesh), view, "B", of_mesh - ahead + of_pair)]
    return scores_of(rows, (metric,))


def answer(of_scores, said):
    """The only row."""
    found = statements(Study(of_scores, claims=read(HEAD + f"4,it is so,word,{said}\n")))
    assert len(found) == 1
    return found.loc[0]


class Statements(unittest.TestCase):
    def check(self, column, *cases):
        for of_scores, said, expected in cases:
            self.assertEqual(answer(of_scores, said)[column], expected, said)

    def test_a_difference_holds_on_the_side_claimed(self):
        clear, noisy = paired(1, .2), paired(.01, .2)
        self.check("by_units", (clear, "scans,auc,above,A,B,", "holds"), (clear, "scans,auc,above,B,A,", "does not hold"),
                   (noisy, "scans,auc,above,A,B,", "undecided"), (paired(1, .2, KL), "scans,kl,above,B,A,", "holds"))

    def test_sameness_takes_a_margin(self):
        clear, noisy = paired(1, .2), paired(.01, .2)
        self.check("by_units", (noisy, "scans,auc,same,A,B,.5", "holds"), (noisy, "scans,auc,same,A,B,.01", "undecided"),
                   (noisy, "scans,auc,same,A,B,", "undecided"), (clear, "scans,auc,same,A,B,.5", "does not hold"),
                   (noisy, "scans,auc,differ,A,B,.5", "does not hold"), (noisy, "scans,auc,differ,A,B,.01", "undecided"),
                   (clear, "scans,auc,differ,B,A,.01", "holds"))

    def test_the_papers_test_takes_shapes_and_reads_what_it_does_not_reject_as_same(self):
        apart, near = paired(9, .2), paired(.15, .2)
        self.check("by_shapes", (apart, "scans,auc,above,A,B,", "holds"), (apart, "scans,auc,above,B,A,", "does not hold"),
                   (apart, "scans,auc,same,A,B,", "does not hold"), (apart, "scans,auc,differ,A,B,", "holds"),
                   (near, "scans,auc,same,A,B,", "holds"))  # it does not see that shapes are paired
        self.check("by_units", (near, "scans,auc,same,A,B,", "does not hold"))
        self.assertEqual(answer(near, "scans,auc,above,A,B,")[["n_shapes", "n"]].tolist(), [40, 20])

    def test_reversed_models_have_the_same_corrected_value_and_the_other_interval(self):
        one, other = (answer(paired(.1, .2), f"scans,auc,above,{models},") for models in ("A,B", "B,A"))
        self.assertLess(one["signed_rank_p_holm"], 1)
        self.assertEqual(one["signed_rank_p_holm"], other["signed_rank_p_holm"])
        for low, high in (("ci95_low", "ci95_high"), ("ci90_low", "ci90_high"), ("mean_difference",) * 2, ("rank_sum_z",) * 2):
            self.assertEqual((one[low], one[high]), (-other[high], -other[low]))

    def test_a_model_without_scores_leaves_cells_empty(self):
        found = answer(paired(1, .2), "scans,auc,above,A,C,")
        self.assertTrue(isnan(found["mean_difference"]))
        self.assertEqual((found["by_units"], found["by_shapes"], found["n"]), ("", "", 0))

    def test_one_row_per_pair_and_none_without_scores(self):
        claims = read("# as said\n" + HEAD + "4,pairs,word,scans,auc,above,A B,C D,\n4,no such data,word,meshes,auc,above,A,B,\n"
                      "4,no such metric,word,scans,nss,above,A,B,\n4,another kind,word,scans,auc,hardest_class,A,B,\n"
                      "4,not about significance,,scans,auc,above,A,B,\n")
        self.assertEqual(len(claims), 3)
        self.assertEqual(len(statements(Study(paired(1, .2), claims=claims))), 4)

    def test_one_mesh_decides_nothing(self):
        self.check("by_units", (scores_of([row("1", "0", "A", .6), row("1", "0", "B", .5)]), "scans,auc,above,A,B,", ""))

    def test_bad_rows_are_named(self):
        for said, message in (("4,it,word,scan,auc,above,A,B,", "claims.csv:2: data set 'scan', expected one of meshes, scans, clouds"),
                              ("4,it,word,scans,auc,same,A,B,-1", "claims.csv:2: margin -1, expected above 0"),
                              ("4,it,word,scans,auc,same,A,B,much", "claims.csv:2: 'much' is not a number")):
            with self.assertRaisesRegex(InputError, message):
                read(HEAD + said + "\n")

    def test_the_papers_own_claims_are_read(self):
        """Of 38 claims the 25 that a word of significance says of pairs."""
        claims = read_statements(Path(__file__).parents[2] / "configs/paper/claims.csv")
        self.assertEqual(len(claims), 25)
        self.assertEqual(claims["check"].value_counts().to_dict(), {"above": 14, "differ": 6, "same": 5})
        self.assertFalse((claims["word"] == "").any())
