# SPDX-License-Identifier: GPL-3.0-or-later
"""Items that a model was trained on: from a list of its training shapes, or from a split of the data set, named with the digest of its splits."""

import os
import re
import unicodedata

from salbench import _core
from salbench.leaderboard.card import Card
from salbench.leaderboard.expected import Expected
from salbench.leaderboard.texts import LIST
from salbench.system.errors import InputError, quoted


def seen(card: Card, names: bytes | None, digest: str, expected: Expected) -> set[str]:
    """Items of `trained_on`. names: content of the list, if there is one; digest: what it should have. Throws InputError."""
    if (names is None) == (len(card.trained_on) == 1):
        raise InputError(f"has no {LIST}, the file {quoted(card.trained_on[0])} of card.yaml" if names is None else
                         f"has {LIST}, and card.yaml names no file of training shapes")
    if names is None:
        return _in_split(card, expected) if card.trained_on else set()
    if _core.digest(names) != digest:
        raise InputError(f"{LIST} is not what submission.yaml has the digest of")
    return _named(names, expected)


def _in_split(card: Card, expected: Expected) -> set[str]:
    layout, split, digest = card.trained_on
    for what, given, has in (("layout", layout, [expected.layout]), ("digest of splits", digest, [expected.splits]), ("split", split, expected.split_names)):
        if given not in has:
            raise InputError(f"card.yaml: trained_on has the {what} {quoted(given)}, and this data set has {', '.join(has) or 'none'}")
    return {item for item, names in expected.split_of.items() if split in names.split("+")}


def _named(names: bytes, expected: Expected) -> set[str]:
    """Each line has a name or path first; letter case, extension and further columns do not count. A scan or view counts as its item."""
    item_of = {_folded(f"{item}_{scan}"): item for item in expected.items for scan in range(_core.views)}
    item_of |= {_folded(shape): item for shape, item in expected.item_of.items()} | {_folded(item): item for item in expected.items}
    first = [re.split(r"[,;\t]", line.removeprefix("\ufeff"))[0].strip(' "') for line in names.decode("utf-8", "surrogateescape").splitlines()]
    files = [re.split(r"[/\\]", path)[-1] for path in first if path and not path.startswith("#")]
    if not files:
        raise InputError(f"{LIST} has no name; leave trained_on out, or write none")
    return {item_of[name] for file in files for name in map(_folded, (file, os.path.splitext(file)[0])) if name in item_of}


def _folded(name: str) -> str:
    return unicodedata.normalize("NFC", name).casefold()
