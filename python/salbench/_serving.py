# SPDX-License-Identifier: GPL-3.0-or-later
"""A process that reads files of strangers, from its own side: it may crash, and nobody else does. _workers.py asks.

A line of standard input is `REQUEST<TAB>OUT`, a request being a line of JSON. The answer is written to the file OUT, or what is wrong with
the input, one line, to OUT.error; then OUT is printed on a line of its own. Where the system keeps it from reading or writing, there is neither
file, and a line before OUT says why.
"""

from __future__ import annotations

import contextlib
import os
import sys
from collections.abc import Callable, Mapping
from typing import Any, BinaryIO

from salbench import _limits, _wire
from salbench._errors import StorageError
from salbench._files import ADVICE, LACKING
from salbench._limits import ERROR
from salbench._processes import end_with_parent, leave_interrupts_to_parent

Request = dict[str, Any]  # `do` names the answer
Answers = Mapping[str, Callable[[Request], "bytes | tuple[bytes | None, list[str]]"]]
Limits = Callable[[Request], "tuple[int, int | None]"]  # as of _limits.limit


def is_of_the_system(error: Exception) -> bool:
    """True of what says nothing about the input: a library that cannot be loaded, say, or a limit on open files."""
    return isinstance(error, (StorageError, ImportError)) or (isinstance(error, OSError) and error.errno in LACKING)


def message(error: BaseException) -> str:
    """One line."""
    if isinstance(error, MemoryError):
        return "no memory for it; close other programs, leave it out, or work on fewer items at a time"
    if isinstance(error, ImportError):
        return f"a library cannot be loaded: {error}"
    if isinstance(error, OSError) and error.filename is not None:
        return f"{os.fsdecode(error.filename)}: cannot be read: {error.strerror}"
    if isinstance(error, (ValueError, OSError)):
        return " ".join(str(error).splitlines())
    return f"a defect of salbench, please report it: {type(error).__name__}: {error}"


def answer(text: bytes, out: bytes, answers: Answers, limits: Limits) -> str:
    """Writes OUT or OUT.error, or both. Otherwise what the system lacks for it: one line."""
    made: bytes | None = None
    problems: list[str] = []
    try:
        request = _wire.loads(text)
        _limits.limit(*limits(request))
        answered = answers[request["do"]](request)
        made, problems = answered if isinstance(answered, tuple) else (answered, [])
    except Exception as error:  # the file of one item must not end the process that reads the others
        if is_of_the_system(error):
            return message(error)
        problems = [message(error)]
    files = {out: made, out + ERROR.encode(): "\n".join(problems).encode("utf-8", "surrogateescape") or None}
    try:
        for path, data in files.items():
            if data is not None:
                with open(path, "wb") as file:
                    file.write(data)
    except OSError as error:
        for path in files:
            with contextlib.suppress(OSError):
                os.unlink(path)
        advice = ADVICE.get(error.errno or 0, "; set TMPDIR to another")
        return f"{os.fsdecode(os.path.dirname(out))}: cannot be written: {error.strerror}{advice}"
    return ""


def main(answers: Answers, limits: Limits, parent: int | None = None) -> int:
    """Serves until standard input, or the parent, ends."""
    leave_interrupts_to_parent()
    end_with_parent(parent)
    _limits.no_core()
    _log_to_stderr()
    said = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # what a library prints is no answer
    serve(sys.stdin.buffer, said, answers, limits)
    return 0


def serve(lines: BinaryIO, said: BinaryIO, answers: Answers, limits: Limits) -> None:
    for line in lines:
        request, _, out = line.rstrip(b"\n").rpartition(b"\t")
        lacking = answer(request, out, answers, limits)
        if lacking:
            said.write(" ".join(lacking.split("\n")).encode("utf-8", "surrogateescape") + b"\n")
        said.write(out + b"\n")
        said.flush()


def _log_to_stderr() -> None:
    import logging

    handler = logging.StreamHandler()
    handler.setFormatter(logging.Formatter("warning: %(message)s"))
    logging.getLogger("salbench").addHandler(handler)
