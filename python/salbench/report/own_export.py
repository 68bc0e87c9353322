# SPDX-License-Identifier: GPL-3.0-or-later
"""The export that a report makes for itself, where none lies beside the results: of what the cache of the
run has. Pictures are computed for it, and no map: nobody's code is run."""

import logging
import os
from collections.abc import Sequence
from pathlib import Path

import numpy

from salbench import _core
from salbench.report.results import Shown
from salbench.runs.settings import Settings
from salbench.system.progress import Told

MOST = 40  # meshes and point clouds; of more, those that the report picks out


def make(results: Shown, folder: Path, examples: Sequence[str], told: Told) -> tuple[list[Path], str]:
    """The export, if there is one, and otherwise why not; empty where the results do not say where cache
    and data set are."""
    cache, data = results.option("cache"), results.option("data")
    if not cache or not data or not results.has("results"):
        return [], ""
    for what, path in (("cache", cache), ("data set", data)):
        if not os.path.isdir(path):
            return [], f"the {what} that run.yaml names is not there: {path}"
    return export(results.folder / "run.yaml", chosen(results, examples), folder / "shapes.h5", told)


def export(config: Path, items: Sequence[str], to: Path, told: Told) -> tuple[list[Path], str]:
    """Items of the run whose run.yaml this is, as far as the cache has them, with their pictures."""
    # U+FFFD stands for bytes that are not known
    names = [os.fsencode(name) for name in items if "\ufffd" not in name]
    going = _core.Run(Settings(str(config), items=names), [])
    log = logging.getLogger("salbench")
    log.disabled = True  # the pages say what they lack
    try:
        going.export(None, told, os.fsencode(to), "h5", b"", True, True)
    except (ValueError, LookupError, OSError) as error:
        return [], str(error.args[0])
    finally:
        log.disabled = False
    return [to], ""


def chosen(results: Shown, examples: Sequence[str]) -> list[str]:
    """All meshes and point clouds that have scores, if they are few; of many the examples, and of each
    model by the first metric its worst, best and median one, as many as MOST."""
    table = results.table("results")
    items = list(dict.fromkeys(table["item"]))
    metric = next((name for name in results.leading if name in table), None)
    if len(items) <= MOST or metric is None:
        return items[:MOST]
    orders = [
        means.dropna().sort_values(kind="stable").index
        for _, means in table.groupby(["item", "model"])[metric].mean().groupby("model")
    ]
    found = [name for name in examples if name in items]
    for share in (0, 1, 0.5, *numpy.linspace(0, 1, MOST)):
        found += [order[round(share * (len(order) - 1))][0] for order in orders if len(order)]
    return list(dict.fromkeys(found))[:MOST]
