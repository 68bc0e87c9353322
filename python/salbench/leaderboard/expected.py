# SPDX-License-Identifier: GPL-3.0-or-later
"""What a submission is checked against."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from salbench.leaderboard import texts
from salbench.leaderboard.card import MOST_SEEDS

NAMES = ("submission.yaml", "card.yaml", "configuration.yaml", "results.csv")
OPTIONAL = (texts.MODEL, texts.LIST)
_HEADER, _ROW = 1024, 4096  # bytes of a map's header, and of a row of results.csv


@dataclass(frozen=True)
class Expected:
    """From a run over the data set without submissions."""

    protocol: str  # the configuration without models and folders
    data: str  # digest of names, shapes and ground truth
    points: Mapping[str, int]  # number per shape with ground truth, by its name
    items: tuple[str, ...]  # the meshes or point clouds that the shapes belong to
    layout: str = ""
    splits: str = ""  # digest of the splits of all items
    split_of: Mapping[str, str] = field(default_factory=dict)  # by item that is in a split
    split_names: tuple[str, ...] = ()  # of the data set, whatever is scored
    item_of: Mapping[str, str] = field(default_factory=dict)  # by the name of a shape, which may be a scan or view

    @property
    def most_bytes(self) -> int:
        """What a submission can need, unpacked: texts, a list, and per shape a row of scores and a map of each training."""
        maps = sum((1 + MOST_SEEDS) * (8 * n + _HEADER) + _ROW for n in self.points.values())
        return (len(NAMES) + 1) * texts.LONGEST_TEXT + texts.LONGEST_LIST + maps

    @property
    def most_entries(self) -> int:
        return len(NAMES) + len(OPTIONAL) + (1 + MOST_SEEDS) * len(self.points)
