# SPDX-License-Identifier: GPL-3.0-or-later
"""Files. Those of strangers are regular and of a bounded size. Those of our own folders are there whole or not at all, and no link in such a
folder leads anywhere."""

import contextlib
import errno
import os
import re
import stat
import sys
import time
from collections.abc import Iterator, Sequence
from typing import BinaryIO, NoReturn

from salbench._errors import InputError, StorageError, UnreadableError

AnyPath = str | os.PathLike[str]

MAX_ITEM_BYTES = 2 << 30
_NEVER_WAIT = os.O_NONBLOCK | os.O_CLOEXEC  # a pipe without a writer is open at once
_TOO_LARGE = "simplify the shape, or copy the file again if it should be smaller"
_NO_FILE = (errno.ENOENT, errno.ENOTDIR, errno.EISDIR, errno.ENAMETOOLONG)
_UNFINISHED = re.compile(r"\.[0-9a-f]{16}\.unfinished")
_ABANDONED_SECONDS = 3600  # a file is unfinished for as long as its bytes are written

_IS_NOT_THERE = (errno.ENOENT, errno.ENOTDIR, errno.EISDIR, errno.ELOOP, errno.ENAMETOOLONG)
# What the system lacks for any file: it says nothing about the one at hand.
LACKING = (errno.ENOSPC, errno.EDQUOT, errno.EROFS, errno.EFBIG, errno.EMFILE, errno.ENFILE, errno.ENOMEM, errno.EAGAIN)

ADVICE = {errno.EACCES: "; check its permissions", errno.EPERM: "; check its permissions", errno.EIO: "; the disk failed: check it and run again",
          errno.EMFILE: "; raise the limit (ulimit -n)", errno.ENOMEM: "; close other programs",
          errno.EFBIG: "; raise the limit on the size of files (ulimit -f)"}


def fail(path: AnyPath, verb: str, error: OSError) -> NoReturn:
    """Throws StorageError where no file could be had, UnreadableError where this one is there, and InputError."""
    code = error.errno or 0
    kind = StorageError if code in LACKING else InputError if code in _IS_NOT_THERE else UnreadableError
    raise kind(f"{os.fspath(path)}: cannot be {verb}: {os.strerror(code)}{ADVICE.get(code, '')}") from None


def path_of(value: object, name: str) -> str:
    """An argument of a user that is a path, with the name that it has. Throws ValueError."""
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
    """The bytes of a regular file. Its size is judged before memory is taken, and a pipe is not waited for. Throws InputError. too_large:
    what to do about one that is."""
    with _regular(path, most, too_large) as file:
        try:
            return file.read(os.fstat(file.fileno()).st_size)
        except MemoryError:
            raise UnreadableError(f"{os.fspath(path)}: no memory for its bytes; leave it out, or work on fewer items at a time") from None


def require_file(path: AnyPath, most: int = MAX_ITEM_BYTES) -> None:
    """Throws InputError for what `read_file` would not read: of a file that a library opens."""
    with _regular(path, most, _TOO_LARGE):
        pass


def open_regular(path: AnyPath) -> contextlib.AbstractContextManager[BinaryIO]:
    """A file that is read in parts, and so may be of any size. Throws InputError, as `read_file`; also where a part cannot be read."""
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


def replace_file(path: AnyPath, data: bytes) -> None:
    """In one step, and on the disk when it is there. Throws OSError."""
    folder, name = os.path.split(os.fspath(path))
    at = os.open(folder or ".", os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
    try:
        _replace(at, name, data, to_disk=True)
    finally:
        os.close(at)


def _replace(at: int, name: str, data: bytes, to_disk: bool) -> None:
    _finish(at, _unfinished(at, data, to_disk), name, to_disk)


def _unfinished(at: int, data: bytes, to_disk: bool) -> str:
    """A new file of no name that anybody looks for."""
    unfinished = f".{os.urandom(8).hex()}.unfinished"
    try:
        with open(os.open(unfinished, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC, 0o666, dir_fd=at), "wb") as file:
            file.write(data)
            if to_disk:
                file.flush()
                os.fsync(file.fileno())
    except BaseException:
        with contextlib.suppress(OSError):
            os.unlink(unfinished, dir_fd=at)
        raise
    return unfinished


def _finish(at: int, unfinished: str, name: str, to_disk: bool) -> None:
    try:
        os.replace(unfinished, name, src_dir_fd=at, dst_dir_fd=at)
    except BaseException:
        with contextlib.suppress(OSError):
            os.unlink(unfinished, dir_fd=at)
        raise
    if to_disk:
        with contextlib.suppress(OSError):  # not every file system can, and the file is whole without
            os.fsync(at)


class OwnFolder:
    """A folder that a command writes to, made if it is missing. Of two calls at the same time each writes whole files, and the last one wins.
    Unfinished files of a call that was killed are removed an hour later, here and below the folders `below`. Names are paths within it; a link
    on the way is an InputError, and one in place of a file is replaced or removed itself. All that the system refuses is a StorageError.
    advice: "choose another with --to".
    """

    def __init__(self, path: AnyPath, advice: str, *, below: Sequence[str] = (), follow: bool = True, to_disk: bool = True) -> None:
        self.path, self.advice, self._to_disk = os.fspath(path), advice, to_disk
        self._later: list[tuple[str, str]] = []  # unfinished file, beside the one that it replaces
        if not follow and os.path.islink(self.path):
            raise InputError(f"{self.path}: is a link; name the folder itself, or {advice}")
        try:
            os.makedirs(self.path, exist_ok=True)
            self._at = os.open(self.path, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC | (0 if follow else os.O_NOFOLLOW))
        except OSError as error:
            raise StorageError(f"{self.path}: the folder cannot be created: {error.strerror}; {advice}") from None
        self._remove_unfinished(below)

    def __enter__(self) -> "OwnFolder":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        for unfinished, name in self._later:
            with contextlib.suppress(OSError), self._parent(name) as (at, _):
                os.unlink(unfinished, dir_fd=at)
        os.close(self._at)

    def _remove_unfinished(self, below: Sequence[str]) -> None:
        def remove(names: Sequence[str], at: int) -> None:
            for name in filter(_UNFINISHED.fullmatch, names):
                with contextlib.suppress(OSError):
                    if time.time() - os.stat(name, dir_fd=at, follow_symlinks=False).st_mtime > _ABANDONED_SECONDS:
                        os.unlink(name, dir_fd=at)

        remove(os.listdir(self._at), self._at)
        for folder in below:
            with contextlib.suppress(OSError):  # there is none
                for _, _, names, at in os.fwalk(folder, dir_fd=self._at):  # follows no link
                    remove(names, at)

    def require_folder(self, name: str) -> None:
        """Makes it if it is missing."""
        with self._refused(name, "written"), self._parent(f"{name}/", make=True):
            pass

    def is_link(self, name: str) -> bool:
        try:
            return stat.S_ISLNK(os.stat(name, dir_fd=self._at, follow_symlinks=False).st_mode)
        except OSError:
            return False

    def write(self, name: str, data: bytes) -> None:
        """The file is there whole or not at all."""
        with self._refused(name, "written"), self._parent(name, make=True) as (at, last):
            _replace(at, last, data, self._to_disk)

    def write_later(self, name: str, data: bytes) -> None:
        """As `write`, when `write_all` is called. Nothing is left of it if this is closed before."""
        with self._refused(name, "written"), self._parent(name, make=True) as (at, _):
            self._later.append((_unfinished(at, data, self._to_disk), name))

    def write_all(self) -> None:
        """What waits for it, in its order: by renames alone, which need no room."""
        while self._later:
            unfinished, name = self._later[0]
            with self._refused(name, "written"), self._parent(name) as (at, last):
                _finish(at, unfinished, last, self._to_disk)
            del self._later[0]

    def append(self, name: str, data: bytes) -> None:
        """To a file that `write` has made."""
        with self._refused(name, "written"), self._parent(name) as (at, last):
            with open(os.open(last, os.O_WRONLY | os.O_APPEND | os.O_NOFOLLOW | _NEVER_WAIT, dir_fd=at), "wb") as file:
                file.write(data)

    def read(self, name: str, most: int = MAX_ITEM_BYTES) -> bytes | None:
        """None where there is no regular file of at most so many bytes."""
        with self._opened(name) as file:
            size = 0 if file is None else os.fstat(file.fileno()).st_size
            return None if file is None or size > most else file.read(size)  # read(most) takes memory for as many

    def head(self, name: str) -> bytes:
        """The first bytes of a regular file; none where there is none."""
        with self._opened(name) as file:
            return b"" if file is None else file.read(1 << 12)

    def remove(self, name: str) -> None:
        """A file, or a link; where there is none, nothing is to be done."""
        with self._refused(name, "removed", _NO_FILE), self._parent(name) as (at, last):
            os.unlink(last, dir_fd=at)

    def remove_empty(self, folder: str) -> None:
        """Folders below this one that hold nothing."""
        with contextlib.suppress(OSError):
            for _, folders, _, at in os.fwalk(folder, topdown=False, dir_fd=self._at):
                for name in folders:
                    with contextlib.suppress(OSError):  # it holds something, or is a link
                        os.rmdir(name, dir_fd=at)

    @contextlib.contextmanager
    def _opened(self, name: str) -> Iterator[BinaryIO | None]:
        with contextlib.ExitStack() as stack:
            file = None
            with contextlib.suppress(OSError):
                at, last = stack.enter_context(self._parent(name))
                file = stack.enter_context(open(os.open(last, os.O_RDONLY | os.O_NOFOLLOW | _NEVER_WAIT, dir_fd=at), "rb"))
            yield file if file is not None and stat.S_ISREG(os.fstat(file.fileno()).st_mode) else None

    @contextlib.contextmanager
    def _parent(self, name: str, make: bool = False) -> Iterator[tuple[int, str]]:
        """The descriptor of the folder that a file is in, and its name there."""
        *folders, last = name.split("/")
        at = os.dup(self._at)
        try:
            for depth, folder in enumerate(folders, 1):
                if make:
                    with contextlib.suppress(FileExistsError):
                        os.mkdir(folder, dir_fd=at)
                try:
                    below = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW | os.O_CLOEXEC, dir_fd=at)
                except NotADirectoryError:
                    if self.is_link("/".join(folders[:depth])):
                        raise InputError(f"{self.path}/{'/'.join(folders[:depth])}: is a link, and is not followed; remove it, or {self.advice}") from None
                    raise
                os.close(at)
                at = below
            yield at, last
        finally:
            os.close(at)

    @contextlib.contextmanager
    def _refused(self, name: str, verb: str, unless: Sequence[int] = ()) -> Iterator[None]:
        try:
            yield
        except OSError as error:
            if error.errno not in unless:
                raise StorageError(f"{self.path}/{name}: cannot be {verb}: {error.strerror}; {self.advice}") from None
