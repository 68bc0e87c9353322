# SPDX-License-Identifier: GPL-3.0-or-later
"""Results folders and exports made up from seeded numbers: small and fixed, or as large as the whole benchmark."""

import atexit
import functools
import shutil
import tempfile
from pathlib import Path

import h5py
import numpy
import pandas

import salbench
from salbench import conclusions
from salbench.conclusions.metrics import lower_is_better, of_program

MODELS = ("LS", "CS", "PS", "MS", "HS", "RS")
METRICS = ("auc", "auc_exact", "nss", "cc", "lcc")
ALL_METRICS = tuple(of_program())  # what `metrics: all` chooses
CLASSES = ("human", "teddy", "glasses", "spring")
LEVELS = {"LS": 0.64, "CS": 0.61, "PS": 0.60, "MS": 0.55, "HS": 0.58, "RS": 0.5}  # mean AUC of a model

CONFIGURATION = """configuration:
  protocol: published
  seed: 2016
  dataset:
    participants: {participants}
  statistics:
    unit: mesh
  fpfh:
    neighbourhood: nearest
    radius: 0.01
  models:
{models}"""


def scores(random, level, n):
    """n rows of the five metrics."""
    auc = numpy.clip(level + 0.05 * random.standard_normal(n), 0, 1)
    cc = numpy.clip(3 * (auc - 0.5) + 0.1 * random.standard_normal(n), -1, 1)
    return {"auc": auc, "auc_exact": numpy.clip(auc + 0.03, 0, 1), "nss": 5 * (auc - 0.5), "cc": cc, "lcc": numpy.abs(cc)}


def with_metrics(results, metrics, seed=7):
    """The table with columns for these metrics: those that it has, and others that follow the AUC, with some noise."""
    random = numpy.random.default_rng(seed)
    made = results[["dataset", "item", "class", "view", "model"]].copy()
    for metric in metrics:
        noise = results["auc"] + 0.02 * random.standard_normal(len(results))
        made[metric] = results[metric] if metric in results else 1 - noise if lower_is_better(metric) else noise
    return made.assign(n_points=results["n_points"], n_picks=results["n_picks"])


def matching_of(metric):
    return "none" if metric.split("_")[0] in ("kl", "sim", "ig", "sauc", "fne", "fpe", "wme") else "histogram"


def metric_lines(metrics):
    """The block `metrics` of run.yaml."""
    return "metrics:  # columns of the tables\n" + "".join(
        f'  {metric}: {{unit: "1", better: {"lower" if lower_is_better(metric) else "higher"}, matching: {matching_of(metric)}}}\n'
        for metric in metrics)


def results_table(items, models=MODELS, views=12, seed=1, datasets=("meshes", "scans")):
    """items: (name, class) pairs. Scans and point clouds have no HS."""
    random = numpy.random.default_rng(seed)
    frames = []
    for dataset in datasets:
        shapes = [(item, name, "") for item, name in items] if dataset != "scans" else [
            (item, name, str(view)) for item, name in items for view in range(views)]
        for model in models:
            if dataset != "meshes" and model == "HS":
                continue
            frame = pandas.DataFrame(shapes, columns=["item", "class", "view"])
            frame.insert(0, "dataset", dataset)
            frame["model"] = model
            for metric, values in scores(random, LEVELS.get(model, 0.57), len(shapes)).items():
                frame[metric] = values
            frame["n_points"], frame["n_picks"] = 2500, 120
            frames.append(frame)
    return pandas.concat(frames, ignore_index=True)


def histograms(models, seed=2):
    random = numpy.random.default_rng(seed)
    table = {"bin_left": numpy.arange(100) / 100}
    for name, (a, b) in zip(("GS", *models), ((0.3, 6), (1, 6), (1, 4), (1, 3), (5, 5), (1, 1), (2, 5), (2, 2), (3, 3))):
        counts = numpy.histogram(random.beta(a, b, 20000), bins=100, range=(0, 1))[0]
        table[name] = counts / counts.sum() * 100
    return pandas.DataFrame(table)


def people(items, metrics, seed=5):
    """people.csv. Each mesh has a level of its own, beside which more participants add much the same."""
    random = numpy.random.default_rng(seed)
    rows = []
    for item, category in items:
        level = 0.04 * random.standard_normal()
        for n in range(1, 12):
            values = {metric: start + gain * (1 - 1 / n) + level + 0.01 * random.standard_normal()
                      for metric, start, gain in (("auc", 0.58, 0.06), ("auc_exact", 0.6, 0.06), ("nss", 0.9, 0.3), ("cc", 0.2, 0.3),
                                                  ("lcc", 0.2, 0.3))}
            rows.append((item, category, n, *(values.get(metric, numpy.nan) for metric in metrics)))
    return pandas.DataFrame(rows, columns=["item", "class", "n", *metrics])


def run_yaml(models, simulated, failed=(), extra=""):
    sections = "".join(f"    {model}:\n" if model == "RS" else f"    {model}: {{radius: 0.02}}\n" for model in models)
    failures = "failed: []\n" if not failed else "failed:\n" + "".join(
        f'  - {{item: "{item}", stage: {stage}, cause: "{cause}"}}\n' for item, stage, cause in failed)
    return (("# SIMULATED participants: the ground truth was made by the program.\n" if simulated else "")
            + "program: salbench 0.1.0\nresults: finished\nhost: \"host\"\nthreads: 2\nseconds: 10.5\nartefacts_computed: 42\n"
            + extra + ("" if "metrics:" in extra else metric_lines(METRICS)) + "data_set: {folder: \"data\", layout: schelling, meshes: 8, files: 20, digest: abcdef, participants: [22, 25]}\n"
            + "stages:\n  mesh: {version: 1, why: {}}\n  map.LS: {version: 3, why: {\"options, inputs, seed or version changed\": 8}}\n"
            + "nodes:\n  - {stage: mesh, of: meshes, scope: mesh, items: 8, settled: 8, computed: 0, seconds: 0.0, median: 0.0, "
            + "p95: 0.0, busy: 0.0}\n  - {stage: map.LS, of: meshes, scope: mesh, items: 8, settled: 8, computed: 8, seconds: "
            + "12.5, median: 1.5, p95: 2.0, busy: 0.6}\n" + failures
            + CONFIGURATION.format(participants="simulated" if simulated else "measured", models=sections))


def write_results(folder, items, models=MODELS, **options):
    """A results folder with all tables: what a run would write, and the conclusions from it. Returns the table of results."""
    if options:
        return draw_conclusions(folder, items, models, **options)
    made, results = concluded(tuple(items), tuple(models))
    shutil.copytree(made, folder, dirs_exist_ok=True)
    return results.copy()


@functools.cache
def concluded(items, models):
    folder = tempfile.mkdtemp()
    atexit.register(shutil.rmtree, folder)
    return folder, draw_conclusions(folder, items, models)


def draw_conclusions(folder, items, models, simulated=False, results=None, **options):
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    results = results_table(items, models) if results is None else results
    remarks = {"remarks": "SIMULATED participants: these scores say nothing about people."} if simulated else {}
    of_meshes = results[results["dataset"] == "meshes"].drop_duplicates("item")
    metrics = [column for column in results if column not in ("dataset", "split", "item", "class", "view", "model", "n_points", "n_picks")]
    tables = {"results": results, "people": people(zip(of_meshes["item"], of_meshes["class"]), metrics),
              "mean_histograms_meshes": histograms(models),
              "mean_histograms_scans": histograms([model for model in models if model != "HS"], 3)}
    for name, table in tables.items():
        (folder / f"{name}.csv").write_text(table.assign(**remarks).to_csv(index=False), encoding="utf-8")
    (folder / "run.yaml").write_text(run_yaml(models, simulated, **options), encoding="utf-8")
    conclusions.conclude(conclusions.source_of(str(folder)))
    return results


def eight_meshes():
    return [(str(index + 1), CLASSES[index // 2]) for index in range(8)]


def write_costs(folder, models=("LS", "RS"), datasets=("meshes", "scans")):
    rows = [(dataset, str(item), "", model, 10.0**-k * item, 10.0**-k * item / 2, 0.5) for dataset in datasets for item in range(1, 9)
            for k, model in enumerate(models)]
    table = pandas.DataFrame(rows, columns=["dataset", "item", "view", "model", "seconds", "processor_seconds", "input_seconds"])
    table.to_csv(Path(folder) / "costs.csv", index=False)


def sphere(rings=14, bumps=0.15):
    """A bumpy sphere: n x 3 vertices, f x 3 faces."""
    around = 2 * rings
    theta, phi = numpy.meshgrid(numpy.linspace(0.1, numpy.pi - 0.1, rings), numpy.arange(around) * 2 * numpy.pi / around,
                                indexing="ij")
    radius = 1 + bumps * numpy.sin(3 * theta) * numpy.cos(4 * phi)
    points = numpy.stack([radius * numpy.sin(theta) * numpy.cos(phi), radius * numpy.cos(theta),
                          radius * numpy.sin(theta) * numpy.sin(phi)], axis=-1).reshape(-1, 3)
    faces = []
    for ring in range(rings - 1):
        for step in range(around):
            a, b = ring * around + step, ring * around + (step + 1) % around
            faces += [(a, b, a + around), (b, b + around, a + around)]
    return points, numpy.array(faces, dtype=numpy.int32)


def write_export(path, items, models=MODELS, views=12, pictures=True, size=96):
    """An export in the program's layout: bumpy spheres and their scans, with pictures if wanted."""
    random = numpy.random.default_rng(4)
    points, faces = sphere()
    with h5py.File(path, "w") as file:
        file.attrs["program"], file.attrs["layout"] = "salbench 0.1.0", "salbench export 1"
        for item, category in items:
            mesh = file.create_group(item)
            mesh.attrs.update({"dataset": "meshes", "item": item, "class": category})
            mesh["mesh/vertices"], mesh["mesh/faces"] = points, faces
            fill(mesh, "ground_truth", points, models, random)
            for view in range(views):
                angle = 2 * numpy.pi * view / max(views, 1)
                eye = 6 * numpy.array([numpy.cos(angle), 0.3, numpy.sin(angle)])
                seen = points[points @ eye > 0.4 * numpy.linalg.norm(eye)]
                scan = file.create_group(f"{item}_{view}")
                scan.attrs.update({"dataset": "scans", "item": item, "class": category, "view": numpy.int64(view)})
                scan["scan/points"], scan["scan/camera"] = seen, eye
                scan["scan_normals/normals"] = seen / numpy.linalg.norm(seen, axis=1, keepdims=True)
                fill(scan, "scan_ground_truth", seen, [model for model in models if model != "HS"], random)
        if pictures:
            add_pictures(file, size)


def add_pictures(file, size):
    """Writes /ITEM/picture for every shape of an open export."""
    for shape in file.values():
        if "mesh" in shape:
            made = salbench.picture(shape["mesh/vertices"][:], shape["mesh/faces"][:], size=size)
        else:
            kind = "scan" if "scan" in shape else "cloud"
            made = salbench.picture(shape[f"{kind}/points"][:], normals=shape[f"{kind}_normals/normals"][:], size=size)
        for name, values in vars(made).items():
            shape.create_dataset(f"picture/{name}", data=values, compression="gzip")


def fill(group, truth, points, models, random):
    """Ground truth with ten picks, and a map of every model but HS before and after matching."""
    group[f"{truth}/saliency"] = numpy.maximum(points[:, 1], 0) ** 2
    group[f"{truth}/picks"] = numpy.argsort(points[:, 1])[-10:].astype(numpy.int32)
    group[f"{truth}/pick_offsets"] = numpy.array([0, 10], dtype=numpy.int64)
    for model in models:
        if model != "HS":
            values = points[:, 1] + 0.3 * random.standard_normal(len(points))
            group[f"map.{model}/saliency"] = values
            group[f"matched.{model}/saliency"] = ((values - values.min()) / numpy.ptp(values)) ** 3
