# SPDX-License-Identifier: GPL-3.0-or-later
"""As sal3d, but on the vertices of the meshes, which take the value of the nearest point. [martin2024]

Seen: none of the meshes; their gaze is that of sal3d.
"""

from functools import partial

from salbench.datasets import described
from salbench.datasets._layout import Layout, Pattern, Place, Splits, TruthPlace, Values
from salbench.datasets.described import VERSION, read

LAYOUT = Layout("sal3d_meshes", (Place(Pattern("Meshes/*.obj"), (TruthPlace(Pattern("Gaze/{item}.txt")),)),),
                values=Values("point", "7", ("1", "2", "3")), splits=Splits(table="splits.csv"), licence="not known; ask the authors")
items = partial(described.items, LAYOUT)

__all__ = ["LAYOUT", "VERSION", "items", "read"]
