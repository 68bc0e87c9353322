# SPDX-License-Identifier: GPL-3.0-or-later
"""Threads for work that NumPy does without the interpreter's lock. Results are in the order of the items, whatever their number."""

import os
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

_MOST = 8  # each has arrays of its own
T = TypeVar("T")
R = TypeVar("R")


def mapped(function: Callable[[T], R], items: Iterable[T]) -> list[R]:
    """function(item) of each."""
    with ThreadPoolExecutor(min(_MOST, len(os.sched_getaffinity(0)))) as threads:
        return list(threads.map(function, items))
