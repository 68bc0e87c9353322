# SPDX-License-Identifier: GPL-3.0-or-later
"""As sal3d, but spread over the nearest points in space, for archives without the authors' lists of neighbours: a stand-in. [martin2024]

Seen: as sal3d. The authors' neighbours are theirs alone, so scores are near the published ones at best.
"""

from dataclasses import replace

from salbench.datasets import sal3d
from salbench.datasets._layout import SPACE, Pattern

LAYOUT = replace(
    sal3d.LAYOUT, name="sal3d_spread", values=replace(sal3d.LAYOUT.values, spread_along=SPACE), remark_unlisted="",
    places=tuple(replace(place, neighbours=Pattern()) for place in sal3d.LAYOUT.places),
    remark="TRUTH: gaze densities spread over the 500 nearest points, a stand-in for the authors' lists of neighbours that the published scores "
           "are measured with")
