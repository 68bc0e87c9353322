# SPDX-License-Identifier: GPL-3.0-or-later
"""Files of saliency, masks and picks, as a description says that they are written; the content tells text and .npy from each other."""

from __future__ import annotations

import re

import numpy as np

from salbench import _core
from salbench._npy import MAGIC
from salbench.datasets._arrays import parse_npy
from salbench.datasets._layout import Indices, Values, number_text
from salbench.datasets._numbers import are_unseen, read_columns
from salbench.datasets._order import Elements
from salbench.datasets._text import before_comment, in_quotes, lines_of
from salbench.datasets.records import Floats, InputError, Ints


def wrong_with_points(points: Floats) -> tuple[int, str] | None:
    """The first row whose coordinates meshes may not have, and why."""
    finite = np.all(np.isfinite(points), axis=1)
    with np.errstate(invalid="ignore"):
        usable = finite & (np.abs(points).max(axis=1) <= _core.largest_coordinate)
    if usable.all():
        return None
    row = int(np.argmin(usable))
    return row, "a coordinate is larger than 1e50: scale the mesh" if finite[row] else "a coordinate is not a finite number"


def read_values(data: bytes, name: str, values: Values, elements: Elements) -> tuple[Floats, Floats | None]:
    """As many as there are elements, NaN where not seen; of values per point any number but 0, and their coordinates."""
    binary = data.startswith(MAGIC)
    if values.per == "point":
        if binary:
            raise InputError(f"{name}: values per point stand in columns beside x, y and z: write them as text")

        def wrong(rows: list[Floats]) -> tuple[int, str] | None:
            with np.errstate(over="ignore"):
                return wrong_with_points(values.scale * np.stack(rows[1:4], axis=1))

        found, *axes = read_columns(data, name, (values.column, *values.points), values.unseen, None, wrong)
        return found, values.scale * np.stack(axes, axis=1)
    if not binary:
        return read_columns(data, name, (values.column,), values.unseen, elements)[0], None
    found = parse_npy(data, name)
    unseen = are_unseen(found, values.unseen.encode())
    for place in np.flatnonzero(~np.isfinite(found) & ~unseen)[:1]:
        raise InputError(f"{name}: value {place} (0-based) is {number_text(float(found[place]))}, expected a finite number")
    found[unseen] = np.nan
    if not elements.has(len(found)):
        raise InputError(f"{name}: {elements.wrong_count(len(found))}")
    return found, None


def read_mask(data: bytes, name: str, elements: Elements) -> Floats:
    def wrong(rows: list[Floats]) -> tuple[int, str] | None:
        odd = np.flatnonzero((rows[0] != 0) & (rows[0] != 1))
        return (int(odd[0]), "a mask has 0 for hidden and 1 for seen, and nothing else") if len(odd) else None

    mask = read_columns(data, name, ("",), "", elements, wrong)[0]
    if not mask.any():
        raise InputError(f"{name}: hides everything: nothing is left to be scored; correct it, or take it and its ground truth away")
    return mask


def read_picks(data: bytes, name: str, indices: Indices, elements: Elements) -> Ints:
    """Indices, 0-based, in the file's order, one per line; a comment may follow. A participant who marked nothing is real data."""
    assert elements.n is not None
    base, picks = indices.base, []
    for number, line in enumerate(lines_of(data), 1):
        word, *others = before_comment(line.split()) or [b""]
        if not word:
            continue
        if not re.fullmatch(rb"\+?[0-9]+|-[0-9]+", word):
            raise InputError(f"{name}:{number}: {in_quotes(word)} is not a whole number")
        if len(word.lstrip(b"+-0")) > 18:
            raise InputError(f"{name}:{number}: {in_quotes(word)} does not fit 64 bits")
        index = int(word)
        if not 0 <= index - base < elements.n:
            raise InputError(f"{name}:{number}: {elements.one} {index} is out of range: the {elements.shape} has {elements.n} {elements.plural}, "
                             f"numbered from {base}")
        if others:
            raise InputError(f"{name}:{number}: the line has more than one value")
        picks.append(index - base)
    return np.array(picks, np.int32)
