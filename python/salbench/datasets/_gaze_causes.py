# SPDX-License-Identifier: GPL-3.0-or-later
"""Why rows of a recording cannot be used, counted by cause and person, with the first place of each.

A row that has a time stays in the recording as a sample that was lost: how long nothing is known of the eye decides where a fixation ends,
and losses are reported per person. One that cannot be put in order of time is left out."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from enum import IntEnum

import numpy as np

from salbench._errors import quoted
from salbench.datasets.records import Bools, Floats


class Wrong(IntEnum):
    NOTHING = 0
    TOO_FEW = 1
    TOO_MANY = 2
    NO_JSON = 3
    OPEN_QUOTE = 4
    NO_TIME = 5
    BACK = 6
    REPEATED = 7
    NO_DURATION = 8
    NO_PERSON = 9
    LAST_LEFT_OUT = 9  # those up to here have no place in a recording
    NO_NUMBER = 10
    NOT_FINITE = 11
    ZERO = 12
    LENGTH = 13
    NO_CAMERA = 14
    NO_CAMERAS = 15
    UNREADABLE_CAMERAS = 16
    NO_FLAG = 17  # and those up to LAST_NO_FLAG: a word in place of a flag, each with a text of its own
    LAST_NO_FLAG = 27
    CAMERA = 28  # and those above: a camera that cannot be used, each with a text of its own


MAX_FLAGS = Wrong.LAST_NO_FLAG - Wrong.NO_FLAG  # words in place of flags that causes name; all others are of the last


TEXTS = {
    Wrong.TOO_FEW: "fewer columns than are named",
    Wrong.TOO_MANY: "more columns than the header has: write decimal commas, if these are some, as points",
    Wrong.NO_JSON: "no object of JSON with these keys",
    Wrong.OPEN_QUOTE: "a quote that nothing closes, or text behind one",
    Wrong.NO_TIME: "the time is no finite number",
    Wrong.BACK: "the time runs back",
    Wrong.REPEATED: "the time is that of a row before",
    Wrong.NO_DURATION: "the duration is no number above 0",
    Wrong.NO_PERSON: "no person is named, or with characters that tables cannot have, or in more than 256 bytes",
    Wrong.NO_NUMBER: "a word that is no number",
    Wrong.NOT_FINITE: "a coordinate is missing, NaN or infinite",
    Wrong.ZERO: "the direction has no length",
    Wrong.LENGTH: "the direction is not of length 1; for directions of any length add `normalise_directions: true`",
    Wrong.NO_CAMERA: "there is no camera of its frame",
    Wrong.NO_CAMERAS: "there is no file of its cameras",
    Wrong.UNREADABLE_CAMERAS: "the file of its cameras cannot be read",
    Wrong.LAST_NO_FLAG: "`valid` is another word, expected a number, true or false",
}


@dataclass
class _Count:
    rows: int
    where: str  # file and line of the first


@dataclass
class Causes:
    """Of one item."""

    counts: dict[tuple[str, str, bool], _Count] = field(default_factory=dict)  # (person, cause, left out)
    rows: dict[str, int] = field(default_factory=dict)  # of each person, all that there are

    def add(self, person: str, path: str, wrong: Floats, lines: Floats, flags: Iterable[str] = (), cameras: Iterable[str] = ()) -> None:
        """Of rows of a person in a file. flags: words in their place; cameras: what is wrong with those that cannot be used."""
        told = dict(enumerate(cameras, int(Wrong.CAMERA)))
        told |= {Wrong.NO_FLAG + k: f"`valid` is {quoted(word)}, expected a number, true or false" for k, word in enumerate(flags)}
        for code, first, count in zip(*(found.tolist() for found in np.unique(wrong, return_index=True, return_counts=True))):
            if code == Wrong.NOTHING:
                continue
            text = told.get(int(code)) or TEXTS[Wrong(int(code))]
            key = person, text, code <= Wrong.LAST_LEFT_OUT
            known = self.counts.setdefault(key, _Count(0, f"{path}:{int(lines[first])}"))
            known.rows += count

    def lines(self) -> list[str]:
        """One per person and cause, in the order in which they were found."""
        return [f"{count.where}: {count.rows} of {self.rows.get(person, count.rows)} rows of {_shown(person)} {'is' if count.rows == 1 else 'are'} "
                f"{'left out' if is_left_out else 'lost'}: {text} (the first is here)"
                for (person, text, is_left_out), count in self.counts.items()]


def _shown(person: str) -> str:
    if not person:
        return "nobody"
    return person if person.isprintable() and len(person) <= 32 else quoted(person)


def has_no_flag(wrong: Floats) -> Bools:
    return np.asarray((wrong >= Wrong.NO_FLAG) & (wrong <= Wrong.LAST_NO_FLAG))


def is_left_out(wrong: Floats) -> Bools:
    return np.asarray((wrong != Wrong.NOTHING) & (wrong <= Wrong.LAST_LEFT_OUT))
