# SPDX-License-Identifier: GPL-3.0-or-later
"""Folders below TMPDIR for files shared with other processes. Their names identify the process that made
them, and so tell whether it is alive. Locks do not, because some shared file systems do not propagate them
between machines."""

import contextlib
import hashlib
import os
import re
import shutil

from salbench.system.errors import StorageError

_NAME = r"salbench-scratch-([0-9a-f]{12})-([0-9]+-[0-9]+)-[0-9a-f]{8}"  # machine, process, random
_removed_by = 0  # process that has already removed abandoned folders


class ScratchFolder:
    """A new folder. The process that made it removes it with its content; forked copies do not. Throws
    StorageError."""

    def __enter__(self) -> str:
        global _removed_by
        self._maker = os.getpid()
        if _removed_by != self._maker:
            _removed_by = self._maker
            remove_abandoned()
        self.path = os.path.join(
            _root(), f"salbench-scratch-{_machine()}-{_life(self._maker)}-{os.urandom(4).hex()}"
        )
        try:
            os.mkdir(self.path, 0o700)
        except OSError as error:
            raise StorageError(
                f"{self.path}: the folder cannot be created: {error.strerror}; set TMPDIR to another"
            ) from None
        return self.path

    def __exit__(self, *_: object) -> None:
        if os.getpid() == self._maker:
            shutil.rmtree(self.path, ignore_errors=True)


def without_scratch_folders(message: str) -> str:
    """Removes paths of such folders, which are temporary and random, from a message: "shape.ply"."""
    return re.sub(f"{re.escape(os.path.join(_root(), ''))}{_NAME}/", "", message)


def remove_abandoned() -> None:
    """Removes folders below TMPDIR that belong to dead processes of this user and machine."""
    with contextlib.suppress(OSError), os.scandir(_root()) as entries:
        for entry in entries:
            name = re.fullmatch(_NAME, entry.name)
            if name is None or name[1] != _machine() or name[2] == _life(int(name[2].partition("-")[0])):
                continue
            if (
                entry.is_dir(follow_symlinks=False)
                and entry.stat(follow_symlinks=False).st_uid == os.geteuid()
            ):
                shutil.rmtree(entry.path, ignore_errors=True)


def _root() -> str:
    """Absolute path, since commands run in other folders."""
    given = os.environ.get("TMPDIR", "")
    return os.path.abspath(given) if os.path.isdir(given) else "/tmp"


def _machine() -> str:
    """Scope of process numbers: a boot of this machine, and a namespace. Host names are not unique,
    especially those of containers."""
    start = b""
    with contextlib.suppress(OSError), open("/proc/sys/kernel/random/boot_id", "rb") as file:
        start = file.read()
    namespace = os.stat("/proc/self/ns/pid").st_ino
    return hashlib.sha256(os.fsencode(f"{os.uname().nodename} {namespace} ") + start).hexdigest()[:12]


def _life(process: int) -> str:
    """Number and start time of a process, which together are unique. Empty if it is dead."""
    try:
        with open(f"/proc/{process}/stat", "rb") as file:
            state, *others = file.read().rpartition(b") ")[2].split()
    except OSError:
        return ""
    return "" if state in b"ZX" else f"{process}-{int(others[18])}"
