# SPDX-License-Identifier: GPL-3.0-or-later
"""Static point clouds that people inspected in virtual reality with six degrees of freedom: a fixation
density per point. [alexiou2019]

Published: by the authors, Multimedia Signal Processing Group, EPFL: fixation density maps, and recorded
trajectories of gaze and head.
Seen: nothing but the paper's abstract.
Assumed: this arrangement, to be made from the authors' files: Clouds/NAME.ply (or .pcd, .xyz), and
Densities/NAME.txt with a number per point, in the order of the cloud's file. Points that nobody looked at
have 0.
Truth: points without a position are left out, with their densities.
Cannot answer: who looked where: the recorded gaze is not read.
"""

import os

from salbench.datasets.files import by_name, first, left_over, match
from salbench.datasets.records import Item, Listing, Shape
from salbench.system.errors import InputError

VERSION = 1
LICENCE = "not known, the files were not seen; ask the authors"


def items(root: str) -> Listing:
    _, clouds = first(root, ["Clouds/*"])
    maps = by_name(match(root, "Densities/{item}.txt", clouds))
    if not maps:
        raise InputError(
            f"{os.path.join(root, 'Densities')}: has no densities of a cloud: expected are files NAME.txt"
        )
    return Listing(
        [
            Item(name, [cloud, *([maps[name]] if name in maps else [])], kind="cloud", truth=name in maps)
            for name, cloud in clouds.items()
        ],
        notes=left_over(root, "Densities/*.txt", maps.values()),
    )


def read(item: Item) -> Shape:
    from salbench.datasets import reading

    found = reading.cloud(item.files[0])
    for path in item.files[1:]:
        left = reading.numbering(found) >= 0
        found.ground_truth = reading.values(path, len(left))[left]
    return found
