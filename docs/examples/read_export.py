#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
# Run by users of an export, and copied by those who write their own: it is installed as an example.
"""Reads what `salbench export` wrote: do the models give more saliency to the points that people picked?

read_export.py FILE.h5

Needs python3-h5py and python3-pandas. docs/data_dictionary.md describes the rest of the file.
"""

import sys

import h5py
import numpy
import pandas


def text(value):
    return value.decode() if isinstance(value, bytes) else value


def picked_points(item):
    """Mask of the points of an item that at least one participant picked; None without picks."""
    for stage in ("ground_truth", "scan_ground_truth"):
        if stage in item and len(item[stage]["picks"]) > 0:
            picked = numpy.zeros(len(item[stage]["saliency"]), dtype=bool)
            picked[item[stage]["picks"][:]] = True
            return picked
    return None


def saliency_at_picks(file):
    rows = []
    for name, item in file.items():
        picked = picked_points(item) if "dataset" in item.attrs else None
        if picked is None or picked.all():
            continue
        for stage in item:
            kind, _, model = stage.partition(".")
            if kind != "map":
                continue
            saliency = item[stage]["saliency"][:]
            rows.append(
                {
                    "dataset": text(item.attrs["dataset"]),
                    "model": model,
                    "item": name,
                    "at picks": saliency[picked].mean(),
                    "elsewhere": saliency[~picked].mean(),
                }
            )
    return pandas.DataFrame(rows, columns=["dataset", "model", "item", "at picks", "elsewhere"])


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    with h5py.File(sys.argv[1], "r") as file:
        if "participants" in file.attrs:
            print(text(file.attrs["participants"]))
        table = saliency_at_picks(file)
    if table.empty:
        sys.exit(f"{sys.argv[1]}: holds no map of an item whose points people picked")
    groups = table.groupby(["dataset", "model"])
    means = groups[["at picks", "elsewhere"]].mean()
    means["items"] = groups.size()
    print(means.reset_index().to_string(index=False, float_format="%.4f"))


if __name__ == "__main__":
    main()
