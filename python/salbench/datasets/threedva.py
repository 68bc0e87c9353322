# SPDX-License-Identifier: GPL-3.0-or-later
"""Where people looked on rendered meshes: fixation densities per vertex from three views of each of 32 meshes, and which vertices each
view shows. Each view is scored by itself, on what it shows. [lavoue2018]

Published: https://perso.liris.cnrs.fr/guillaume.lavoue/data/saliency/
Seen: the names of its folders and files, none of the files.
Assumed: a number per line. A hidden vertex has 0 in the densities, and so has one that is visible and not looked at: the masks tell them
apart. The second arrangement has no masks, and -1 for hidden; its views are averaged. The published densities are not negative.
People: PerSubjectFixations/NAME_VIEW.csv.Tnn.result has a number per vertex of each of 19 people (not seen; as a public re-analysis reads
them). They give HS and reliability per view; the ground truth stays the published density. Files of `hand-35K` begin with `hand_`.
Cannot answer: who looked where, without these files.
"""

from salbench.datasets._layout import Layout, Pattern, Place, TruthPlace, Values

_PUBLISHED = (TruthPlace(Pattern("FixationMaps/{item}_{view}norm.txt"),
                         viewers=Pattern("PerSubjectFixations/{item}_{view}.csv.T{viewer}.result"),
                         mask=Pattern("CentricityAndVisibilityMaps/{item}_{view}_visibility.txt")),)
LAYOUT = Layout(
    "3dva",
    (Place(Pattern("3DModels-Simplif/*"), _PUBLISHED, views="scored"),
     Place(Pattern("3DModels-Simplif-up/*"), _PUBLISHED, views="scored"),  # the same meshes, turned upright
     Place(Pattern("Meshes/*"), (TruthPlace(Pattern("FixationMaps/{item}_{view}.txt")),))),
    values=Values(unseen="-1"), aliases=(("hand", "hand-35K"),), licence="not known, the files were not seen; ask the authors")
