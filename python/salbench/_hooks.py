# SPDX-License-Identifier: GPL-3.0-or-later
"""What the engine asks of Python while a run goes on, by several threads of its own (python/front.cpp). Errors are those of salbench._errors."""

import atexit
from collections.abc import Sequence
from typing import Any

from salbench import _command, _shell, _wire
from salbench._errors import InputError, StorageError
from salbench._serving import is_of_the_system, message
from salbench._workers import NotRead, Pool
from salbench.datasets import listing, sets

layouts_that_fit = sets.layouts_that_fit

_readers = Pool()
_items: dict[tuple[str, str], dict[str, Any]] = {}  # rows of the last listing of a layout and folder, by name


def listed(root: str, layout: str) -> dict[str, Any]:
    """What a layout that C++ does not list finds in a folder. No shape is read."""
    try:
        found = listing.document(layout, root)
    except (OSError, ImportError) as error:
        raise (StorageError if is_of_the_system(error) else InputError)(message(error)) from None
    _items[layout, root] = {row["name"]: row for row in found["items"]}
    return found


def read(request: dict[str, Any]) -> bytes:
    """The answer of a process that reads files of strangers (datasets/worker.py). An item is asked for by its name in the last listing."""
    if request["do"] == "item":
        row = _items[request["layout"], request["root"]][request["item"]]
        request = request | {"item": row, "path": row["files"][0]["path"]}
    try:
        return _readers.ask(request)
    except NotRead as error:  # other items may take less memory
        raise InputError(str(error)) from None


def names_of_maps(path: str) -> list[str]:
    """Of data sets of numbers in an HDF5 file."""
    names: list[str] = _wire.loads(read({"do": "maps", "path": path}))
    return names


def command(name: str, line: str, timeout: float, depends: Sequence[tuple[str, str, str]]) -> _command.Command:
    """depends: name as written, whole path, and digest of each file."""
    return _command.Command(name, line, timeout, depends, lambda path: read({"do": "values", "path": path}))


def begin() -> None:
    """Before a run: commands and readers may be started."""
    _shell.begin()
    _readers.begin()


def end_all() -> None:
    """Ends those at work, and has none started: who waits for one has Interrupted."""
    _readers.end_all()
    _shell.end_all()


def finish() -> None:
    """After a run: ends those that have been kept for the next shape."""
    _command.close_all()
    _readers.close()


atexit.register(finish)
