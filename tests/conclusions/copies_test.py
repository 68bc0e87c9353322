# SPDX-License-Identifier: GPL-3.0-or-later
"""A run finds copies by the digests of shape and ground truth, and its conclusions count them once."""

import shutil
import tempfile
import unittest
from pathlib import Path

from tests.support import forked
from tests.support.toy_data import study

from salbench.conclusions.folders import read_record, read_run
from salbench.conclusions.means import ranking


class CopiesTest(unittest.TestCase):
    def test_of_a_run(self):
        folder = Path(self.enterContext(tempfile.TemporaryDirectory()))
        study(folder / "data", (1, 2, 3))
        for form in ("Meshes/{}.off", "Distributions/{}.val", *("RawData/{}_" + f"{person}.pid" for person in range(3))):
            shutil.copy(folder / "data" / form.format(1), folder / "data" / form.format(4))
        shutil.copy(folder / "data/Meshes/2.off", folder / "data/Meshes/3.off")  # of another ground truth: no copy
        (folder / "c.yaml").write_text("dataset: {scans: false}\nmodels: {CB: , LS: }\nmetrics: {names: [auc]}\n")
        done = forked.salbench("run", folder / "c.yaml", "--data", folder / "data", "--cache", folder / "cache", "--out", folder / "out", "--quiet")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(read_record(folder / "out/run.yaml")["copies"], [["1", "4"]])
        self.assertEqual(set(ranking(read_run(folder / "out").study)["n"]), {3})
        self.assertIn("Copies, counted once: 1 and 4.", (folder / "out/leaders.csv").read_text())


if __name__ == "__main__":
    unittest.main()
