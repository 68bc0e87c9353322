# SPDX-License-Identifier: GPL-3.0-or-later
"""Exceptions, by who has to act, and how their messages show words of files."""

import contextlib
import os
import unicodedata
from collections.abc import Iterator

NO_LINE = {
    "Cc": "a control character",
    "Cs": "a surrogate, which is no character",
    "Zl": "a line separator",
    "Zp": "a paragraph separator",
}


class InputError(ValueError):
    """A file, a table or a configuration that cannot be used: one line that says what, where, and what to
    do."""


class UnreadableError(InputError):
    """A file that the system does not hand over (permissions, a disk that fails, no memory): nothing is
    known of what it holds."""


class StorageError(OSError):
    """A folder or file that cannot be written, or a system that lacks what any file needs."""


class Interrupted(Exception):
    """What was asked for is not made, since the run ends."""


@contextlib.contextmanager
def arguments_refused() -> Iterator[None]:
    """What functions raise of their arguments, such as names of items and configurations that are not
    there, is InputError on a command line."""
    try:
        yield
    except InputError:
        raise
    except (ValueError, KeyError, FileNotFoundError) as error:
        raise InputError(str(error.args[0] if isinstance(error, KeyError) else error)) from None


def message(error: BaseException) -> str:
    """What any exception says to a user, on one line."""
    if isinstance(error, MemoryError):
        return "no memory for it; close other programs, leave it out, or work on fewer items at a time"
    if isinstance(error, ImportError):
        text = f"a library cannot be loaded: {error}"
    elif isinstance(error, OSError) and error.filename is not None:
        text = f"{os.fsdecode(error.filename)}: cannot be read: {error.strerror}"
    elif isinstance(error, (ValueError, OSError)):
        text = str(error)
    else:
        from salbench import _core

        text = f"{_core.a_defect}: {type(error).__name__}: {error}"
    return " ".join(text.splitlines())


def quoted(text: str) -> str:
    """A word of an unknown file for a message: short, printable."""
    shown = "".join(c if " " <= c <= "~" else "?" for c in text[:32])
    return f'"{shown}..."' if len(text) > 32 else f'"{shown}"'


def in_quotes(word: bytes) -> str:
    return quoted(word.decode("latin-1"))


def wrong_with_line(text: str) -> str:
    """What makes a text no line of UTF-8, as tables and pages have them: "a control character". Empty if
    nothing does."""
    for character in text:
        if (kind := unicodedata.category(character)) in NO_LINE:
            return "a byte that is no UTF-8" if "\udc80" <= character <= "\udcff" else NO_LINE[kind]
    return ""


def require_line(text: str, what: str) -> None:
    """Throws InputError for a text that is no such line. what: "the split", behind its place."""
    if wrong := wrong_with_line(text):
        raise InputError(f"{what} {quoted(text)} has {wrong}, which tables cannot have: rename it")
