# SPDX-License-Identifier: GPL-3.0-or-later
"""Where people looked on meshes in virtual reality, without textures: a density per face. [zhang2025]

Published: a link in the public repository kaviezhang/MeshMamba.
Seen: that repository, with three meshes of 32 868 triangles, without and with texture, and its list of 100 files.
A line of a file of values is a number per face, in the order of the mesh's file; the largest is 1. Splits are of the lines of
paths_dataset_rgb.txt, for both kinds. The authors' code trains on the first 60 % and tests on the last 60 %: of 100 shapes, 20 are in
both. `train_80` and `test_20` are those that TexMeshSaliency gives, 80 % and 20 %.
Cannot answer: who looked where (pooled over people).
"""

import os
from salbench.datasets._files import extension, list_folder
from salbench.datasets._layout import Layout, Pattern, Place, Splits, TruthPlace, Values
from salbench.datasets.records import Source

TEXTURES = (".mtl", ".jpg", ".jpeg", ".png")
SHARES = (("train+train_80", 0.4), ("train+test+train_80", 0.2), ("test+train_80", 0.2), ("test+test_20", 0.2))  # "+": in each of them


def layout(name: str, kind: str) -> Layout:
    """Of meshes without (`non_texture`) or with (`rgb_texture`) their textures."""
    return Layout(
        name,
        (Place(Pattern(f"MeshFile/{kind}/*/*.obj"), (TruthPlace(Pattern(f"SaliencyMap/{kind}/{{item}}.csv")),)),),
        values=Values(per="face"), splits=Splits(list="paths_dataset_rgb.txt", shares=SHARES),
        licence="not known; ask the authors")


def textures(mesh: str) -> list[Source]:
    """Materials and pictures in the folder of a mesh, which has it alone."""
    folder = os.path.dirname(mesh)
    names = [name for name, is_folder in list_folder(folder) if not is_folder and extension(name) in TEXTURES]
    return [Source(f"texture {k}, {extension(name)}", os.path.join(folder, name), f"texture {name}") for k, name in enumerate(names)]


LAYOUT = layout("meshmamba", "non_texture")
