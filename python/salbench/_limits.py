# SPDX-License-Identifier: GPL-3.0-or-later
"""Limits of a process that reads files of strangers: what they make a library do ends with the process, not with the machine."""

from __future__ import annotations

import contextlib
import math
import os
import resource
from collections.abc import Iterable

ERROR = ".error"  # behind the name of an answer: what is wrong in place of it
SECONDS, SECONDS_PER_MB = 60, 1  # of processor time, per request: a damaged file can have a library go round in circles
SECONDS_OF_A_MAP = 60
BYTES_OF_A_MAP = 1 << 30  # beyond what the process has


def physical_memory() -> int:
    return os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")


def own_memory() -> int:
    """Address space of this process, bytes."""
    with open("/proc/self/statm", "rb") as file:
        return int(file.read().split()[0]) * os.sysconf("SC_PAGE_SIZE")


def seconds_for(paths: Iterable[str]) -> int:
    """What reading these files may take."""
    return SECONDS + SECONDS_PER_MB * (sum(os.path.getsize(path) for path in paths if os.path.isfile(path)) // 1_000_000)


def limit(seconds: int = SECONDS, memory: int | None = None) -> None:
    """Bounds what this process uses from now on: processor time in seconds, and bytes beyond what it has (None: the machine's memory). A
    request for more memory is then a MemoryError; one second more ends the process."""
    used = sum(resource.getrusage(resource.RUSAGE_SELF)[:2])
    with contextlib.suppress(ValueError, OSError):  # a lower limit of the user's stands
        lower(resource.RLIMIT_CPU, math.ceil(used) + seconds)
        lower(resource.RLIMIT_AS, own_memory() + (physical_memory() if memory is None else memory))


def lower(kind: int, most: int, hard: int | None = None) -> None:
    """hard: what the process cannot raise it to again (None: what that was). A stricter limit of whoever started it stands."""
    _, before = resource.getrlimit(kind)
    stricter = before != resource.RLIM_INFINITY and (hard is None or before < hard)
    resource.setrlimit(kind, (min(most, before) if stricter else most, before if stricter or hard is None else hard))


def most_memory() -> float:
    """That this process cannot raise."""
    _, hard = resource.getrlimit(resource.RLIMIT_AS)
    return math.inf if hard == resource.RLIM_INFINITY else hard


def no_core() -> None:
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
