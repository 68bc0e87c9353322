# SPDX-License-Identifier: GPL-3.0-or-later
"""Files and folders of an archive, with messages that begin with the path and say what to do."""

from __future__ import annotations

import errno
import os
import stat
from typing import NoReturn

from salbench.datasets.records import InputError

MAX_ITEM_BYTES = 2 << 30

_ADVICE = {errno.EACCES: "; check its permissions", errno.EPERM: "; check its permissions", errno.EIO: "; the disk failed: check it and run again",
           errno.EMFILE: "; raise the limit (ulimit -n)", errno.ENOMEM: "; close other programs"}


def _fail(path: str, verb: str, error: OSError) -> NoReturn:
    code = error.errno or 0
    raise InputError(f"{path}: cannot be {verb}: {os.strerror(code)}{_ADVICE.get(code, '')}") from None


def read_file(path: str, most: int = MAX_ITEM_BYTES) -> bytes:
    """The bytes of a regular file. Its size is judged before memory is taken, and a pipe is not waited for."""
    try:
        with open(os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC), "rb") as file:
            status = os.fstat(file.fileno())
            if stat.S_ISDIR(status.st_mode):
                raise InputError(f"{path}: is a folder, where a file is expected")
            if not stat.S_ISREG(status.st_mode):
                raise InputError(f"{path}: is not a regular file")
            if status.st_size > most:
                raise InputError(f"{path}: {status.st_size} bytes: at most {most} can be read; simplify the shape, or copy the file again if "
                                 "it should be smaller")
            return file.read(status.st_size)
    except IsADirectoryError:
        raise InputError(f"{path}: is a folder, where a file is expected") from None
    except OSError as error:
        _fail(path, "read", error)
    except ValueError as error:
        if isinstance(error, InputError):
            raise
        raise InputError(f"{path}: cannot be read: it is no name of a file") from None
    except MemoryError:
        raise InputError(f"{path}: no memory for its bytes; leave it out, or work on fewer items at a time") from None


def exists(path: str) -> bool:
    """True of a file; a folder that cannot be looked into is an error."""
    try:
        os.stat(path)
    except (FileNotFoundError, NotADirectoryError):
        return False
    except OSError as error:
        _fail(path, "looked at", error)
    return True


def list_folder(folder: str) -> list[tuple[str, bool]]:
    """Names in a folder, and whether they are folders, in the order of their bytes; nothing if it is missing."""
    try:
        with os.scandir(folder) as entries:
            return sorted(((entry.name, entry.is_dir()) for entry in entries), key=lambda entry: os.fsencode(entry[0]))
    except (FileNotFoundError, NotADirectoryError):
        return []
    except OSError as error:
        _fail(folder, "listed", error)


def below(root: str, path: str) -> str:
    """A path of a description, below the folder of the data set."""
    return os.path.normpath(os.path.join(root, path))


def extension(path: str) -> str:
    """In lower case, with its dot."""
    return os.path.splitext(path)[1].lower()


def stem(path: str) -> str:
    return os.path.splitext(os.path.basename(path))[0]
