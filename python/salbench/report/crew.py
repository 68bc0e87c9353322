# SPDX-License-Identifier: GPL-3.0-or-later
"""Work on several processes, with results in the order of the tasks, whichever process did them."""

import multiprocessing
import os
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from typing import Any

from salbench._errors import InputError, StorageError
from salbench._files import ADVICE, LACKING
from salbench._processes import end_with_parent, interrupts_held, leave_interrupts_to_parent

# (function, tasks): processes are forked when they are known, so that nothing is sent to them
_work: tuple[Callable[[Any], Any], Sequence[tuple[str, Any]]] | None = None


def _do(at: int) -> Any:
    assert _work is not None
    function, tasks = _work
    name, task = tasks[at]
    try:
        return function(task)
    except (InputError, StorageError):
        raise
    except MemoryError:
        raise StorageError(f"no memory to draw {name}: close other programs; --processes 1 takes the least") from None
    except OSError as error:
        if error.errno not in LACKING:
            raise RuntimeError(f"drawing {name}: {type(error).__name__}: {error}") from error
        raise StorageError(f"drawing {name}: {error.filename or ''}: {error.strerror}{ADVICE.get(error.errno, '')}") from None
    except Exception as error:
        raise RuntimeError(f"drawing {name}: {type(error).__name__}: {error}") from error


def _begin(parent: int) -> None:
    end_with_parent(parent)
    leave_interrupts_to_parent()


def each(function: Callable[[Any], Any], tasks: Sequence[tuple[str, Any]], processes: int) -> Iterator[Any]:
    """Yields function(task) for each (name, task) of the list. An error names its task."""
    global _work
    _work = function, tasks
    if min(processes, len(tasks)) < 2:
        yield from map(_do, range(len(tasks)))
        return
    pool = ProcessPoolExecutor(min(processes, len(tasks)), multiprocessing.get_context("fork"), _begin, (os.getpid(),))
    try:
        with interrupts_held():
            futures = [pool.submit(_do, at) for at in range(len(tasks))]
        for (name, _), future in zip(tasks, futures):
            try:
                yield future.result()
            except BrokenProcessPool:
                raise StorageError(f"a process that drew {name} or what follows it was ended from outside; is there too little memory? "
                               "The next call goes on from here: --processes 1 takes the least.") from None
    except BaseException:  # nobody waits for the other drawings
        for process in multiprocessing.active_children():
            process.kill()
        raise
    finally:
        pool.shutdown(cancel_futures=True)
