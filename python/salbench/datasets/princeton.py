# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes of the Princeton segmentation benchmark [chen2009], with the ground truth of the Schelling study
[chen2012] beside them.

Published: https://segeval.cs.princeton.edu/
Seen: the files. Read in C++.
"""

import os

from salbench.datasets.study import Folders, listed
from salbench.datasets.records import Listing

VERSION = 1
LICENCE = "not known; cite the study, and ask its authors before you pass the data on"


def items(root: str) -> Listing:
    """Meshes in off/, or in the folder itself if it is named off; ground truth beside that folder."""
    places = [(f"{folder}off/*", _truths("")) for folder in ("", "data/", "MeshsegBenchmark-1.0/data/")]
    if os.path.basename(os.path.normpath(root)) == "off":
        places.append(("*", _truths("../")))
    return listed(root, places, required=False, shrec07=True)


def _truths(above: str) -> list[Folders]:
    study = [f"{above}{'SchellingData/' * depth}" for depth in range(3)]
    return [
        (f"{above}GS/Saliency", f"{above}GS/RawData"),
        *((f"{folder}Distributions", f"{folder}RawData") for folder in study),
    ]
