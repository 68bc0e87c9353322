# SPDX-License-Identifier: GPL-3.0-or-later
"""What a submission is held against."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from salbench.leaderboard import texts
from salbench.leaderboard.card import MOST_SEEDS

_MEMORY = 1 << 30  # beside twice the bytes of an archive: the interpreter, NumPy, and the program's libraries
NAMES = ("submission.yaml", "card.yaml", "configuration.yaml", "results.csv")
OPTIONAL = (texts.MODEL, texts.LIST)


@dataclass(frozen=True)
class Expected:
    """From a run over the data set that has no maps of it."""

    protocol: str  # the configuration without models and folders
    data: str  # digest of names, shapes and ground truth
    points: Mapping[str, int]  # of each shape with ground truth, by its name
    items: tuple[str, ...]  # that shapes are of: the meshes or point clouds
    layout: str = ""
    splits: str = ""  # digest of which item is in which
    split_of: Mapping[str, str] = field(default_factory=dict)  # by item, where it is in one
    split_names: tuple[str, ...] = ()  # of the data set, whatever is scored
    item_of: Mapping[str, str] = field(default_factory=dict)  # by the name of a shape, which may be a scan or view

    @property
    def most_bytes(self) -> int:
        """What a submission can need, unpacked: five texts, a list, and per shape a row of scores and a map of each training with its header."""
        header, row = 1024, 4096
        trainings = 1 + MOST_SEEDS
        return (len(NAMES) + 1) * texts.LONGEST_TEXT + texts.LONGEST_LIST + sum(trainings * (8 * n + header) + row for n in self.points.values())

    @property
    def most_entries(self) -> int:
        return len(NAMES) + len(OPTIONAL) + (1 + MOST_SEEDS) * len(self.points)

    @property
    def most_memory(self) -> int:
        return 2 * self.most_bytes + _MEMORY
