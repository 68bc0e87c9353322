# SPDX-License-Identifier: GPL-3.0-or-later
# Run by scripts/fidelity.
"""Compares the tables and maps that scripts/fidelity has made with what was published; see there."""

import sys
from pathlib import Path

import h5py
import numpy as np
import pandas as pd
from scipy import stats

import published

data, work = Path(sys.argv[1]), Path(sys.argv[2])
reference = data / "reference"
figures = []

# Aims of the scans: how far a mean may lie from the published one, and the least r scan by scan.
SCAN_MEANS = {(model, metric): 0.015 for model in ["CS", "PS"] for metric in ["nss", "cc"]}
SCAN_R = {("PS", "nss"): 0.86, ("PS", "cc"): 0.87, ("LS", "nss"): 0.78}


def figure(what, value, aim, reached):
    """One line: what was measured, the value, its aim in words, and whether it is reached (None: no aim)."""
    figures.append((what, value, aim, {True: "hit", False: "MISS", None: ""}[None if reached is None else bool(reached)]))


def at_most(what, value, limit):
    figure(what, value, f"<= {limit}", value <= limit)


def at_least(what, value, limit):
    figure(what, value, f">= {limit}", value >= limit)


def results(run):
    return published.results(work / run)


def read_map(path):
    return np.array(Path(path).read_text().split(), dtype=float)


def unit(values):
    return (values - values.min()) / (values.max() - values.min())


def mesh_scores():
    ours = results("meshes").set_index(["item", "model"])
    theirs = pd.read_csv(reference / "published_scores.csv", dtype={"item": str}).set_index(["item", "model"])
    both = ours.join(theirs, rsuffix="_published", how="inner")
    for model, limit in [("PS", 0.005), ("LS", 0.01), ("MS", 0.04)]:
        rows = both.xs(model, level="model")
        for metric in ["nss", "cc"]:
            error = (rows[metric] - rows[f"{metric}_published"]).abs().mean()
            at_most(f"{model}: mean |{metric.upper()} - published|, {len(rows)} meshes", error, limit)
    complete = theirs.groupby(level="item").size()
    items = complete[complete >= 4].index
    both = both.loc[both.index.get_level_values("item").isin(items)]
    means = both.groupby(level="model").mean(numeric_only=True)
    for model, limit in [("LS", 0.005), ("CS", 0.005), ("PS", 0.005), ("MS", 0.02)]:
        at_most(f"{model}: |mean AUC - published mean|, {len(items)} meshes",
                abs(means.auc[model] - means.auc_published[model]), limit)
    for metric in ["auc", "nss", "cc"]:
        model_order(both, metric)


def model_order(both, metric):
    """The order of the models by their mean. Two whose published means lie closer than the standard error of their
    paired difference are tied: either order is the published one."""
    models = ["LS", "CS", "PS", "MS", "RS"]
    ours = both[metric].unstack("model")[models]
    theirs = both[f"{metric}_published"].unstack("model")[models]
    swapped, wrong = [], False
    for i, a in enumerate(models):
        for b in models[i + 1:]:
            difference = theirs[a] - theirs[b]
            if (ours[a] - ours[b]).mean() * difference.mean() >= 0:
                continue
            tied = abs(difference.mean()) < difference.std(ddof=1) / np.sqrt(len(difference))
            swapped.append(f"{a}/{b} {'tied' if tied else 'swapped'}")
            wrong |= not tied

    def order(means):
        return " ".join(f"{m} {v:.3f}" for m, v in means.sort_values(ascending=False).items())
    note = f" ({', '.join(swapped)})" if swapped else ""
    figure(f"order by mean {metric.upper()}{note}", order(ours.mean()), order(theirs.mean()), not wrong)


def random_baseline():
    rs = results("meshes").query("model == 'RS'")
    figure("RS: mean AUC", rs.auc.mean(), "0.50 +- 0.01", abs(rs.auc.mean() - 0.5) <= 0.01)
    for metric in ["nss", "cc"]:
        figure(f"RS: mean {metric.upper()}", rs[metric].mean(), "0 +- 0.05", abs(rs[metric].mean()) <= 0.05)


def cs_maps():
    correlations = []
    for path in sorted((reference / "CS").glob("*.val")):
        correlations.append(stats.spearmanr(read_map(path), read_map(work / "maps/CS" / path.name))[0])
    at_least(f"CS: Spearman with the authors' {len(correlations)} maps, median", float(np.median(correlations)), 0.99)
    at_least("CS: the same, 10th percentile", float(np.percentile(correlations, 10)), 0.95)


def figure_maps():
    for name, limit in [("PS_2", 0.995), ("PS_65", 0.995), ("LS_2", 0.995), ("LS_336", 0.995), ("LS_65", 0.99),
                        ("MS_2", 0.97), ("MS_65", 0.955)]:
        model, item = name.split("_")
        read = np.loadtxt(reference / f"figures/{name}.txt")
        ours = unit(read_map(work / f"maps/{model}/{item}.val"))
        at_least(f"{model}: Pearson with the paper's figure, mesh {item}",
                 float(np.corrcoef(ours[read[:, 0].astype(int)], read[:, 1])[0, 1]), limit)


def histograms():
    for run, kind, limits in [("meshes", "meshes", {"PS": 0.02, "LS": 0.03, "MS": 0.05}),
                              ("scans", "scans", {"CS": 0.02, "PS": 0.02, "LS": 0.067})]:
        for model, distance in published.histogram_distances(work / run, reference, kind).items():
            if model in limits:
                at_most(f"{model}: KS distance of the mean histogram, {kind}", distance, limits[model])
            else:
                figure(f"{model}: KS distance of the mean histogram, {kind}", distance, "", None)


def scan_scores():
    both = published.scan_by_scan(work / "scans", reference)
    rows = []
    for model in published.MODELS:
        for metric in published.METRICS:
            a = published.agreement(both, model, metric)
            ceiling = published.ceiling(work / "scans", work / "scans_shifted", model, metric)
            rows.append([model, metric, a["n"], a["ours"], a["published"], a["ours"] - a["published"], a["r"], ceiling])
            name = f"{model}: {metric.upper()}, {a['n']} scans"
            if (model, metric) in SCAN_MEANS:
                figure(f"{name}, mean (published {a['published']:.3f})", a["ours"], f"within {SCAN_MEANS[model, metric]}",
                       abs(a["ours"] - a["published"]) <= SCAN_MEANS[model, metric])
            if (model, metric) in SCAN_R:
                at_least(f"{name}, r scan by scan (ceiling {ceiling:.2f})", a["r"], SCAN_R[model, metric])
    run = (work / "scans/run.yaml").read_text()
    failed = 0 if "failed: []" in run else run.count("- {item:")
    at_most("scans: failed items", failed, 0)
    constant, maps = 0, 0
    for path in (work / "cache/map.MS").glob("*/*_*.h5"):  # scans are named N_k
        with h5py.File(path) as artefact:
            if artefact.attrs["protocol"].decode() == "published":
                constant += np.ptp(artefact["saliency"][:]) == 0
                maps += 1
    at_least(f"MS: share of {maps} scans with a map that is not constant", 1 - constant / maps, 0.99)
    return pd.DataFrame(rows, columns=["model", "metric", "scans", "ours", "published", "difference", "r", "ceiling of r"])


def aligned(title, table):
    print(f"\n{title}\n{table.to_string(index=False)}")


def smoothed_picks():
    with h5py.File(work / "picks.h5") as export:
        worst = max(float(np.abs(export[f"{path.stem}/ground_truth/saliency"][:] - read_map(path)).max())
                    for path in (data / "SchellingData/Distributions").glob("*.val"))
    at_most("smoothed picks: largest difference to the .val of 19 meshes", worst, 1e-5)


def eyetracking():
    summary = pd.read_csv(work / "eyetracking/summary.csv", comment="#")
    aligned("eye tracking: 23 meshes, and 12 scans of each",
            summary[["dataset", "model", "metric", "n", "mean", "ci95_low", "ci95_high"]].round(4))


def protocols():
    authors, text = results("meshes"), results("text").query("dataset == 'meshes'")
    rows = []
    for model in ["LS", "CS", "PS", "MS", "RS"]:
        row = [model]
        for table in [authors, text]:
            row += [round(float(table[table.model == model][metric].mean()), 4) for metric in ["auc", "nss", "cc"]]
        rows.append(row)
    aligned("the two protocols on the same meshes", pd.DataFrame(
        rows, columns=["model", "auc published", "nss published", "cc published", "auc text", "nss text", "cc text"]))


random_baseline()
cs_maps()
mesh_scores()
figure_maps()
histograms()
scans = scan_scores()
smoothed_picks()
table = pd.DataFrame(figures, columns=["figure", "measured", "aim", "verdict"])
table.to_csv(work / "fidelity.csv", index=False)
for what, value, aim, verdict in figures:
    print(f"{verdict:5}{what:75}{value if isinstance(value, str) else format(value, '.4g'):>10}   {aim}")
aligned("scans with published scores, scan by scan; ceiling of r: our own grid of rays against itself half a step aside",
        scans.round(3))
eyetracking()
protocols()
print(f"\n{(table.verdict == 'hit').sum()} hit, {(table.verdict == 'MISS').sum()} missed; table in {work / 'fidelity.csv'}")
