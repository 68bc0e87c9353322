# SPDX-License-Identifier: GPL-3.0-or-later
"""How processes of the package end: commands by a signal, as those of the program do, and children with their parent."""

import contextlib
import os
import select
import shlex
import signal
import sys
import threading
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import subprocess

INTERRUPTED = 130
PYTHON = [sys.executable, "-P", *(["-X", "utf8"] if sys.flags.utf8_mode else [])]  # which reads names of files as this one does
# Of a person, a scheduler, or a system without memory; a library that crashes raises others.
FROM_OUTSIDE = (signal.SIGKILL, signal.SIGTERM, signal.SIGINT, signal.SIGHUP, signal.SIGQUIT)
_PACKAGE = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
_SIGNALS = {signal.SIGINT, signal.SIGTERM, signal.SIGHUP}


def raise_interrupts(words: Sequence[str]) -> None:
    """A signal that asks for the end is a KeyboardInterrupt, unless whoever started this process has it ignored (nohup). Another one ends the
    process at once: an exception in the middle of what another one ends would find locks half taken. The program blocks Ctrl-C until then:
    no import is interrupted. words: of the subcommand."""
    asked = False

    def interrupt(number: int, _: Any) -> None:
        nonlocal asked
        if not asked:
            asked = True
            raise KeyboardInterrupt
        if number != signal.SIGHUP:  # a terminal that goes says so twice
            os.write(2, last_words(words).encode("utf-8", "surrogateescape") + b"\n")  # print() may be at work
            os._exit(INTERRUPTED)

    for number in _SIGNALS:
        if signal.getsignal(number) is not signal.SIG_IGN:
            signal.signal(number, interrupt)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, _SIGNALS)


def text_of_signal(status: int) -> str:
    """status: of a process that a signal ended, as subprocess has it."""
    return f"signal {-status}: {signal.strsignal(-status)}"


def resume_line(words: Sequence[str]) -> str:
    return f"  {shlex.join(['salbench', *words])}"


def say_interrupted(words: Sequence[str]) -> int:
    """The last words of a command, and its status."""
    print(last_words(words), file=sys.stderr, flush=True)
    return INTERRUPTED


def last_words(words: Sequence[str]) -> str:
    return f"\ninterrupted; everything finished so far is kept. To go on:\n{resume_line(words)}"


def end_with_parent(parent: int | None = None) -> None:
    """From now on this process is ended when its parent is, in whichever way. parent: the process that was to start this one."""
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
    """While a child is started: one that begins with `leave_interrupts_to_parent` is not interrupted before."""
    before = signal.pthread_sigmask(signal.SIG_BLOCK, _SIGNALS)
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def start(code: str, *arguments: str, **how: Any) -> "subprocess.Popen[bytes]":
    """A process that runs a text of Python, which has the folder of the package as its first argument. how: of subprocess, beside a pipe to it."""
    import subprocess  # which commands that list need not wait for

    with interrupts_held():
        return subprocess.Popen([*PYTHON, "-c", code, _PACKAGE, *arguments], stdin=subprocess.PIPE, **how)


def leave_interrupts_to_parent() -> None:
    """A signal to all processes of a terminal is for the one that started this one."""
    for number in (signal.SIGINT, signal.SIGHUP):
        signal.signal(number, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, _SIGNALS)
