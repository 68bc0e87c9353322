# SPDX-License-Identifier: GPL-3.0-or-later
"""Limits of a process that reads untrusted files: a library misled by a damaged file ends only this
process."""

import math
import os
import resource
from collections.abc import Iterable

# processor time per question: a damaged file can cause endless loops
SECONDS, SECONDS_PER_MB = 60, 1
BYTES_OF_A_MAP = 1 << 30  # beyond what the process has


def seconds_for(paths: Iterable[str]) -> int:
    """Limit of processor time for reading these files."""
    return SECONDS + SECONDS_PER_MB * (
        sum(os.path.getsize(path) for path in paths if os.path.isfile(path)) // 1_000_000
    )


def limit(seconds: int, memory: int | None = None) -> None:
    """Limits this process from now on: processor time in seconds, and bytes beyond what it has (None: the
    machine's memory). Excess memory raises MemoryError; excess time ends the process, without a core file.
    Existing hard limits stay."""
    page = os.sysconf("SC_PAGE_SIZE")
    with open("/proc/self/statm", "rb") as file:
        used = int(file.read().split()[0]) * page
    most = {
        resource.RLIMIT_CPU: math.ceil(sum(resource.getrusage(resource.RUSAGE_SELF)[:2])) + seconds,
        resource.RLIMIT_AS: used + (os.sysconf("SC_PHYS_PAGES") * page if memory is None else memory),
        resource.RLIMIT_CORE: 0,
    }
    for kind, value in most.items():
        _, hard = resource.getrlimit(kind)
        resource.setrlimit(kind, (value if hard == resource.RLIM_INFINITY else min(value, hard), hard))
