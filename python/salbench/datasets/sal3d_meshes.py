# SPDX-License-Identifier: GPL-3.0-or-later
"""As sal3d, but on the vertices of the meshes, which take the value of the nearest point. [martin2024]

Seen: none of the meshes; their gaze is that of sal3d.
"""

from salbench.datasets._layout import Layout, Pattern, Place, Splits, TruthPlace, Values

LAYOUT = Layout("sal3d_meshes", (Place(Pattern("Meshes/*.obj"), (TruthPlace(Pattern("Gaze/{item}.txt")),)),),
                values=Values("point", "7", ("1", "2", "3")), splits=Splits(table="splits.csv"), licence="not known; ask the authors")
