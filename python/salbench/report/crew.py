# SPDX-License-Identifier: GPL-3.0-or-later
"""Work on several processes."""

import multiprocessing
import os
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from typing import Any

from salbench.system.errors import StorageError
from salbench.system.processes import end_with_parent, interrupts_held, leave_interrupts_to_parent

# (function, tasks): processes are forked when they are known, so that nothing is sent to them
_work: tuple[Callable[[Any], None], Sequence[Any]] | None = None


def _do(at: int) -> None:
    assert _work is not None
    _work[0](_work[1][at])


def _begin(parent: int) -> None:
    end_with_parent(parent)
    leave_interrupts_to_parent()


def each(function: Callable[[Any], None], tasks: Sequence[Any], processes: int) -> None:
    """Calls the function for each task of the list."""
    global _work
    _work = function, tasks
    if min(processes, len(tasks)) < 2:
        for task in tasks:
            function(task)
        return
    pool = ProcessPoolExecutor(min(processes, len(tasks)), multiprocessing.get_context("fork"), _begin, (os.getpid(),))
    try:
        with interrupts_held():
            futures = [pool.submit(_do, at) for at in range(len(tasks))]
        for future in futures:
            future.result()
    except BrokenProcessPool:
        raise StorageError("a process that drew was ended from outside; is there too little memory? "
                           "The next call goes on from here: --processes 1 takes the least.") from None
    except BaseException:  # nobody waits for the other drawings
        for process in multiprocessing.active_children():
            process.kill()
        raise
    finally:
        pool.shutdown(cancel_futures=True)
