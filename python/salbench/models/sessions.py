# SPDX-License-Identifier: GPL-3.0-or-later
"""Sessions of processes that this one has started. None is left when this process has ended: if it is
killed, its guard, a process that outlives it, ends them."""

import contextlib
import os
import signal
import subprocess
import sys
import threading
import time

from salbench.system.processes import start
from salbench.system.scratch import remove_abandoned

# The command of a session, to be followed by `file_of_guard()` and a line for the shell. The session itself
# tells the guard of its number: this process may be killed in the moment of a start, and then there is no
# such file.
SHELL = ("/bin/sh", "-c", 'echo $$ > "$1" && exec /bin/sh -c "$2" sh', "sh")
_GUARD = "import sys; sys.path.insert(0, sys.argv[1]); from salbench.models.sessions import guard; guard()"
# s, with processes that the system does not end: they hang in a device, or belong to somebody else
_PATIENCE = 10

_guard: "subprocess.Popen[bytes] | None" = None
_starting = threading.Lock()


def _leave_guard_to_parent() -> None:
    """A copy of this process that lives on must not keep the guard from seeing this one's end."""
    global _guard, _starting
    if _guard is not None and _guard.stdin is not None:
        _guard.stdin.close()
    _guard, _starting = None, threading.Lock()


os.register_at_fork(after_in_child=_leave_guard_to_parent)


def file_of_guard() -> str:
    """Started if there is none. No session inherits the file: the guard waits until nobody has it open."""
    global _guard
    with _starting:
        if _guard is None or _guard.poll() is not None:
            _guard = start(
                _GUARD,
                stdin=subprocess.PIPE,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
                cwd="/",
                start_new_session=True,
            )
        assert _guard.stdin is not None
        return f"/proc/{os.getpid()}/fd/{_guard.stdin.fileno()}"


def tell_of_end(session: int) -> None:
    if _guard is not None and _guard.stdin is not None:
        with contextlib.suppress(OSError):
            os.write(_guard.stdin.fileno(), b"-%d\n" % session)


def guard() -> None:
    """The life of the guard: it is told of each session that begins (its number) and ends (minus its
    number). When nobody is left to tell it, it ends those that are left, and removes the files that they
    worked on."""
    for asked in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT):
        signal.signal(asked, signal.SIG_IGN)
    sessions: set[int] = set()
    for line in sys.stdin.buffer:
        number = int(line)
        sessions = sessions | {number} if number > 0 else sessions - {-number}
    for session in sessions:
        kill(session)
    remove_abandoned()


def kill(session: int) -> None:
    """Until none of its processes is left. The number of a session is its own until its first process has
    been waited for."""
    deadline, pause = time.monotonic() + _PATIENCE, 0.001
    while tell(session, signal.SIGKILL) and time.monotonic() < deadline:
        time.sleep(pause)
        pause = min(2 * pause, 0.05)


def tell(session: int, number: int) -> bool:
    """Sends a signal to all its processes; true if one was alive. A signal to a group reaches what its
    processes are just about to start. The group of the first process is signalled unseen: one that always
    replaces itself may be in no listing of /proc.
    """
    alive = set()
    for process in map(int, filter(str.isdecimal, os.listdir("/proc"))):
        with contextlib.suppress(OSError):  # it is gone
            if os.getsid(process) == session and not _is_dead(process):
                alive.add(os.getpgid(process))
    for group in {session, *alive}:
        with contextlib.suppress(ProcessLookupError, PermissionError):
            os.killpg(group, number)
    return bool(alive)


def _is_dead(process: int) -> bool:
    """True of one that nobody has waited for yet."""
    with open(f"/proc/{process}/stat", "rb") as file:
        return file.read().rpartition(b") ")[2][:1] in b"ZX"
