# SPDX-License-Identifier: GPL-3.0-or-later
"""Words of files: what a number is, and how a message shows what is none. As strict as the readers in C++, and the same doubles."""

from __future__ import annotations

import re

from salbench._errors import in_quotes as in_quotes
from salbench._errors import quoted as quoted

BYTE_ORDER_MARK = b"\xef\xbb\xbf"
BLANKS = b" \t\n\r\v\f"

_NUMBER = re.compile(rb"\+?-?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?|\+?-?(?:inf|infinity|nan(?:\([0-9A-Za-z_]*\))?)", re.IGNORECASE)
_DECIMAL_COMMA = re.compile(rb"[-+]?[0-9]*,[0-9]+(?:[eE].*)?", re.DOTALL)


def number_in(word: bytes) -> float | None:
    """None for a word that is no number; an infinity or 0 also for one that no double holds."""
    if not _NUMBER.fullmatch(word) or word.startswith(b"+-"):
        return None
    return float(word.split(b"(")[0])


def fits(word: bytes, value: float) -> bool:
    """False of the value of a word such as 1e999 or 1e-999."""
    if value == 0:
        return not re.search(b"[1-9]", re.split(b"[eE]", word)[0])
    return abs(value) != float("inf") or word.lstrip(b"+-")[:1] in b"iI"


def finite_number(text: str) -> float | None:
    """None for what is no finite number, as options are written: no blanks, no underscores, no plus sign."""
    word = text.encode("utf-8", "surrogateescape")
    number = number_in(word)
    return number if number is not None and abs(number) < float("inf") and fits(word, number) and word[:1] != b"+" else None


def is_number(word: bytes) -> bool:
    """Also of one that is not finite."""
    return number_in(word) is not None


def decimal_comma_in(word: bytes) -> str:
    """What to do about a number such as "0,5"; "" for another word."""
    return ": write its decimal comma as a point" if _DECIMAL_COMMA.fullmatch(word) else ""


def lines_of(data: bytes) -> list[bytes]:
    """LF, CR LF and CR each end a line, wherever they stand."""
    return data.removeprefix(BYTE_ORDER_MARK).splitlines()


def before_comment(words: list[bytes]) -> list[bytes]:
    """The words before that with which a comment begins: a '#' within a word, as in 1.#INF, begins none."""
    return words[:next((place for place, word in enumerate(words) if word.startswith(b"#")), None)]
