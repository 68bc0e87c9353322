# SPDX-License-Identifier: GPL-3.0-or-later
"""Sessions of processes started by this one. If this process is killed, a guard process that outlives it ends
them."""

import contextlib
import os
import signal
import subprocess
import sys
import threading
import time

from salbench.system.processes import start
from salbench.system.scratch import remove_abandoned

# Command of a session, followed by `file_of_guard()` and a shell line. The session itself reports its number
# to the guard. If this process is killed during the start, the file is gone, and the session does not begin.
SHELL = ("/bin/sh", "-c", 'echo $$ > "$1" && exec /bin/sh -c "$2" sh', "sh")
_GUARD = "import sys; sys.path.insert(0, sys.argv[1]); from salbench.models.sessions import guard; guard()"
# s, for processes that survive a kill: hung in a device, or owned by another user
_PATIENCE = 10

_guard: "subprocess.Popen[bytes] | None" = None
_starting = threading.Lock()


def _leave_guard_to_parent() -> None:
    """Closes the pipe in a forked child, which would keep the guard from noticing the end of its parent."""
    global _guard, _starting
    if _guard is not None and _guard.stdin is not None:
        _guard.stdin.close()
    _guard, _starting = None, threading.Lock()


os.register_at_fork(after_in_child=_leave_guard_to_parent)


def file_of_guard() -> str:
    """File of the guard, which is started if necessary. Sessions do not inherit the file: the guard waits
    until no process has it open."""
    global _guard
    with _starting:
        if _guard is None or _guard.poll() is not None:
            _guard = start(
                _GUARD,
                str(os.getpid()),
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
    """Main loop of the guard. It is told of sessions that begin (their number) and end (minus their number).
    At end of file it kills the remaining sessions, and removes their files."""
    for asked in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT):
        signal.signal(asked, signal.SIG_IGN)
    parent, sessions = int(sys.argv[2]), set[int]()
    for line in sys.stdin.buffer:
        number = int(line)
        sessions = sessions | {number} if number > 0 else sessions - {-number}
    for session in sessions:
        kill(session)
    deadline = time.monotonic() + _PATIENCE
    while os.getppid() == parent and time.monotonic() < deadline:  # a dying process closes its files first
        time.sleep(0.01)
    remove_abandoned()


def kill(session: int) -> None:
    """Kills a session until none of its processes is left. Its number stays reserved until its first process
    has been waited for."""
    deadline, pause = time.monotonic() + _PATIENCE, 0.001
    while tell(session, signal.SIGKILL) and time.monotonic() < deadline:
        time.sleep(pause)
        pause = min(2 * pause, 0.05)


def tell(session: int, number: int) -> bool:
    """Sends a signal to all processes of a session; true if one was alive. A signal to a group reaches
    processes that are just being forked. The group of the first process is signalled unconditionally: a
    process that keeps replacing itself may appear in no listing of /proc."""
    alive = set()
    for process in map(int, filter(str.isdecimal, os.listdir("/proc"))):
        with contextlib.suppress(OSError):  # already gone
            if os.getsid(process) == session and not _is_dead(process):
                alive.add(os.getpgid(process))
    for group in {session, *alive}:
        with contextlib.suppress(ProcessLookupError, PermissionError):
            os.killpg(group, number)
    return bool(alive)


def _is_dead(process: int) -> bool:
    """True for a zombie."""
    with open(f"/proc/{process}/stat", "rb") as file:
        return file.read().rpartition(b") ")[2][:1] in b"ZX"
