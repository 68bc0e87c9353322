# SPDX-License-Identifier: GPL-3.0-or-later
"""Shared by tests of the package: small data sets, and runs of the program."""

import pathlib
import random
import tempfile
import unittest

from tests.support.shapes import lines  # noqa: F401
from tests.support.toy_data import PROGRAM, ROOT, meshes, run  # noqa: F401

LEARNABLE = [20 * kind + number for kind in range(5) for number in (1, 2)]  # SHREC'07 has 20 of each class


class InAFolder(unittest.TestCase):
    """A temporary folder: self.folder."""

    def setUp(self):
        self.folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))


def export(config, *options):
    run(config, *options, subcommand="export")


def learnable(folder):
    """Ten meshes in the Schelling study's form, two of each of five classes and each in a place of its own, whose ground truth is random:
    nothing but memory predicts it."""
    folder = pathlib.Path(folder)
    made = sorted(meshes(folder / "made", 10, 24, 8).glob("*.off"))
    numbers = random.Random(1)
    for part in ("Meshes", "Distributions"):
        (folder / part).mkdir()
    for place, (path, name) in enumerate(zip(made, LEARNABLE)):
        head, counts, *rows = path.read_text().splitlines()
        n = int(counts.split()[0])
        moved = [f"{float(x) + 4 * place} {rest}" for x, rest in (row.split(None, 1) for row in rows[:n])]
        (folder / f"Meshes/{name}.off").write_text("\n".join([head, counts, *moved, *rows[n:]]) + "\n")
        (folder / f"Distributions/{name}.val").write_text(lines([numbers.random() for _ in range(n)]))
    return folder
