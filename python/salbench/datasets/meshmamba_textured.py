# SPDX-License-Identifier: GPL-3.0-or-later
"""The same meshes as meshmamba, seen with their textures. [zhang2025]

Seen: three of them, with their materials and pictures; the form of a mesh has no colours, and names these files with their digests.
"""

from functools import partial

from salbench.datasets import described, meshmamba
from salbench.datasets.described import VERSION, read

LAYOUT = meshmamba.layout("meshmamba_textured", "rgb_texture")
items = partial(described.items, LAYOUT, beside=meshmamba.textures)

__all__ = ["LAYOUT", "VERSION", "items", "read"]
