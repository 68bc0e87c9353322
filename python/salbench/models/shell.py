# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs the user's shell commands, with their output, time limit and exit status."""

import array
import errno
import fcntl
import os
import re
import select
import signal
import subprocess
import termios
import time
from typing import Literal

from salbench.models import sessions
from salbench.system.errors import InputError, Interrupted, StorageError

_GRACE = 2  # s, between increasingly harsh ways to end a command
_KEPT, _KEPT_LINES = 4096, 20  # bytes and lines kept of the end of a command's output, per pipe
_COLOUR = re.compile(rb"\x1b\[[0-9;]*m")

_at_work: set[int] = set()  # sessions
os.register_at_fork(after_in_child=_at_work.clear)
_is_ending = False


def end_all() -> None:
    """Ends all commands: callers that wait for one or start one get Interrupted, until `begin`."""
    global _is_ending
    _is_ending = True
    for session in list(_at_work):
        sessions.tell(session, signal.SIGTERM)


def begin() -> None:
    """Allows commands to start again; none is running."""
    global _is_ending
    _is_ending = False


class TookTooLong(InputError):
    """A command that exceeded its timeout."""


class Shell:
    """Context manager for `/bin/sh -c line` in a folder, with empty input or, if it serves, with request
    lines. Its output does not reach the terminal. Its session ends no later than the block. Throws
    Interrupted, StorageError, and InputError for a line that is too long."""

    def __init__(self, line: str, folder: str, serves: bool = False) -> None:
        require_not_ending()
        self.has_answered = False
        self._is_idle = serves
        # the expected line, and the unfinished last line of output
        self._answer = self._partial = b""
        given, errors = (
            (subprocess.PIPE, subprocess.PIPE) if serves else (subprocess.DEVNULL, subprocess.STDOUT)
        )
        try:
            self._process = subprocess.Popen(
                [*sessions.SHELL, sessions.file_of_guard(), line],
                cwd=folder,
                bufsize=0,
                stdin=given,
                stdout=subprocess.PIPE,
                stderr=errors,
                start_new_session=True,
            )
            self._session = self._process.pid
            _at_work.add(self._session)
            self._end = os.pidfd_open(self._session)
        except OSError as error:
            if "_session" in vars(self):
                self._finish()
            if error.errno == errno.E2BIG:
                raise InputError("the command is longer than the system allows") from None
            raise StorageError(f"no process to run a command: {error.strerror}") from None
        # Standard output first, so that text on standard error before an answer is complete.
        self._kept = {
            stream: b"" for stream in (self._process.stdout, self._process.stderr) if stream is not None
        }
        self._open = list(self._kept)
        for stream in self._open:
            os.set_blocking(stream.fileno(), False)

    def __enter__(self) -> "Shell":
        return self

    def __exit__(self, *_: object) -> None:
        """Gives an idle process time to finish its lines."""
        if self._is_idle and not _is_ending:
            self.tell_no_more()
            self._wait(_GRACE, in_grace=True)
        self._terminate()
        for stream in (self._process.stdin, *self._kept):
            if stream is not None:
                stream.close()
        os.close(self._end)

    def has_ended(self) -> bool:
        if self._process.returncode is None and os.waitid(
            os.P_PID, self._session, os.WEXITED | os.WNOHANG | os.WNOWAIT
        ):
            self._finish()
        return self._process.returncode is not None

    def failure(self) -> str:
        """Reason of a failure; empty for success."""
        status = self._process.returncode
        if status < 0:
            return f"the command was killed by signal {-status}"
        return f"the command ended with status {status}" if status else ""

    def said(self) -> str:
        """Last lines of output, for a message; for a serving command those since the request, without its
        answer."""
        self._take_in()
        lines = [line for kept in self._kept.values() for line in _lines_at_the_end(kept, self._answer)]
        return f"its last lines: {' | '.join(lines)}" if lines else "it printed nothing"

    def ask(self, line: bytes, answer: bytes, timeout: float) -> bool:
        """Writes a line, and waits for a line equal to `answer`. False if the command ended without fault of
        this line: with status 0, or, after other answers, without reading it. Otherwise throws as `run`."""
        self._answer, self._is_idle = answer, False
        self._kept = dict.fromkeys(self._kept, b"")
        assert self._process.stdin is not None
        try:
            self._process.stdin.write(line)
            is_lost = False
        except BrokenPipeError:
            is_lost = True
        if self.wait_for(timeout) == "answered":
            self.has_answered = self._is_idle = True
            return True
        is_unread = is_lost or _bytes_unread(self._process.stdin.fileno()) == len(line)
        if (failure := self.failure()) and not (self.has_answered and is_unread):
            raise InputError(f"{failure}; {self.said()}")
        return False

    def tell_no_more(self) -> None:
        assert self._process.stdin is not None
        self._process.stdin.close()

    def wait_for(self, timeout: float) -> Literal["answered", "ended"]:
        """Waits for the command; ends it at the timeout, or at the end of the run. Throws TookTooLong and
        Interrupted."""
        event = self._wait(timeout)
        if event == "late":
            self._terminate()
        require_not_ending()
        if event == "late":
            raise TookTooLong(
                f"the command took longer than its timeout of {timeout:.15g} s, and was ended; {self.said()}"
            )
        return event

    def _wait(self, seconds: float, in_grace: bool = False) -> Literal["answered", "ended", "late"]:
        """Collects output while waiting. In grace, neither answer nor end of the run counts."""
        deadline = time.monotonic() + seconds
        while True:
            over = self.has_ended()
            if self._take_in() and not in_grace:
                return "answered"
            left = deadline - time.monotonic()
            if over or left <= 0 or (_is_ending and not in_grace):
                return "ended" if over else "late"
            events = select.poll()
            for file in (self._end, *(stream.fileno() for stream in self._open)):
                events.register(file, select.POLLIN)
            # polls, because nothing wakes a command that resists the end of the run
            events.poll(1000 * min(left, 1))

    def _take_in(self) -> bool:
        """Reads the pipes. True if the answer was among the output."""
        is_answered = False
        for stream in list(self._open):
            piece: bytes | None = stream.read(1 << 20)
            if piece == b"":
                self._open.remove(stream)
            if not piece:
                continue
            self._kept[stream] = (self._kept[stream] + piece)[-_KEPT:]
            if stream is self._process.stdout and self._answer:
                *lines, partial = re.split(b"[\r\n]", self._partial + piece)
                # a longer line is a different one, at any length
                self._partial = partial[: len(self._answer) + 1]
                is_answered = self._answer in lines
        return is_answered

    def _terminate(self) -> None:
        if not self.has_ended():
            sessions.tell(self._session, signal.SIGTERM)
            self._wait(_GRACE, in_grace=True)
        if self._process.returncode is None:
            self._finish()

    def _finish(self) -> None:
        sessions.kill(self._session)
        _at_work.discard(self._session)
        self._process.wait()
        sessions.tell_of_end(self._session)


def run(line: str, folder: str, timeout: float) -> str:
    """Runs a command, and returns its last output. Throws InputError, one line with the reason and the last
    output, if it fails or takes longer; Interrupted and StorageError."""
    with Shell(line, folder) as shell:
        shell.wait_for(timeout)
        if failure := shell.failure():
            raise InputError(f"{failure}; {shell.said()}")
        return shell.said()


def require_not_ending() -> None:
    if _is_ending:
        raise Interrupted("the run ends")


def _bytes_unread(pipe: int) -> int:
    """Bytes still in the pipe; 0 if unknown."""
    count = array.array("i", [0])
    try:
        fcntl.ioctl(pipe, termios.FIONREAD, count)
    except OSError:
        return 0
    return count[0]


def _lines_at_the_end(printed: bytes, answer: bytes) -> list[str]:
    """Lines without empty ones and the answer, printable on a terminal, without its colours."""
    lines = [line for line in re.split(b"[\r\n]+", printed) if line and line != answer]
    texts = [
        _COLOUR.sub(b"", line).decode("utf-8", "replace").replace("\t", " ") for line in lines[-_KEPT_LINES:]
    ]
    return ["".join(c if c.isprintable() else "?" for c in text) for text in texts]
