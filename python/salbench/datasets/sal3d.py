# SPDX-License-Identifier: GPL-3.0-or-later
"""Where 32 people looked on 58 meshes in virtual reality: 20 000 points of the surface of each, with fixation densities. [martin2024]

Published: supplement of the paper; an earlier state in the public repository FandosA/3D_Mesh_Saliency_Prediction_PyTorch.
Seen: 52 point clouds of that state, and their splits.
A line has the position, a direction along the normal, the density, and 1 for the points that are looked at most, between blanks. In 26 of
the 52 clouds the directions are sums around a vertex, mostly 2 pi long, in the others unit normals. None of them is padded. Points with
the same position are clones of one vertex: each is scored, as the authors do.
Assumed: Models_3D/ and dataset_*/ of the earlier state, and meshes/ and gaze/ of another public repository, whose meshes take the value of
the nearest point.
Truth: the density is raw, and not 0 on a quarter of the points. The published scores are on densities that each point that was looked at
spreads over its first 500 neighbours, with 0.9 of its own value at the first and 0 at the last. The lists of neighbours are in Smooth_Gaze
of the final release (not seen; as a public re-analysis reads them). Where they are, the ground truth is spread; elsewhere it stays raw, and
every table says so.
Cannot answer: who looked where (pooled over people).
"""

from salbench.datasets._layout import LISTED, Columns, Layout, Pattern, Place, Splits, TruthPlace, Values

LISTS = Pattern("Smooth_Gaze/{item}_neighbors.txt")
_VALUES = Values("point", "7", ("1", "2", "3"), spread_neighbours=500, spread_from=0.9, spread_along=LISTED)
_LICENCE = "not known; ask the authors"


def _meshes(meshes: str, gaze: str) -> Place:
    return Place(Pattern(meshes), (TruthPlace(Pattern(gaze)),), neighbours=LISTS)


LAYOUT = Layout(
    "sal3d",
    (Place(Pattern("Gaze/*.txt"), neighbours=LISTS),  # as published: points and ground truth in one
     _meshes("Models_3D/*.obj", "dataset_*/{item}.txt"), _meshes("meshes/*.obj", "gaze/{item}.txt")),
    values=_VALUES, columns=Columns(("1", "2", "3"), ("4", "5", "6"), True, "any", "kept", "7", "8"),
    splits=Splits(table="splits.csv"), licence=_LICENCE,
    remark_unlisted="TRUTH: raw gaze densities; the published scores are measured on smoothed ones, whose lists of neighbours (Smooth_Gaze) are not "
                    "here")
