# SPDX-License-Identifier: GPL-3.0-or-later
"""Expectations for submissions: the data set of a leaderboard, and the items that a model was trained on."""

import os
import re
import unicodedata
from collections.abc import Mapping
from dataclasses import dataclass, field

from salbench import _core
from salbench.leaderboard import texts
from salbench.leaderboard.card import MOST_SEEDS, Card
from salbench.system.errors import InputError, quoted

NAMES = ("submission.yaml", "card.yaml", "configuration.yaml", "results.csv")
OPTIONAL = (texts.MODEL, texts.LIST)
_HEADER, _ROW = 1024, 4096  # bytes of a map's header, and of a row of results.csv
_LONGEST_NAME = 255  # characters of a file name; normalising takes quadratic time


@dataclass(frozen=True)
class Expected:
    """Facts from a run over the data set without submissions."""

    protocol: str  # the configuration without models and folders
    data: str  # digest of names, shapes and ground truth
    points: Mapping[str, int]  # values of a map, by name of a shape with ground truth
    items: tuple[str, ...]  # meshes or point clouds that the shapes belong to
    layout: str = ""
    splits: str = ""  # digest of the splits of all items
    split_of: Mapping[str, str] = field(default_factory=dict)  # for items in a split
    split_names: tuple[str, ...] = ()  # in the data set, even if not scored
    # by name of a shape, which may be a scan or view
    item_of: Mapping[str, str] = field(default_factory=dict)

    @property
    def most_bytes(self) -> int:
        """Bound for an unpacked submission: texts, a list, and per shape a row of scores and one map per
        training."""
        maps = sum((1 + MOST_SEEDS) * (8 * n + _HEADER) + _ROW for n in self.points.values())
        return (len(NAMES) + 1) * texts.LONGEST_TEXT + texts.LONGEST_LIST + maps

    @property
    def most_entries(self) -> int:
        return len(NAMES) + len(OPTIONAL) + (1 + MOST_SEEDS) * len(self.points)


def trained_on(card: Card, names: bytes | None, digest: str, expected: Expected) -> set[str]:
    """Items that a model was trained on, by its card. names: content of the list, if there is one; digest:
    the expected one. Throws InputError."""
    if (names is None) == (len(card.trained_on) == 1):
        raise InputError(
            f"has no {texts.LIST}, the file {quoted(card.trained_on[0])} of card.yaml"
            if names is None
            else f"has {texts.LIST}, and card.yaml names no file of training shapes"
        )
    if names is None:
        return _in_split(card, expected) if card.trained_on else set()
    if _core.digest(names) != digest:
        raise InputError(f"{texts.LIST} is not what submission.yaml has the digest of")
    return _named(names, expected)


def _in_split(card: Card, expected: Expected) -> set[str]:
    layout, split, digest = card.trained_on
    for what, given, has in (
        ("layout", layout, [expected.layout]),
        ("digest of splits", digest, [expected.splits]),
        ("split", split, expected.split_names),
    ):
        if given not in has:
            raise InputError(
                f"card.yaml: trained_on has the {what} {quoted(given)}, and this data set has"
                f" {', '.join(has) or 'none'}"
            )
    return {item for item, names in expected.split_of.items() if split in names.split("+")}


def _named(names: bytes, expected: Expected) -> set[str]:
    """Items in a list. Each line begins with a name or path; letter case, extension and further columns are
    ignored. A scan or view counts as its item."""
    item_of = {_folded(f"{item}_{scan}"): item for item in expected.items for scan in range(_core.views)}
    item_of |= {_folded(shape): item for shape, item in expected.item_of.items()} | {
        _folded(item): item for item in expected.items
    }
    first = [
        re.split(r"[,;\t]", line.removeprefix("\ufeff"))[0].strip(' "')
        for line in names.decode("utf-8", "surrogateescape").splitlines()
    ]
    files = [re.split(r"[/\\]", path)[-1] for path in first if path and not path.startswith("#")]
    if not files:
        raise InputError(f"{texts.LIST} has no name; leave trained_on out, or write none")
    short = [file for file in files if len(file) <= _LONGEST_NAME]
    return {
        item_of[name]
        for file in short
        for name in map(_folded, (file, os.path.splitext(file)[0]))
        if name in item_of
    }


def _folded(name: str) -> str:
    return unicodedata.normalize("NFC", name).casefold()
