# SPDX-License-Identifier: GPL-3.0-or-later
"""SHREC'07 meshes beside a folder GS with the ground truth of the Schelling study. [chen2012]

Published: page of "Schelling Points on 3D Surface Meshes", Princeton computer graphics group.
Seen: the files; this is another arrangement of them. C++ reads them by itself.
"""

from salbench.datasets._layout import Layout, Pattern, Place, TruthPlace


def truth(folder: str, saliency: str = "Distributions") -> TruthPlace:
    """Of the study, below a folder: smoothed picks, and those of each participant."""
    return TruthPlace(Pattern(f"{folder}{saliency}/{{item}}.val"), Pattern(f"{folder}RawData/{{item}}_{{participant}}.pid"))


def _place(needs: str, meshes: str) -> Place:
    return Place(Pattern(f"{meshes}/*"), (truth("GS/" if needs == "GS" else "", "Saliency"),), needs)


LAYOUT = Layout(
    "gs",
    tuple(_place(needs, meshes) for folder in ("off", "Meshes")
          for needs, meshes in (("GS", folder), ("Saliency", folder), ("Saliency", f"../{folder}"))),
    classes="shrec07", needs_truth=False, licence="not known; cite the study, and ask its authors before you pass the data on")
