# SPDX-License-Identifier: GPL-3.0-or-later
"""Termination of the package's processes: commands by a signal, and children with their parent."""

import contextlib
import os
import select
import shlex
import signal
import sys
import threading
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any, NoReturn

if TYPE_CHECKING:
    import subprocess

INTERRUPTED = 130
# reads file names like this one does
PYTHON = [sys.executable, "-P", *(["-X", "utf8"] if sys.flags.utf8_mode else [])]
# From a user, a scheduler, or a system without memory; crashes raise other signals.
FROM_OUTSIDE = (signal.SIGKILL, signal.SIGTERM, signal.SIGINT, signal.SIGHUP, signal.SIGQUIT)
# parent folder of the package; in a build, that of the compiled part, with links to the files
PACKAGES = os.path.abspath(f"{__file__}/../../..")
_SIGNALS = {signal.SIGINT, signal.SIGTERM, signal.SIGHUP}
_at_once = False  # True: a signal ends this process


def hold_interrupts() -> None:
    """Holds termination signals until `raise_interrupts`, so that no import ends with a traceback."""
    signal.pthread_sigmask(signal.SIG_BLOCK, _SIGNALS)


def raise_interrupts(words: Sequence[str], at_once: bool = False) -> None:
    """Lets the first termination signal raise KeyboardInterrupt; with at_once, and within `ends_at_once`, it
    ends the process. A second one always does: an exception during the reaction to the first one could find
    locks half taken. words: of the subcommand."""
    global _at_once
    _at_once, asked = at_once, False

    def interrupt(number: int, _: Any) -> None:
        nonlocal asked
        if asked or _at_once:
            _end_at_once(words)
        asked = True
        # The second signal of a kind needs no interpreter, which may be busy. A closing terminal sends SIGHUP
        # twice.
        signal.signal(number, signal.SIG_IGN if number == signal.SIGHUP else signal.SIG_DFL)
        raise KeyboardInterrupt

    # if inherited as ignored, it hides the exit status of commands
    signal.signal(signal.SIGCHLD, signal.SIG_DFL)
    for number in _SIGNALS:
        if signal.getsignal(number) is not signal.SIG_IGN:  # ignored under nohup
            signal.signal(number, interrupt)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, _SIGNALS)


@contextlib.contextmanager
def ends_at_once() -> Iterator[None]:
    """For code that can be ended at any point, and may hang on a file system that is gone."""
    global _at_once
    before, _at_once = _at_once, True
    try:
        yield
    finally:
        _at_once = before


def _end_at_once(words: Sequence[str]) -> NoReturn:
    with contextlib.suppress(OSError):
        os.write(2, last_words(words).encode("utf-8", "surrogateescape") + b"\n")  # print() may be active
    os._exit(INTERRUPTED)


def text_of_signal(status: int) -> str:
    """Describes the signal that ended a process. status: as from subprocess."""
    return f"signal {-status}: {signal.strsignal(-status)}"


def say_interrupted(words: Sequence[str]) -> int:
    """Prints the last words of a command, and returns its status."""
    print(last_words(words), file=sys.stderr, flush=True)
    return INTERRUPTED


def last_words(words: Sequence[str]) -> str:
    return (
        f"\ninterrupted; everything finished so far is kept. To go on:\n  {shlex.join([_program(), *words])}"
    )


def _program() -> str:
    """The command as it was typed, or as a shell finds it."""
    folder, name = os.path.split(sys.argv[0])
    return (
        sys.argv[0]
        if name == "salbench" and folder not in os.environ.get("PATH", "").split(os.pathsep)
        else "salbench"
    )


def end_with_parent(parent: int | None = None) -> None:
    """Ends this process when its parent ends, for any reason. parent: the expected parent."""
    parent = parent or os.getppid()
    try:
        watched = os.pidfd_open(parent)
    except OSError:  # the parent is in another namespace, or the kernel is old
        watched = -1
    if os.getppid() != parent:
        os._exit(INTERRUPTED)
    if watched < 0:
        return

    def wait() -> None:
        ends = select.poll()
        ends.register(watched)
        ends.poll()
        os._exit(INTERRUPTED)

    threading.Thread(target=wait, daemon=True).start()


@contextlib.contextmanager
def interrupts_held() -> Iterator[None]:
    """Holds interrupts while a child starts, until it calls `leave_interrupts_to_parent`."""
    before = signal.pthread_sigmask(signal.SIG_BLOCK, _SIGNALS)
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def start(code: str, *arguments: str, **how: Any) -> "subprocess.Popen[bytes]":
    """Starts a process with Python code, which gets the parent folder of the package as its first argument.
    how: as for subprocess."""
    import subprocess  # slow to import for commands that only list

    with interrupts_held():
        return subprocess.Popen([*PYTHON, "-c", code, PACKAGES, *arguments], **how)


def leave_interrupts_to_parent() -> None:
    """Ignores signals to the terminal's process group; the parent handles them."""
    for number in (signal.SIGINT, signal.SIGHUP):
        signal.signal(number, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, _SIGNALS)
