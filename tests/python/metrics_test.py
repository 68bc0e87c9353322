# SPDX-License-Identifier: GPL-3.0-or-later
"""Metrics as functions: the bytes of the program's tables. Beside other implementations: tests/stages/metrics/metrics_reference.py.
Every area under a ROC curve is what docs/metrics.md says: its positives and negatives, and what a perfect map and its negation get."""

import math
import pathlib
import re
import subprocess
import sys
import tempfile
import textwrap
import unittest

import h5py
import numpy as np

import salbench
import toy
from salbench import _core, metrics
from tests.docs import pages

NAMES = [row.name for row in salbench.metrics.table()]
SEED = 2016


def density_of_others(points, own, of_set):
    """Density of the other shapes' ground truth, at the distance of each point from the centroid."""
    marked, of_points = (np.asarray(of_set[name]) - own[name] for name in ("marked", "points"))
    density = np.divide(marked, of_points, out=np.zeros(100), where=of_points > 0)
    distance = np.linalg.norm(points - points.mean(axis=0), axis=1)
    return density[np.minimum((distance / distance.max() * 100).astype(int), 99)]


def reference_with(bin_, value):
    reference = np.ones(100)
    reference[bin_] = value
    return reference


def same(a, b):
    """Bit for bit, NaN and NaN alike."""
    return np.array_equal(np.float64(a).view(np.uint64), np.float64(b).view(np.uint64)) or (math.isnan(a) and math.isnan(b))


class Tables(unittest.TestCase):
    """Scores of a run, beside those of the same arrays."""

    def compared(self, file):
        """Number of scores."""
        rows = file["scores"][:]
        compared = 0
        for row in rows:
            item, view, model = (row[name].decode() for name in ("item", "view", "model"))
            shape = f"{item}_{view}" if view else item
            level = "scans" if view else "meshes"
            if model not in ("LS", "RS") or f"map.{model}" not in file[shape]:
                continue
            truth = file[shape]["scan_ground_truth" if view else "ground_truth"]
            saliency = truth["saliency"][:] if "saliency" in truth else None
            points = file[shape]["scan"]["points"][:] if view else file[item]["mesh"]["vertices"][:]
            faces = file[shape]["surface"]["faces"][:] if view else file[item]["mesh"]["faces"][:]
            found = salbench.score(
                file[shape][f"map.{model}"]["saliency"][:], saliency, self.picks(truth), metrics="all",
                areas=salbench.vertex_areas(points, faces), points=points, faces=faces,
                negatives=density_of_others(points, file[shape]["centre_density"], file["means/centre_densities"][level]),
                reference=file["means/reference"][level]["density"][:], seed=(SEED, shape))
            for name in NAMES:
                if name.startswith("sauc"):  # its negatives were worked out here
                    self.assertAlmostEqual(found[name], row[name], delta=1e-12)
                else:
                    self.assertTrue(same(found[name], row[name]), f"{shape} {model} {name}: {found[name]!r}, {row[name]!r}")
                compared += 1
        return compared

    def picks(self, truth):
        return np.split(truth["picks"][:], truth["pick_offsets"][1:-1]) if "picks" in truth else None

    def test_no_score_is_beyond_its_range(self):
        """Rounding could put those of a map that is the ground truth itself there."""
        rng, ranges = np.random.default_rng(3), {row[0]: row[5:7] for row in _core.metric_rows()}
        for n in (3, 10, 100):
            for _ in range(100):
                truth = rng.random(n)
                for sign in (1, -1):
                    found = salbench.score(sign * truth, truth, metrics=["cc", "lcc", "spearman", "sim"])
                    for name, value in found.items():
                        self.assertTrue(ranges[name][0] <= value <= ranges[name][1] or value != value, (name, value))

    def test_toy_meshes_and_their_scans(self):
        with tempfile.TemporaryDirectory() as folder:
            config = pathlib.Path(folder, "all.yaml")
            config.write_text("dataset: {layout: folder, participants: simulated}\nscan: {step_degrees: 1}\nmetrics: {names: all}\n"
                              "models: {LS: {}, RS: {}}\n")
            options = ["--data", toy.meshes(f"{folder}/meshes", 2), "--cache", f"{folder}/cache"]
            toy.run(config, *options, "--out", f"{folder}/out")
            toy.export(config, *options, "--to", f"{folder}/all.h5")
            with h5py.File(f"{folder}/all.h5") as file:
                self.assertEqual(self.compared(file), 2 * 13 * 2 * len(NAMES))


class Arguments(unittest.TestCase):
    def setUp(self):
        rng = np.random.default_rng(1)
        self.map, self.truth, self.picks = rng.random(40), rng.random(40), [3, 4, 4, 30]

    def test_types_orders_and_lists_have_the_same_scores(self):
        expected = salbench.score(self.map, self.truth, self.picks)
        double = np.repeat(self.map, 2)[::2]
        for same_map in (self.map.tolist(), self.map[::-1][::-1], double, self.map.astype(">f8"), self.map.astype("longdouble")):
            self.assertEqual(salbench.score(same_map, self.truth, np.array(self.picks, "u1")), expected)
        self.assertNotEqual(salbench.score(self.map.astype("f2"), self.truth, self.picks), expected)

    def test_maps_as_rows_have_a_score_each(self):
        maps = np.stack([self.map, self.truth, np.zeros(40)])
        found = salbench.score(maps, self.truth, self.picks, seed=3)
        for k, row in enumerate(maps):
            alone = salbench.score(row, self.truth, self.picks, seed=3)
            self.assertEqual({name: values[k] for name, values in found.items()}, alone)

    def test_a_metric_is_a_function_of_its_name(self):
        for name in NAMES:
            value = getattr(salbench.metrics, name)(self.map, self.truth, self.picks, seed=5)
            self.assertTrue(same(value, salbench.score(self.map, self.truth, self.picks, metrics=name, seed=5)[name]))

    def test_draws_are_those_of_seed_and_item_whatever_the_model(self):
        auc = [salbench.score(self.map, self.truth, self.picks, seed=seed)["auc"] for seed in ((3, "a"), (3, "LS", "a"), (3, "PS", "a"), (3, "b"))]
        self.assertEqual(auc[:3], [auc[0]] * 3)
        self.assertNotEqual(auc[3], auc[0])
        with self.assertRaisesRegex(ValueError, r"seed must be a number, or \(number, item\)"):
            salbench.score(self.map, self.truth, self.picks, seed=(3,))

    def test_participants_are_arrays_of_their_own(self):
        apart = salbench.score(self.map, None, [[3, 4], [4, 30]], metrics=["nss", "nss_multiplicity"])
        self.assertEqual(apart, salbench.score(self.map, None, self.picks, metrics=["nss", "nss_multiplicity"]))

    def test_without_ground_truth_a_mask_leaves_points_out(self):
        mask = np.arange(40) >= 2
        low, high = self.map.min(), self.map.max()
        whole = (self.map - low) / (high - low)
        self.assertEqual(salbench.metrics.auc_exact(self.map, None, self.picks, mask=mask),
                         salbench.metrics.auc_exact(whole[2:], None, np.array(self.picks) - 2))

    def test_a_histogram_is_of_points_that_somebody_saw(self):
        np.testing.assert_array_equal(salbench.histogram([0.2, np.nan, 1, 0.4]), salbench.histogram([0.2, 1, 0.4]))

    def test_a_reference_stands_for_the_density_of_its_shape(self):
        """As a column of a file does (tests/e2e/reference_test.py)."""
        density = np.linspace(2, 0.02, 100) / np.linspace(2, 0.02, 100).sum() * 100
        for factor in (0.01, 7.0, 1e-200):
            with self.subTest(factor), self.assertLogs("salbench", "WARNING") as logged:
                np.testing.assert_allclose(salbench.match_histogram(self.map, density * factor),
                                           salbench.match_histogram(self.map, density), rtol=0, atol=1e-12)
            self.assertRegex(logged.output[0], "reference sums to .*, densities over 100 bins to 100: it was scaled")
        rounded = density * 1.0001  # of few digits
        with self.assertNoLogs("salbench", "WARNING"):
            self.assertFalse(np.array_equal(salbench.match_histogram(self.map, rounded), salbench.match_histogram(self.map, density)))
        counts = np.arange(100)
        with self.assertLogs("salbench", "WARNING"):
            scores = salbench.score(self.map, self.truth, self.picks, reference=counts, metrics=["nss", "cc"])
        self.assertEqual(scores, salbench.score(self.map, self.truth, self.picks, reference=counts / counts.sum() * 100, metrics=["nss", "cc"]))

    def test_what_cannot_be_used_is_named(self):
        score, match, map_, column = salbench.score, salbench.match_histogram, self.map, self.map[:, None]
        for error, named, *calls in [
            (ValueError, "^prediction", lambda: score(3.0), lambda: score(map_ * 1j), lambda: score(column, self.truth),
             lambda: score(column, None, self.picks),
             lambda: score(np.tile(column, 3), mask=map_ > 0), lambda: score(np.r_[map_, np.nan], np.r_[self.truth, 1])),
            (ValueError, r"^ground_truth.*\(40,\).*\(39,\)", lambda: score(map_, self.truth[1:])),
            (ValueError, "^mask", lambda: score(map_, mask=self.picks * 10)),
            (ValueError, "^picks.* 39.* 40", lambda: score(map_, None, [40])), (ValueError, "^picks.*-1", lambda: score(map_, None, [-1])),
            (ValueError, "^picks.*float64", lambda: score(map_, None, [1.0])),
            (ValueError, "^faces.* 39.* 40", lambda: score(map_, faces=[[0, 1, 40]])),
            (ValueError, "^reference", lambda: score(map_, reference=[1, 2]), lambda: score(map_, reference=np.zeros(100)),
             lambda: match(map_, np.full(100, 1e307))), (ValueError, "^reference.*-0.5.* 7", lambda: score(map_, reference=reference_with(7, -0.5))),
            (ValueError, "^reference.*nan.* 8", lambda: match(map_, reference_with(8, math.nan))),
            (ValueError, "^reference.*inf.* 99", lambda: match(map_, reference_with(99, math.inf))),
            (ValueError, "^areas", lambda: score(map_, areas=-map_)),
            (ValueError, "^negatives", lambda: score(map_, negatives=-map_), lambda: score(map_, negatives=map_[1:])),
            (ValueError, "tolerance", lambda: score(map_, tolerance=0)), (ValueError, "floor", lambda: score(map_, floor=1.5)),
            (ValueError, "splits", lambda: score(map_, splits=0)), (TypeError, "'splits'", lambda: score(map_, split=3)),
            (KeyError, "'aucs'.*'auc'", lambda: score(map_, metrics=["aucs"])), (KeyError, "'AUC'.*'auc'", lambda: score(map_, metrics="AUC")),
            (KeyError, "'XX'\"", lambda: score(map_, metrics="XX")),
        ]:
            for call in calls:
                with self.subTest(named), self.assertRaisesRegex(error, named):
                    call()

    def test_a_truth_in_place_of_the_map_is_refused(self):
        unseen = np.where(np.arange(40) % 9 == 0, math.nan, self.truth)
        shape = salbench.Shape("1", np.eye(40, 3), ground_truth=unseen)
        for what, arguments in [
            ("prediction must be a map, not a Shape", (shape, self.map)),
            ("prediction must be a map, not a Shape", (shape,)),
            ("prediction must be finite: a ground truth alone is NaN where nobody looked", (unseen, self.map)),
            (r"ground_truth must have shape \(40,\), not \(3, 40\): several maps are a prediction", (self.truth, np.tile(self.map, (3, 1)))),
        ]:
            for function in (salbench.score, salbench.metrics.cc, salbench.metrics.kl):
                with self.subTest(what, function=function), self.assertRaisesRegex(ValueError, f"^{what}; the map comes first, then ground_truth"):
                    function(*arguments)
        self.assertEqual(salbench.metrics.cc(np.tile(self.map, (3, 1)), ground_truth=unseen).shape, (3,))

    def test_no_surface_is_built_that_no_metric_reads(self):
        """Its graph takes more memory than all else here: the most that a process has had tells whether it was there."""
        script = r"""
            import re, sys, numpy, salbench
            side = 500
            points = numpy.stack([*numpy.mgrid[:side, :side], numpy.zeros((side, side))], -1).reshape(-1, 3).astype(float)
            corner = numpy.arange(side * side).reshape(side, side)[:-1, :-1].ravel()
            faces = numpy.vstack([numpy.stack([corner, corner + side, corner + 1], 1), numpy.stack([corner + side, corner + side + 1, corner + 1], 1)])
            salbench.score(points[:, 0], points[:, 1], [3], points=points, faces=faces, metrics=[sys.argv[1]])
            print(re.search(r"VmHWM:\s*(\d+)", open("/proc/self/status").read())[1])
            """
        most = {metric: int(subprocess.run([sys.executable, "-B", "-c", textwrap.dedent(script), metric], capture_output=True, text=True,
                                           check=True).stdout) for metric in ("lcc", "fne")}
        self.assertGreater(most["fne"], most["lcc"] + 10_000)  # KiB


N = 300
DRAW = np.random.default_rng(5)
G = DRAW.random(N) ** 4
PICKS = np.append(DRAW.choice(np.arange(1, N), 14, replace=False), [40, 40, 41, 41])  # points that several people picked
F = np.bincount(PICKS, minlength=N) > 0
OF_OTHERS = DRAW.random(N)  # density of the other shapes' ground truth
TOP = G > np.sort(G)[-61]
ALL = np.ones(N)
WEIGHTS = {"auc": (F, ALL), "auc_exact": (F, ~F), "auc_all": (np.bincount(PICKS, minlength=N), ALL), "auc_judd": (F, ~F), "auc_borji": (F, ALL),
           "auc_top20": (TOP, ~TOP), "sauc": (F, OF_OTHERS)}  # positives, negatives
PAIRS = ("auc_exact", "auc_all", "auc_top20", "sauc")  # shares of pairs; others are areas of coarser curves
DRAWN = ("auc", "auc_borji")


def score(name, saliency):
    own = {"ground_truth": G} if name == "auc_top20" else {"picks": PICKS}
    return salbench.score(saliency, metrics=name, splits=4000 if name in DRAWN else 1, **own, **({"negatives": OF_OTHERS} if name == "sauc" else {}))[name]


def share_of_pairs(saliency, positive, negative):
    higher = np.sign(saliency[:, None] - saliency) / 2 + .5
    return positive @ higher @ negative / (np.sum(positive) * np.sum(negative))


def page():
    """Name -> what a perfect map and its negation get, as the page says."""
    text = (pages.ROOT / "docs/metrics.md").read_text(encoding="utf-8").split("### Areas under ROC curves")[1].split("\n### ")[0]
    return {name: ends for name, *ends in re.findall(r"^\| `(\w+)` \|.*\| ([^|]+) \| ([^|]+) \|$", text, re.MULTILINE)}


class Areas(unittest.TestCase):
    def test_the_page_has_all(self):
        self.assertEqual(set(page()), {row.name for row in metrics.table() if "auc" in row.name})
        self.assertEqual(set(WEIGHTS), set(page()))

    def test_a_perfect_map_and_its_negation_get_what_the_page_says(self):
        for name, said in page().items():
            positive, negative = (np.asarray(weights, dtype=float) for weights in WEIGHTS[name])
            q = negative[positive > 0].sum() / negative.sum()
            perfect = G if name == "auc_top20" else F.astype(float)
            for saliency, words in zip((perfect, -perfect), said):
                expected = {"1 - q/2": 1 - q / 2, "q/2": q / 2, "1": 1, "0": 0, "1/2": .5}[words]
                self.assertAlmostEqual(score(name, saliency), expected, delta=.002 if name in DRAWN else 1e-12, msg=(name, words))

    def test_shares_of_pairs_have_the_negatives_that_the_page_says(self):
        saliency = np.round(DRAW.random(N) + .3 * F, 1)  # with ties
        for name in PAIRS:
            self.assertAlmostEqual(score(name, saliency), share_of_pairs(saliency, *WEIGHTS[name]), delta=1e-12, msg=name)

    def test_curves_are_near_the_share_of_pairs(self):
        saliency = DRAW.random(N) + .3 * F
        for name in set(WEIGHTS) - set(PAIRS):
            self.assertAlmostEqual(score(name, saliency), share_of_pairs(saliency, *WEIGHTS[name]), delta=.03, msg=name)

    def test_judds_curve_of_picks_without_ties_ends_above_0(self):
        saliency = np.where(F, -1 - DRAW.random(N), 0)
        self.assertAlmostEqual(score("auc_judd", saliency), 1 / (2 * F.sum()), delta=1e-12)
