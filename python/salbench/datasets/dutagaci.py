# SPDX-License-Identifier: GPL-3.0-or-later
"""Interest points that people marked on 43 meshes, pooled over them. [dutagaci2012]

Published: NIST, "A Benchmark for 3D Interest Point Detection Algorithms".
Seen: nothing but the paper; all names are assumed.
Assumed: a cell array GT_POINTS, row: radius of agreement in hundredths of the diameter, column: number of people who agree; a cell holds
vertices counted from 1. Cell 3, 8 has the points that 8 people marked within 0.03; other readings are other cells, in a description of
your own.
Cannot answer: who marked what (HS does not apply).
"""

from salbench.datasets._layout import Indices, Layout, Pattern, Place, TruthPlace

LAYOUT = Layout(
    "dutagaci",
    (Place(Pattern("MODEL_DATASET/*.off"),
           tuple(TruthPlace(picks=Pattern(f"GROUND_TRUTH_{part}/{{item}}.mat")) for part in "BA")),),
    indices=Indices(base=1, variable="GT_POINTS", cell=("3", "8")), licence="not known, the archive was not seen; ask the authors")
