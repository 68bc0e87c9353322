# SPDX-License-Identifier: GPL-3.0-or-later
"""Shared by the tests of docs/stability.md: old examples, copied to a folder for today's program.

examples/set has two tori and a point cloud, as salbench.datasets.write of 0.2.0 wrote them. computed.tar.xz has the cache that 1.1 made of
them, and the export that 0.2.0 made. record.py adds what a version promises in addition.
"""

import os
import shlex
import shutil
import tarfile
import tempfile
import unittest
from pathlib import Path

import matplotlib.font_manager  # noqa: F401  or each report would look for fonts, in a folder of its own
import salbench.leaderboard.commands  # noqa: F401  and with it libraries that each call would import
from tests.support import forked
from tests.support.without_figures import never_drawn

EXAMPLES = Path(__file__).resolve().parent / "examples"
PROGRAM = os.environ.get("SALBENCH_PROGRAM", str(EXAMPLES.parents[2] / "build/release/salbench"))
COMPUTED = "computed.tar.xz"
RUNS = ("run meshes.yaml", "run scans.yaml --items 1 --reference items")  # whose artefacts the old cache has
EXPORT = "export meshes.yaml --items 1,cloud --models LS,HS,RS --pictures"


def salbench(folder, line):
    words = shlex.split(line)

    def before():
        os.chdir(folder)
        never_drawn(words)
    return forked.salbench(*words, before=before)


class OldExamples(unittest.TestCase):
    """Each class of tests has the examples in a folder of its own."""

    @classmethod
    def setUpClass(cls):
        holder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(holder.cleanup)
        cls.folder = Path(holder.name)
        shutil.copytree(EXAMPLES, cls.folder, dirs_exist_ok=True)
        with tarfile.open(EXAMPLES / COMPUTED) as computed:
            computed.extractall(cls.folder)

    def said(self, line):
        done = salbench(self.folder, line)
        self.assertEqual(done.returncode, 0, f"salbench {line}: {done.stderr}")
        return done.stdout
