# SPDX-License-Identifier: GPL-3.0-or-later
"""3D-ViSa: gaze of 16 people on pictures of 180 meshes, three views of each, transferred to the vertices that
a view shows. [song2023]

Published: links in the public repository rsong/3D-ViSa.
Seen: that repository: six meshes, and the code that makes the values; none of the files of values. The code
blurs the fixations of all people in pictures of 1200 x 1200 pixels (Gaussian, standard deviation 30), gives
each visible vertex the exponential of its pixel, which is between 0 and 1, subtracts the smallest value and
divides by the largest. Hidden vertices thus have 0 and visible ones at least exp(-1): 0 is read as hidden,
and each view is scored by itself, on its visible vertices.
Assumed: the folders of this code, mesh3d/NAME.off and saliency3d_gt/NAMEk.txt, with k from 1 to 3 and a
number per line.
Truth: values are exponentials: CC with a density of fixations is not 1, but ranks are those of the density.
Cannot answer: who looked where: the published fixations are in pixels, and pooled over people.
"""

import os

from salbench.datasets.files import first, left_over, match
from salbench.datasets.records import Item, Listing, Shape
from salbench.system.errors import InputError

VERSION = 1
LICENCE = "not known, the files were not seen; ask the authors"


def items(root: str) -> Listing:
    _, meshes = first(root, ["mesh3d/*.off"])
    maps = [
        one for one in match(root, "saliency3d_gt/{item}{view}.txt", meshes) if one.view in ("1", "2", "3")
    ]
    if not maps:
        raise InputError(
            f"{os.path.join(root, 'saliency3d_gt')}: has no values of a view of a mesh: expected are files"
            " NAME1.txt to NAME3.txt"
        )
    listing = Listing([], notes=left_over(root, "saliency3d_gt/*.txt", [one.path for one in maps]))
    for name, mesh in meshes.items():
        views = [
            Item(f"{name}_{one.view}", [mesh, one.path], shape=name, view=one.view)
            for one in maps
            if one.item == name
        ]
        listing.items += views or [Item(name, [mesh], truth=False)]
    return listing


def read(item: Item) -> Shape:
    from salbench.datasets import reading

    found = reading.mesh(item.files[0])
    for path in item.files[1:]:
        found.ground_truth = reading.values(path, len(found.points), unseen=0)
    return found
