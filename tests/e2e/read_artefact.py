# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads the artefacts of a run as anybody would: with h5py and pandas, knowing only the documented layout.

read_artefact.py CACHE RESULTS_CSV: prints "ok: ..." or says what is wrong.
"""

import pathlib
import subprocess
import sys

try:
    import h5py
    import numpy
    import pandas
except ImportError as error:
    sys.exit(f"{error}: install python3-h5py and python3-pandas (scripts/setup does)")

KINDS = {"mesh": "mesh", "scan": "scan", "normals": "normals", "scan_normals": "normals", "fpfh": "descriptors", "map": "field",
         "matched": "field", "ground_truth": "ground_truth", "scan_ground_truth": "ground_truth", "scores": "scores",
         "reference": "histogram", "mean_histogram": "histogram", "score_table": "score_table"}

METRICS = ["auc", "auc_exact", "nss", "cc", "lcc"]


def fail(path, what):
    sys.exit(f"{path}: {what}")


def text_of(path, thing, name):
    """A text attribute: UTF-8 of fixed length, which h5py gives as bytes."""
    value = thing.attrs.get(name)
    if not isinstance(value, bytes):
        fail(path, f"the attribute '{name}' is {value!r}, no text")
    return value.decode()


def check_texts(path, group):
    for name, data in group.items():
        if not text_of(path, data, "unit") or not text_of(path, data, "description"):
            fail(path, f"the data set '{name}' has an empty unit or description")


def points_of(path, kind, file):
    """Number of points, by the documented shapes; None for what is not per point."""
    if kind == "mesh":
        if file["faces"].shape[1:] != (3,) or file["faces"][:].max() >= len(file["vertices"]):
            fail(path, "faces are not triples of vertex indices")
        return len(file["vertices"])
    if kind == "scan":
        if file["points"].shape[1:] != (3,) or file["camera"].shape != (3,):
            fail(path, "points are not n x 3, or the camera is not 3")
        return len(file["points"])
    if kind == "normals":
        if not numpy.allclose(numpy.linalg.norm(file["normals"][:], axis=1), 1):
            fail(path, "normals are not of unit length")
        return len(file["normals"])
    if kind == "descriptors":
        if file["fpfh"].shape[1:] != (33,) or file["fpfh"].dtype != numpy.float32:
            fail(path, "descriptors are not n x 33 floats")
        return len(file["fpfh"])
    if kind == "field":
        return len(file["saliency"])
    if kind == "ground_truth":
        offsets = file["pick_offsets"][:]
        if offsets[0] != 0 or offsets[-1] != len(file["picks"]) or (numpy.diff(offsets) < 0).any():
            fail(path, "pick_offsets do not divide the picks")
        return len(file["saliency"])
    if kind == "scores":
        return int(file["counts"][0])
    if kind == "histogram" and file["density"].shape != (100,):
        fail(path, "the histogram has not 100 bins")
    return None


def check_score_table(path, model, item, file, results):
    """One row per shape, in the order of the results."""
    expected = results[(results["model"] == model) & (results["dataset"] == item)]
    if not numpy.array_equal(expected[METRICS].to_numpy(), file["scores"][:], equal_nan=True):
        fail(path, "other scores than in results.csv")
    if not numpy.array_equal(expected[["n_points", "n_picks"]].to_numpy(), file["counts"][:]):
        fail(path, "other counts than in results.csv")
    return len(expected)


def dump(path):
    """HDF5's own tools read it, behind the head, to the last value."""
    run = subprocess.run(["h5dump", path], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    if run.returncode != 0 or run.stderr:
        fail(path, f"h5dump (package hdf5-tools) cannot read it: {run.stderr}")


def main():
    cache, results_csv = pathlib.Path(sys.argv[1]), sys.argv[2]
    results = pandas.read_csv(results_csv, dtype={"item": str, "view": str}, float_precision="round_trip")
    names = results["item"] + ("_" + results["view"]).fillna("")
    results["name"] = names
    points = dict(zip(names, results["n_points"]))
    checked = scored = in_tables = 0
    for path in sorted([*cache.glob("??/*.h5"), *cache.glob("set/*.h5")]):
        dump(path)
        with h5py.File(path, "r") as file:
            if file.userblock_size < 512:
                fail(path, "has no head")
            for stage, item in ((stage, item) for stage in file for item in file[stage]):
                group, kind, model = file[stage][item], KINDS.get(stage.partition(".")[0]), stage.partition(".")[2]
                check_texts(path, group)
                n = points_of(path, kind, group)
                if n is not None and n != points[item]:
                    fail(path, f"{n} points, results.csv says {points[item]}")
                if kind == "scores":
                    row = results[(names == item) & (results["model"] == model)]
                    if not numpy.array_equal(row[METRICS].to_numpy()[0], group["scores"][:], equal_nan=True):
                        fail(path, "other scores than in results.csv")
                    scored += 1
                if kind == "score_table":
                    in_tables += check_score_table(path, model, item, group, results)
                checked += 1
    if scored != len(results) or in_tables != len(results):
        sys.exit(f"{scored} artefacts of scores, {in_tables} rows in tables of scores, {len(results)} rows of results")
    print(f"ok: {checked} artefacts, {scored} of them scores")


main()
