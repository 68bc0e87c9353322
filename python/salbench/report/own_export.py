# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes an export from the run's cache if there is none beside the results. Pictures are computed for it, but
no maps: no user code is run."""

import logging
import os
from collections.abc import Sequence
from pathlib import Path

import numpy

from salbench import _core
from salbench.report.results import Shown
from salbench.runs.settings import Settings, can_be_listed
from salbench.system.progress import Told

MOST = 40  # meshes and point clouds; beyond this, only those that the report selects


def make(results: Shown, folder: Path, examples: Sequence[str], told: Told) -> tuple[list[Path], str]:
    """Returns the export, or the reason why there is none; the reason is empty if the results do not name
    cache and data set."""
    cache, data = results.option("cache"), results.option("data")
    if not cache or not data or not results.has("results"):
        return [], ""
    if lacking := made_in_python(results):
        return [], lacking
    for what, path in (("cache", cache), ("data set", data)):
        if not os.path.isdir(path):
            return [], f"the {what} that run.yaml names is not there: {path}"
    return export(results.folder / "run.yaml", chosen(results, examples), folder / "shapes.h5", told)


def made_in_python(results: Shown) -> str:
    """Reason why shapes of a data set of functions cannot be read again; empty for others."""
    layout = results.record.get("data_set", {}).get("layout", "")
    if not layout or can_be_listed(layout, results.option("dataset.layout") or ""):
        return ""
    return (
        f"the data set {layout} was made in Python, so no other process can read its shapes: write its items()"
        " and read() into a file, and run with dataset: {layout: mine.py}"
    )


def export(config: Path, items: Sequence[str], to: Path, told: Told) -> tuple[list[Path], str]:
    """Exports items of this run.yaml's run, as far as they are cached, with their pictures."""
    # U+FFFD marks unknown bytes
    names = [os.fsencode(name) for name in items if "\ufffd" not in name]
    going = _core.Run(Settings(str(config), items=names), [])
    log = logging.getLogger("salbench")
    log.disabled = True  # the pages report missing data
    try:
        going.export(None, told, os.fsencode(to), "h5", b"", True, True)
    except (ValueError, LookupError, OSError) as error:
        return [], str(error.args[0])
    finally:
        log.disabled = False
    return [to], ""


def chosen(results: Shown, examples: Sequence[str]) -> list[str]:
    """All meshes and point clouds with scores, if they are few. Otherwise the examples, and for each model
    the worst, best and median shape by the first metric, up to MOST."""
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
