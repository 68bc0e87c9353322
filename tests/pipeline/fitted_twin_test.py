# SPDX-License-Identifier: GPL-3.0-or-later
"""Fitted densities beside NumPy and SciPy: what was fitted is the optimum of the likelihood written here, and scores follow from it."""

import os
import re
import subprocess
import tempfile
import unittest
from pathlib import Path

import h5py
import numpy as np
import pandas as pd
from scipy import optimize

from protocols_twin_test import EPS, bumpy_sphere, density, distances, min_max, smoother

PROGRAM = os.environ["SALBENCH_PROGRAM"]
WIDTHS = (0, 0.02, 0.04, 0.08)
PENALTY = 1e-3
CONFIG = """
dataset: {scans: false}
metrics: {names: [ig, ig_fitted, kl_fitted, sim_fitted]}
fitting: {folds: 4, by: mesh}
models: {MC: {}, RS: {}}
"""


def hats(x, knots):
    """(n, knots): weights of linear interpolation."""
    place = x * (knots - 1)
    lower = np.minimum(place.astype(int), knots - 2)
    weights = np.zeros((len(x), knots))
    weights[np.arange(len(x)), lower] = 1 - (place - lower)
    weights[np.arange(len(x)), lower + 1] = place - lower
    return weights


def middles(x, bins):
    """The middle of the bin of each value in [0, 1]."""
    return (np.minimum((x * bins).astype(int), bins - 1) + 0.5) / bins


class Shape:
    def __init__(self, seed, rng):
        self.points, self.faces = bumpy_sphere(seed)
        self.distances = distances(self.points)
        looked = np.exp(2 * self.distances + rng.normal(size=len(self.points)))
        self.picks = rng.choice(len(self.points), 40, p=looked / looked.sum())
        edges = {(a, b) for face in self.faces for a in face for b in face if a != b}
        degree = np.bincount([a for a, _ in edges], minlength=len(self.points))
        lengths = sum(((self.points[a] - self.points[b]) ** 2).sum() / (degree[a] + 1) for a, b in edges)
        radius = np.linalg.norm(self.points - self.points.mean(0), axis=1).max()
        self.variance = lengths / 2 / len(self.points) / radius**2  # of a step of smoothing

    def blurred(self, map_, width):
        return min_max(smoother(len(map_), self.faces, round(width**2 / self.variance)) @ min_max(map_))

    def marks(self):
        return np.bincount(self.picks, minlength=len(self.points)) / len(self.picks)


def loss(knots, parts):
    """Mean over shapes of -log likelihood against the uniform map, in nats, and its gradient. parts: (features, marks) of each."""
    value, gradient = 0, 0
    for features, marks in parts:
        height = features @ knots
        mass = np.exp(height - height.max())
        value += np.log(mass.mean()) + height.max() - marks @ height
        gradient = gradient + features.T @ (mass / mass.sum() - marks)
    return value / len(parts), gradient / len(parts)


def fitted(parts):
    """Knots of the optimum: steps of the first 20 are >= 0, and the first is 0."""
    sums = np.zeros((30, 29))
    for step in range(19):
        sums[step + 1:20, step] = 1
    sums[20:, 19:] = np.eye(10)

    def penalised(steps):
        value, gradient = loss(sums @ steps, parts)
        return value + PENALTY / 2 * steps @ steps, sums.T @ gradient + PENALTY * steps

    found = optimize.minimize(penalised, np.zeros(29), jac=True, method="L-BFGS-B", bounds=[(0, None)] * 19 + [(None, None)] * 10,
                              options={"maxiter": 5000, "maxfun": 20000, "ftol": 1e-15, "gtol": 1e-9})
    return sums @ found.x, found.fun


class Fitted(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        rng = np.random.default_rng(5)
        cls.shapes = {f"m{k}": Shape(k, rng) for k in range(6)}
        cls.folder = Path(cls.enterClassContext(tempfile.TemporaryDirectory()))
        for part in ("Meshes", "RawData"):
            (cls.folder / "data" / part).mkdir(parents=True)
        for name, shape in cls.shapes.items():
            lines = [f"OFF\n{len(shape.points)} {len(shape.faces)} 0"]
            lines += [" ".join(map(repr, map(float, point))) for point in shape.points]
            lines += [f"3 {a} {b} {c}" for a, b, c in shape.faces]
            (cls.folder / f"data/Meshes/{name}.off").write_text("\n".join(lines) + "\n")
            (cls.folder / f"data/RawData/{name}_0.pid").write_text("\n".join(map(str, shape.picks)) + "\n")
        (cls.folder / "c.yaml").write_text(CONFIG)
        for arguments in (("run", "--out", cls.folder / "out"), ("export", "--to", cls.folder / "all.h5")):
            subprocess.run([PROGRAM, arguments[0], cls.folder / "c.yaml", "--data", cls.folder / "data", "--cache", cls.folder / "cache",
                            "--quiet", *arguments[1:]], check=True)
        cls.fits = pd.read_csv(cls.folder / "out/fitted.csv")
        cls.scores = pd.read_csv(cls.folder / "out/results.csv")
        with h5py.File(cls.folder / "all.h5") as file:
            cls.maps = {(model, name): file[f"{name}/map.{model}/saliency"][:] for model in ("MC", "RS") for name in cls.shapes}
            cls.folds = {name: int(file[f"{name}/density_counts.MC/fold"][()]) for name in cls.shapes}

    def parts(self, model, names, width):
        """Over bins, as the program has them."""
        features = lambda name, shape: np.hstack([hats(middles(shape.blurred(self.maps[model, name], width), 76), 20),  # noqa: E731
                                                  hats(middles(shape.distances, 18), 10)])
        return [(features(name, self.shapes[name]), self.shapes[name].marks()) for name in names]

    def knots(self, model, fold):
        rows = self.fits[(self.fits["model"] == model) & (self.fits["fold"] == fold)]
        return rows, rows["log_density"].to_numpy()

    def test_columns_of_exported_shapes_are_documented(self):
        subprocess.run([PROGRAM, "export", self.folder / "c.yaml", "--data", self.folder / "data", "--cache", self.folder / "cache",
                        "--quiet", "--format", "csv", "--to", self.folder / "shapes"], check=True)
        listed = pd.read_csv(Path(__file__).parents[2] / "docs/tables/columns.csv")
        known = {"x", "y", "z", "nx", "ny", "nz", *listed.loc[listed["file"].str.startswith("shapes"), "name"]}
        columns = pd.read_csv(self.folder / "shapes/m0.csv").columns
        self.assertIn("constant_map_constant", columns)
        self.assertEqual([name for name in columns if name not in known and re.sub("_(MC|RS|constant)$", "_MODEL", name) not in known], [])

    def test_what_was_fitted_is_the_optimum_of_the_best_blur(self):
        self.assertEqual(set(self.fits["model"]), {"MC", "RS", "constant"})
        for model in ("MC", "RS"):
            for fold in sorted(set(self.folds.values())):
                rows, knots = self.knots(model, fold)
                others = [name for name in self.shapes if self.folds[name] != fold]
                self.assertEqual(set(rows["shapes"]), {len(others)})
                best = min(((fitted(self.parts(model, others, width)), width) for width in WIDTHS), key=lambda found: found[0][1])
                self.assertEqual(set(rows["blur"]), {best[1]})
                value, _ = loss(knots, self.parts(model, others, best[1]))
                self.assertAlmostEqual(rows["gain"].iloc[0], -value / np.log(2), delta=1e-6)
                np.testing.assert_allclose(knots, best[0][0], atol=1e-3)

    def test_of_a_constant_map_the_centre_bias_is_left(self):
        knots = self.fits[self.fits["model"] == "constant"].groupby("of")["log_density"]
        self.assertLess(knots.get_group("value").abs().max(), 1e-9)
        self.assertGreater(np.ptp(knots.get_group("distance")), 0.5)

    def test_scores_are_those_of_the_density(self):
        for _, row in self.scores.iterrows():
            shape, fold = self.shapes[row["item"]], self.folds[row["item"]]
            rows, knots = self.knots(row["model"], fold)
            map_ = shape.blurred(self.maps[row["model"], row["item"]], rows["blur"].iloc[0])
            p = density(np.exp(np.hstack([hats(map_, 20), hats(shape.distances, 10)]) @ knots))
            with h5py.File(self.folder / "all.h5") as file:
                q = density(file[f"{row['item']}/ground_truth/saliency"][:])
            expected = {"ig_fitted": (np.log2(EPS + p[shape.picks]) - np.log2(EPS + 1 / len(p))).mean(),
                        "kl_fitted": (q * np.log(EPS + q / (EPS + p))).sum(), "sim_fitted": np.minimum(p, q).sum()}
            for metric, value in expected.items():
                self.assertAlmostEqual(row[metric], value, delta=1e-9, msg=f"{row['model']} {row['item']} {metric}")


if __name__ == "__main__":
    unittest.main()
