# SPDX-License-Identifier: GPL-3.0-or-later
"""Scores on faces beside NumPy, SciPy and scikit-learn, on random meshes and on the three meshes of Mesh Mamba that are public."""

import os
from pathlib import Path

import numpy as np
import pandas as pd
import protocols_twin_test
from protocols_twin_test import EPS, bumpy_sphere, called, density, distances, divergence, face_areas, matched, min_max, similarity, weighted_correlation
from salbench.report.exports import Shapes
from scipy import stats

REAL = Path(os.environ.get("SALBENCH_DATA", "")) / "meshmamba"
ITEMS = ("Apple_v01_l3", "Aquarium_Deep_Sea_Diver_v1_L1", "Aquarium_Skull_v1_L1")
ALONE = "dataset: {layout: meshmamba, scans: false, score_on: faces}\n"
PER_FACE = """from salbench.datasets import Item, face_values, match, mesh
from salbench.datasets.reading import from_faces

def items(root):
    return [Item(one.item, [one.path, f"{root}/maps/{one.item}.txt"]) for one in match(root, "off/{item}.off")]

def read(item):
    shape = mesh(item.files[0])
    shape.face_truth = face_values(item.files[1], shape, unseen=-1)
    shape.ground_truth = from_faces(shape, shape.face_truth)
    return shape
"""


def smoother_of_faces(faces, steps):
    """The matrix by which a face takes, in each step, the mean over itself and the faces that share an edge with it."""
    sides = {}
    for face, (a, b, c) in enumerate(faces.tolist()):
        for side in ((a, b), (b, c), (c, a)):
            sides.setdefault(frozenset(side), []).append(face)
    ring = np.eye(len(faces))
    for one, other in (pair for pair in sides.values() if len(pair) == 2):
        ring[one, other] = ring[other, one] = 1
    return np.linalg.matrix_power(ring / ring.sum(1, keepdims=True), steps)


# The evaluation of Mesh Mamba, utils/loss_function.py of its repository, in the precision that it has there. [zhang2025]

def their_divergence(map_, truth):
    p, q = map_ / map_.sum(), truth / truth.sum()
    return (q * np.log(np.float32(EPS) + q / (p + np.float32(EPS)))).sum()


def their_correlation(map_, truth):
    p, q = map_ - map_.mean(), truth - truth.mean()
    return (p * q).sum() / np.sqrt((p * p).sum() * (q * q).sum())


def their_similarity(map_, truth):
    return np.minimum(density(min_max(map_)), density(min_max(truth))).sum()


class Faces(protocols_twin_test.Archives):
    def results(self, yaml, data, *further):
        """Tables by name, and maps by model and item."""
        config = self.folder / "config.yaml"
        config.write_text(yaml)
        for subcommand, more in (("run", ["--out", self.folder / "out", *further]), ("export", ["--to", self.folder / "maps", "--format", "maps"])):
            if subcommand == "run" or not further:
                called(subcommand, config, "--data", data, "--cache", self.folder / "cache", *more)
        maps = {(path.parent.name, path.stem): np.loadtxt(path) for path in (self.folder / "maps").glob("*/*.val")}
        return {path.stem: pd.read_csv(path) for path in (self.folder / "out").glob("*.csv")}, maps

    def given(self, maps):
        """A folder of maps that were made elsewhere, by item."""
        folder = self.folder / "given"
        folder.mkdir(exist_ok=True)
        for item, values in maps.items():
            (folder / f"{item}.val").write_text("".join(f"{value!r}\n" for value in values.tolist()))
        return ["--maps", folder, "--name", "GIVEN"]

    def random_set(self):
        """Shapes by item: points, the faces that stay, their values; a face without area and a twin of another stand between them."""
        shapes = {}
        for k in range(3):
            points, faces = bumpy_sphere(k, 12)
            looked = np.where(self.rng.random(len(faces)) < 0.1, np.nan, self.rng.random(len(faces)) ** 3)
            written = np.insert(faces, [7, 30], [[4, 4, 9], faces[3][[1, 2, 0]]], axis=0)
            self.write_mesh(f"off/shape{k}.off", points, written)
            self.write_lines(f"maps/shape{k}.txt", np.insert(np.where(np.isnan(looked), -1, looked), [7, 30], [5, 6]))
            shapes[f"shape{k}"] = points, faces, looked
        return shapes

    def test_random_meshes(self):
        shapes = self.random_set()
        own = self.folder / "own.py"
        own.write_text(PER_FACE)
        tables, maps = self.results(f"dataset: {{layout: {own}, scans: false, score_on: faces}}\n"
                                    "metrics: {names: [auc_top20, cc, cc_area, kl, sim, nss, fne], smoothing: [0, 3]}\n"
                                    "models: {CB: {}, RS: {}}\n", self.data)
        reference = np.mean([np.histogram(min_max(looked[~np.isnan(looked)]), bins=100, density=True)[0] for _, _, looked in shapes.values()],
                            axis=0)
        self.assertEqual(len(tables["results"]), 6)
        for _, row in tables["results"].iterrows():
            points, faces, looked = shapes[row["item"]]
            seen = ~np.isnan(looked)
            map_, truth = maps[row["model"], row["item"]][faces].mean(axis=1), looked[seen]
            by_histogram, read, areas = matched(map_, reference)[seen], min_max(map_)[seen], face_areas(points, faces)[seen]
            p, q = density(read), density(truth)
            self.agree(row, cc=stats.pearsonr(by_histogram, truth)[0],
                       auc_top20=protocols_twin_test.auc_of_upper_fifth(by_histogram, truth), kl=(q * np.log(EPS + q / (EPS + p))).sum(),
                       sim=np.minimum(p, q).sum(), cc_area=weighted_correlation(by_histogram, truth, areas))
            self.assertEqual(row["n_points"], seen.sum())
            self.assertTrue(row[["nss", "fne"]].isna().all(), "nobody picks faces")
        for _, row in tables["smoothed"].query("smoothing == 3").iterrows():
            _, faces, looked = shapes[row["item"]]
            seen = ~np.isnan(looked)
            map_ = smoother_of_faces(faces, 3) @ maps[row["model"], row["item"]][faces].mean(axis=1)
            self.agree(row, cc=stats.pearsonr(matched(map_, reference)[seen], looked[seen])[0])
        for _, row in tables["constant"].iterrows():
            _, _, looked = shapes[row["item"]]
            q = density(looked[~np.isnan(looked)])
            self.agree(row, kl=(q * np.log(EPS + q / (EPS + 1 / len(q)))).sum())
        self.check_report(shapes)

    def check_report(self, shapes):
        """Values of faces are drawn as means around the vertices."""
        maps = self.folder / "maps.h5"
        called("export", self.folder / "config.yaml", "--data", self.data, "--cache", self.folder / "cache", "--pictures", "--to", maps)
        called("report", self.folder / "out", "--export", maps, "--to", self.folder / "report")
        for item, (points, faces, _) in shapes.items():
            self.assertTrue((self.folder / f"report/shapes/{item}.html").is_file())
            drawn = Shapes([maps]).itself(item).maps()
            self.assertEqual({(name, when): len(values) for (name, when), values in drawn.items()},
                             {(name, when): len(points) for name in ("CB", "RS") for when in ("before", "after")})

    # --- real data ----------------------------------------------------------------------------------------------

    def real(self):
        """Points, faces and values per face, by item."""
        if not REAL.is_dir():
            self.skipTest("SALBENCH_DATA has no meshmamba")
        shapes = {}
        for item in ITEMS:
            lines = next(REAL.glob(f"MeshFile/non_texture/*/{item}.obj")).read_text().splitlines()
            points = np.array([line.split()[1:4] for line in lines if line.startswith("v ")], float)
            faces = np.array([[corner.split("/")[0] for corner in line.split()[1:4]] for line in lines if line.startswith("f ")], int) - 1
            shapes[item] = points, faces, np.loadtxt(REAL / f"SaliencyMap/non_texture/{item}.csv")
        return shapes

    def test_distance_from_the_mean_of_the_vertices(self):
        shapes = self.real()
        by_vertex = {item: distances(points) for item, (points, _, _) in shapes.items()}
        expected = {"faces": (2.118, 0.359, 1.043), "vertices": (2.104, 0.351, 1.024), "raw": (1.565, 0.224, 0.804)}
        for case, values in expected.items():
            options = "metrics: [kl, sim]\n" if case != "raw" else "metrics: {names: [kl, sim], matching: raw}\n"
            given = by_vertex if case != "raw" else {item: 0.2 + 0.6 * min_max(map_[shapes[item][1]].mean(axis=1)) for item, map_ in by_vertex.items()}
            yaml = (ALONE.replace("faces", "vertices") if case == "vertices" else ALONE) + options + "models: {RS: {}}\n"
            tables, _ = self.results(yaml, REAL, *self.given(given))
            rows = tables["results"].query("model == 'GIVEN'").set_index("item")
            for item, value in zip(ITEMS, values):
                self.assertAlmostEqual(rows.loc[item, "kl"], value, delta=5e-4, msg=f"{case} {item}")
                _, faces, looked = shapes[item]
                if case == "faces":
                    map_ = given[item][faces].mean(axis=1)
                    self.assertAlmostEqual(rows.loc[item, "kl"], divergence(map_, looked), delta=1e-9)
                    self.assertAlmostEqual(rows.loc[item, "sim"], similarity(map_, looked), delta=1e-9)

    def test_protocol_gives_what_mesh_mambas_evaluation_gives(self):
        shapes = self.real()
        yaml = (protocols_twin_test.ROOT / "configs/protocols/meshmamba.yaml").read_text()
        everywhere = "".join(line for line in yaml.splitlines(True) if not line.startswith("  split:"))
        tables, maps = self.results(everywhere[:everywhere.index("models:")] + "models: {CB: {}, RS: {}}\n", REAL)
        rows, theirs = tables["results"], []
        self.assertEqual(len(rows), 6)
        for _, row in rows.iterrows():
            _, faces, looked = shapes[row["item"]]
            map_, truth = maps[row["model"], row["item"]][faces].mean(axis=1).astype(np.float32), looked.astype(np.float32)
            found = {"cc": their_correlation(map_, truth), "sim_minmax": their_similarity(map_, truth), "kl": their_divergence(map_, truth)}
            for metric, value in found.items():
                theirs.append((row["model"], metric, value))
                self.assertAlmostEqual(row[metric], value, delta=2e-5, msg=f"{row['model']} {row['item']} {metric}")
        means = tables["means"][tables["means"]["split"].isna()].set_index(["model", "metric"])["mean"]
        for key, value in pd.DataFrame(theirs, columns=["model", "metric", "value"]).groupby(["model", "metric"])["value"].mean().items():
            self.assertAlmostEqual(means[key], value, delta=2e-5, msg=f"{key}")
