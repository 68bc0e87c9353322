# SPDX-License-Identifier: GPL-3.0-or-later
"""Gaze of 46 people who walked through twelve scenes of Gaussian splats, with eye-tracking headsets.
[ding2025]

Published: https://github.com/symmru/EyeNavGS_Rutgers_Dataset and
https://github.com/sawalee0811/EyeNavGS_NTHU_Dataset
Seen: the documentation of both, and the first rows of two recordings (NTHU): a row per frame and eye,
ViewIndex 0 is the left one; the last column is the time in ms, called Timestamp in the documentation and
timestep in these rows. No scene was seen: the scenes belong to third parties.
Assumed: dataset/SCENE/PERSON_SCENE.csv, or SCENE/PERSON_SCENE.csv, and scenes/SCENE.ply, the centres of the
splats in the frame of the recordings, that is, the frame of the software that showed them. Its scale, tilt
and start of each scene (scene_setting.csv) are not applied: apply them to the cloud. Gaze is the quaternion
GazeQ applied to the forward axis, which is -z, as the authors' overlay has it. That overlay then turns the
gaze of each eye outwards by 15.55 degrees, to fit its pictures; here it stays as recorded. The left eye
represents both.
Truth: none is published per point: `gaze:` of a configuration makes it.
Cannot answer: which splats were occluded: rays meet the partial mesh of the centres.
"""

from salbench.datasets.files import match
from salbench.datasets.listings import recorded
from salbench.datasets.records import Item, Listing, Shape

VERSION = 2
LICENCE = "Apache 2.0 for the recordings; the scenes have terms of their own"


def items(root: str) -> Listing:
    pattern = "{item}/{person}_{item}.csv"
    return recorded(
        root,
        "scenes/*.ply",
        f"dataset/{pattern}" if match(root, f"dataset/{pattern}") else pattern,
        kind="cloud",
    )


def read(item: Item) -> Shape:
    from salbench.datasets import trackers
    from salbench.datasets.reading import cloud
    from salbench.datasets.recordings import gather

    shape = cloud(item.files[0])
    shape.recording = gather(zip(item.info, item.files[1:]), trackers.eyenavgs)
    return shape
