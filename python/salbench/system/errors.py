# SPDX-License-Identifier: GPL-3.0-or-later
"""Exceptions, grouped by who has to act, and quoting of file content in messages."""

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
    """A file, a table or a configuration that cannot be used: one line with the problem, the place, and the
    remedy."""


class UnreadableError(InputError):
    """A file that the system cannot read (permissions, disk failure, no memory): its content is unknown."""


class StorageError(OSError):
    """A folder or file that cannot be written, or a system that lacks general resources."""


class Interrupted(Exception):
    """A requested result is not computed, because the run ends."""


@contextlib.contextmanager
def arguments_refused() -> Iterator[None]:
    """Converts exceptions of functions about their arguments, such as unknown items and configurations, to
    InputError for the command line."""
    try:
        yield
    except InputError:
        raise
    except (ValueError, KeyError, FileNotFoundError) as error:
        raise InputError(str(error.args[0] if isinstance(error, KeyError) else error)) from None


def message(error: BaseException) -> str:
    """One line for the user about any exception."""
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
    """Quotes a word of an unknown file for a message: short and printable."""
    shown = "".join(c if c.isprintable() else "?" for c in text[:32])
    return f'"{shown}..."' if len(text) > 32 else f'"{shown}"'


def in_quotes(word: bytes) -> str:
    return quoted(word.decode("utf-8", "surrogateescape"))


def wrong_with_line(text: str) -> str:
    """Reason why a text is not one line of UTF-8, as tables and pages require, such as "a control character";
    empty if it is."""
    for character in text:
        if (kind := unicodedata.category(character)) in NO_LINE:
            return "a byte that is no UTF-8" if "\udc80" <= character <= "\udcff" else NO_LINE[kind]
    return ""


def require_line(text: str, what: str) -> None:
    """Throws InputError for a text that is not such a line. what: for example "the split", with its
    location."""
    if wrong := wrong_with_line(text):
        raise InputError(f"{what} {quoted(text)} has {wrong}, which tables cannot have: rename it")
