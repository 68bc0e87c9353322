# SPDX-License-Identifier: GPL-3.0-or-later
"""What the tests of the documentation share: its pages, their blocks, and the folder that blocks run in."""

import os
import re

import numpy as np

from tests.support import toy_data
from tests.support.toy_data import PROGRAM, ROOT

PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").glob("*.md"))]
MESHES = (1, 52, 125)  # named as SHREC'07's are, from three of its classes


class Block:
    def __init__(self, language, text, line):
        self.language, self.text, self.line = language, text, line

    @property
    def file(self):
        """The file that the block is, if its first line is a comment with nothing but a name: `# predict.py`."""
        found = re.match(r"# ([\w./-]+\.\w+)\n", self.text)
        return found and found.group(1)


def blocks(page):
    """Fenced blocks in their order; directives of MyST, {toctree} and such, are none."""
    text = page.read_text(encoding="utf-8")
    found = re.finditer(r"^```([^\n]*)\n(.*?)^```$", text, flags=re.M | re.S)
    return [Block(match[1], match[2], text.count("\n", 0, match.start()) + 1) for match in found if not match[1].startswith("{")]


def prose(page):
    """A page without its blocks."""
    return re.sub(r"^```.*?^```$", "", page.read_text(encoding="utf-8"), flags=re.M | re.S)


def shape_files(folder):
    """A small data set of the Schelling study's form, maps of another program, and a cloud."""
    rng = np.random.default_rng(1)
    truths = toy_data.study(folder / "SchellingData", MESHES, 12, 10, participants=4)
    toy_data.meshes(folder / "toy", len(MESHES))
    for part in ("my_maps", "mine", "my_clouds"):
        (folder / part).mkdir()
    for number, truth in truths.items():
        for maps in ("my_maps", "mine"):
            np.savetxt(folder / maps / f"{number}.val", rng.random(len(truth)))
    np.savetxt(folder / "my_clouds/statue.xyz", rng.normal(size=(200, 3)))


def workspace(folder):
    """Fills a folder as a checkout is, with data beside it; the environment in which its commands run."""
    shape_files(folder)
    for name in ("configs", "docs", "models", "scripts"):
        (folder / name).symlink_to(ROOT / name)
    bin_folder = folder / "bin"
    bin_folder.mkdir()
    (bin_folder / "python3").symlink_to("/usr/bin/python3")  # which sees Debian's packages
    (bin_folder / "salbench").symlink_to(PROGRAM)
    (bin_folder / "salbench-engine").symlink_to(f"{PROGRAM}-engine")
    return os.environ | {"PATH": f"{bin_folder}:{os.environ['PATH']}", "TMPDIR": str(folder), "PYTHONDONTWRITEBYTECODE": "1"}
