# SPDX-License-Identifier: GPL-3.0-or-later
"""A Matplotlib figure to be drawn: a function and its arguments. File names contain its digest, so that
unchanged figures are not drawn again, and any process can draw it."""

import multiprocessing
import os
import zlib
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from functools import cache
from importlib.metadata import version
from io import BytesIO
from pathlib import Path
from pickle import Pickler
from typing import Any, Literal

import numpy
import PIL
from PIL import features

from salbench.pages import rendering
from salbench.report import style
from salbench.report.folder import digest
from salbench.system.errors import StorageError
from salbench.system.processes import end_with_parent, interrupts_held, leave_interrupts_to_parent


@dataclass(frozen=True)
class Drawing:
    # module-level function: takes an empty figure and the arguments, and reads nothing else
    draw: Callable[..., None]
    arguments: tuple[Any, ...]
    size: tuple[float, float]  # width and height, inches
    layout: Literal["constrained"] | None = "constrained"
    svg_dpi: int = style.SCREEN_DPI  # of pictures in the SVG

    def digest(self) -> str:
        """Digest of the arguments, and of the code and libraries that draw."""
        content = BytesIO()
        pickler = Pickler(content, 5)
        pickler.fast = True  # equal values give equal bytes, even if they are different objects
        pickler.dump(self)
        return digest(code(), content.getvalue())

    def real(self) -> Any:
        from matplotlib.figure import Figure

        style.apply()
        figure = Figure(figsize=self.size, dpi=self.svg_dpi, layout=self.layout)
        self.draw(figure, *self.arguments)
        return figure


@cache
def code() -> str:
    """Digest of all drawing code: a new version draws again."""
    sources = [
        path for folder in (Path(__file__).parent, rendering.HERE) for path in sorted(folder.glob("*.py"))
    ]
    libraries = (
        version("matplotlib"),
        numpy.__version__,
        PIL.__version__,
        str(features.version("webp")),
        zlib.ZLIB_RUNTIME_VERSION,
    )
    return digest(
        *libraries, *(path.read_bytes() for path in (*sources, rendering.HERE / "static/palette.js"))
    )


_work: Callable[[int], None]  # in a drawing process: runs the task of this number


def each(
    work: Callable[[Any], None], tasks: Sequence[Any], processes: int, told: Callable[[int], None]
) -> None:
    """Calls a function for each task. Processes are forked when both are known, so nothing is sent to them.
    told: called with the number of finished tasks."""
    processes = min(processes, len(tasks))
    if processes < 2:
        for done, task in enumerate(tasks):
            told(done)
            work(task)
        told(len(tasks))
        return
    pool = ProcessPoolExecutor(
        processes, multiprocessing.get_context("fork"), _begin, (os.getpid(), lambda at: work(tasks[at]))
    )
    try:
        with interrupts_held():
            futures = [pool.submit(_do, at) for at in range(len(tasks))]
        for done, future in enumerate(as_completed(futures), 1):
            future.result()
            told(done)
    except BrokenProcessPool:
        raise StorageError(
            "a process that drew was ended from outside; is there too little memory? "
            "The next call goes on from here: --processes 1 takes the least."
        ) from None
    except BaseException:  # does not wait for the other drawings
        for process in multiprocessing.active_children():
            process.kill()
        raise
    finally:
        pool.shutdown(cancel_futures=True)


def _begin(parent: int, work: Callable[[int], None]) -> None:
    global _work
    _work = work
    end_with_parent(parent)
    leave_interrupts_to_parent()


def _do(at: int) -> None:
    _work(at)
