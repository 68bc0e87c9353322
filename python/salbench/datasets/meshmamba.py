# SPDX-License-Identifier: GPL-3.0-or-later
"""Where people looked on meshes in virtual reality, without textures: a density per face. [zhang2025]

Published: a link in the public repository kaviezhang/MeshMamba.
Seen: that repository, with three meshes of 32 868 triangles, without and with texture, and its list of 100 files.
A line of a file of values is a number per face, in the order of the mesh's file; the largest is 1. The first 80 % of the lines of
paths_dataset_rgb.txt are what the authors train with, for both kinds.
Cannot answer: who looked where (pooled over people).
"""

import os
from salbench.datasets._files import extension, list_folder
from salbench.datasets._layout import Layout, Pattern, Place, Splits, TruthPlace, Values
from salbench.datasets.records import Source

TEXTURES = (".mtl", ".jpg", ".jpeg", ".png")


def layout(name: str, kind: str) -> Layout:
    """Of meshes without (`non_texture`) or with (`rgb_texture`) their textures."""
    return Layout(
        name,
        (Place(Pattern(f"MeshFile/{kind}/*/*.obj"), (TruthPlace(Pattern(f"SaliencyMap/{kind}/{{item}}.csv")),)),),
        values=Values(per="face"), splits=Splits(list="paths_dataset_rgb.txt", shares=(("train", 0.8), ("test", 0.2))),
        licence="not known; ask the authors")


def textures(mesh: str) -> list[Source]:
    """Materials and pictures in the folder of a mesh, which has it alone."""
    folder = os.path.dirname(mesh)
    names = [name for name, is_folder in list_folder(folder) if not is_folder and extension(name) in TEXTURES]
    return [Source(f"texture {k}, {extension(name)}", os.path.join(folder, name), f"texture {name}") for k, name in enumerate(names)]


LAYOUT = layout("meshmamba", "non_texture")
