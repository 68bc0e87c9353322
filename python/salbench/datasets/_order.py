# SPDX-License-Identifier: GPL-3.0-or-later
"""The elements of a shape that a file has one value for each of, and the column of a table that numbers them."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from salbench.datasets._text import in_quotes
from salbench.datasets._layout import number_text
from salbench.datasets.records import Floats, InputError

_POINTS, _FACES = "vertex|vert|vtx|point|node", "face|facet|triangle|polygon"
_INDICES = "index|idx|id|nr"


@dataclass(frozen=True)
class Elements:
    n: int | None = None  # None: any number of rows will do
    shape: str = "mesh"
    one: str = "vertex"
    plural: str = "vertices"
    faces: tuple[int, int] | None = None  # of a mesh: those of its file, and the triangles that they were split into

    def has(self, count: int) -> bool:
        """True of as many values as there are elements; of triangles also of as many as there are faces in the file."""
        return self.n is None or count == self.n or (self.one == "face" and self.faces is not None and count == self.faces[0])

    def wrong_count(self, count: int) -> str:
        there, advice, faces = f"{self.n} {self.plural}", "", ""
        if self.faces is not None:
            in_file, triangles = self.faces
            faces = f"{triangles} faces" if in_file == triangles else f"{in_file} faces, split into {triangles} triangles"
        if faces and self.one == "face":
            there = faces
        elif self.faces is not None and count in self.faces:
            there, advice = f"{there}, and {faces}", ": if they are of faces, write `values: {per: face}`"
        return f"the file has {count} values, but the {self.shape} has {there}{advice}"


def _how_sure(name: bytes, is_first: bool, elements: Elements) -> int:
    """How surely a name is that of a column of numbers of elements: 0 is no such name, 3 names the elements."""
    plain = re.sub("[^a-z0-9]", "", re.sub("[A-Z]", lambda letter: letter[0].lower(), name.decode("latin-1")))
    if not name or plain == "unnamed0":
        return int(is_first)  # as pandas and R write it
    if re.fullmatch(_INDICES, plain):
        return 2
    words = _FACES if elements.one == "face" else _POINTS
    return 3 if re.fullmatch(f"({words})({_INDICES}|number|no)?", plain) else 0


def numbering_column(header: Sequence[bytes], elements: Elements, taken: Sequence[int]) -> int | None:
    """Place of the column whose name says that it numbers the elements, among those that are not taken: one named after the elements
    ("vertex", "Point ID", "face_index"), else "index", "idx", "id" or "nr", else a first column without a name."""
    sure = [0 if place in taken else _how_sure(name, place == 0, elements) for place, name in enumerate(header)]
    best = max(sure)
    if best == 0:
        return None
    first, *others = [place for place, one in enumerate(sure) if one == best]
    if others:
        raise InputError(f"columns {in_quotes(header[first])} and {in_quotes(header[others[0]])} both number the {elements.plural}: rename one")
    return first


def row_of_elements(numbers: Floats, elements: Elements) -> Any:
    """The row of each element, from the number that each row has: 0 to n - 1 or 1 to n, each once; the smallest tells which. For any other
    numbers the first row that has one, and what is wrong with it."""
    n = len(numbers)
    places = numbers - (0 if numbers.min() == 0 else 1)
    is_place = (places >= 0) & (places < n) & (places == np.floor(places))
    first_of = np.full(n, n)
    inside = np.flatnonzero(is_place)
    np.minimum.at(first_of, places[inside].astype(np.int64), inside)
    is_new = np.zeros(n, bool)
    is_new[first_of[first_of < n]] = True
    if is_new.all():
        return first_of
    row = int(np.flatnonzero(~is_new)[0])
    return row, (f"has {number_text(float(numbers[row]))}{' a second time' if is_place[row] else ''}; it numbers the {elements.plural}, expected "
                 f"each number from 0 to {n - 1}, or from 1 to {n}, once: correct it, or rename it if it is something else")
