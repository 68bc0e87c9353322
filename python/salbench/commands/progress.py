# SPDX-License-Identifier: GPL-3.0-or-later
"""How far a command is."""

import sys
import time

_JOBS = ("reference", "first tries", "evaluation")  # what is counted in jobs; all other work is in items
_WIDTH = 24  # of the bar, in characters


class Progress:
    """On standard error: a bar on a terminal, a plain line every ten seconds elsewhere; nothing if the
    command is to be quiet."""

    def __init__(self, quiet: bool) -> None:
        self._quiet, self._on_terminal = quiet, sys.stderr.isatty()
        self._interval = 0.1 if self._on_terminal else 10  # s
        self._what, self._done = "", 0  # as last shown
        self._started = self._shown = 0.0

    def __enter__(self) -> "Progress":
        return self

    def __call__(self, what: str, done: int, items: int, at_work: str) -> None:
        """what: is done, or "" before anything is. at_work: names of jobs, or ""."""
        now = time.monotonic()
        if what != self._what:
            self._end()
            self._what, self._started, self._shown = what, now, now
        if not self._quiet and done != self._done and (now - self._shown >= self._interval or done == items):
            self._show(done, items, at_work)

    def _show(self, done: int, items: int, at_work: str) -> None:
        self._shown, self._done = time.monotonic(), done
        unit = "jobs" if self._what in _JOBS else "items"
        rate = done / max(self._shown - self._started, 1e-3)
        text = (
            f"{self._what}: {done}/{items} {unit}, {rate:.1f} {unit}/s,"
            f" {_duration((items - done) / rate)} left{f'; now {at_work}' if at_work else ''}"
        )
        bar = "-" * (done * _WIDTH // items)
        print(
            f"\r[{bar:{_WIDTH}}] {text}\033[K" if self._on_terminal else text,
            end="" if self._on_terminal else "\n",
            file=sys.stderr,
            flush=True,
        )

    def _end(self) -> None:
        if self._on_terminal and self._done:
            print(file=sys.stderr, flush=True)
        self._done = 0

    def __exit__(self, *_: object) -> None:
        self._end()


def _duration(seconds: float) -> str:
    whole = round(seconds)
    if whole < 60:
        return f"{whole} s"
    if whole < 3600:
        return f"{whole // 60} min {whole % 60:02} s"
    return f"{whole // 3600} h {whole // 60 % 60:02} min"
