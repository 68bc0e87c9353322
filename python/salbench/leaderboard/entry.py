# SPDX-License-Identifier: GPL-3.0-or-later
"""An archive in the folder of submissions, with the result of its check."""

import os
from dataclasses import dataclass
from pathlib import Path

from salbench.leaderboard.card import Card
from salbench.leaderboard.submission import Submission
from salbench.leaderboard.texts import Manifest, shown
from salbench.system.errors import InputError

HERE, BY_AUTHORS = "measured here", "measured by its authors, maps checked"  # origins of a number


@dataclass
class Entry:
    file: Path
    read: Submission = Submission()  # empty if the archive is unreadable
    refused: str = "was not checked"  # reason; empty: not refused
    remark: str = ""
    beside: str = ""  # reason why it is not ranked; empty: ranked

    @property
    def card(self) -> Card:
        return self.read.card

    @property
    def manifest(self) -> Manifest:
        return self.read.manifest

    @property
    def name(self) -> str:
        """File name as a line."""
        return shown(self.file.name)

    @property
    def status(self) -> str:
        return "refused" if self.refused else "beside" if self.beside else "ranked"

    @property
    def seen(self) -> set[str]:
        """Items that the model was trained or tuned on."""
        return set(self.card.test_overlap)

    @property
    def trained_here(self) -> str:
        """Training data within the data set, including items that are not scored; empty: none, according to
        the card."""
        n = len(self.seen)
        # the splits of this data set, as checked in expected.py
        of_split = f"split {self.card.trained_on[1]}" if len(self.card.trained_on) == 3 else ""
        return "; ".join(
            filter(None, (f"{n} item{'s' * (n > 1)}" if n else "", of_split, self.manifest.learned))
        )

    @property
    def measured(self) -> str:
        """Origin of its numbers; empty: none."""
        return "" if self.refused else BY_AUTHORS


def archives_in(folder: str, may_be_none: bool) -> list[Entry]:
    found = sorted(
        entry.path
        for entry in os.scandir(folder)
        if entry.name.lower().endswith(".zip") and not entry.is_dir()
    )
    if not found and not may_be_none:
        raise InputError(
            f"{folder}: has no submission (NAME.zip, as salbench submit writes them); --models ranks models"
            " of the program alone"
        )
    return [Entry(Path(path)) for path in found]
