# SPDX-License-Identifier: GPL-3.0-or-later
"""Callbacks of the engine during a run, from several of its threads (python/front.cpp). Errors are those of
salbench.system.errors."""

import atexit
import copy
import logging
import secrets
import traceback
from collections.abc import Sequence
from typing import Any

from salbench.datasets import sets
from salbench.datasets.files import extension
from salbench.datasets.records import Arrays, Item, Listing, arrays_of
from salbench.models import shell
from salbench.models.command import Command, close_all
from salbench.models.fingerprint import Unwalkable, fingerprint
from salbench.system.errors import InputError, StorageError, message
from salbench.system.processes import PACKAGES
from salbench.system.workers import NotRead, Pool, Question, is_of_the_system

_readers = Pool()


def listed(root: str, layout: str) -> tuple[sets.Dataset, Listing]:
    """Returns the data set of a layout that C++ does not list, and its listing of a folder. Reads no
    shape."""
    return listed_of(sets.find(layout), root)


def listed_of(dataset: sets.Dataset, root: str = "") -> tuple[sets.Dataset, Listing]:
    """Returns a data set with its items, and with the key of its function."""
    if dataset.key is None:
        # computed again in the next run, since values used by the function may have changed
        dataset = copy.copy(dataset)
        dataset.key = f"{dataset.name}, {_key_of(dataset)}"
    try:
        return dataset, dataset.items(root)
    except (InputError, StorageError):
        raise
    except Exception as error:
        raise (StorageError if is_of_the_system(error) else InputError)(message(error)) from None


def _key_of(dataset: sets.Dataset) -> str:
    """Identity of a reading function; unique to this run if it cannot be determined."""
    try:
        return f"function {fingerprint(dataset.function)}"
    except Unwalkable as error:
        logging.getLogger("salbench").warning(
            (
                "%s: is read anew in each run, since its function depends on what cannot be compared: %s;"
                " version=1 keeps what was read"
            ),
            dataset.name,
            error,
        )
        return f"of one run: {secrets.token_hex(16)}"


def layouts_that_fit(root: str) -> str:
    """End of a message on a folder without shapes in its layout."""
    others = sets.layouts_that_fit(root)
    return (
        f"{others}; choose one with dataset: {{layout: ...}}" if others else sets.shapes_in_sub_folders(root)
    )


def read(dataset: sets.Dataset, item: Item) -> tuple[Arrays, str]:
    """Returns the shape of an item, and a remark, one line, on unusable parts of its files. User functions
    are called in this process, as models are."""
    shape = (
        _asked(dataset.question("salbench.datasets.sets:read_of", [item], item, dataset.key))
        if dataset.layout
        else dataset.read(item)
    )
    return arrays_of(shape, item.view, item.place), "; ".join(
        shape.recording.remarks if shape.recording else ()
    )


def read_cloud(path: str) -> Any:
    """Points, normals and viewpoint in a point cloud file; None for missing ones."""
    return _asked(Question("salbench.datasets.clouds:read_cloud", (path,), path, (path,)))


def read_form(path: str, shape: str) -> Arrays:
    """The shape in an HDF5-form file of another program, with all its views."""
    arrays: Arrays = _asked(
        Question("salbench.datasets.one_form:foreign_arrays", (path, shape), path, (path,))
    )
    return arrays


def names_of_maps(path: str) -> list[str]:
    """Names of numeric data sets in an HDF5 file."""
    names: list[str] = _asked(Question("salbench.system.hdf5:names_in", (path,), path, of_map=True))
    return names


def read_map(path: str, name: str) -> Any:
    """The map in a data set of an HDF5 file, or in a .npy file."""
    if extension(path) == ".npy":
        return _asked(Question("salbench.datasets.reading:read_values", (path,), path, of_map=True))
    return _asked(Question("salbench.system.hdf5:map_in", (path, name), path, of_map=True))


def _asked(question: Question) -> Any:
    try:
        return _readers.ask(question)
    except NotRead as error:  # other items may take less memory
        raise InputError(str(error)) from None


def command(name: str, line: str, timeout: float, depends: Sequence[tuple[str, str, str]]) -> Command:
    """depends: name as written, absolute path, and digest of each file."""
    return Command(name, line, timeout, depends, _values_in)


def _values_in(path: str) -> Any:
    """Map in an HDF5 file with a single one."""
    return _asked(Question("salbench.system.hdf5:only_values", (path,), path, of_map=True))


def raised(error: BaseException, trace: Any) -> tuple[str, str]:
    """An exception as one line, with the innermost line of code that is not of salbench; and its
    traceback."""
    frames = [
        frame
        for frame in traceback.extract_tb(trace)
        if not frame.filename.startswith(f"{PACKAGES}/salbench/")
    ]
    place = f" ({frames[-1].filename}, line {frames[-1].lineno})" if frames else ""
    try:
        text = f"{type(error).__name__}: {error}"
    except Exception:  # raised by its own __str__
        text = type(error).__name__
    lines = (
        " ".join(text.split()) + place,
        "".join(traceback.format_exception(type(error), error, trace)).rstrip(),
    )
    line, whole = (one.encode("utf-8", "backslashreplace").decode().replace("\0", "\\0") for one in lines)
    return line, whole


def begin() -> None:
    """Called before a run: allows commands and readers to start."""
    shell.begin()
    _readers.begin()


def end_all() -> None:
    """Ends running processes and prevents new ones; waiting callers get Interrupted."""
    _readers.end_all()
    shell.end_all()


def finish() -> None:
    """Called after a run: ends processes kept for the next shape."""
    close_all()
    _readers.close()


atexit.register(finish)
