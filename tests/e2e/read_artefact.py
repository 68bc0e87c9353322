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

TEXTS = ("program", "item", "kind", "stage", "options", "seed", "inputs", "key", "content", "protocol")

METRICS = ["auc", "auc_exact", "nss", "cc", "lcc"]


def fail(path, what):
    sys.exit(f"{path}: {what}")


def text_of(path, thing, name):
    """A text attribute: UTF-8 of fixed length, which h5py gives as bytes."""
    value = thing.attrs.get(name)
    if not isinstance(value, bytes):
        fail(path, f"the attribute '{name}' is {value!r}, no text")
    return value.decode()


def lines_of(inputs):
    """One per input; a line that begins with / goes on with the name of the line before."""
    return [line.replace("\0", "\n") for line in inputs.replace("\n/", "\0").split("\n")[:-1]]


def check_attributes(path, file):
    texts = {name: text_of(path, file, name) for name in TEXTS}
    if texts["stage"] != path.parent.parent.name:
        fail(path, "lies in another stage's folder")
    if not texts["program"].startswith("salbench "):
        fail(path, "another program's file")
    if int(file.attrs["stage_version"]) < 1 or float(file.attrs["seconds"]) < 0:
        fail(path, "stage_version or seconds is impossible")
    for line in lines_of(texts["inputs"]):
        name, _, digest = line.rpartition(": ")
        if not name or len(digest) != 32 or set(digest) - set("0123456789abcdef"):
            fail(path, f"'{line}' is no input with its digest")
    for line in texts["options"].splitlines():
        if ": " not in line:
            fail(path, f"'{line}' is no option")
    for name, data in file.items():
        if not text_of(path, data, "unit") or not text_of(path, data, "description"):
            fail(path, f"the data set '{name}' has an empty unit or description")


def points_of(path, file):
    """Number of points, by the documented shapes; None for what is not per point."""
    kind = text_of(path, file, "kind")
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


def check_score_table(path, file, results):
    """One row per shape, in the order of the attribute `inputs`."""
    names = [line.rpartition(": ")[0] for line in lines_of(text_of(path, file, "inputs"))]
    expected = results[results["model"] == text_of(path, file, "stage").partition(".")[2]]
    expected = expected.set_index("name").reindex(names)
    if not numpy.array_equal(expected[METRICS].to_numpy(), file["scores"][:], equal_nan=True):
        fail(path, "other scores than in results.csv")
    if not numpy.array_equal(expected[["n_points", "n_picks"]].to_numpy(), file["counts"][:]):
        fail(path, "other counts than in results.csv")
    return len(names)


def dump(path):
    """What is written past the HDF5 library is read by its own tools, to the last value."""
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
    for path in sorted(cache.glob("*/??/*.h5")):
        dump(path)
        with h5py.File(path, "r") as file:
            check_attributes(path, file)
            n = points_of(path, file)
            item = text_of(path, file, "item")
            if n is not None and n != points[item]:
                fail(path, f"{n} points, results.csv says {points[item]}")
            if text_of(path, file, "kind") == "scores":
                model = text_of(path, file, "stage").partition(".")[2]
                row = results[(names == item) & (results["model"] == model)]
                if not numpy.array_equal(row[METRICS].to_numpy()[0], file["scores"][:], equal_nan=True):
                    fail(path, "other scores than in results.csv")
                scored += 1
            if text_of(path, file, "kind") == "score_table":
                in_tables += check_score_table(path, file, results)
            checked += 1
    if scored != len(results) or in_tables != len(results):
        sys.exit(f"{scored} artefacts of scores, {in_tables} rows in tables of scores, {len(results)} rows of results")
    print(f"ok: {checked} artefacts, {scored} of them scores")


main()
