# SPDX-License-Identifier: GPL-3.0-or-later
"""File access. Untrusted files must be regular and of bounded size. Own files are written atomically."""

import contextlib
import errno
import fcntl
import os
import shutil
import stat
import struct
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO, NoReturn

from salbench.system.errors import InputError, StorageError, UnreadableError

AnyPath = str | os.PathLike[str]

MAX_ITEM_BYTES = 2 << 30
_NEVER_WAIT = os.O_NONBLOCK | os.O_CLOEXEC  # a pipe without a writer opens at once
_TOO_LARGE = "simplify the shape, or copy the file again if it should be smaller"
_UNFINISHED = ".unfinished-"  # and 16 digits: a temporary folder of new files
# a file being written; the engine uses the same name, and removes unlocked ones before a run
_PART = ".salbench-part"

_IS_NOT_THERE = (errno.ENOENT, errno.ENOTDIR, errno.EISDIR, errno.ELOOP, errno.ENAMETOOLONG)
# Errors of a system without resources, which say nothing about the file.
LACKING = (
    errno.ENOSPC,
    errno.EDQUOT,
    errno.EROFS,
    errno.EFBIG,
    errno.EMFILE,
    errno.ENFILE,
    errno.ENOMEM,
    errno.EAGAIN,
)

ADVICE = {
    errno.EACCES: "; check its permissions",
    errno.EPERM: "; check its permissions",
    errno.EIO: "; the disk failed: check it and run again",
    errno.EMFILE: "; raise the limit (ulimit -n)",
    errno.ENOMEM: "; close other programs",
    errno.EFBIG: "; raise the limit on the size of files (ulimit -f)",
}


def fail(path: AnyPath, verb: str, error: OSError) -> NoReturn:
    """Throws StorageError if the system lacks resources, UnreadableError if this file exists, otherwise
    InputError."""
    code = error.errno or 0
    kind = StorageError if code in LACKING else InputError if code in _IS_NOT_THERE else UnreadableError
    raise kind(f"{os.fspath(path)}: cannot be {verb}: {os.strerror(code)}{ADVICE.get(code, '')}") from None


def path_of(value: object, name: str) -> str:
    """Checks a user's argument that is a path, known to the user as `name`. Throws ValueError."""
    text = os.fspath(value) if isinstance(value, os.PathLike) else value
    if not isinstance(text, str):
        raise ValueError(f"{name} must be a text or a path, not {value!r:.100}")
    if not text:
        raise ValueError(f"{name} is empty: name a file or a folder")
    return text


def require_folder(path: str) -> None:
    """Throws FileNotFoundError, or NotADirectoryError."""
    if not os.path.isdir(path):
        wrong = errno.ENOTDIR if os.path.exists(path) else errno.ENOENT
        raise OSError(wrong, os.strerror(wrong), path)


def read_file(path: AnyPath, most: int = MAX_ITEM_BYTES, too_large: str = _TOO_LARGE) -> bytes:
    """Reads a regular file. Checks its size before allocating memory, and does not wait for pipes. Throws
    InputError. too_large: advice for files that are too large."""
    with _regular(path, most, too_large) as file:
        try:
            return file.read(os.fstat(file.fileno()).st_size)
        except MemoryError:
            raise UnreadableError(
                f"{os.fspath(path)}: no memory for its bytes; leave it out, or work on fewer items at a time"
            ) from None


def require_file(path: AnyPath, most: int = MAX_ITEM_BYTES) -> None:
    """Throws InputError for files that `read_file` would refuse, before a library opens them."""
    with _regular(path, most, _TOO_LARGE):
        pass


def open_regular(path: AnyPath) -> contextlib.AbstractContextManager[BinaryIO]:
    """Opens a file for reading in parts, hence of any size. Throws InputError like `read_file`, also for
    failed reads."""
    return _regular(path, sys.maxsize, _TOO_LARGE)


@contextlib.contextmanager
def _regular(path: AnyPath, most: int, too_large: str) -> Iterator[BinaryIO]:
    name = os.fspath(path)
    try:
        with open(os.open(path, os.O_RDONLY | _NEVER_WAIT), "rb") as file:
            status = os.fstat(file.fileno())
            if stat.S_ISDIR(status.st_mode):
                raise InputError(f"{name}: is a folder, where a file is expected")
            if not stat.S_ISREG(status.st_mode):
                raise InputError(f"{name}: is not a regular file")
            if status.st_size > most:
                raise InputError(f"{name}: {status.st_size} bytes: at most {most} can be read; {too_large}")
            yield file
    except IsADirectoryError:
        raise InputError(f"{name}: is a folder, where a file is expected") from None
    except OSError as error:
        fail(path, "read", error)
    except ValueError as error:
        if isinstance(error, InputError):
            raise
        raise InputError(f"{name}: cannot be read: it is no name of a file") from None


@contextlib.contextmanager
def stored(path: AnyPath, advice: str, verb: str = "written") -> Iterator[None]:
    """Throws StorageError for errors of the system. advice: "choose another with --to"."""
    try:
        yield
    except OSError as error:
        raise StorageError(f"{os.fspath(path)}: cannot be {verb}: {error.strerror}; {advice}") from None


def replace_file(path: AnyPath, data: bytes) -> None:
    """Writes the file atomically; a link is replaced. Removes temporary files of killed calls beside it.
    Throws OSError."""
    folder = Path(path).parent
    for left in folder.glob(f"*{_PART}"):
        with contextlib.suppress(OSError), open(left, "r+b") as file:
            _hold(file)
            left.unlink()
    part = folder / f"{os.urandom(8).hex()}{_PART}"
    try:
        with open(part, "wb") as file:
            with contextlib.suppress(OSError):  # file systems without locks
                _hold(file)
            _write_to_disk(file, data)
            os.replace(part, path)
    except BaseException:
        with contextlib.suppress(OSError):
            part.unlink()
        raise


def _hold(file: BinaryIO) -> None:
    """Locks a file until it is closed, like the engine does. Throws OSError if it is locked."""
    fcntl.fcntl(file, fcntl.F_OFD_SETLK, struct.pack("hhlli", fcntl.F_WRLCK, os.SEEK_SET, 0, 0, 0))


def _write_to_disk(file: BinaryIO, data: bytes) -> None:
    file.write(data)
    file.flush()
    os.fsync(file.fileno())  # otherwise a power failure may leave an empty file behind the rename


def has_unfinished(path: AnyPath) -> bool:
    """True if a FolderUpdate works in the folder, or was killed there."""
    return any(Path(path).glob(f"{_UNFINISHED}*"))


def holds(path: AnyPath, data: bytes) -> bool:
    """True if the file exists with this content."""
    file = Path(path)
    return file.is_file() and file.stat().st_size == len(data) and file.read_bytes() == data


class FolderUpdate:
    """Updates the files of a folder, which is created if missing and unchanged until `finish`, except for
    files that are `put` there. Files are written to a temporary folder within it and renamed. Remains of
    killed calls are removed; a concurrent call in the same folder fails. Names are paths within the folder.
    Throws StorageError for errors of the system, InputError for a link in place of a folder. advice: "choose
    another with --to"."""

    def __init__(self, path: AnyPath, advice: str) -> None:
        self.path, self._advice = Path(path), advice
        self._new = self.path / f"{_UNFINISHED}{os.urandom(8).hex()}"
        with stored(self.path, advice, "created"):
            self._new.mkdir(parents=True)
        for other in self.path.glob(f"{_UNFINISHED}*"):
            if other != self._new:
                shutil.rmtree(other, ignore_errors=True)

    def __enter__(self) -> "FolderUpdate":
        return self

    def __exit__(self, *_: object) -> None:
        shutil.rmtree(self._new, ignore_errors=True)

    def write(self, name: str, data: bytes) -> None:
        self._require_alone()
        with stored(self.path / name, self._advice):
            (self._new / name).parent.mkdir(parents=True, exist_ok=True)
            with open(self._new / name, "wb") as file:
                _write_to_disk(file, data)

    def put(self, name: str, data: bytes) -> None:
        """Writes a file immediately."""
        self._require_no_link(name)
        self.write(name, data)
        self._move(name)

    def finish(self, last: str) -> None:
        """Moves all files to their places, the file `last` at the end."""
        self._require_alone()
        names = [str(path.relative_to(self._new)) for path in self._new.rglob("*") if path.is_file()]
        for name in names:
            self._require_no_link(name)
        for name in sorted(names, key=lambda name: (name == last, name)):
            self._move(name)

    def remove(self, name: str) -> None:
        """Removes a file or a link, if it exists, and folders that become empty."""
        self._require_no_link(name)
        path = self.path / name
        if os.path.isfile(path) or os.path.islink(path):
            with stored(path, self._advice, "removed"):
                path.unlink()
            with contextlib.suppress(OSError):
                os.removedirs(path.parent)

    def _move(self, name: str) -> None:
        with stored(self.path / name, self._advice):
            (self.path / name).parent.mkdir(parents=True, exist_ok=True)
            os.replace(self._new / name, self.path / name)

    def _require_alone(self) -> None:
        if not self._new.is_dir():
            raise StorageError(
                f"{self.path}: another call has begun to write it: let that one end, or {self._advice}"
            )

    def _require_no_link(self, name: str) -> None:
        for folder in [*Path(name).parents][:-1]:
            if os.path.islink(self.path / folder):
                raise InputError(
                    f"{self.path / folder}: is a link, and is not followed; remove it, or {self._advice}"
                )
