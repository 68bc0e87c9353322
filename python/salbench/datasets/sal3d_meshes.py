# SPDX-License-Identifier: GPL-3.0-or-later
"""As sal3d, but on the vertices of the meshes, which take the value of the nearest point. [martin2024]

Seen: none of the meshes; their gaze is that of sal3d.
"""

from salbench.datasets import sal3d
from salbench.datasets.records import Listing

VERSION = sal3d.VERSION
LICENCE = sal3d.LICENCE


def items(root: str) -> Listing:
    return sal3d.listed(root, [("Meshes/*.obj", "Gaze/{item}.txt")])


read = sal3d.read
