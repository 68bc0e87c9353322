# SPDX-License-Identifier: GPL-3.0-or-later
"""The export that a report makes for itself, where none lies beside the results: of what the cache of the run has. The program computes
pictures for it, and no map: nobody's code is run."""

import os
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

import numpy

from salbench import _core
from salbench.report.results import Results

MOST = 40  # meshes and point clouds; of more, those that the report picks out


def make(results: Results, folder: Path, examples: Sequence[str]) -> tuple[list[Path], str]:
    """The export, if there is one, and otherwise why not; empty where the results do not say where cache and data set are."""
    cache, data = results.option("cache"), results.option("data")
    if not cache or not data or not results.has("results"):
        return [], ""
    for what, path in (("cache", cache), ("data set", data)):
        if not os.path.isdir(path):
            return [], f"the {what} that run.yaml names is not there: {path}"
    program, to = _program(), folder / "shapes.h5"
    if program is None:
        return [], f"there is no program beside the package ({_core.__file__})"
    items = [name for name in chosen(results, examples) if not {",", "\ufffd"} & set(name)]  # that --items can name
    words = [str(program), "export", str(results.folder / "run.yaml"), "--for-report", "--link", "--quiet", "--to", str(to),
             "--items", ",".join(f"./{name}" for name in items)]
    ended = subprocess.run(words, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
                           env=os.environ | {"SALBENCH_PYTHON": sys.executable}, check=False)
    if to.is_file():
        return [to], ""
    errors = [line for line in ended.stderr.decode(errors="replace").splitlines() if line.startswith("error: ")]
    return [], errors[-1].removeprefix("error: ") if errors else f"salbench export ended with {ended.returncode}"


def chosen(results: Results, examples: Sequence[str]) -> list[str]:
    """All meshes and point clouds that have scores, if they are few; of many the examples, and of each model by the first metric its
    worst, best and median one, as many as MOST."""
    table = results.table("results")
    items = list(dict.fromkeys(table["item"]))
    metric = next((name for name in results.leading if name in table), None)
    if len(items) <= MOST or metric is None:
        return items[:MOST]
    orders = [means.dropna().sort_values(kind="stable").index for _, means in table.groupby(["item", "model"])[metric].mean().groupby("model")]
    found = [name for name in examples if name in items]
    for share in (0, 1, 0.5, *numpy.linspace(0, 1, MOST)):
        found += [order[round(share * (len(order) - 1))][0] for order in orders if len(order)]
    return list(dict.fromkeys(found))[:MOST]


def _program() -> Path | None:
    """The one of this package: of a wheel, of a build, or of Debian's packages."""
    package = Path(_core.__file__).parent
    for path in (package / "bin/salbench", package / "../../salbench", package / "../../../../bin/salbench"):
        if path.is_file() and os.access(path, os.X_OK):
            return path
    return None
