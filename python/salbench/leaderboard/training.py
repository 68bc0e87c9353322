# SPDX-License-Identifier: GPL-3.0-or-later
"""Overlap from lists: a card names a file of the shapes that its model was trained on, or a split of the data set by the digest of its splits."""

from __future__ import annotations

import os
import re
import unicodedata

from salbench import _core
from salbench._errors import InputError, quoted
from salbench.leaderboard.card import Card
from salbench.leaderboard.expected import Expected
from salbench.leaderboard.texts import LIST


def seen(card: Card, names: bytes | None, digest: str, expected: Expected) -> set[str]:
    """Items that were trained on, as the list has them. names: what is in the file; digest: what it should have. Throws InputError."""
    if names is not None and len(card.trained_on) != 1:
        raise InputError(f"has {LIST}, and card.yaml names no file of training shapes")
    if not card.trained_on:
        return set()
    if len(card.trained_on) > 1:
        return _in_split(card, expected)
    if names is None:
        raise InputError(f"has no {LIST}, the file {quoted(card.trained_on[0])} of card.yaml")
    if _core.digest(names) != digest:
        raise InputError(f"{LIST} is not what submission.yaml has the digest of")
    return _named(names, expected)


def _in_split(card: Card, expected: Expected) -> set[str]:
    layout, split, digest = card.trained_on
    if layout != expected.layout:
        raise InputError(f"card.yaml: trained_on has a split of {quoted(layout)}, and this data set is {expected.layout}; name a file with its shapes")
    if digest != expected.splits:
        raise InputError(f"card.yaml: trained_on has splits with the digest {quoted(digest)}, and this data set has {expected.splits or 'none'}")
    if split not in expected.split_names:
        raise InputError(f"card.yaml: trained_on has the split {quoted(split)}, and this data set has {', '.join(expected.split_names) or 'none'}")
    return {item for item, of in expected.split_of.items() if split in of.split("+")}


def _named(names: bytes, expected: Expected) -> set[str]:
    """A line has a name or a path first; its extension, letters' case and what is in further columns play no part. A scan or view is of its item."""
    item_of = {_folded(item): item for item in expected.items}
    of_view = {_folded(f"{item}_{scan}"): item for item in expected.items for scan in range(_core.views)}
    of_view |= {_folded(shape): item for shape, item in expected.item_of.items()}
    found, any_name = set(), False
    for line in names.decode("utf-8", "surrogateescape").splitlines():
        path = re.split(r"[,;\t]", line.removeprefix("\ufeff"))[0].strip(' "')
        if not path or path.startswith("#"):
            continue
        any_name, name = True, re.split(r"[/\\]", path)[-1]
        for known in map(_folded, (name, os.path.splitext(name)[0])):
            found.add(item_of.get(known, "") or of_view.get(known, ""))
    if not any_name:
        raise InputError(f"{LIST} has no name; leave trained_on out, or write none")
    return found - {""}


def _folded(name: str) -> str:
    return unicodedata.normalize("NFC", name).casefold()
