# SPDX-License-Identifier: GPL-3.0-or-later
"""Models that are shell commands: the files that a command gets for a shape, and the file that it writes."""

from __future__ import annotations

import contextlib
import functools
import logging
import os
import re
import shlex
import sys
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from salbench import _core
from salbench.models.depended import DependedFiles, write
from salbench.models.shell import Shell, TookTooLong, require_not_ending, run
from salbench.system.errors import InputError, StorageError
from salbench.system.files import read_file, require_file
from salbench.system.processes import PACKAGES
from salbench.system.scratch import ScratchFolder, without_scratch_folders

if TYPE_CHECKING:
    import numpy as np

    from salbench.shapes.shape import Shape
    from salbench.system.types import NDArray

_FILES = {
    "{mesh}": "shape.ply",
    "{shape}": "shape.h5",
    "{out}": "out.val",
    "{out.npy}": "out.npy",
    "{out.h5}": "out.h5",
}
# {python}: the interpreter that runs salbench, with the package on its path
_PYTHON = f"PYTHONPATH={shlex.quote(PACKAGES)}${{PYTHONPATH:+:$PYTHONPATH}} {shlex.quote(sys.executable)}"
# placeholder -> first file on each line of the list; the second one is that of {out}
_LISTS = {"{list}": "shape.ply", "{list.h5}": "shape.h5"}
# the last one comes from numpy.save with the name of the first
_WRITTEN = ("out.val", "out.npy", "out.h5", "out.val.npy")
_MISNAMED = tuple(f"{file}." for file in _WRITTEN)  # begins a name with an ending that the program added
_MOST_LATE = 3  # shapes awaited, one timeout each, before any answer
_ADVICE = "does it print the second file of each line, as a line, and flush its standard output after it?"
_HDF5 = b"\x89HDF\r\n\x1a\n"
# bounds of a file of n values: a number in text, and a header
_BYTES_PER_VALUE, _HEADER_BYTES = 64, 1 << 20
_SECONDS_OF_A_LOOK = 30  # to probe an interpreter

_used: "set[Command]" = set()  # commands that may keep state for the next shape
os.register_at_fork(after_in_child=_used.clear)


def close_all() -> None:
    """Ends idle processes, and removes copies of files. All can be used again."""
    while _used:
        _used.pop()._close()


class Command:
    """Several threads may ask for maps. Commands with a list keep processes running from shape to shape, as
    many as there are simultaneous requests."""

    def __init__(
        self,
        name: str,
        line: str,
        timeout: float,
        depends: Sequence[tuple[str, str, str]],
        read_hdf5: Callable[[str], NDArray[np.float64]],
    ) -> None:
        self._name, self._line, self._timeout, self._read_hdf5 = (
            name,
            line.replace("{python}", _PYTHON),
            timeout,
            read_hdf5,
        )
        self._depends = DependedFiles(depends)
        self._list = next((listed for listed in _LISTS if listed in line), "")
        self._idle: list[tuple[Shell, contextlib.ExitStack]] = []
        self._n_late, self._has_answered, self._has_warned = 0, False, False

    def map(self, shape: Shape, mapped_faces: int) -> NDArray[np.float64]:
        """The values that the command writes, one per point, or per face with `mapped_faces` faces. Throws
        InputError if it fails, StorageError, and Interrupted."""
        _used.add(self)
        with ScratchFolder() as folder:
            if "{mesh}" in self._line or self._list == "{list}":
                write(f"{folder}/shape.ply", _core.shape_ply(shape.points, shape.normals, shape.faces))
            if "{shape}" in self._line or self._list == "{list.h5}":
                write(
                    f"{folder}/shape.h5",
                    _core.shape_hdf5(shape.points, shape.normals, shape.faces, shape.fpfh),
                )
            try:
                file = self._carried_out(folder, shape)
                self._depends.check_unchanged()
                return self._values_in(
                    f"{folder}/{file}", f"the command's {file}", len(shape.points), mapped_faces
                )
            except InputError as error:
                raise InputError(without_scratch_folders(str(error))) from None

    def _values_in(self, path: str, title: str, n_points: int, n_faces: int) -> NDArray[np.float64]:
        """Reads text, .npy or HDF5, detected by content. n_faces: 0 if values belong only to points."""
        require_file(path, sys.maxsize)
        most = max(n_points, n_faces)
        if (size := os.path.getsize(path)) > most * _BYTES_PER_VALUE + _HEADER_BYTES:
            raise InputError(f"{title}: {size} bytes are too many for {most} values")
        data = read_file(path)
        if data.startswith(_HDF5):
            values = self._read_hdf5(path)
        elif data.startswith(b"\x93NUMPY"):
            from salbench.datasets.reading import read_values

            try:
                values = read_values(path)
            except InputError as error:
                raise InputError(str(error).replace(path, title)) from None
        else:
            values = _core.parse_values(data, title)
        _core.check_values(values, title, n_points, n_faces)
        return values

    def _close(self) -> None:
        idle, self._idle = self._idle, []
        for shell, _ in idle:
            shell.tell_no_more()
        for _, server in idle:
            server.close()
        self._depends.close()

    def _carried_out(self, folder: str, shape: Shape) -> str:
        """Runs the command. Returns the name of the file that it wrote."""
        try:
            said = self._serve(folder) if self._list else self._run(folder, shape)
            if file := next((file for file in _WRITTEN if os.path.exists(f"{folder}/{file}")), ""):
                return file
            misnamed = [file for file in os.listdir(folder) if file.startswith(_MISNAMED)]
            raise InputError(
                f"the command {'answered' if self._list else 'ended'} without a file {{out}}; it must write one"
                " value per point there; "
                + (f"it wrote {min(misnamed)}: write exactly {{out}}; " if misnamed else "")
                + said
            )
        except InputError as error:
            why = str(error)
            raise InputError(why + (self._depends.left_out_of(why) or who_has_module(why))) from None

    def _run(self, folder: str, shape: Shape) -> str:
        """Returns the last lines that it printed."""
        self._depends.put_into(folder)
        words = {
            **{text: f"{folder}/{file}" for text, file in _FILES.items()},
            "{source}": shape.source or "",
            "{item}": shape.id,
        }
        line = self._line
        for text, word in words.items():
            if shlex.quote(word) != word:  # in quotes of the user's, a word of the line would be quoted twice
                line = re.sub(rf"(?<![^\s=])(['\"]){re.escape(text)}\1", text, line)
        return run(
            re.sub("|".join(map(re.escape, words)), lambda found: shlex.quote(words[found[0]]), line),
            folder,
            self._timeout,
        )

    def _serve(self, folder: str) -> str:
        """Returns the last lines that it printed."""
        shape, out = f"{folder}/{_LISTS[self._list]}", f"{folder}/out.val"
        if re.search("[\t\r\n]", folder):
            raise StorageError(
                f"{shape}: a tab or a line end in a path cannot be part of {{list}}; set TMPDIR to another"
            )
        if self._n_late >= _MOST_LATE:
            raise InputError(
                f"the command was not asked any more: it has answered none of {self._n_late} shapes within"
                f" its timeout of {self._timeout:.15g} s; {_ADVICE}"
            )
        try:
            said = self._asked(os.fsencode(f"{shape}\t{out}\n"), os.fsencode(out))
        except TookTooLong as error:
            if self._has_answered:
                raise
            self._n_late += 1
            raise InputError(f"{error}; {_ADVICE}") from None
        self._has_answered = True
        return said

    def _asked(self, line: bytes, answer: bytes) -> str:
        """Asks a process, and returns the last lines that it printed. A process that ended after its answer
        is replaced."""
        while True:
            shell, server = self._idle_or_new()
            with server:
                if shell.ask(line, answer, self._timeout):
                    said = shell.said()
                    self._idle.append((shell, server.pop_all()))
                    return said
                if not shell.has_answered:
                    raise InputError(
                        "the command ended without an answer; when it is done with a line of {list} it"
                        f" must print the second file of that line; {shell.said()}"
                    )
                # it stops after some shapes: this one is the first of the next process
                self._warn_of_end(shell)

    def _idle_or_new(self) -> tuple[Shell, contextlib.ExitStack]:
        while True:
            try:
                shell, server = self._idle.pop()
            except IndexError:
                break
            if not shell.has_ended():
                return shell, server
            with server:
                self._warn_of_end(shell)
        with contextlib.ExitStack() as stack:
            folder = stack.enter_context(ScratchFolder())
            self._depends.put_into(folder)
            shell = stack.enter_context(
                Shell(self._line.replace(self._list, "/dev/stdin"), folder, serves=True)
            )
            server = stack.pop_all()
        return shell, server

    def _warn_of_end(self, shell: Shell) -> None:
        """Warns once for all shapes."""
        require_not_ending()
        if (failure := shell.failure()) and not self._has_warned:
            self._has_warned = True
            logging.getLogger("salbench").warning(
                "models.%s: %s after an answer, which counts; the next shape gets a new process; %s",
                self._name,
                failure,
                shell.said(),
            )


def who_has_module(why: str) -> str:
    """Hint such as "; /usr/bin/python3 has numpy ...", if the command failed because Python misses a
    module."""
    missing = re.search(r"No module named '([A-Za-z0-9_]+)['.]", why)
    return _interpreter_with(missing[1]) if missing else ""


@functools.cache
def _interpreter_with(module: str) -> str:
    look = f"import importlib.util as u, sys; sys.exit(u.find_spec('{module}') is None)"
    beside = [
        os.path.join(folder, "python3")
        for folder in os.environ.get("PATH", "").split(":")
        if os.path.isabs(folder)
    ]
    for python in [sys.executable, *filter(os.path.isfile, beside)]:
        with contextlib.suppress(InputError):
            run(f"exec {shlex.quote(python)} -c {shlex.quote(look)}", "/", _SECONDS_OF_A_LOOK)
            return f"; {python} has {module}: start the command with it"
    return f"; no python3 on the PATH has {module}"
