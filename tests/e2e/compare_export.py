#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether an export says what the artefacts of the cache say, data set by data set: compare_export.py EXPORT CACHE

Values to the bit, types, attributes and filters. Prints how many data sets and scores it compared.
"""
import glob
import sys

import h5py
import numpy

NAMED = {"stage", "stage_version", "kind", "options", "seed", "inputs", "key", "content"}
SCORES = ("auc", "auc_exact", "nss", "cc", "lcc")


def text(value):
    return value.decode() if isinstance(value, bytes) else value


def expect(condition, *what):
    if not condition:
        sys.exit(" ".join(map(str, what)) + " differs")


def packed(data):
    return data.chunks, data.compression, data.compression_opts, data.shuffle, data.id.get_storage_size()


def compare_sets(artefact, group):
    expect(set(artefact) == set(group), group.name)
    for name, data in artefact.items():
        copy = group[name]
        expect(data.dtype == copy.dtype and data.shape == copy.shape, copy.name)
        expect(data[()].tobytes() == copy[()].tobytes(), copy.name)
        expect(dict(data.attrs) == dict(copy.attrs) and set(copy.attrs) == {"unit", "description"}, copy.name)
        expect(packed(data) == packed(copy), copy.name, "packing")


def compare_scores(stage, item, artefact, row):
    numbers = numpy.array([row[name] for name in SCORES])
    expect(numpy.array_equal(numbers, artefact["scores"][()], equal_nan=True), "scores of", item)
    expect([row["n_points"], row["n_picks"]] == list(artefact["counts"][()]), "counts of", item)


def main():
    export, cache = sys.argv[1:]
    n_sets = n_scores = n_packed = 0
    with h5py.File(export, "r") as file:
        rows = {}
        for row in file["scores"][:] if "scores" in file else ():
            item, view = text(row["item"]), text(row["view"])
            rows["scores." + text(row["model"]), item + "_" + view if view else item] = row
        for path in sorted(glob.glob(glob.escape(cache) + "/[0-9a-fs][0-9a-fe]*/*.h5")):
            with h5py.File(path, "r") as segment:
                for stage, item in ((stage, item) for stage in segment for item in segment[stage]):
                    artefact, kind = segment[stage][item], stage.partition(".")[0]
                    if kind == "score_table":
                        expect(f"means/{stage}" not in file, stage)  # its rows are those of /scores
                        continue
                    if kind == "scores":
                        compare_scores(stage, item, artefact, rows[stage, item])
                        n_scores += 1
                        continue
                    group = file[f"means/{stage}/{item}" if kind in ("reference", "mean_histogram") else f"{item}/{stage}"]
                    compare_sets(artefact, group)
                    expect(set(group.attrs) == NAMED and text(group.attrs["stage"]) == stage, group.name, "attributes")
                    n_sets += len(group)
                    n_packed += sum(data.compression == "gzip" for data in group.values())
    expect(n_scores == len(rows), "number of scores")
    print(f"{n_sets} data sets, {n_packed} of them packed, {n_scores} scores")


if __name__ == "__main__":
    main()
