# SPDX-License-Identifier: GPL-3.0-or-later
"""Files and folders of an archive, with messages that begin with the path and say what to do."""

from __future__ import annotations

import os

from salbench._files import MAX_ITEM_BYTES as MAX_ITEM_BYTES
from salbench._files import fail
from salbench._files import read_file as read_file


def exists(path: str) -> bool:
    """True of a file; a folder that cannot be looked into is an error."""
    try:
        os.stat(path)
    except (FileNotFoundError, NotADirectoryError):
        return False
    except OSError as error:
        fail(path, "looked at", error)
    return True


def list_folder(folder: str) -> list[tuple[str, bool]]:
    """Names in a folder, and whether they are folders, in the order of their bytes; nothing if it is missing."""
    try:
        with os.scandir(folder) as entries:
            return sorted(((entry.name, entry.is_dir()) for entry in entries), key=lambda entry: os.fsencode(entry[0]))
    except (FileNotFoundError, NotADirectoryError):
        return []
    except OSError as error:
        fail(folder, "listed", error)


def below(root: str, path: str) -> str:
    """A path of a description, below the folder of the data set."""
    return os.path.normpath(os.path.join(root, path))


def extension(path: str) -> str:
    """In lower case, with its dot."""
    return os.path.splitext(path)[1].lower()


def stem(path: str) -> str:
    return os.path.splitext(os.path.basename(path))[0]
