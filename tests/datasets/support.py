# SPDX-License-Identifier: GPL-3.0-or-later
"""Archives in a temporary folder, and what is read of them."""

import io
import os
import tempfile
import unittest
from pathlib import Path

import numpy as np

from salbench.datasets import importing, sets
from salbench.datasets.records import InputError
from tests.support.shapes import FACES, POINTS, lines, obj, off, sphere  # noqa: F401

NAN = float("nan")
find = sets.find


def npy(values):
    file = io.BytesIO()
    np.save(file, values)
    return file.getvalue()


class WithArchive(unittest.TestCase):
    """A temporary folder of files, and a file for a set of one's own beside it."""

    def setUp(self):
        folder = Path(self.enterContext(tempfile.TemporaryDirectory()))
        self.root, self.own = folder / "data", folder / "own.py"
        self.root.mkdir()

    def write(self, files):
        """Contents by name; None removes a file. Returns the path of the last one."""
        path = self.root
        for name, content in files.items():
            path = self.root / name
            path.parent.mkdir(parents=True, exist_ok=True)
            if content is None:
                path.unlink()
            else:
                path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return path

    def list(self, name):
        return find(name).items(self.root)

    def read(self, name, item=0):
        """An item of a public set, by its number or name."""
        rows = self.list(name).items
        row = rows[item] if isinstance(item, int) else next(row for row in rows if row.name == item)
        return find(name).read(row)

    def error_of(self, work, *arguments):
        """The message of what fails, with the folder as ROOT."""
        with self.assertRaises(InputError) as caught:
            work(*arguments)
        message = str(caught.exception)
        self.assertNotIn("\n", message)
        return message.replace(str(self.root), "ROOT")

    def equal(self, found, expected):
        np.testing.assert_array_equal(found, expected)


def read_here(questions, done):
    """As ask_all, in this process, which takes less time; the last one is the first that is done."""
    for number, question in reversed([*enumerate(questions)]):
        done(number, importing.made_of(*question.arguments), "")
    return True


def real(name):
    """A folder of real data; None where there are none."""
    root = os.environ.get("SALBENCH_DATA")
    path = Path(root) / name if root else None
    return path if path and path.is_dir() else None
