# SPDX-License-Identifier: GPL-3.0-or-later
# Imported by scripts/figures.
"""docs/methods.md: distance of the benchmark's scores from the authors' published ones."""

import shutil
from pathlib import Path

import h5py
import numpy as np
import pandas as pd

from .common import ROOT, markdown, ran, read, results

import salbench
from salbench.system.csv import read_csv

MODELS, METRICS = ["LS", "CS", "PS", "MS"], ["auc", "nss", "cc"]

PUBLISHED = "9,52,58,74,114,124,125,185,200,214,237,257,260,309,341,353,367,386,47"


def run_everything(data, work):
    cache, study, reference, meshes = (
        work / "cache",
        data / "SchellingData",
        data / "reference",
        ROOT / "configs/shrec07_meshes.yaml",
    )
    of_meshes, of_scans = (
        ["--reference", reference / f"mean_histograms_{kind}.csv"] for kind in ("meshes", "scans")
    )
    # shifts the grid of rays by half a step
    (work / "shifted.yaml").write_text("dataset: {meshes: false}\nscan: {phase: 0.5}\n")
    (work / "text.yaml").write_text("protocol: text\ndataset: {scans: false}\n")
    ran("run", meshes, study, cache, *of_meshes, "--out", work / "meshes")
    ran("run", ROOT / "configs/shrec07_scans.yaml", study, cache, *of_scans, "--out", work / "scans")
    ran(
        "run",
        work / "shifted.yaml",
        study,
        cache,
        "--items",
        PUBLISHED,
        *of_scans,
        "--out",
        work / "scans_shifted",
    )
    ran("run", work / "text.yaml", study, cache, "--items", PUBLISHED, *of_meshes, "--out", work / "text")
    ran("run", ROOT / "configs/eyetracking.yaml", data / "eyetracking", cache, "--out", work / "eyetracking")
    of_authors = ",".join(sorted(path.stem for path in (reference / "CS").glob("*.val")))
    for items, models in ((of_authors, "CS"), ("2,65,168,336", "LS,PS,MS")):
        ran(
            "export",
            meshes,
            study,
            cache,
            "--items",
            items,
            "--models",
            models,
            "--to",
            work / "maps",
            "--format",
            "maps",
        )
    # without the authors' saliency files, so that the program makes the saliency from picks
    picks_only = work / "picks_only"
    picks_only.mkdir()
    for folder in ("Meshes", "RawData"):
        (picks_only / folder).symlink_to(study / folder)
    ran(
        "export",
        meshes,
        picks_only,
        cache,
        "--items",
        PUBLISHED,
        "--stage",
        "ground_truth",
        "--to",
        work / "picks.h5",
    )


def read_map(path):
    return np.array(path.read_text().split(), dtype=float)


def histogram_distance(out, reference, kind, model):
    """Kolmogorov-Smirnov distance of two mean density histograms."""
    ours, published = (read(folder / f"mean_histograms_{kind}.csv")[model] for folder in (out, reference))
    if (kind, model) == ("scans", "MS"):  # 185 of the 4800 published maps are constant, and fall into bin 50
        published[50] -= 100 * 185 / 4800
    a, b = (np.cumsum(histogram) / histogram.sum() for histogram in (ours, published))
    return float(np.abs(a - b).max())


def scans_beside(out, published):
    """Scores of the scans with picks in both, by model; without the published failures of MS (AUC .5 and CC
    0).
    """
    failed = (published["model"] == "MS") & (published["auc"] == 0.5) & (published["cc"] == 0)
    both = (
        results(out)
        .merge(published[~failed], on=["item", "view", "model"], suffixes=("", "_published"))
        .dropna(subset=["nss"])
    )
    return {model: rows for model in MODELS if len(rows := both[both["model"] == model])}


def scans_of(out, reference):
    """Prints a row per model of a results folder."""
    rows = []
    for model, both in scans_beside(out, read(reference / "published_scan_by_scan.csv")).items():
        row = {"model": model, "KS": histogram_distance(out, reference, "scans", model)}
        for metric in METRICS:
            ours, theirs = both[metric], both[f"{metric}_published"]
            row |= {
                metric: ours.mean(),
                f"{metric} published": theirs.mean(),
                f"r {metric}": ours.corr(theirs),
            }
        rows.append(row)
    print(pd.DataFrame(rows).round(3).to_string(index=False))


class Measures:
    """Measures by the names of aims.csv: the figure, and its number of shapes."""

    def __init__(self, data, work):
        self.data, self.work, self.reference = data, work, data / "reference"
        theirs = read(self.reference / "published_scores.csv")
        self.meshes = results(work / "meshes").merge(
            theirs, on=["item", "model"], suffixes=("", "_published")
        )
        self.complete = self.meshes[
            self.meshes["item"].isin(theirs["item"][theirs.groupby("item")["model"].transform("size") >= 4])
        ]
        self.scans = scans_beside(work / "scans", read(self.reference / "published_scan_by_scan.csv"))
        self.shifted = scans_beside(work / "scans", results(work / "scans_shifted"))

    def off_chance(self, model, metric):
        scores = results(self.work / "meshes").query("model == @model")[metric]
        return abs(scores.mean() - (0.5 if metric == "auc" else 0)), len(scores)

    def authors_maps(self, model, quantile):
        maps = [
            (read_map(path), read_map(self.work / "maps" / model / path.name))
            for path in sorted((self.reference / model).glob("*.val"))
        ]
        return np.quantile(
            [pd.Series(theirs).corr(pd.Series(ours), method="spearman") for theirs, ours in maps],
            float(quantile),
        ), len(maps)

    def mesh_error(self, model, metric):
        rows = self.meshes.query("model == @model")
        return (rows[metric] - rows[f"{metric}_published"]).abs().mean(), len(rows)

    def mesh_mean(self, model, metric):
        rows = self.complete.query("model == @model")
        return abs((rows[metric] - rows[f"{metric}_published"]).mean()), len(rows)

    def figure_map(self, model, item):
        vertices, values = np.loadtxt(self.reference / f"figures/{model}_{item}.txt")[:, :2].T
        return np.corrcoef(read_map(self.work / f"maps/{model}/{item}.val")[vertices.astype(int)], values)[
            0, 1
        ], len(values)

    def histogram(self, model, kind):
        return histogram_distance(self.work / kind, self.reference, kind, model), 0

    def scan_mean(self, model, metric):
        rows = self.scans[model]
        return abs((rows[metric] - rows[f"{metric}_published"]).mean()), len(rows)

    def scan_r(self, model, metric):
        rows = self.scans[model]
        return rows[metric].corr(rows[f"{metric}_published"]), len(rows)

    def failed_scans(self, *_):
        run = (self.work / "scans/run.yaml").read_text()
        return 0 if "failed: []" in run else run.count("- {item:"), 0

    def maps_that_vary(self, model, _):
        cache = salbench.Cache(self.work / "cache")
        scans = (cache[name] for name in cache if "_" in name)  # named N_k
        maps = [
            np.ptp(map["saliency"]) > 0
            for scan in scans
            if f"map.{model}" in scan.stages
            for map in scan.all(f"map.{model}")
            if map.attributes["protocol"] == "published"
        ]
        return np.mean(maps), len(maps)

    def picks(self, *_):
        paths = list((self.data / "SchellingData/Distributions").glob("*.val"))
        with h5py.File(self.work / "picks.h5") as export:
            return max(
                np.abs(export[f"{path.stem}/ground_truth/saliency"][:] - read_map(path)).max()
                for path in paths
            ), len(paths)

    def order(self, metric):
        """Both orders of the models by mean, and the swapped pairs. Pairs whose published means are closer
        than the standard error of their paired difference are tied: either order counts as published."""
        ours, theirs = (
            self.complete.pivot(index="item", columns="model", values=name)[[*MODELS, "RS"]]
            for name in (metric, f"{metric}_published")
        )
        swapped = []
        for i, a in enumerate(ours):
            for b in list(ours)[i + 1 :]:
                apart = theirs[a] - theirs[b]
                if (ours[a] - ours[b]).mean() * apart.mean() < 0:
                    swapped.append(
                        f"{a}/{b} "
                        + (
                            "tied"
                            if abs(apart.mean()) < apart.std(ddof=1) / np.sqrt(len(apart))
                            else "swapped"
                        )
                    )
        orders = (
            " ".join(f"{m} {v:.3f}" for m, v in means.mean().sort_values(ascending=False).items())
            for means in (ours, theirs)
        )
        return [*orders, ", ".join(swapped)]


def fidelity(data, work, of=None):
    """Repeats all runs in `work`, and prints their figures beside the aims; for an existing results folder,
    only its scans."""
    if of:
        return scans_of(of, data / "reference")
    shutil.rmtree(work, ignore_errors=True)
    work.mkdir(parents=True)
    run_everything(data, work)
    measures, rows = Measures(data, work), []
    aims = read_csv(ROOT / "configs/paper/aims.csv", lambda column: column in ("least", "most"))
    for aim in aims.itertuples():
        value, n = getattr(measures, aim.measure)(aim.model, aim.of)
        limit, kept = (
            (f">= {aim.least:g}", value >= aim.least)
            if aim.least == aim.least
            else (f"<= {aim.most:g}", value <= aim.most)
        )
        if "nan" in limit:
            limit, kept = "", None
        rows.append(
            [
                {True: "hit", False: "MISS", None: ""}[kept],
                (f"{aim.model}: " if aim.model else "") + aim.figure.format(n=n),
                float(value),
                limit,
            ]
        )
    for metric in METRICS:
        ours, theirs, swapped = measures.order(metric)
        rows.append(
            [
                "MISS" if " swapped" in swapped else "hit",
                f"order by mean {metric.upper()}{swapped and f' ({swapped})'}",
                ours,
                theirs,
            ]
        )
    pd.DataFrame(rows, columns=["verdict", "figure", "measured", "aim"]).to_csv(
        work / "fidelity.csv", index=False
    )
    for verdict, what, value, aim in rows:
        print(f"{verdict:5}{what:75}{value if isinstance(value, str) else format(value, '.4g'):>10}   {aim}")
    scans = [
        [
            model,
            metric,
            len(both),
            both[metric].mean(),
            both[f"{metric}_published"].mean(),
            both[metric].corr(both[f"{metric}_published"]),
            measures.shifted[model][metric].corr(measures.shifted[model][f"{metric}_published"]),
        ]
        for model, both in measures.scans.items()
        for metric in METRICS
    ]
    eyes = read(work / "eyetracking/summary.csv")
    protocols = [
        results(work / run)
        .query("dataset == 'meshes'")
        .groupby("model")[METRICS]
        .mean()
        .add_suffix(f" {protocol}")
        for run, protocol in (("meshes", "published"), ("text", "text"))
    ]
    for title, table in (
        (
            (
                "scans with published scores; ceiling of r: our own grid of rays against itself half a step"
                " aside"
            ),
            pd.DataFrame(
                scans, columns=["model", "metric", "scans", "ours", "published", "r", "ceiling of r"]
            ).round(3),
        ),
        (
            "eye tracking: 23 meshes, and 12 scans of each",
            eyes[["dataset", "model", "metric", "n", "mean", "ci95_low", "ci95_high"]].round(4),
        ),
        (
            "the two protocols on the same meshes",
            pd.concat(protocols, axis=1).loc[[*MODELS, "RS"]].round(4).reset_index(),
        ),
    ):
        print(f"\n{title}\n{table.to_string(index=False)}")
    verdicts = [row[0] for row in rows]
    print(f"\n{verdicts.count('hit')} hit, {verdicts.count('MISS')} missed; table in {work / 'fidelity.csv'}")
