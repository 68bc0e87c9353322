# SPDX-License-Identifier: GPL-3.0-or-later
"""As sal3d, but on the vertices of the meshes, which take the value of the nearest point. [martin2024]

Seen: none of the meshes; their gaze is that of sal3d.
"""

from dataclasses import replace

from salbench.datasets import sal3d
from salbench.datasets._layout import Columns, Pattern, Place, TruthPlace

LAYOUT = replace(sal3d.LAYOUT, name="sal3d_meshes", columns=Columns(), places=(
    Place(Pattern("Meshes/*.obj"), (TruthPlace(Pattern("Gaze/{item}.txt")),), neighbours=sal3d.LISTS),))
