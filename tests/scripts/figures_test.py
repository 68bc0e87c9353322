# SPDX-License-Identifier: GPL-3.0-or-later
"""scripts/figures house: the table of CONTRIBUTING.md. scripts/figures data_sets: which models it calls better than the floors, which rows
it prints, and what it finds in two sets of one measurement."""

import contextlib
import io
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np
import pandas as pd

ROOT = Path(__file__).resolve().parents[2]
sys.path.append(str(ROOT / "scripts"))

from studies import common, data_sets, house  # noqa: E402


class House(unittest.TestCase):
    def test_contributing_says_what_each_folder_includes(self):
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            house.house(write=False)
        begin, end = common.marks("house")
        page = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8").split(begin)[1].split(end)[0]
        found, said = ([(row.split("|")[1], row.split("|")[4]) for row in text.splitlines()] for text in (printed.getvalue(), page))
        self.assertEqual(found, said, "scripts/figures house --write")
        self.assertIn((" `cache` ", " `io`, `stages/core` "), found)


class Figures(unittest.TestCase):
    def pairs(self, metric, intervals):
        """Rows of significance.csv: (a, b) -> interval of a - b."""
        return pd.DataFrame([{"metric": metric, "model_a": a, "model_b": b, "ci95_low": low, "ci95_high": high}
                             for (a, b), (low, high) in intervals.items()])

    def test_better_is_better_than_every_floor_by_the_whole_interval(self):
        from salbench.conclusions.floors import FLOORS as floors

        above = data_sets.better_than_floors
        wins = {("A", floor): (0.1, 0.2) for floor in floors} | {("B", floor): (0.1, 0.2) for floor in floors}
        self.assertIn("cc: A, B.", above(self.pairs("cc", wins)))
        self.assertIn("kl: none.", above(self.pairs("kl", wins)), "less is better")
        turned = {(floor, model): (low, high) for (model, floor), (low, high) in wins.items()}
        self.assertIn("kl: A, B.", above(self.pairs("kl", turned)))
        self.assertIn("cc: A.", above(self.pairs("cc", wins | {("B", floors[-1]): (-0.01, 0.3)})))
        del wins["A", floors[0]], wins["B", floors[0]]
        self.assertIn("cc: none.", above(self.pairs("cc", wins)), "a floor without scores")

    def test_models_stand_before_floors_and_those_without_scores_are_left_out(self):
        rows = [{"model": model, "metric": "cc", "n": n, "mean": 0.5, "ci95_low": 0.25, "ci95_high": 0.75}
                for model, n in (("RS", 3), ("LS", 3), ("HS", 0))]
        self.assertEqual(data_sets.table_of_means(pd.DataFrame(rows)).splitlines()[2:],
                         ["| LS |  | 0.500 (0.250 to 0.750) |", "| RS | baseline | 0.500 (0.250 to 0.750) |"])

    def test_rows_of_single_splits_are_left_out_where_there_are_several(self):
        table = pd.DataFrame({"split": ["", "test", "train"], "n": [3, 1, 2]})
        self.assertEqual(data_sets.of_all(table)["n"].tolist(), [3])
        self.assertEqual(data_sets.of_all(table[1:2])["n"].tolist(), [1])

    def test_leads_are_turned_so_that_above_0_is_better(self):
        learnt = data_sets.LEARNT
        rows = [{"item": str(item), "model": model, "cc": score + 0.01 * (item % 3), "kl": score + 0.01 * (item % 2)}
                for model, score in ((learnt, 0.6), ("LS", 0.5), ("RS", 0.6)) for item in range(8)]
        rows[0]["cc"] += 0.05  # or all differences would be the same
        rows[0]["kl"] += 0.05
        found = data_sets.leads(pd.DataFrame(rows), ["cc", "kl"])
        self.assertAlmostEqual(found["cc"]["LS"][0], 0.1 + 0.05 / 8)
        self.assertAlmostEqual(found["kl"]["LS"][0], -0.1 - 0.05 / 8)
        for of in found.values():
            self.assertTrue(all(low <= mean <= high for mean, low, high in of.values()))
        self.assertEqual(data_sets.verdict(found["cc"]), "ahead of LS; not told from RS.")
        self.assertEqual(data_sets.verdict(found["kl"]), "behind LS; not told from RS.")

    def test_faces_are_next_to_each_other_at_an_edge_that_has_two(self):
        faces = np.array([[0, 1, 2], [3, 2, 0], [4, 5, 6], [5, 4, 7], [4, 5, 8]])
        self.assertEqual([set(pair) for pair in data_sets.next_to_each_other(faces).tolist()], [{0, 1}])

    def test_values_that_follow_the_sizes_of_faces_are_told(self):
        with tempfile.TemporaryDirectory() as folder:
            root, n = Path(folder), 12
            (root / "MeshFile/non_texture/Grid").mkdir(parents=True)
            (root / "SaliencyMap/non_texture").mkdir(parents=True)
            (root / "paths_dataset_rgb.txt").write_text("Grid/grid.obj\n")
            cells = np.array([(y * (n + 1) + x, y * (n + 1) + x + 1, (y + 1) * (n + 1) + x) for y in range(n) for x in range(n)]) + 1
            vertices = [f"v {(x / n) ** 2} {y / n} 0" for y in range(n + 1) for x in range(n + 1)]
            lines = vertices + [f"f {a} {b} {b + n + 1}\nf {a} {b + n + 1} {c}" for a, b, c in cells.tolist()]
            (root / "MeshFile/non_texture/Grid/grid.obj").write_text("\n".join(lines) + "\n")
            densities = np.repeat(np.tile(1 / np.diff((np.arange(n + 1) / n) ** 2), n), 2)
            (root / "SaliencyMap/non_texture/grid.csv").write_text("".join(f"{value!r}\n" for value in densities.tolist()))
            row = data_sets.sizes_of_faces(root).splitlines()[-1].strip("| ").split(" | ")
        self.assertEqual((row[0], row[-1]), ("grid", "1.000"), "densities that are one over the area")
        self.assertGreater(float(row[-2]), 0.9, "SD")

    def written(self, root, noise):
        """Two meshes, and clouds with the same points in another order, whose densities differ by so much."""
        rng = np.random.default_rng(1)
        for folder in ("eyetracking/Meshes", "eyetracking/Distributions", "eyetracking/RawData", "sal3d/Gaze"):
            (root / folder).mkdir(parents=True)
        for name in ("cow", "horse"):
            points, density, order = rng.normal(size=(30, 3)), rng.random(30), rng.permutation(30)
            faces = "".join(f"3 {i} {i + 1} {i + 2}\n" for i in range(28))
            vertices = "".join(" ".join(map(repr, row)) + "\n" for row in points.tolist())
            (root / f"eyetracking/Meshes/{name}.off").write_text(f"OFF\n30 28 0\n{vertices}{faces}")
            (root / f"eyetracking/Distributions/{name}.val").write_text("".join(f"{value!r}\n" for value in density.tolist()))
            (root / f"eyetracking/RawData/{name}_0.pid").write_text("1\n")
            rows = np.column_stack([points, points, density + noise * rng.random(30), np.zeros(30)])[order]
            (root / f"sal3d/Gaze/{name}.txt").write_text("".join(" ".join(map(repr, row)) + "\n" for row in rows.tolist()))

    def test_one_measurement_in_two_files_is_told_from_two(self):
        for noise, same in ((0, True), (0.5, False)):
            with self.subTest(noise), tempfile.TemporaryDirectory() as folder:
                self.written(Path(folder), noise)
                text = data_sets.overlap(Path(folder))
                self.assertEqual("one measurement in two files" in text, same)
                self.assertIn(f"the densities differ at {0 if same else 60} of 60 vertices", text)
                self.assertEqual("| cc | 1.000000 | 1.000000 |" in text, same)

    def test_raw_and_spread_densities_are_told_apart(self):
        with tempfile.TemporaryDirectory() as folder:
            self.written(Path(folder), 0)
            text = data_sets.readings(Path(folder) / "sal3d")
            self.assertIn("2 shapes", text)
            self.assertRegex(text, r"correlate at -?0\.\d{3} on average")
            self.assertIn("Raw ones are above 0 on 100 % of the points, spread ones on 100 %.", text)
