#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
# Run by scripts/check and scripts/release, and by hand on exports that two machines have made.
"""Compares two exports, or two results folders, of one configuration over the same data, made on two machines.

compare_exports.py FIRST.h5 SECOND.h5 [TOLERANCE]
compare_exports.py FIRST SECOND [TOLERANCE]

Prints two tables of exports in Markdown. Stages, those of all models in one row: how many artefacts there are and how many have
the same bytes; of the others, the largest difference between two values over the largest value of their array, and the stage
and array where that is. Metrics, those without a difference in one row: the largest difference between two scores. Exit status 1
if that is above the tolerance (default 1e-6), or if an artefact or an array of other length is in one export only. Prints one
table of folders: how many cells of their .csv files, but for timeline.csv and costs.csv, are equal, and the largest difference between two
numbers over the largest one of their column and metric, since an interval may end near 0. The tolerance applies to it. Needs
python3-h5py.
"""

import csv
import sys
from collections import defaultdict
from pathlib import Path

import h5py
import numpy


def text(value):
    return value.decode() if isinstance(value, bytes) else value


def artefacts(file):
    """(stage, item) -> group, of the items and of the means over them."""
    found = {}
    for name, item in file.items():
        if "dataset" in item.attrs:
            found |= {(stage, name): group for stage, group in item.items()}
    for stage, means in file.get("means", {}).items():
        found |= {(stage, f"mean of {name}"): group for name, group in means.items()}
    return found


def difference(first, second):
    """The largest relative difference between the arrays of two artefacts, and the name of the array."""
    worst = (0.0, "")
    for name in sorted(set(first) | set(second)):
        a, b = (numpy.asarray(group[name], dtype=float) if name in group else None for group in (first, second))
        if a is None or b is None or a.shape != b.shape or (numpy.isnan(a) != numpy.isnan(b)).any():
            return numpy.inf, name
        same = (a == b) | numpy.isnan(a)
        if same.all():
            continue
        size = max(numpy.nanmax(numpy.abs(a)), numpy.nanmax(numpy.abs(b)))
        worst = max(worst, (float(numpy.abs(a - b)[~same].max() / size), name))
    return worst


def family(stage):
    """What the table calls a stage: those of models and metrics, such as map.LS, have a row together."""
    return stage.split(".")[0] + ".*" if "." in stage else stage


def compare_stages(first, second):
    """Prints a row per stage, in the order of the computation. True if all artefacts have their counterparts."""
    ours, theirs = artefacts(first), artefacts(second)
    order = [family(line.split(":")[0]) for line in text(first.attrs["stage_versions"]).splitlines()]
    rows = sorted({family(stage) for stage, _ in ours | theirs}, key=lambda row: (order.index(row) if row in order else -1, row))
    complete = True
    print("| stage | artefacts | same bytes | largest difference | in |\n|---|---|---|---|---|")
    for row in rows:
        keys = [key for key in ours.keys() | theirs.keys() if family(key[0]) == row]
        same, worst = 0, (0.0, "")
        for key in keys:
            if key not in ours or key not in theirs:
                worst = max(worst, (numpy.inf, f"{key[0]} of {key[1]}, in one export only"))
            elif text(ours[key].attrs["content"]) == text(theirs[key].attrs["content"]):
                same += 1
            else:
                size, array = difference(ours[key], theirs[key])
                worst = max(worst, (size, f"{key[0]}: {array}"))
        complete = complete and worst[0] < numpy.inf
        print(f"| `{row}` | {len(keys)} | {same} | {worst[0]:.1g} | {worst[1] or '-'} |")
    return complete


def compare_scores(first, second):
    """Prints a row per metric, and returns the largest difference of all."""
    def by_name(file):
        table = file["scores"][:]
        return {tuple(text(row[column]) for column in ("dataset", "item", "view", "model")): row for row in table}, table.dtype
    (ours, columns), (theirs, _) = by_name(first), by_name(second)
    if ours.keys() != theirs.keys():
        print("the scores are of other shapes or models")
        return numpy.inf
    print("\n| metric | scores | equal | largest difference |\n|---|---|---|---|")
    largest, same, scores = 0.0, 0, 0
    for metric in (name for name in columns.names if columns[name] == float):
        a, b = (numpy.array([table[key][metric] for key in ours]) for table in (ours, theirs))
        known = ~(numpy.isnan(a) & numpy.isnan(b))
        off = numpy.nan_to_num(numpy.abs(a - b)[known], nan=numpy.inf)
        largest = max(largest, off.max(initial=0))
        if (off == 0).all():
            same, scores = same + 1, scores + len(off)
        else:
            print(f"| {metric} | {len(off)} | {(off == 0).sum()} | {off.max():.1g} |")
    print(f"| the {same} without a difference | {scores} | {scores} | 0 |")
    return largest


def number(cell):
    try:
        return float(cell)
    except ValueError:
        return numpy.nan


def cells_of(path):
    """The header and the rows, without remarks: in 1.0 lines of '#', later the last column."""
    rows = [row for row in csv.reader(path.read_text(encoding="utf-8").splitlines()) if not "".join(row).startswith("#")]
    width = len(rows[0]) - ("remarks" in rows[0])
    return [row[:width] for row in rows]


def compare_cells(first, second):
    """How many cells two tables have, how many are equal, the largest difference, and the column where that is."""
    ours, theirs = cells_of(first), cells_of(second)
    cells = sum(map(len, ours))
    if [len(row) for row in ours] != [len(row) for row in theirs]:
        return cells, 0, numpy.inf, "other rows"
    header = ours[0]
    metric = header.index("metric") if "metric" in header else None
    size, off = defaultdict(lambda: numpy.finfo(float).tiny), []  # all may be 0
    for row, other in zip(ours, theirs):
        for column, a, b in zip(header, row, other):
            place = "" if metric is None else row[metric], column
            size[place] = numpy.fmax(size[place], abs(number(a)))
            if a != b:
                off.append((abs(number(a) - number(b)), place))
    found = [(apart / size[place] if apart <= size[place] else numpy.inf, place[1]) for apart, place in off]
    return cells, cells - len(off), *max(found, default=(0.0, "-"))


def compare_tables(first, second):
    """Prints a row per table that differs, and one for the others. Returns the largest difference of all."""
    names = sorted({path.name for folder in (first, second) for path in folder.glob("*.csv")} - {"costs.csv", "timeline.csv"})
    print("| table | cells | equal | largest difference | in |\n|---|---|---|---|---|")
    largest, same, in_same = 0.0, 0, 0
    for name in names:
        if not ((first / name).is_file() and (second / name).is_file()):
            cells, equal, off, column = 0, 0, numpy.inf, "in one folder only"
        else:
            cells, equal, off, column = compare_cells(first / name, second / name)
            if (first / name).read_bytes() == (second / name).read_bytes():
                same, in_same = same + 1, in_same + cells
                continue
        largest = max(largest, off)
        print(f"| `{name}` | {cells} | {equal} | {off:.1g} | {column} |")
    print(f"| the {same} with the same bytes | {in_same} | {in_same} | 0 | - |")
    return largest


def main(first, second, tolerance="1e-6"):
    if Path(first).is_dir():
        return 0 if compare_tables(Path(first), Path(second)) <= float(tolerance) else 1
    with h5py.File(first) as ours, h5py.File(second) as theirs:
        complete = compare_stages(ours, theirs)
        return 0 if compare_scores(ours, theirs) <= float(tolerance) and complete else 1


if __name__ == "__main__":
    if len(sys.argv) not in (3, 4):
        sys.exit(__doc__)
    sys.exit(main(*sys.argv[1:]))
