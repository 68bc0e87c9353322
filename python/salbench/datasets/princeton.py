# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes of the Princeton segmentation benchmark [chen2009], with the ground truth of the Schelling study [chen2012] beside them.

Published: https://segeval.cs.princeton.edu/
Seen: the files. C++ reads them by itself.
"""

from salbench.datasets._layout import Layout, Pattern, Place, TruthPlace
from salbench.datasets.gs import truth


def _truths(above: str) -> tuple[TruthPlace, ...]:
    return (truth(f"{above}GS/", "Saliency"), *(truth(f"{above}{'SchellingData/' * depth}") for depth in range(3)))


LAYOUT = Layout(
    "princeton",
    (*(Place(Pattern(f"{folder}off/*"), _truths("")) for folder in ("", "data/", "MeshsegBenchmark-1.0/data/")),
     Place(Pattern("*"), _truths("../"), root_is="off")),
    classes="shrec07", needs_truth=False, licence="not known; cite the study, and ask its authors before you pass the data on")
