# SPDX-License-Identifier: GPL-3.0-or-later
"""Archives in a temporary folder, and what is made of them."""

import io
import os
import tempfile
import unittest
from pathlib import Path

import numpy as np

from salbench import datasets
from salbench.datasets.records import InputError
from tests.support.shapes import FACES, POINTS, lines, obj, off, sphere  # noqa: F401

NAN = float("nan")


def npy(values):
    file = io.BytesIO()
    np.save(file, values)
    return file.getvalue()


class WithArchive(unittest.TestCase):
    """A temporary folder of files, and a description beside it."""

    def setUp(self):
        folder = Path(self.enterContext(tempfile.TemporaryDirectory()))
        self.root, self.own = folder / "data", folder / "own.yaml"
        self.root.mkdir()

    def write(self, files):
        for name, content in files.items():
            path = self.root / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(content if isinstance(content, bytes) else content.encode())

    def list(self, layout):
        """Of an archive, or of a description in YAML."""
        return datasets.find(self._layout(layout)).items(str(self.root))

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
