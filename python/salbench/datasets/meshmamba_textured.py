# SPDX-License-Identifier: GPL-3.0-or-later
"""The same meshes as meshmamba, seen with their textures. [zhang2025]

Seen: three of them, with their materials and pictures. Shapes have no colours; these files are part of the
key.
"""

from salbench.datasets import meshmamba
from salbench.datasets.records import Listing

VERSION = meshmamba.VERSION
LICENCE = meshmamba.LICENCE


def items(root: str) -> Listing:
    return meshmamba.listed(root, "rgb_texture")


read = meshmamba.read
