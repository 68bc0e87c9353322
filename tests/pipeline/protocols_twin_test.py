# SPDX-License-Identifier: GPL-3.0-or-later
"""Scores by configs/protocols/ beside NumPy, SciPy and scikit-learn, which read the published files themselves: a miniature of each
public archive in its published names. Of the program only the maps are taken. What `salbench import` makes of the archive gives its tables,
byte by byte; what is written and refused there is tested in tests/datasets."""

import re
import tempfile
import unittest
from pathlib import Path

import h5py
import numpy as np
import pandas as pd
from scipy import spatial, stats
from sklearn import metrics

import salbench.conclusions  # noqa: F401  and with it libraries that each call would import
from tests.support import forked
from tests.support.without_figures import never_drawn

ROOT = Path(__file__).resolve().parents[2]
LAYOUT = r"(?m)^(dataset: {|  )layout: (\w+)"
EPS = 2.2204e-16  # as code_forMetrics/KLdiv.m has MATLAB's eps


def called(*words):
    done = forked.salbench(*words, "--quiet", before=lambda: never_drawn(words))
    assert (done.returncode, done.stdout) == (0, ""), done.stderr


def bumpy_sphere(seed, n=16):
    """A grid of longitudes and latitudes with a pole at each end; every corner is used."""
    rng = np.random.default_rng(seed)
    longitude, latitude = np.meshgrid(np.arange(n) * 2 * np.pi / n, np.pi * (np.arange(1, n) / n - 0.5))
    points = np.stack([np.cos(longitude) * np.cos(latitude), np.sin(longitude) * np.cos(latitude), np.sin(latitude)], -1).reshape(-1, 3)
    points = np.vstack([points, [[0, 0, -1], [0, 0, 1]]])
    points *= (1 + 0.1 * np.sin(points @ rng.normal(size=(3, 2)) * 4).sum(1))[:, None]
    faces = []
    for i in range(n):
        j = (i + 1) % n
        faces += [(j, i, len(points) - 2), ((n - 2) * n + i, (n - 2) * n + j, len(points) - 1)]
        for k in range(n - 2):
            faces += [(k * n + i, k * n + j, (k + 1) * n + j), (k * n + i, (k + 1) * n + j, (k + 1) * n + i)]
    return points, np.array(faces)


def density(field):
    return field / field.sum()


def min_max(field):
    return (field - field.min()) / (field.max() - field.min())


def divergence(map_, truth):
    """MIT's benchmark of saliency models."""
    p, q = density(min_max(map_)), density(truth)
    return (q * np.log(EPS + q / (EPS + p))).sum()


def smoothed_divergence(map_, truth):
    """1e-12 added to both before they are made densities, as in many programs for training."""
    p, q = density(min_max(map_) + 1e-12), density(truth + 1e-12)
    return (q * np.log(q / p)).sum()


def similarity(map_, truth):
    return np.minimum(density(min_max(map_)), density(truth)).sum()


def auc_of_upper_fifth(map_, truth):
    positives = np.zeros(len(truth), bool)
    positives[np.argsort(truth)[-int(np.ceil(0.2 * len(truth))):]] = True
    return metrics.roc_auc_score(positives, map_)


def distances(points):
    """From the centroid, as a fraction of the largest."""
    lengths = np.linalg.norm(points - points.mean(axis=0), axis=1)
    return lengths / lengths.max()


def vertex_areas(points, faces):
    return np.bincount(faces.ravel(), np.repeat(face_areas(points, faces) / 3, 3), len(points))


def correlation(map_, truth):
    return stats.pearsonr(map_, truth)[0]


def weighted_correlation(map_, truth, weights):
    covariance = np.cov(map_, truth, aweights=weights, bias=True)
    return covariance[0, 1] / np.sqrt(covariance[0, 0] * covariance[1, 1])


def face_areas(points, faces):
    corners = points[faces]
    return np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2


def disc_densities(points):
    """16 points over the area of the disc that the nearest 16 other ones lie in, per squared radius of the shape."""
    reach = spatial.cKDTree(points).query(points, 17)[0][:, 16]
    return 16 / (np.pi * reach**2) * squared_radius(points)


def squared_radius(points):
    return ((points - points.mean(axis=0)) ** 2).sum(axis=1).max()


def matched(map_, reference):
    """Values moved through two cumulative histograms. [tasse2016]"""
    heights, edges = np.histogram(min_max(map_), bins=100, density=True)
    own, wanted = np.r_[0, heights.cumsum()], np.r_[0, reference.cumsum()]
    return min_max(np.interp(min_max(map_), edges, np.interp(own, wanted, edges)))


def sampled_aucs(map_, picks, rng, splits):
    """The comparison's AUC, split by split: as many negatives as picks, 20 thresholds."""
    high = map_[np.unique(picks)]
    for _ in range(splits):
        low = map_[rng.integers(1, len(map_), len(high))]
        at = np.linspace(0, max(high.max(), low.max()), 20)[:, None]
        true, false = np.r_[1, (high >= at).mean(1), 0], np.r_[1, (low >= at).mean(1), 0]
        yield metrics.auc(false, true)


def auc_of_picks(map_, picks):
    labels = np.zeros(len(map_))
    labels[np.unique(picks)] = 1
    return metrics.roc_auc_score(labels, map_)


def nss(map_, picks):
    return ((map_ - map_.mean()) / map_.std())[np.unique(picks)].mean()


class Archives(unittest.TestCase):
    """Writes miniatures of archives, and scores them."""

    def setUp(self):
        holder = tempfile.TemporaryDirectory()
        self.addCleanup(holder.cleanup)
        self.folder = Path(holder.name)
        self.data = self.folder / "data"
        self.rng = np.random.default_rng(1)

    def write(self, name, text):
        path = self.data / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)

    def write_mesh(self, name, points, faces):
        """With all digits: what is read are these very points."""
        lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in points.tolist()] + [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in faces]
        if name.endswith(".off"):
            lines = ["OFF", f"{len(points)} {len(faces)} 0"]
            lines += [f"{x!r} {y!r} {z!r}" for x, y, z in points.tolist()] + [f"3 {a} {b} {c}" for a, b, c in faces]
        self.write(name, "\n".join(lines) + "\n")

    def write_lines(self, name, values):
        self.write(name, "".join(f"{value}\n" for value in np.asarray(values).tolist()))

    def agree(self, row, **expected):
        for metric, value in expected.items():
            self.assertAlmostEqual(row[metric], value, delta=1e-9, msg=f"{row['model']} {row['item']} {metric}")


class Protocols(Archives):
    """Each archive as it is published, and converted."""

    def configured(self, protocol, layout=None):
        text = (ROOT / f"configs/protocols/{protocol}.yaml").read_text()
        file = self.folder / "protocol.yaml"
        file.write_text(text if layout is None else re.sub(LAYOUT, rf"\1layout: {layout}", text))
        return file

    def tables(self, config, data, out):
        called("run", config, "--data", data, "--cache", self.folder / "cache", "--out", out)
        not_of_scores = ("costs.csv", "published.csv")  # that one is of a layout: in one form nothing says what a set once was
        return {path.name: path.read_bytes() for path in out.glob("*.csv") if path.name not in not_of_scores}

    def scored(self, protocol):
        """The table of scores, and maps by model and item. The set gives the same tables once it is converted."""
        layout = re.search(LAYOUT, self.configured(protocol).read_text())[2]
        expected = self.tables(self.configured(protocol), self.data, self.folder / "tables")
        self.converted = self.folder / "one_form"
        called("import", layout, "--data", self.data, "--to", self.converted)
        found = self.tables(self.configured(protocol, "hdf5"), self.converted, self.folder / "out")
        self.assertIn("results.csv", expected)
        self.assertEqual(found.keys(), expected.keys())
        for name, table in expected.items():
            self.assertEqual(found[name], table, name)
        called("export", self.configured(protocol, "hdf5"), "--data", self.converted, "--cache", self.folder / "cache",
                      "--to", self.folder / "maps", "--format", "maps")
        found = {(path.parent.name, path.stem): np.loadtxt(path) for path in (self.folder / "maps").glob("*/*.val")}
        return pd.read_csv(self.folder / "out/results.csv", dtype={"item": str, "view": str}), found

    def item(self, name):
        """As it was converted."""
        file = h5py.File(self.converted / f"items/{name}.h5")
        self.addCleanup(file.close)
        return file

    def test_3dva(self):
        truth = {}
        for k, mesh in enumerate(("bunny", "dragon", "horse")):
            points, faces = bumpy_sphere(k)
            self.write_mesh(f"3DModels-Simplif/{mesh}.obj", points, faces)
            for view in (300, 413, 599):
                seen = points @ self.rng.normal(size=3) > -0.2
                looked = np.where(seen, self.rng.random(len(points)), 0)
                truth[mesh, str(view)] = looked, seen
                self.write_lines(f"FixationMaps/{mesh}_{view}norm.txt", looked)
                self.write_lines(f"CentricityAndVisibilityMaps/{mesh}_{view}_visibility.txt", seen.astype(int))
        table, maps = self.scored("3dva")
        self.assertEqual(len(table), len({model for model, _ in maps}) * 9)
        for _, row in table.iterrows():
            looked, seen = truth[row["item"], row["view"]]
            map_ = maps[row["model"], f"{row['item']}_{row['view']}"]
            self.assertEqual(row["n_points"], seen.sum())
            self.agree(row, cc=correlation(map_[seen], looked[seen]), auc_top20=auc_of_upper_fifth(map_[seen], looked[seen]))
        for (mesh, view), (looked, seen) in truth.items():  # converted, views keep what their masks hide
            group = self.item(mesh)[f"views/{view}"]
            np.testing.assert_array_equal(group["saliency"][:], np.where(seen, looked, np.nan))

    def test_sal3d(self):
        truth, points_of = {}, {}
        for k, mesh in enumerate(("cat", "cow", "dog", "horse")):
            points, _ = bumpy_sphere(k)
            points_of[mesh] = points
            truth[mesh] = np.maximum(0, self.rng.normal(size=len(points)))
            rows = np.column_stack([points, 6.28 * points, truth[mesh], truth[mesh] > 1])
            self.write(f"Gaze/{mesh}.txt", "".join(" ".join(map(repr, row)) + "\n" for row in rows.tolist()))
        self.write("splits.csv", "item,split\ncat,train\ncow,test\ndog,val\nhorse,test\n")
        table, maps = self.scored("sal3d")
        self.assertEqual(set(table["item"]), {"cow", "horse"})
        self.assertEqual(set(table["split"]), {"test"})
        for _, row in table.iterrows():
            looked, map_ = truth[row["item"]], maps[row["model"], row["item"]]
            self.agree(row, cc=correlation(map_, looked), kl=divergence(map_, looked), kl_smoothed=smoothed_divergence(map_, looked),
                       sim=similarity(map_, looked))
        for item in ("cow", "horse"):
            np.testing.assert_allclose(maps["SD", item], disc_densities(points_of[item]), rtol=1e-9)

    def test_schelling(self):
        truth = {}
        for k in range(1, 4):
            points, faces = bumpy_sphere(k)
            self.write_mesh(f"Meshes/{k}.off", points, faces)
            picks = [np.sort(self.rng.choice(len(points), 12, replace=False)) for _ in range(3)]
            truth[str(k)] = self.rng.random(len(points)) ** 3, np.concatenate(picks)
            self.write_lines(f"Distributions/{k}.val", truth[str(k)][0])
            for participant, picked in enumerate(picks):
                self.write_lines(f"RawData/{k}_{participant}.pid", picked)
        reference = np.mean([np.histogram(min_max(values), bins=100, density=True)[0] for values, _ in truth.values()], axis=0)
        table, maps = self.scored("schelling")
        table = table[table["model"] != "HS"]  # people, not maps
        self.assertEqual(len(table), len({model for model, _ in maps}) * 3)
        for _, row in table.iterrows():
            values, picks = truth[row["item"]]
            map_ = matched(maps[row["model"], row["item"]], reference)
            self.agree(row, nss=nss(map_, picks), lcc=abs(correlation(map_, values)))
            drawn = np.array(list(sampled_aucs(map_, picks, self.rng, 400)))  # by other draws: 100 there, 400 here
            self.assertAlmostEqual(row["auc"], drawn.mean(), delta=5 * drawn.std() * (1 / 100 + 1 / 400) ** 0.5)

    def test_meshmamba(self):
        truth, paths, faces_of, points_of = {}, "", {}, {}
        for k in range(5):
            mesh = f"Apple_v{k}"
            points, faces = bumpy_sphere(k)
            self.write_mesh(f"MeshFile/non_texture/Apple/{mesh}.obj", points, faces)
            paths += f"MeshFile/rgb_texture/Apple/{mesh}.obj\n"
            faces_of[mesh], truth[mesh], points_of[mesh] = faces, self.rng.random(len(faces)), points
            self.write_lines(f"SaliencyMap/non_texture/{mesh}.csv", truth[mesh])
        self.write("paths_dataset_rgb.txt", paths)
        table, maps = self.scored("meshmamba")
        self.assertEqual(set(table["item"]), {"Apple_v2", "Apple_v3", "Apple_v4"})
        for _, row in table.iterrows():
            points, faces, looked = points_of[row["item"]], faces_of[row["item"]], truth[row["item"]]
            map_ = maps[row["model"], row["item"]][faces].mean(axis=1)
            p, q = density(map_ - min(map_.min(), 0)), density(looked)
            self.agree(row, cc=correlation(map_, looked), cc_area=weighted_correlation(map_, looked, face_areas(points, faces)),
                       kl=(q * np.log(EPS + q / (EPS + p))).sum(), sim_minmax=similarity(map_, min_max(looked)))
        for mesh in sorted(set(table["item"])):
            points = points_of[mesh]
            np.testing.assert_allclose(maps["SD", mesh], squared_radius(points) / vertex_areas(points, faces_of[mesh]), rtol=1e-9)
        np.testing.assert_array_equal(self.item("Apple_v4")["truth/faces"][:], truth["Apple_v4"])
        index = pd.read_csv(self.converted / "index.csv")
        self.assertEqual(index["split"].tolist(), ["train+train_80"] * 2 + ["train+test+train_80", "test+train_80", "test+test_20"])

    def test_zaragoza(self):
        points, faces = bumpy_sphere(0)
        self.write_mesh("Meshes/bimba.off", points, faces)
        looked, picks = self.rng.random(len(points)), np.sort(self.rng.choice(len(points), 20, replace=False))
        self.write_lines("Distributions/bimba.val", looked)
        self.write_lines("RawData/bimba_0.pid", picks)
        table, maps = self.scored("zaragoza")
        for _, row in table.iterrows():
            map_ = maps[row["model"], row["item"]]
            self.agree(row, cc=correlation(map_, looked), kl=divergence(map_, looked), kl_smoothed=smoothed_divergence(map_, looked),
                       sim=similarity(map_, looked), auc_exact=auc_of_picks(map_, picks), nss=nss(map_, picks))
