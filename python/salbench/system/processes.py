# SPDX-License-Identifier: GPL-3.0-or-later
"""How processes of the package end: commands by a signal, and children with their parent."""

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
# which reads names of files as this one does
PYTHON = [sys.executable, "-P", *(["-X", "utf8"] if sys.flags.utf8_mode else [])]
# Of a person, a scheduler, or a system without memory; a library that crashes raises others.
FROM_OUTSIDE = (signal.SIGKILL, signal.SIGTERM, signal.SIGINT, signal.SIGHUP, signal.SIGQUIT)
# the folder of the package; in a build, beside what is compiled: files are links there
PACKAGES = os.path.abspath(f"{__file__}/../../..")
_SIGNALS = {signal.SIGINT, signal.SIGTERM, signal.SIGHUP}
_at_once = False  # a signal ends this process


def hold_interrupts() -> None:
    """Signals that ask for the end wait until `raise_interrupts` is called: no import before it ends in a
    traceback."""
    signal.pthread_sigmask(signal.SIG_BLOCK, _SIGNALS)


def raise_interrupts(words: Sequence[str], at_once: bool = False) -> None:
    """From now on the first signal that asks for the end is a KeyboardInterrupt; at_once, and within
    `ends_at_once`, it ends the process. A second one does in any case: an exception in the middle of what the
    first one ends would find locks half taken. words: of the subcommand.
    """
    global _at_once
    _at_once, asked = at_once, False

    def interrupt(number: int, _: Any) -> None:
        nonlocal asked
        if asked or _at_once:
            _end_at_once(words)
        asked = True
        # The same one again needs no interpreter, which may be busy. A terminal that goes says so twice.
        signal.signal(number, signal.SIG_IGN if number == signal.SIGHUP else signal.SIG_DFL)
        raise KeyboardInterrupt

    # ignored, as whoever starts this may have it, it hides how commands have ended
    signal.signal(signal.SIGCHLD, signal.SIG_DFL)
    for number in _SIGNALS:
        if signal.getsignal(number) is not signal.SIG_IGN:  # as nohup has it
            signal.signal(number, interrupt)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, _SIGNALS)


@contextlib.contextmanager
def ends_at_once() -> Iterator[None]:
    """Around what leaves nothing half done, and may take as long as a file system that has gone."""
    global _at_once
    before, _at_once = _at_once, True
    try:
        yield
    finally:
        _at_once = before


def _end_at_once(words: Sequence[str]) -> NoReturn:
    with contextlib.suppress(OSError):
        os.write(2, last_words(words).encode("utf-8", "surrogateescape") + b"\n")  # print() may be at work
    os._exit(INTERRUPTED)


def text_of_signal(status: int) -> str:
    """status: of a process that a signal ended, as subprocess has it."""
    return f"signal {-status}: {signal.strsignal(-status)}"


def say_interrupted(words: Sequence[str]) -> int:
    """The last words of a command, and its status."""
    print(last_words(words), file=sys.stderr, flush=True)
    return INTERRUPTED


def last_words(words: Sequence[str]) -> str:
    return (
        f"\ninterrupted; everything finished so far is kept. To go on:\n  {shlex.join([_program(), *words])}"
    )


def _program() -> str:
    """As it was typed, or as a shell finds it."""
    folder, name = os.path.split(sys.argv[0])
    return (
        sys.argv[0]
        if name == "salbench" and folder not in os.environ.get("PATH", "").split(os.pathsep)
        else "salbench"
    )


def end_with_parent(parent: int | None = None) -> None:
    """From now on this process is ended when its parent is, in whichever way. parent: the process that was
    to start this one."""
    parent = parent or os.getppid()
    try:
        watched = os.pidfd_open(parent)
    except OSError:  # the parent is of another namespace, or the kernel is old
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
    """While a child is started: one that begins with `leave_interrupts_to_parent` is not interrupted
    before."""
    before = signal.pthread_sigmask(signal.SIG_BLOCK, _SIGNALS)
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def start(code: str, *arguments: str, **how: Any) -> "subprocess.Popen[bytes]":
    """A process that runs a text of Python, which has the folder of the package as its first argument.
    how: as for subprocess."""
    import subprocess  # which commands that list need not wait for

    with interrupts_held():
        return subprocess.Popen([*PYTHON, "-c", code, PACKAGES, *arguments], **how)


def leave_interrupts_to_parent() -> None:
    """A signal to all processes of a terminal is for the one that started this one."""
    for number in (signal.SIGINT, signal.SIGHUP):
        signal.signal(number, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, _SIGNALS)
