# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables of `salbench conclusions` beside pandas, SciPy and statsmodels, which know nothing of the program: random tables with ties,
gaps, unequal numbers of views and equal models, and the real items where they are."""

import itertools
import os
import subprocess
import tempfile
import unittest
from pathlib import Path

import numpy as np
import pandas as pd
import statsmodels.api as sm
from scipy import special, stats
from statsmodels.stats.multitest import multipletests
from statsmodels.stats.proportion import proportion_confint
from statsmodels.stats.weightstats import DescrStatsW

PROGRAM = os.environ["SALBENCH_PROGRAM"]
DATA = os.environ.get("SALBENCH_DATA", "")
METRICS = ("auc", "nss", "cc")
REFERENCES = ("HS", "RS")
TABLES, PER_FILE = 204, 6  # two data sets of three metrics


def random_scores(rng):
    """Rows of a score table. Meshes differ, views of them less; some scores are rounded, so that they tie, and some are missing."""
    models = ["A", "B", "C", "HS", "RS"][:rng.integers(2, 6)]
    step, missing = rng.choice([0, 0.1, 0.5]), rng.choice([0, 0, 0.1])
    rows = []
    for mesh in range(rng.integers(2, 26)):
        of_mesh = rng.normal(size=(1 + len(models), len(METRICS)))
        for view in ["", *range(rng.integers(1, 6))]:
            for m, model in enumerate(models):
                values = of_mesh[0] + 0.5 * of_mesh[1 + m] + 0.3 * rng.normal(size=len(METRICS)) + 0.2 * m
                if step:
                    values = step * np.round(values / step)
                values[rng.random(len(METRICS)) < missing] = np.nan
                rows.append((mesh, view, model, *values))
    return pd.DataFrame(rows, columns=["item", "view", "model", *METRICS])


def critical_t(freedom, confidence):
    """By the incomplete beta function: stats.t.ppf, which statsmodels uses, has only nine digits in SciPy 1.10."""
    beta = special.betaincinv(freedom / 2, 0.5, 1 - confidence)
    return np.sqrt(freedom * (1 - beta) / beta)


def around(mean, error, n, confidence=0.95):
    half = critical_t(n - 1, confidence) * error
    return mean - half, mean + half


def by_mesh(scores, models):
    """Means over the views of a mesh that all of them have scores for, one column per model. Added up one by one: pandas, and
    Python's sum() since 3.12, round otherwise, and ties of means hang on it."""
    shapes = scores[list(models)].dropna()
    return shapes.groupby(level="item", sort=False).agg(lambda values: np.cumsum(values.to_numpy())[-1] / len(values))


def pair(wide, competitors, a, b):
    """What significance.csv says of a - b, but for Holm's correction."""
    shapes = wide[list(dict.fromkeys([a, b, *competitors]))].dropna()
    means = by_mesh(shapes, [a, b])
    d = (means[a] - means[b]).to_numpy()
    found = {"n": len(d), "n_shapes": len(shapes), "mean_difference": d.mean() if len(d) else np.nan}
    z, p = stats.ranksums(wide[a].dropna(), wide[b].dropna())
    found |= {"rank_sum_z": z, "rank_sum_p": p}
    if len(d) < 2:
        return found
    wins = np.mean(d > 0) + np.mean(d == 0) / 2
    low, high = proportion_confint(wins * len(d), len(d), method="wilson")
    ranks = stats.rankdata(np.abs(d[d != 0]))
    found |= {"superiority": wins, "superiority_low": low, "superiority_high": high,
              "rank_biserial": (ranks * np.sign(d[d != 0])).sum() / ranks.sum() if len(ranks) else 0}
    found["signed_rank"], found["signed_rank_p"] = signed_rank(means[a], means[b])
    if d.std(ddof=1) > 0:
        described = DescrStatsW(d)
        (found["ci95_low"], found["ci95_high"]), (found["ci90_low"], found["ci90_high"]) = (
            around(d.mean(), described.std_mean, len(d), confidence) for confidence in (0.95, 0.9))
        found |= {"t_p": described.ttest_mean(0)[1], "d_z": d.mean() / d.std(ddof=1)}
    return found


def signed_rank(x, y):
    difference = (x - y).to_numpy()
    if not difference.any():
        return 0, 1
    sizes = np.abs(difference)
    # SciPy before 1.11 takes the exact distribution for tied differences too, where it does not hold.
    exact = len(x) <= 50 and len(np.unique(sizes)) == len(sizes) and sizes.min() > 0
    return stats.wilcoxon(x, y, zero_method="wilcox", correction=False, method="exact" if exact else "approx")


def clustered(shapes, a, b):
    """The 95 % interval of a - b with standard errors that are robust to clusters, over meshes of equally many views."""
    d = (shapes[a] - shapes[b]).to_numpy()
    mesh = pd.factorize(shapes.index.get_level_values("item"))[0]
    fit = sm.OLS(d, np.ones(len(d))).fit(cov_type="cluster", cov_kwds={"groups": mesh, "df_correction": True}, use_t=True)
    return around(fit.params[0], fit.bse[0], mesh.max() + 1)


class ConclusionsTwinTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def equal(self, ours, theirs, where):
        for column, value in theirs.items():
            known, found = value == value, ours[column]
            self.assertEqual(known, found == found, (where, column, value, found))
            if known:
                self.assertLess(abs(found - value), 1e-9 * max(1, abs(value)), (where, column, value, found))

    def compare(self, scores):
        """All tables of a score table, and the number of its data sets and metrics."""
        file = self.folder / "scores.csv"
        scores.to_csv(file, index=False)
        subprocess.run([PROGRAM, "conclusions", file, "--out", self.folder / "out", "--quiet"], check=True)
        read = {name: pd.read_csv(self.folder / "out" / f"{name}.csv", keep_default_na=False, na_values=[""])
                for name in ("summary", "significance", "ranking")}
        scores = scores.assign(view=scores["view"].astype(str), dataset=np.where(scores["view"] == "", "meshes", "scans"))
        count = 0
        for (dataset, rows), metric in itertools.product(scores.groupby("dataset", sort=False), METRICS):
            wide = rows.pivot(index=["item", "view"], columns="model", values=metric)[list(dict.fromkeys(rows["model"]))]
            tables = {name: table[(table["dataset"] == dataset) & (table["metric"] == metric)] for name, table in read.items()}
            self.compare_tables(wide, tables, f"{dataset} {metric}")
            count += 1
        return count

    def compare_tables(self, wide, tables, where):
        scored = [model for model in wide if wide[model].notna().any()]
        competitors = [model for model in scored if model not in REFERENCES]
        for row in tables["summary"].to_dict("records"):
            self.compare_means(wide, competitors, row, where)
        holm = []
        for row, (a, b) in zip(tables["significance"].to_dict("records"), itertools.combinations(scored, 2), strict=True):
            self.assertEqual((row["model_a"], row["model_b"]), (a, b))
            self.equal(row, pair(wide, competitors, a, b), f"{where} {a} {b}")
            if row["signed_rank_p"] == row["signed_rank_p"]:
                holm.append((row["signed_rank_p"], row["signed_rank_p_holm"]))
            self.compare_clusters(wide, competitors, row, where)
        if holm:
            p, ours = zip(*holm)
            np.testing.assert_allclose(ours, multipletests(p, method="holm")[1], atol=1e-12)
        ranked = tables["ranking"].set_index("model")["mean"]
        self.assertEqual(list(ranked.sort_values(ascending=False, kind="stable")), list(ranked))

    def compare_means(self, wide, competitors, row, where):
        model = row["model"]
        compared = by_mesh(wide.dropna(subset=competitors), [model])[model].to_numpy()
        own = by_mesh(wide, [model])[model]
        theirs = {"n": len(compared), "own_mean": own.mean(), "n_own_shapes": wide[model].notna().sum(), "mean": np.nan,
                  "sd": np.nan, "ci95_low": np.nan, "ci95_high": np.nan}
        if len(compared):
            theirs["mean"] = compared.mean()
        if len(compared) > 1:
            theirs["sd"] = compared.std(ddof=1)
            if theirs["sd"] > 1e-12:
                theirs["ci95_low"], theirs["ci95_high"] = around(compared.mean(), stats.sem(compared), len(compared))
        self.equal(row, theirs, f"{where} {model}")

    def compare_clusters(self, wide, competitors, row, where):
        shapes = wide[list(dict.fromkeys([row["model_a"], row["model_b"], *competitors]))].dropna()
        views = shapes.groupby(level="item").size()
        if row["ci95_low"] == row["ci95_low"] and views.nunique() == 1:
            low, high = clustered(shapes, row["model_a"], row["model_b"])
            self.equal(row, {"ci95_low": low, "ci95_high": high}, f"{where} clustered")

    def test_random_tables(self):
        count = sum(self.compare(random_scores(np.random.default_rng(seed))) for seed in range(TABLES // PER_FILE))
        self.assertGreaterEqual(count, 200)

    def test_bootstrap_intervals_within_the_error_of_resampling(self):
        rng = np.random.default_rng(1)
        scores = random_scores(rng)
        scores = pd.DataFrame([(mesh, "", model, value, 0.0, 0.0) for model, skewed in (("A", rng.normal), ("B", rng.exponential))
                               for mesh, value in enumerate(skewed(size=25))], columns=scores.columns)
        self.compare(scores)
        summary = pd.read_csv(self.folder / "out/summary.csv")
        for row in summary[summary["metric"] == "auc"].to_dict("records"):
            sample = scores.loc[scores["model"] == row["model"], "auc"].to_numpy()
            twin = stats.bootstrap((sample,), np.mean, n_resamples=10000, method="BCa", random_state=1).confidence_interval
            # Four standard errors of the difference of two quantiles at .025, of 10 000 resamples each.
            allowed = 4 * np.sqrt(2 * 0.025 * 0.975 / 10000) / stats.norm.pdf(1.96) * stats.sem(sample)
            self.assertLess(abs(row["bca95_low"] - twin.low), allowed)
            self.assertLess(abs(row["bca95_high"] - twin.high), 2 * allowed)  # the tail is thin there

    @unittest.skipUnless(DATA and (Path(DATA) / "reference").is_dir(), "the real data is not here: set SALBENCH_DATA")
    def test_the_published_scores(self):
        for name in ("published_all_scores.csv", "published_all_scans.csv"):
            scores = pd.read_csv(Path(DATA) / "reference" / name)
            if "view" not in scores:
                scores.insert(1, "view", "")
            self.assertEqual(self.compare(scores), len(METRICS))


if __name__ == "__main__":
    unittest.main()
