# SPDX-License-Identifier: GPL-3.0-or-later
"""Progress of a command or a call, on standard error."""

import os
import sys
import time
from collections.abc import Callable

Told = Callable[[str, int, int, str], None]  # current work, number done, total, names of active jobs

_JOBS = ("reference", "first tries", "evaluation")  # counted in jobs; all other work in items
_WIDTH = 24  # characters of the bar, where there is room
_STILL = 6  # intervals without news before a line reports that work goes on


def nothing(_what: str, _done: int, _items: int, _at_work: str) -> None:
    """Ignores progress."""


def say(line: str) -> None:
    """Prints a line, even if there is a bar on the terminal."""
    print(f"\r\033[K{line}" if _redraws() else line, file=sys.stderr, flush=True)


class Progress:
    """A bar on a terminal and in a notebook; elsewhere a line every ten seconds, or every minute without
    progress. quiet: no output. estimates: show speed and time left, which mislead if some jobs take much
    longer than others."""

    def __init__(self, quiet: bool, estimates: bool = True) -> None:
        self._quiet, self._estimates, self._redraws = quiet, estimates, _redraws()
        self._interval = 0.1 if self._redraws else 10  # s
        self._what, self._done = "", 0  # as last shown
        self._started = self._shown = 0.0
        self._has_bar = False

    def __enter__(self) -> "Progress":
        return self

    def __call__(self, what: str, done: int, items: int, at_work: str) -> None:
        """what: "" before anything is done. at_work: names of jobs, or ""."""
        now = time.monotonic()
        if what != self._what:
            self._end()
            self._what, self._started, self._shown = what, now, now
        if self._quiet or not items:
            return
        has_news = done != self._done
        if now - self._shown >= self._interval * (1 if has_news else _STILL) or has_news and done == items:
            self._show(done, items, at_work)

    def _show(self, done: int, items: int, at_work: str) -> None:
        self._shown, self._done = time.monotonic(), done
        unit = "jobs" if self._what in _JOBS else "items"
        since = self._shown - self._started
        rate = done / max(since, 1e-3)
        speed = (
            f"{rate:.1f} {unit}/s, {_duration((items - done) / rate)} left"
            if done and self._estimates
            else _duration(since)
        )
        text = f"{self._what}: {done}/{items} {unit}, {speed}"
        now = f"; now {at_work}" if at_work else ""
        self._has_bar = self._redraws
        if not self._redraws:
            print(text + now, file=sys.stderr, flush=True)
            return
        room = _columns() - 1  # a line that wraps could not be overwritten
        if len(f"[] {text}{now}") + _WIDTH <= room:
            text += now
        width = max(1, min(_WIDTH, room - len(f"[] {text}")))
        line = f"[{'-' * (done * width // items):{width}}] {text}"[:room]
        print(f"\r{line}\033[K", end="", file=sys.stderr, flush=True)

    def _end(self) -> None:
        if self._has_bar:
            print(file=sys.stderr, flush=True)
        self._done, self._has_bar = 0, False

    def __exit__(self, *_: object) -> None:
        self._end()


def _redraws() -> bool:
    """True if lines can be overwritten."""
    return "ipykernel" in sys.modules or sys.stderr.isatty()


def _columns() -> int:
    """Width of the terminal, if it is known."""
    try:
        return os.get_terminal_size(sys.stderr.fileno()).columns or sys.maxsize
    except (OSError, ValueError, AttributeError):  # a notebook
        return sys.maxsize


def _duration(seconds: float) -> str:
    whole = round(seconds)
    if whole < 60:
        return f"{whole} s"
    if whole < 3600:
        return f"{whole // 60} min {whole % 60:02} s"
    return f"{whole // 3600} h {whole // 60 % 60:02} min"
