# SPDX-License-Identifier: GPL-3.0-or-later
"""Scripts that take a folder like the real data's, over one of toys: they run, and print the table that they promise."""

import os
import random
import subprocess
import tempfile
import unittest
from pathlib import Path

import pandas

from tests.support import toy_data

SCRIPTS = Path(__file__).resolve().parents[2] / "scripts"
PROGRAM = Path(os.environ["SALBENCH_PROGRAM"])
PYTHON = ["/usr/bin/python3", "-B"]
DATA = os.environ.get("SALBENCH_DATA", "")


def make_data(data):
    """Two meshes with saliency and picks, and what was published of them: tables of made-up numbers."""
    toy_data.study(data / "SchellingData", (1, 2), 24, 12, participants=4)
    reference, chance = data / "reference", random.Random(1)
    reference.mkdir()
    models = ["LS", "CS", "PS", "MS"]
    bins = [{"bin_left": i / 100, **{model: 1 + chance.random() for model in ("GS", *models)}} for i in range(100)]
    pandas.DataFrame(bins).to_csv(reference / "mean_histograms_scans.csv", index=False)
    pandas.DataFrame(bins).to_csv(reference / "mean_histograms_meshes.csv", index=False)
    rows = [{"item": item, "view": view, "model": model, "auc": chance.random(), "nss": chance.random(), "cc": chance.random()}
            for item in (1, 2, 21, 22) for view in range(12) for model in [*models, "HS", "RS"]]
    scans = pandas.DataFrame(rows)
    scans.to_csv(reference / "published_all_scans.csv", index=False)
    scans[scans["model"].isin(models)].to_csv(reference / "published_scan_by_scan.csv", index=False)
    meshes = scans[scans["view"] == 0].drop(columns="view")
    meshes[meshes["item"] != 2].to_csv(reference / "published_scores.csv", index=False)
    meshes[meshes["item"] == 2].to_csv(reference / "held_out_scores.csv", index=False)


class ToyDataTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = Path(cls.enterClassContext(tempfile.TemporaryDirectory(prefix="toy data ")))
        cls.data = cls.folder / "data"
        make_data(cls.data)

    def printed(self, figures, *arguments):
        """Output of scripts/figures for the toys."""
        done = subprocess.run([*PYTHON, SCRIPTS / "figures", figures, self.data, *arguments], cwd=self.folder, capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertNotIn("Traceback", done.stderr)
        return done.stdout

    def test_fidelity(self):
        out = self.folder / "scans"
        (self.folder / "scans.yaml").write_text("dataset: {meshes: false}\nscan: {step_degrees: 2}\n")
        subprocess.run([PROGRAM, "run", self.folder / "scans.yaml", "--data", self.data / "SchellingData", "--cache", self.folder / "cache",
                        "--reference", self.data / "reference/mean_histograms_scans.csv", "--out", out, "--quiet"], check=True)
        table = self.printed("fidelity", "--of", out)
        self.assertRegex(table, r"^model +KS +auc +auc published +r auc +nss .*\n +LS +0\.\d+ +[\d.]+ +[\d.]+ +-?[\d.]+ ")
        self.assertNotIn("NaN", table)

    def test_readme(self):
        table = self.printed("readme").splitlines()
        heads = " | ".join(f"{metric}, {size}" for size in ("1 meshes fitted to", "1 held out") for metric in ("AUC", "NSS", "LCC"))
        self.assertEqual(table[0], f"| ours / published | {heads} |")
        self.assertEqual(len(table), 7)
        self.assertRegex(table[2], r"^\| LS \| 0\.\d{3} / 0\.\d{3} \| ")

