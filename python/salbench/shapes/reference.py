# SPDX-License-Identifier: GPL-3.0-or-later
"""Histograms for matching of maps, from an array or a file, in the engine's form: densities over 100 bins of
[0, 1]."""

import logging
import math
import os
from collections.abc import Callable
from typing import Any

from salbench import _core
from salbench.system.errors import InputError
from salbench.system.files import path_of, require_file

ITEMS = "items"  # replaces a histogram: the mean over the items of the run
_BINS = 100
_ROUNDED = 1e-3  # tolerance of the sum, for densities written with few digits
_MOST_BYTES = 1 << 30  # limit for a table; a histogram has a hundred rows


def reference_of(given: Any) -> Any:
    """Converts an argument `reference` for settings: the density of a file or an array; "items" and None
    stay."""
    if given is None or isinstance(given, str) and given == ITEMS:
        return given
    return _in_file(path_of(given, "reference")) if isinstance(given, (str, os.PathLike)) else density(given)


def density(given: Any) -> Any:
    """Converts an argument `reference` that is an array. Throws ValueError."""

    def fail(place: int | None, what: str) -> None:
        raise ValueError(f"reference {what}" + ("" if place is None else f" in bin {place}"))

    return _checked(_core.numbers(given, "reference", _BINS), "reference", fail)


def _in_file(path: str) -> Any:
    """Reads the column GS of a CSV file. Throws InputError, with file and line."""
    from salbench.system.csv import fail, read_csv, require

    require_file(path, _MOST_BYTES)
    table = read_csv(path, lambda column: column == "GS")
    require(table, "GS")
    if len(table) != _BINS:
        raise InputError(f"{path}: column GS has {len(table)} rows, expected {_BINS} bins")
    for remark in table.attrs["remarks"]:
        logging.getLogger("salbench").warning("%s: %s", path, remark)
    return _checked(
        table["GS"].to_numpy(),
        f"{path}: column GS",
        lambda row, what: fail(table, row or 0, f"column GS {what}"),
    )


def _checked(bins: Any, name: str, fail: Callable[[int | None, str], object]) -> Any:
    """Scales a histogram with another sum than a density, such as probabilities, with a warning."""
    import numpy as np

    for place, value in enumerate(bins.tolist()):
        if not 0 <= value < math.inf:
            fail(place, f"holds {value:g}, expected a density, finite and not negative")
    with np.errstate(over="ignore"):
        total = float(np.cumsum(bins)[-1])  # sequential sum: the same bits on every machine
    if not 0 < total < math.inf:
        fail(None, f"sums to {total:.6g}: no density does")
    if abs(total / _BINS - 1) <= _ROUNDED:
        return bins
    logging.getLogger("salbench").warning(
        "%s sums to %.6g, densities over %d bins to %d: it was scaled", name, total, _BINS, _BINS
    )
    return bins / total * _BINS
