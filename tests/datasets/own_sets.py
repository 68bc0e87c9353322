# SPDX-License-Identifier: GPL-3.0-or-later
"""Data sets in files of Python, as users write them."""

PLAIN = '''"""Cattle."""
import os
from salbench.datasets import Item, match, mesh, values
VERSION = 1
LICENCE = "mine"
def items(root):
    return [Item(one.item, [one.path, f"{root}/v/{one.item}.txt"]) for one in match(root, "m/{item}.off")]
def read(item):
    shape = mesh(item.files[0])
    shape.ground_truth = values(item.files[1], len(shape.points))
    return shape
'''
FACES = PLAIN.replace("shape.ground_truth = values(item.files[1], len(shape.points))", """shape.face_truth = face_values(item.files[1], shape)
    shape.ground_truth = from_faces(shape, shape.face_truth)""").replace("import Item,", "import Item, face_values,").replace(
        "VERSION", "from salbench.datasets.reading import from_faces\nVERSION")
VIEWS = """from salbench.datasets import Item, Listing, mask, match, mesh, splits, values
VERSION = 1
def items(root):
    found = [Item(f"{one.item}_{one.view}", [f"{root}/m/{one.item}.off", one.path, f"{root}/seen/{one.item}_{one.view}.txt"], shape=one.item, view=one.view)
             for one in match(root, "v/{item}_{view}.txt")]
    return splits.from_table(Listing(found), f"{root}/splits.csv")
def read(item):
    shape = mesh(item.files[0])
    shape.ground_truth = values(item.files[1], 4)
    shape.ground_truth[~mask(item.files[2], 4)] = float("nan")
    return shape
"""
VIEWERS = """import numpy
from salbench.datasets import Item, match, mesh, values
from salbench.datasets.reading import mean
def items(root):
    return [Item(one.item, [one.path, *(of.path for of in match(root, "maps/{item}_{viewer}.csv", [one.item]))], viewers=2) for one in match(root, "off/{item}.off")]
def read(item):
    shape = mesh(item.files[0])
    shape.viewers = numpy.stack([values(path, 4, unseen=-1) for path in item.files[1:]])
    shape.ground_truth = mean(shape.viewers)
    return shape
"""


def doing(**work):
    """PLAIN, of which some items do something else when they are read."""
    return PLAIN.replace("def read(item):\n", "def read(item):\n" + "".join(f"    if item.name == {name!r}:\n        {what}\n" for name, what in work.items()))
