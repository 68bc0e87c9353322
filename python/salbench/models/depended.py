# SPDX-License-Identifier: GPL-3.0-or-later
"""Files that a command needs beside the shape; their content is part of the key of its maps."""

from __future__ import annotations

import contextlib
import os
import re
import shutil
import sys
import threading
import time
from collections.abc import Sequence
from typing import NoReturn

from salbench import _core
from salbench.system.errors import InputError, StorageError
from salbench.system.files import read_file
from salbench.system.scratch import ScratchFolder


class DependedFiles:
    """Tuples (name, path, digest) as planned. Several threads may use them."""

    def __init__(self, files: Sequence[tuple[str, str, str]]) -> None:
        self._files = [file for file in files if not os.path.isabs(file[0])]
        # used in place by the command
        self._originals = [file for file in files if os.path.isabs(file[0])]
        self._lock = threading.Lock()
        # originals, as last verified
        self._identities: dict[str, tuple[int, ...] | None] = {}
        self._scratch: ScratchFolder | None = None
        self._copies: list[tuple[str, str, int]] = []  # name, path, time of the last change

    def put_into(self, folder: str) -> None:
        """Copies the files, so that the command finds no neighbours of the originals, and cannot modify
        these."""
        self.check_unchanged()
        with self._lock:
            if self._files and not self._copies:
                self._copy_all()
        for name, copy, _ in self._copies:
            place = os.path.join(folder, os.path.normpath(name))
            try:
                os.makedirs(os.path.dirname(place), exist_ok=True)
                try:
                    os.link(copy, place)
                except OSError:
                    shutil.copy2(copy, place)
            except OSError as error:
                _fail_to_write(place, error)

    def check_unchanged(self) -> None:
        """Throws InputError if a file has changed: a result could be of either version."""
        with self._lock:
            for name, copy, time_of_copy in self._copies:
                if not os.path.exists(copy):
                    raise StorageError(
                        f"{copy}: the copy of {name} for all shapes was removed during the run; set TMPDIR to"
                        " another"
                    )
                if os.stat(copy).st_mtime_ns != time_of_copy:
                    raise InputError(
                        f"{name}: the command has written into its copy of this file, which is that of the"
                        " other shapes, too: let it write into another"
                    )
            for _, path, digest in self._originals:  # weights are large, and commands are many
                if (identity := _identity(path)) is None or identity != self._identities.get(path):
                    _as_planned(path, digest)
                    self._identities[path] = identity

    def left_out_of(self, why: str) -> str:
        """Hint such as "; helper.py is not in the command's folder ...", if the failure names a file that
        lies beside one of these but is not listed."""
        names = {os.path.normpath(name) for name, _, _ in self._files}
        for name, path, _ in self._files:
            with contextlib.suppress(OSError), os.scandir(os.path.dirname(path)) as entries:
                for entry in entries:
                    beside = os.path.normpath(os.path.join(os.path.dirname(name), entry.name))
                    if _names(why, entry.name) and not any(
                        f"{other}/".startswith(f"{beside}/") for other in names
                    ):
                        return (
                            f"; {beside} is not in the command's folder: add"
                            f" {'its files' if entry.is_dir() else 'it'} to depends"
                        )
        return ""

    def close(self) -> None:
        if self._scratch is not None:
            self._scratch.__exit__()
            self._scratch, self._copies = None, []

    def _copy_all(self) -> None:
        """Copies each once per run, with the time of the original, so that writing to a copy changes its
        time."""
        if self._scratch is None:
            self._scratch = ScratchFolder()
            self._scratch.__enter__()
        copies = []
        for number, (name, path, digest) in enumerate(self._files):
            copy = f"{self._scratch.path}/{number}"
            write(copy, _as_planned(path, digest), like=path)
            copies.append((name, copy, os.stat(copy).st_mtime_ns))
        self._copies = copies


def _as_planned(path: str, digest: str) -> bytes:
    content = read_file(path, sys.maxsize)
    if _core.digest(content) != digest:
        raise InputError(f"{path}: changed since this run was planned; run it again")
    return content


def _identity(path: str) -> tuple[int, ...] | None:
    """None if the file is inaccessible, or changed so recently that another change could have the same
    time."""
    try:
        found = os.stat(path)
    except OSError:
        return None
    is_recent = time.time() - found.st_ctime < 2
    return (
        None
        if is_recent
        else (found.st_dev, found.st_ino, found.st_size, found.st_mtime_ns, found.st_ctime_ns)
    )


def _names(why: str, file: str) -> bool:
    """True if a message names the file: "No module named 'helper'" for helper.py, "/tmp/x/weights.txt: No
    such file" for weights.txt."""
    stem = re.escape(os.path.splitext(file)[0])
    # not the top of a whole path: a folder "tmp" is not that of /tmp/x
    name = rf"""([ '"]|(?<=[^ '"])/){re.escape(file)}(['"/:]|\Z)"""
    return re.search(rf"{name}|'{stem}(['.]|\Z)", why) is not None


def write(path: str, content: bytes, like: str = "") -> None:
    """Writes a file in a scratch folder. like: a file whose time and permissions to copy. Throws
    StorageError."""
    try:
        with open(path, "wb") as file:
            file.write(content)
        if like:
            shutil.copystat(like, path)
    except OSError as error:
        _fail_to_write(path, error)


def _fail_to_write(path: str, error: OSError) -> NoReturn:
    raise StorageError(f"{path}: cannot be written: {error.strerror}; set TMPDIR to another") from None
