# SPDX-License-Identifier: GPL-3.0-or-later
"""What the paper prints, typed into configs/paper/*.csv with its source."""

from pathlib import Path

import numpy
import pandas

FOLDER = Path(__file__).resolve().parent.parent / "configs" / "paper"
CLASSES = 20
SHAPES = {"meshes": 400, "scans": 4800}  # each class has 20 meshes, each mesh 12 scans (section 4.1)


def read(name):
    """A table of configs/paper: text, but for the columns mean and ci95."""
    table = pandas.read_csv(FOLDER / name, comment="#", dtype=str, keep_default_na=False)
    for column in ("mean", "ci95"):
        if column in table:
            table[column] = table[column].astype(float)
    return table


def per_class():
    """(class, model) -> (mean AUC, half of its 95 % interval), from table 2."""
    return {(row["class"], row["model"]): (row["mean"], row["ci95"]) for _, row in read("per_class.csv").iterrows()}


def mean_auc(model):
    """The paper's mean AUC on meshes: the mean of its table over the classes, which are equally large. None if the paper
    does not have the model."""
    means = [mean for (_, name), (mean, _) in per_class().items() if name == model]
    return float(numpy.mean(means)) if len(means) == CLASSES else None
