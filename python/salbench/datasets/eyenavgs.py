# SPDX-License-Identifier: GPL-3.0-or-later
"""Where 46 people looked while they walked through twelve scenes of Gaussian splats, with headsets that track eyes. [ding2025]

Published: https://github.com/symmru/EyeNavGS_Rutgers_Dataset and https://github.com/sawalee0811/EyeNavGS_NTHU_Dataset
Seen: the documentation of both, and the first rows of two recordings (NTHU): a row per frame and eye, ViewIndex 0 is the left one; the last
column is the time in ms, called Timestamp in the documentation and timestep in these rows. No scene was seen: they belong to others.
Assumed: dataset/SCENE/PERSON_SCENE.csv, or SCENE/PERSON_SCENE.csv, and scenes/SCENE.ply, the centres of the splats in the frame of the
recordings, which is that of the software that showed them. Its scale, tilt and start of each scene (scene_setting.csv) are not applied: apply
them to the cloud. Gaze is the quaternion GazeQ applied to the forward axis, which is -z, as the authors' overlay has it. That overlay then
turns the gaze of each eye outwards by 15.55 degrees, to fit its pictures; here it stays as recorded. The left eye stands for both.
Truth: none is published per point: `gaze:` of a configuration makes it.
Cannot answer: what a splat hid: rays meet the partial mesh of the centres.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from salbench.datasets.files import first, match
from salbench.datasets.records import Item, Listing, Shape
from salbench.datasets.saliency3d import recorded

if TYPE_CHECKING:
    import pandas as pd

VERSION = 1
LICENCE = "Apache 2.0 for the recordings; the scenes have terms of their own"
PLACE, TURN, TIME = ("GazePosX", "GazePosY", "GazePosZ"), ("GazeQX", "GazeQY", "GazeQZ", "GazeQW"), 20


def items(root: str) -> Listing:
    scenes, patterns = first(root, ["scenes/*.ply"])[1], ("dataset/{item}/{person}_{item}.csv", "{item}/{person}_{item}.csv")
    return recorded(root, scenes, patterns[0] if match(root, patterns[0], scenes) else patterns[1], "cloud")


def read(item: Item) -> Shape:
    from salbench.datasets.gaze import Gaze, gather
    from salbench.datasets.reading import cloud

    gaze = Gaze(time=TIME, origin=PLACE, direction=("forward x", "forward y", "forward z"), normalise_directions=True)
    return gather(zip(item.files[1:], item.info), _left_eye, gaze).added_to(cloud(item.files[0]))


def _left_eye(path: str) -> pd.DataFrame:
    """Rows of the left eye, with the forward axis that its quaternion turns; of length 0 where the tracker wrote zeros."""
    import pandas as pd

    from salbench.datasets.gaze import table

    frame = table(path, ["ViewIndex", TIME, *PLACE, *TURN])
    frame = frame[pd.to_numeric(frame["ViewIndex"], errors="coerce") == 0]
    x, y, z, w = (pd.to_numeric(frame[column], errors="coerce") for column in TURN)
    return frame.assign(**{"forward x": -2 * (x * z + w * y), "forward y": -2 * (y * z - w * x), "forward z": x * x + y * y - z * z - w * w})
