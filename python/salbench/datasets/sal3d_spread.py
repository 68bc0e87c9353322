# SPDX-License-Identifier: GPL-3.0-or-later
"""As sal3d, but spread over the nearest points in space, for archives without the authors' lists of
neighbours: a stand-in. [martin2024]

Seen: as sal3d. The authors' own neighbours are not available, so scores approximate the published ones at
best.
"""


from salbench.datasets import sal3d
from salbench.datasets.records import Item, Listing, Shape

VERSION = sal3d.VERSION
LICENCE = sal3d.LICENCE
REMARK = (
    "TRUTH: gaze densities spread over the 500 nearest points, a stand-in for the authors' lists of"
    " neighbours that the published scores are measured with"
)


def items(root: str) -> Listing:
    return sal3d.listed(root, has_lists=False, remark=REMARK)


def read(item: Item) -> Shape:
    return sal3d.read(item, nearest=True)
