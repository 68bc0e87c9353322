# SPDX-License-Identifier: GPL-3.0-or-later
"""23 models with the time that 32 people looked at each vertex in virtual reality; picks are the 1000
vertices that the study marks as interesting.

Published: data of the 2022 study.
Seen: the files, in the arrangement of folders of the Schelling study [chen2012], read in C++.
Cannot answer: who looked where (pooled over people).
"""

from salbench.datasets.study import listed
from salbench.datasets.records import Listing

VERSION = 1
LICENCE = "not known; ask the authors"


def items(root: str) -> Listing:
    return listed(root, [("Meshes/*", [("Distributions", "RawData")])])
