# SPDX-License-Identifier: GPL-3.0-or-later
"""Gaze of people on shapes that they turned on a screen: fixations with hit points. [wang2024]

Published: https://doi.org/10.18419/darus-4101
Seen: no file; the columns, from 0, as public re-analyses read them: 4 and 5 pixel, 8 and 9 view, 10 duration,
11 to 13 x, y and z of the hit.
Assumed: the folders of these re-analyses, 3D_gaze_data/Code/Exp1/SHAPE/PERSON and obj/SHAPE.obj; durations in
ms; rows in order of time, each beginning when the one before it ends: no known column holds the time. The
hits are in the frame and unit of the .obj files.
Truth: none is published per vertex: `gaze:` of a configuration makes it. The authors spread fixations on the
screen, by 26.3 pixels: half a degree at 85 cm from a display of 24.5 inches. The position of the eye is
unknown, so `degrees` is unavailable: use `radius`.
Cannot answer: the position of the eye, and the visible part of a shape.
"""

from salbench.datasets.listings import recorded
from salbench.datasets.records import Item, Listing, Shape

VERSION = 1
LICENCE = "not known, the files were not seen; ask the authors"


def items(root: str) -> Listing:
    return recorded(root, "obj/*.obj", "3D_gaze_data/Code/Exp1/{item}/{person}", kind="mesh")


def read(item: Item) -> Shape:
    from salbench.datasets.reading import mesh
    from salbench.datasets.recordings import Recording, gather

    shape = mesh(item.files[0])
    shape.recording = gather(zip(item.info, item.files[1:]), Recording.of, duration=11, point=(12, 13, 14))
    return shape
