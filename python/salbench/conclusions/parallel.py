# SPDX-License-Identifier: GPL-3.0-or-later
"""Threads for NumPy work outside the interpreter's lock. Results are in the order of the items, whatever the
number of threads."""

import os
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

MOST_THREADS = 8  # each has its own arrays
T = TypeVar("T")
R = TypeVar("R")


def mapped(function: Callable[[T], R], items: Iterable[T], threads: int | None = None) -> list[R]:
    """Returns function(item) for each item. threads: by default one per core that the process may use."""
    with ThreadPoolExecutor(min(MOST_THREADS, threads or len(os.sched_getaffinity(0)))) as pool:
        return list(pool.map(function, items))
