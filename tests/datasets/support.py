# SPDX-License-Identifier: GPL-3.0-or-later
"""Archives in a temporary folder, and what is made of them."""

import io
import os
import tempfile
import unittest
from pathlib import Path

import numpy as np
import scipy.io

from salbench import datasets
from salbench.datasets.records import InputError

NAN = float("nan")
POINTS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])  # of a tetrahedron
FACES = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])


def off(points=POINTS, faces=FACES):
    lines = ["OFF", f"{len(points)} {len(faces)} 0", *(" ".join(map(repr, map(float, point))) for point in points),
             *(f"3 {a} {b} {c}" for a, b, c in faces)]
    return "\n".join(lines) + "\n"


def obj(points=POINTS, faces=FACES):
    return "".join(f"v {x!r} {y!r} {z!r}\n" for x, y, z in points.tolist()) + "".join(f"f {a} {b} {c}\n" for a, b, c in (faces + 1).tolist())


def lines(values):
    return "".join(f"{value!r}\n" for value in np.asarray(values).tolist())


def sphere(rings=12, sides=14):
    """Points and faces of a closed surface of radius 1."""
    up, around = np.meshgrid(np.pi * (np.arange(1, rings) / rings - 0.5), 2 * np.pi * np.arange(sides) / sides, indexing="ij")
    points = np.stack([np.cos(up) * np.cos(around), np.cos(up) * np.sin(around), np.sin(up)], -1).reshape(-1, 3)
    points = np.vstack([points, [[0, 0, -1], [0, 0, 1]]])
    faces = []
    for i in range(sides):
        j, last = (i + 1) % sides, (rings - 2) * sides
        faces += [(j, i, len(points) - 2), (last + i, last + j, len(points) - 1)]
        faces += [corner for k in range(0, last, sides) for corner in ((k + i, k + j, k + sides + j), (k + i, k + sides + j, k + sides + i))]
    return points, np.array(faces)


def npy(values):
    file = io.BytesIO()
    np.save(file, values)
    return file.getvalue()


def mat(**variables):
    file = io.BytesIO()
    scipy.io.savemat(file, variables, do_compression=True)
    return file.getvalue()


def cells(rows, columns, **filled):
    """A cell array; `r3c8=[...]` fills the cell of row 3, column 8."""
    array = np.empty((rows, columns), object)
    for row in range(rows):
        for column in range(columns):
            array[row, column] = np.array(filled.get(f"r{row + 1}c{column + 1}", []), float).reshape(-1, 1)
    return array


class WithArchive(unittest.TestCase):
    """A temporary folder of files, and a description beside it."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = Path(folder.name) / "data"
        self.root.mkdir()
        self.own = Path(folder.name) / "own.yaml"

    def write(self, files):
        for name, content in files.items():
            path = self.root / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(content if isinstance(content, bytes) else content.encode())

    def list(self, layout, twins="refuse"):
        """Of an archive, or of a description in YAML."""
        return datasets.find(self._layout(layout)).items(str(self.root), twins)

    def _layout(self, layout):
        if layout in datasets.ARCHIVES:
            return layout
        self.own.write_text(layout)
        return str(self.own)

    def read(self, layout, item=0):
        """The one form of an item by its number or name."""
        rows = self.list(layout).items
        row = rows[item] if isinstance(item, int) else next(row for row in rows if row.name == item)
        if row.problem:
            raise InputError(row.problem)
        return datasets.read(self._layout(layout), str(self.root), row)

    def truth(self, layout, item=0):
        return self.read(layout, item).truths[0]

    def error_of(self, work):
        """The message of what fails, with the folder as ROOT and the description as own.yaml."""
        with self.assertRaises(InputError) as caught:
            work()
        message = str(caught.exception)
        self.assertNotIn("\n", message)
        return message.replace(str(self.root), "ROOT").replace(str(self.own), "own.yaml")

    def equal(self, found, expected):
        np.testing.assert_array_equal(found, expected)


def real(name):
    """A folder of real data; None where there are none."""
    root = os.environ.get("SALBENCH_DATA")
    path = Path(root) / name if root else None
    return path if path and path.is_dir() else None
