# SPDX-License-Identifier: GPL-3.0-or-later
"""Output of commands: reports on standard output, which may fail; messages on standard error, whose failure
is ignored."""

import argparse
import contextlib
import errno
import json
import os
import signal
import sys
from collections.abc import Sequence
from typing import Any

from salbench.system.errors import StorageError

ALL_DONE, SOME_FAILED, UNUSABLE_ARGUMENTS, UNUSABLE_STORAGE, DEFECT = 0, 1, 2, 3, 70
SCHEMA = 2  # version of JSON documents: incremented when a key is removed, or changes its type or meaning


def report(given: argparse.Namespace, name: str, document: dict[str, Any], text: str) -> None:
    """Prints the document, or else the text, unless the command is quiet."""
    if given.format == "json":
        text = (
            json.dumps(
                {"schema": SCHEMA, "command": name, **document}, ensure_ascii=False, separators=(",", ":")
            )
            + "\n"
        )
        # from names that are not UTF-8
        text = text.encode("utf-8", "surrogateescape").decode("utf-8", "replace")
    elif getattr(given, "quiet", False):
        return
    write_output(text)


def write_output(text: str) -> None:
    """Writes to standard output. On failure the command ends: with an error or, if the reader is gone, by
    SIGPIPE."""
    if not text:
        return
    try:
        if sys.stdout is None:
            raise OSError(errno.EBADF, "")
        sys.stdout.write(text)
        sys.stdout.flush()
        if sys.stdout is sys.__stdout__:
            os.close(os.dup(1))  # network file systems report storage errors on close
    except OSError as error:
        if isinstance(error, BrokenPipeError):
            signal.signal(signal.SIGPIPE, signal.SIG_DFL)
            os.kill(os.getpid(), signal.SIGPIPE)
        # for the remaining text: Python ends with status 120 if it cannot be written
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
        why = "it is closed" if error.errno == errno.EBADF else error.strerror
        raise StorageError(f"standard output: cannot be written to: {why}") from None


def warn(kind: str, line: str) -> None:
    """Prints "warning: ..." on standard error."""
    print(f"{kind}: {line}", file=sys.stderr, flush=True)


def aligned(names: Sequence[str], rows: Sequence[Sequence[Any]], decimals: int = 4) -> str:
    """Formats columns two spaces apart, numbers to the right, "-" for unknown values."""
    columns = []
    for number, name in enumerate(names):
        values = [row[number] for row in rows]
        cells = [name, *(_cell(value, decimals) for value in values)]
        width = max(map(len, cells))
        of_text = any(isinstance(value, str) for value in values)
        columns.append([cell.ljust(width) if of_text else cell.rjust(width) for cell in cells])
    return "".join("  ".join(line).rstrip(" ") + "\n" for line in zip(*columns))


def _cell(value: Any, decimals: int) -> str:
    if not isinstance(value, float):
        return str(value)
    if value != value:
        return "-"
    # values that round to 0 keep their magnitude
    vanishes = value != 0 and abs(value) < 0.5 * 10.0**-decimals
    return f"{value:.1e}" if vanishes else f"{value:.{decimals}f}"


class Forgiving:
    """Standard error that ignores failures, such as a full disk: lost messages cost no result."""

    def __init__(self, stream: Any) -> None:
        self._stream = stream

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)

    def write(self, text: str) -> int:
        with contextlib.suppress(OSError):
            self._stream.write(text)
            self._stream.flush()
        return len(text)

    def flush(self) -> None:
        with contextlib.suppress(OSError):
            self._stream.flush()


def open_standard_streams() -> None:
    """Opens standard streams that the caller has closed, so that no file gets their number and is
    overwritten. Messages may get lost, but not results: standard output is opened for reading, so that
    writing fails."""
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            os.set_inheritable(os.open(os.devnull, os.O_WRONLY if number == 2 else os.O_RDONLY), True)
    if sys.stderr is None:
        sys.stderr = open(2, "w", closefd=False)
