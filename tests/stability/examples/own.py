# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes, and for some a number per vertex: -1 where nobody looked."""
import os

from salbench.datasets import Item, match, mesh, values

VERSION = 1
LICENCE = "none"


def items(root):
    found = []
    for one in match(root, "shapes/{item}.ply"):
        saliency = f"{root}/mine/{one.item}.val"
        truth = [saliency] if os.path.exists(saliency) else []
        found.append(Item(one.item, [one.path, *truth], split="train" if one.item == "1" else "", truth=bool(truth)))
    return found


def read(item):
    shape = mesh(item.files[0])
    for path in item.files[1:]:
        shape.ground_truth = values(path, len(shape.points), unseen=-1)
    return shape
