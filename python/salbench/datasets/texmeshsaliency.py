# SPDX-License-Identifier: GPL-3.0-or-later
"""Textured Mesh Saliency: gaze of people on textured meshes in virtual reality, a density per face.
[zhang2025tex]

Published: a link to the data in the public repository kaviezhang/TexMeshSaliency.
Seen: the code of that repository and its list paths_dataset_tex.txt, with absolute paths: the same 100 names
as those of Mesh Mamba, in the same order. No mesh and no file of values.
Assumed: the folders and files of Mesh Mamba, as this code names them. Splits are the first 80 % and the last
20 % of the list. Warning: the authors' loader takes SaliencyMap/non_texture as its target, values of the
meshes without textures, although it trains on the textured ones. Here the truth is SaliencyMap/rgb_texture,
so scores cannot be compared with what that code prints.
Cannot answer: who looked where (pooled over people).
"""

from salbench.datasets import meshmamba
from salbench.datasets.records import Listing

VERSION = meshmamba.VERSION
LICENCE = "not known; ask the authors"
REMARK = (
    "TRUTH: densities of the textured meshes; the authors' loader takes those of the meshes without textures"
    " (SaliencyMap/non_texture) as its target"
)


def items(root: str) -> Listing:
    listing = meshmamba.listed(root, "rgb_texture", "paths_dataset_tex.txt", {"train": 0.8, "test": 0.2})
    listing.remark = REMARK
    listing.notes.append(REMARK)
    return listing


read = meshmamba.read
