# SPDX-License-Identifier: GPL-3.0-or-later
"""configs/paper/statements.csv is what the published scores say, and its rank sums are SciPy's."""

import csv
import importlib.machinery
import importlib.util
import math
import os
import tempfile
import unittest
from collections import defaultdict
from pathlib import Path

from scipy import stats

ROOT = Path(__file__).resolve().parents[2]
DATA = os.environ.get("SALBENCH_DATA", "")


def script():
    loader = importlib.machinery.SourceFileLoader("paper_statements", str(ROOT / "scripts/paper_statements"))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader(loader.name, loader))
    loader.exec_module(module)
    return module


@unittest.skipUnless((Path(DATA) / "reference").is_dir() and DATA, "the real data is not here: set SALBENCH_DATA")
class PaperStatementsTest(unittest.TestCase):
    def test_the_file_is_what_the_published_scores_say(self):
        made = script()
        self.assertEqual(made.ANSWERS.read_text(), made.answers(Path(DATA)), f"run scripts/paper_statements {DATA}")

    def test_each_pair_has_the_rank_sum_of_scipy(self):
        made = script()
        for name in ("published_all_scores.csv", "published_all_scans.csv"):
            file = Path(DATA) / "reference" / name
            scores = defaultdict(list)
            for row in csv.DictReader(file.open()):
                for metric in ("auc", "nss", "cc"):
                    scores[metric, row["model"]].append(float(row[metric]))
                scores["lcc", row["model"]].append(abs(float(row["cc"])))
            with tempfile.TemporaryDirectory() as scratch:
                rows = made.concluded(file, "shape", Path(scratch))
            self.assertGreater(len(rows), 25)
            for row in rows:
                twin = stats.ranksums(scores[row["metric"], row["model_a"]], scores[row["metric"], row["model_b"]])
                self.assertTrue(math.isclose(float(row["rank_sum_z"]), twin.statistic, rel_tol=1e-9, abs_tol=1e-9), row)
                self.assertTrue(math.isclose(float(row["rank_sum_p"]), twin.pvalue, rel_tol=1e-9, abs_tol=1e-300), row)


if __name__ == "__main__":
    unittest.main()
