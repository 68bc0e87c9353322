# SPDX-License-Identifier: GPL-3.0-or-later
"""SHREC'07 meshes beside a folder GS with the ground truth of the Schelling study. [chen2012]

Published: page of "Schelling Points on 3D Surface Meshes", Princeton computer graphics group.
Seen: the files; this is another arrangement of them, read in C++.
"""

import os

from salbench.datasets.study import Folders, listed
from salbench.datasets.records import Listing

VERSION = 1
LICENCE = "not known; cite the study, and ask its authors before you pass the data on"

_IN_GS: Folders = ("GS/Saliency", "GS/RawData")
_HERE: Folders = ("Saliency", "RawData")


def items(root: str) -> Listing:
    """Lists the first candidate that has meshes, among those with a folder of ground truth."""
    places = [
        (f"{meshes}/*", folders)
        for name in ("off", "Meshes")
        for meshes, folders in ((name, _IN_GS), (name, _HERE), (f"../{name}", _HERE))
    ]
    there = [place for place in places if os.path.isdir(os.path.join(root, place[1][0].split("/")[0]))]
    return listed(
        root, [(meshes, [folders]) for meshes, folders in there or places[:1]], required=False, shrec07=True
    )
