# SPDX-License-Identifier: GPL-3.0-or-later
"""Gaze of people on meshes without textures in virtual reality: a density per face. [zhang2025]

Published: a link in the public repository kaviezhang/MeshMamba.
Seen: that repository, with three meshes of 32 868 triangles, without and with texture, and its list of 100
files. Value files have one number per face and line, in the order of the mesh file; the largest is 1. Splits
cut the lines of paths_dataset_rgb.txt, for both kinds. The authors' code trains on the first 60 % and tests
on the last 60 %: of 100 shapes, 20 are in both. `train_80` and `test_20` are the splits of TexMeshSaliency,
80 % and 20 %.
Assumed: FixationMap/NAME.csv, which the authors' loader names and does not read, has a number per face, above
0 where somebody fixated; the corners of these faces are the picks that NSS and AUC need. No such file was
seen.
Cannot answer: who looked where (pooled over people).
"""

import os

from salbench.datasets import splits
from salbench.datasets.files import by_name, extension, first, left_over, list_folder, match
from salbench.datasets.records import Item, Listing, Shape
from salbench.system.errors import InputError

VERSION = 1
LICENCE = "not known; ask the authors"

TEXTURES = (".mtl", ".jpg", ".jpeg", ".png")
# "+": in each of these splits
SHARES = {"train+train_80": 0.4, "train+test+train_80": 0.2, "test+train_80": 0.2, "test+test_20": 0.2}


def items(root: str) -> Listing:
    return listed(root, "non_texture")


def listed(
    root: str, kind: str, paths: str = "paths_dataset_rgb.txt", shares: dict[str, float] = SHARES
) -> Listing:
    """Lists meshes without (`non_texture`) or with (`rgb_texture`) textures. paths: the list that splits are
    cut from."""
    _, meshes = first(root, [f"MeshFile/{kind}/*/*.obj"])
    values = f"SaliencyMap/{kind}/{{item}}.csv"
    maps, fixations = (
        by_name(match(root, pattern, meshes)) for pattern in (values, "FixationMap/{item}.csv")
    )
    if not maps:
        raise InputError(
            f"{os.path.join(root, os.path.dirname(values))}: has no saliency map of a mesh: expected are"
            " files NAME.csv"
        )
    listing = Listing([], notes=left_over(root, values, maps.values()))
    for name, mesh in meshes.items():
        truth = [maps[name], *([fixations[name]] if name in fixations else [])] if name in maps else []
        listing.items.append(
            Item(name, [mesh, *truth, *(_textures(mesh) if kind == "rgb_texture" else [])], truth=bool(truth))
        )
    return splits.from_list(listing, os.path.join(root, paths), shares)


def _textures(mesh: str) -> list[str]:
    """Materials and pictures in the mesh's own folder: not part of the shape, but of what people saw."""
    folder = os.path.dirname(mesh)
    return [
        os.path.join(folder, name)
        for name, is_folder in list_folder(folder)
        if not is_folder and extension(name) in TEXTURES
    ]


def read(item: Item) -> Shape:
    import numpy as np

    from salbench.datasets import reading

    found = reading.mesh(item.files[0])
    maps = [path for path in item.files if extension(path) == ".csv"]
    if maps:
        found.face_truth = reading.face_values(maps[0], found)
        found.ground_truth = reading.from_faces(found, found.face_truth)
    for path in maps[1:]:
        found.participants = [np.unique(found.faces[reading.face_values(path, found) > 0])]
    return found
