# SPDX-License-Identifier: GPL-3.0-or-later
"""A cross-validated model as a command: a folder for `submit` and `reproduce`, with the trained model of each
fold."""

import csv
import io
import sys
from collections.abc import Collection, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from salbench import _core
from salbench.models.function import PARTS
from salbench.runs.kept import packages_in, pickled
from salbench.system.files import replace_file
from salbench.system.yaml import flow_text

if TYPE_CHECKING:
    from salbench.runs.learning import Learner

CONFIGURATION = "model.yaml"  # with the protocol of the run
_FOLDS, _PREDICT, _NEEDED = "folds.csv", "predict.py", "requirements.txt"
_PREDICT_TEXT = '''"""Makes the map of a shape by the model that was not trained on it: predict.py FOLDER SHAPE.h5 ITEM OUT.npy"""
import csv
import pickle
import sys

import h5py
import numpy as np
from salbench import Shape

folder, shape, item, out = sys.argv[1:]
if sys.version_info[:2] != {python}:
    sys.exit("what was trained holds code of Python {{}}.{{}}; requirements.txt has the packages".format(*{python}))
with open("folds.csv", encoding="utf-8", newline="") as file:
    fold = {{row["item"]: row["fold"] for row in csv.DictReader(file)}}[item]
with open(f"{{folder}}/fold_{{fold}}.pickle", "rb") as file:
    predict = pickle.load(file)
with h5py.File(shape) as file:
    parts = {{name: file[name][:] for name in ("points", "faces", "normals", "fpfh") if name in file}}
np.save(out, np.asarray(predict(Shape(item, **parts)), np.float64))
'''


def write(to: Path, protocol: str, learners: Mapping[str, "Learner | None"], how: str) -> None:
    """Writes the folder. protocol: the configuration without models. learners: by model; the first is that of
    the card, others are further seeds. how: training in words. Throws ValueError if a fold is missing, and
    exceptions of pickle; nothing is written then."""
    if maps := sorted(to.glob("*.val")):  # `submit` would use them
        raise ValueError(f"it holds {maps[0].name}, a map, from before: name an empty folder")
    files: dict[str, bytes] = {}
    fold_of: Mapping[str, int] = {}
    entries, needed = {}, {f"salbench=={_core.version}", "h5py", "numpy"}
    for place, (model, learner) in enumerate(learners.items()):
        predictors = learner.predictors() if learner is not None else {}
        if learner is None or len(predictors) < learner.n_folds:
            raise ValueError(f"not all folds of {model} were trained by this call or stored by keep=")
        folder, fold_of = f"folds_{place}", learner.fold_of
        pickles = {f"{folder}/fold_{fold}.pickle": pickled(predict) for fold, predict in predictors.items()}
        files |= pickles
        needed.update(name for data in pickles.values() for name in packages_in(data))
        entries[model] = {
            "command": f"{{python}} {_PREDICT} {folder} {{shape}} {{item}} {{out.npy}}",
            "trained": how,
            "reads": ["points", *(part for part in PARTS if part in learner.reads)],
            "depends": [_PREDICT, _FOLDS, *pickles],
        }
    files |= {
        _FOLDS: _folds_text(fold_of).encode("utf-8", "surrogateescape"),
        _NEEDED: _needed_text(needed).encode(),
        _PREDICT: _PREDICT_TEXT.format(python=tuple(sys.version_info[:2])).encode(),
        CONFIGURATION: f"{protocol}models: {flow_text(entries)}\n".encode(),
    }
    for name, data in files.items():
        (to / name).parent.mkdir(parents=True, exist_ok=True)
        replace_file(to / name, data)


def _folds_text(fold_of: Mapping[str, int]) -> str:
    rows = io.StringIO(newline="")
    csv.writer(rows, lineterminator="\n").writerows([("item", "fold"), *fold_of.items()])
    return rows.getvalue()


def _needed_text(needed: Collection[str]) -> str:
    """Requirements in pip's format."""
    with_version = {name.partition("==")[0] for name in needed if "==" in name}
    return f"# Python {sys.version_info[0]}.{sys.version_info[1]}\n" + "".join(
        f"{name}\n" for name in sorted(set(needed) - with_version)
    )
