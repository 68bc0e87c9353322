# SPDX-License-Identifier: GPL-3.0-or-later
"""The same meshes as meshmamba, seen with their textures. [zhang2025]

Seen: three of them, with their materials and pictures; the form of a mesh has no colours, and names these files with their digests.
"""

from salbench.datasets import meshmamba

LAYOUT = meshmamba.layout("meshmamba_textured", "rgb_texture")
beside = meshmamba.textures
