# SPDX-License-Identifier: GPL-3.0-or-later
# Imported by scripts/figures.
"""Figures of docs/data_set_scores.md: models, trivial baselines and ceilings by the protocol of each public
data set, trained models, and properties of the sets."""

import functools
import importlib.machinery
import importlib.util
import tempfile
from functools import partial
from pathlib import Path

import numpy as np
import pandas as pd

from .common import ROOT, ran, show

import salbench
from salbench.conclusions.floors import CEILING, above_floors, role
from salbench.conclusions.tables import of_all
from salbench.datasets.sets import find

PAGE = ROOT / "docs/data_set_scores.md"
NEARLY_KL = "kl_smoothed"  # same maps: a nearly identical column
LEARNT = "FOREST"
LEARNING = """### Trained trees

`models/forest` is boosted trees over descriptors, curvature, distance to the centroid and the maps of LS, CS, PS and MS at a point. Each
map comes from trees that were trained without its mesh or, by class, without its class. The rows say how far FOREST is ahead of another
model on the same shapes: mean difference and 95 % interval by the paired t-test, with the sign chosen so that FOREST is better above 0,
also by `kl`. "Not told from" lists models whose interval contains 0. There is no correction for the number of models, metrics and sets.
The intervals are over shapes, and do not include the variation between folds or training sets.
"""
HIGHER = {row.name: row.higher_is_better for row in salbench.metrics.table()}
CACHE = ROOT / "build/figures-cache"


def results_of(data, scratch, protocol, folder):
    """Folder of the results of a protocol over all splits of a set; all share a cache."""
    config, out, further = scratch / f"{protocol}.yaml", scratch / protocol, []
    text = (ROOT / f"configs/protocols/{protocol}.yaml").read_text()
    config.write_text("".join(line for line in text.splitlines(True) if not line.startswith("  split:")))
    if protocol == "schelling":  # few of its meshes have ground truth in these files
        known = sorted(int(path.stem) for path in (data / folder / "Distributions").glob("*.val"))
        further += ["--items", ",".join(map(str, known))]
    ran("run", config, data / folder, CACHE, "--out", out, *further)
    return out


def interval(mean, low, high):
    return f"{mean:.3f} ({low:.3f} to {high:.3f})" if np.isfinite(low) else f"{mean:.3f}"


def table_of_means(summary):
    metrics, models = list(dict.fromkeys(summary["metric"])), list(dict.fromkeys(summary["model"]))
    models.sort(key=lambda model: (role(model) != "", role(model) == "ceiling"))
    lines = ["| model | | " + " | ".join(metrics) + " |", "|---" * (2 + len(metrics)) + "|"]
    for model in models:
        rows = summary[summary["model"] == model].set_index("metric")
        if rows["n"].max() == 0:
            continue
        cells = [
            interval(*rows.loc[metric, ["mean", "ci95_low", "ci95_high"]]) if rows.loc[metric, "n"] else ""
            for metric in metrics
        ]
        lines.append(f"| {model} | {role(model)} | " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def better_than_floors(significance):
    said = "; ".join(
        f"{metric}: {', '.join(models) or 'none'}" for metric, models in above_floors(significance).items()
    )
    return (
        "Better than every trivial baseline, by the paired 95 % interval against each, without"
        f" correction: {said}.\n"
    )


def section(title, out, without=None):
    """`without`: a model whose scores are meaningless on these data."""
    results = salbench.Results(out)
    summary, significance = of_all(results.summary), of_all(results.significance)
    summary = summary[(summary["model"] != without) & (summary["metric"] != NEARLY_KL)]
    significance = significance[significance["metric"] != NEARLY_KL]
    n = int(summary["n_shapes"].max())
    return f"### {title}, {n} shapes\n\n{table_of_means(summary)}\n{better_than_floors(significance)}\n"


@functools.cache
def forest():
    """The module of models/forest, which computes features of a shape once: folds, and forms of ground truth,
    share names and points."""
    loader = importlib.machinery.SourceFileLoader("forest", str(ROOT / "models/forest/model.py"))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader("forest", loader))
    loader.exec_module(module)
    known, describe = {}, module.features

    def features(shape):
        key = shape.id, shape.points.tobytes()
        if key not in known:
            known[key] = describe(shape)
        return known[key]

    module.features = features
    return module


def learnt(data, scratch, protocol, folder, by):
    """Results of models/forest, cross-validated beside the models of a protocol. Shares a cache with those of
    the protocol."""
    return salbench.cross_validate(
        {LEARNT: forest().fit},
        data / folder,
        scratch / f"{protocol}.yaml",
        by=by,
        cache=CACHE,
        out=scratch / f"{protocol}-{by}",
        progress=False,
    )


def leads(scores, metrics):
    """By metric and other model: the mean of FOREST for None, and its lead over each: (mean, low, high)."""
    concluded = salbench.stats.conclude(scores, metrics=metrics)
    summary, significance = of_all(concluded.summary), of_all(concluded.significance)
    found = {}
    for metric in metrics:
        own = summary[(summary["metric"] == metric) & (summary["model"] == LEARNT)].iloc[0]
        found[metric] = {None: tuple(own[["mean", "ci95_low", "ci95_high"]])}
        for _, pair in significance[significance["metric"] == metric].iterrows():
            if LEARNT in (pair["model_a"], pair["model_b"]) and pair["n"]:
                sign = (1 if HIGHER[metric] else -1) * (1 if pair["model_a"] == LEARNT else -1)
                mean, *ends = (sign * pair[name] for name in ("mean_difference", "ci95_low", "ci95_high"))
                found[metric][pair["model_b"] if pair["model_a"] == LEARNT else pair["model_a"]] = (
                    mean,
                    min(ends),
                    max(ends),
                )
    return found


def learning_section(title, results, without=None):
    scores = pd.concat(
        [results.scores, pd.read_csv(results.folder / "constant.csv", dtype={"item": str, "view": str})]
    )
    scores = scores[scores["model"] != without]
    metrics = [name for name in results.summary["metric"].unique() if name != NEARLY_KL]
    models = sorted(scores["model"].unique(), key=lambda name: role(name) == "baseline")
    found = {
        metric: {name: of[name] for name in (None, *models) if name in of}
        for metric, of in leads(scores, metrics).items()
    }
    others = [name for name in models if any(name in of for of in found.values())]
    lines = [
        f"### `models/forest` on {title}, {scores['item'].nunique()} shapes, {results.trained[LEARNT]}\n",
        "| | | " + " | ".join(metrics) + " |",
        "|---" * (2 + len(metrics)) + "|",
    ]
    for name in (None, *others):
        cells = [interval(*of[name]) if name in of else "" for of in found.values()]
        lines.append(
            f"| {f'ahead of {name}' if name else f'mean of {LEARNT}'} | {role(name) if name else ''} | "
            + " | ".join(cells)
            + " |"
        )
    return "\n".join([*lines, "", *(f"- {metric}: {verdict(of)}" for metric, of in found.items())]) + "\n"


def verdict(of):
    """Verdict from the intervals of one metric."""
    rows = [(name, low, high) for name, (_, low, high) in of.items() if name]
    groups = {
        "ahead of": [name for name, low, _ in rows if low > 0],
        "behind": [name for name, _, high in rows if high < 0],
    }
    groups["not told from"] = [name for name, low, high in rows if not low > 0 and not high < 0]
    return "; ".join(f"{words} {', '.join(names)}" for words, names in groups.items() if names) + "."


def overlap(data):
    """Agreement of two sets of one laboratory on shapes of the same names: coordinates, and the ground truth
    of each vertex against that of the nearest point of the cloud."""
    meshes, clouds = salbench.Dataset("zaragoza", data / "eyetracking"), salbench.Dataset(
        "sal3d", data / "sal3d"
    )
    rows, farthest, changed = [], 0.0, 0
    shared = [name for name in meshes.ids if name in clouds.ids]
    for name in shared:
        mesh, cloud = meshes[name], clouds[name]

        def framed(points):  # centroid and size: nearly equal for samples of one surface
            centre = points.mean(0)
            return (points - centre) / np.linalg.norm(points - centre, axis=1).max()

        places = [
            salbench.vertex_values_of_samples(
                mesh.points, cloud.points, np.ascontiguousarray(cloud.points[:, axis])
            )
            for axis in range(3)
        ]
        size = np.linalg.norm(np.ptp(cloud.points, axis=0))
        farthest = max(farthest, np.linalg.norm(np.column_stack(places) - mesh.points, axis=1).max() / size)
        carried = salbench.vertex_values_of_samples(
            framed(mesh.points), framed(cloud.points), cloud.ground_truth
        )
        changed += int((carried != mesh.ground_truth).sum())
        rows.append(
            {
                "item": name,
                "model": "carried over",
                "cc": salbench.metrics.cc(carried, ground_truth=mesh.ground_truth),
                "spearman": salbench.metrics.spearman(carried, ground_truth=mesh.ground_truth),
            }
        )
    frame = pd.DataFrame(rows)
    summary = salbench.stats.conclude(frame, metrics=["cc", "spearman"]).summary.set_index("metric")
    vertices = sum(len(meshes[name].points) for name in shared)
    lines = [
        f"### `zaragoza` against `sal3d`, {len(shared)} shapes of the same names\n",
        (
            "In the coordinates of the files, the vertex that is farthest from the points of its cloud is"
            f" {farthest:.1e} diagonals away."
        ),
        (
            "Transferred by nearest point, with equal centroid and size, the densities differ at"
            f" {changed} of {vertices} vertices.\n"
        ),
        "| metric | mean | lowest | 95 % interval |",
        "|---|---|---|---|",
    ]
    for metric in ("cc", "spearman"):
        row = summary.loc[metric]
        lines.append(
            f"| {metric} | {row['mean']:.6f} | {frame[metric].min():.6f} | {row['ci95_low']:.6f} to"
            f" {row['ci95_high']:.6f} |"
        )
    if farthest == 0 and changed < 0.01 * vertices:
        lines += [
            "",
            (
                "Except at these vertices, both have the same points with the same densities, in another"
                " order: one measurement in two files."
            ),
            (
                "Their agreement does not show that the measurement is repeatable. A model trained on"
                " one of them must not be tested on"
            ),
            "these shapes of the other.",
        ]
    return "\n".join(lines) + "\n"


def readings(root):
    """Agreement of the raw densities of SAL3D's clouds with those spread over the nearest points."""
    raw, spread = (salbench.Dataset(name, root) for name in ("sal3d", "sal3d_spread"))
    truths = [(raw[name].ground_truth, spread[name].ground_truth) for name in raw.ids]
    agreement = [salbench.metrics.cc(wide, ground_truth=narrow) for narrow, wide in truths]
    above_0 = [np.mean(np.concatenate([truth[k] for truth in truths]) > 0) for k in range(2)]
    return f"""### Raw and smoothed `sal3d`, {len(truths)} shapes

Raw and spread densities of a cloud correlate at {np.mean(agreement):.3f} on average, {min(agreement):.3f} to {max(agreement):.3f}: a map that
equals one of them scores no more than that against the other. Raw ones are above 0 on {100 * above_0[0]:.0f} % of the points, spread ones on {100 * above_0[1]:.0f} %.
"""


def next_to_each_other(faces):
    """(k, 2): numbers of the two faces at each edge that has two."""
    sides = np.sort(faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    _, edge, count = np.unique(sides, axis=0, return_inverse=True, return_counts=True)
    order = np.argsort(edge, kind="stable")
    return order[count[edge[order]] == 2].reshape(-1, 2) // 3


def sizes_of_faces(root):
    """Correlations of the values of Mesh Mamba's faces with their areas."""
    archive, cc = find("meshmamba"), salbench.metrics.cc
    lines = [
        ("| shape | adjacent faces | divided by area | random / area, truth / area | SD | 1 / area |"),
        "|---" * 6 + "|",
    ]
    for item in archive.items(str(root)).items:
        shape = archive.read(item)
        corners, truth = shape.points[shape.faces], shape.face_truth
        areas = (
            np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2
        )
        first, second = next_to_each_other(shape.faces).T
        by_area, random = truth / areas, np.random.default_rng(0).random(len(truth))
        figures = [
            cc(truth[first], ground_truth=truth[second]),
            cc(by_area[first], ground_truth=by_area[second]),
            cc(random / areas, ground_truth=by_area),
            cc(salbench.models.sd(shape.points, shape.faces)[shape.faces].mean(1), ground_truth=truth),
            cc(1 / areas, ground_truth=truth),
        ]
        lines.append(f"| {item.name} | " + " | ".join(f"{value:.3f}" for value in figures) + " |")
    return (
        """### Sizes of the faces of `meshmamba`

Correlations: between the values of faces that share an edge; between the same values divided by the areas of the faces; of a random number with
the ground truth, both divided by area; and of the ground truth with SD, as in the protocol, and with one over the area of the face.

"""
        + "\n".join(lines)
        + "\n"
    )


def data_sets(data, write):
    sets = [
        ("`sal3d`", "sal3d", "sal3d", None),
        ("`sal3d_spread`", "sal3d_spread", "sal3d", None),
        ("`zaragoza`", "zaragoza", "eyetracking", None),
        # its picks are not assigned to participants
        ("`schelling`", "schelling", "SchellingData", CEILING),
    ]
    with tempfile.TemporaryDirectory() as name:
        scratch = Path(name)
        of = partial(results_of, data, scratch)
        parts = [
            section("`sal3d`, all splits", of("sal3d", "sal3d")),
            section("`sal3d_spread`, all splits", of("sal3d_spread", "sal3d")),
            readings(data / "sal3d"),
            section("`zaragoza`", of("zaragoza", "eyetracking")),
            section(
                "`schelling`, meshes with ground truth at hand",
                of("schelling", "SchellingData"),
                without=CEILING,
            ),
            section("`meshmamba`, all splits", of("meshmamba", "meshmamba")),
            sizes_of_faces(data / "meshmamba"),
            overlap(data),
            LEARNING,
        ]
        for by, (title, protocol, folder, without) in [
            *(("mesh", one) for one in sets[:3]),
            ("class", sets[3]),
            ("mesh", sets[3]),
        ]:
            parts.append(learning_section(title, learnt(data, scratch, protocol, folder, by), without))
    text = "\n".join(part.rstrip("\n") + "\n" for part in parts)
    show(text, PAGE, "data_sets", write)
