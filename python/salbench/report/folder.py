# SPDX-License-Identifier: GPL-3.0-or-later
"""The folder that a report stands in. Pictures and figures have names with a digest of what they show: one that is there is not drawn again.
What an earlier call wrote and this one does not show goes; everything else is left alone."""

import hashlib
import os
from collections.abc import Iterable
from pathlib import Path

from salbench._errors import InputError
from salbench._files import OwnFolder
from salbench.pages.rendering import MARK, OF_LEADERBOARD, is_ours

FOLDERS = ("figures", "data", "shapes", "pictures", "static")
LIST = "files.txt"  # of the files of the report, one per line
ADVICE = "choose another folder with --to"


def digest(*parts: str | bytes) -> str:
    """Digest of texts and bytes, told apart by their lengths, as a part of file names."""
    made = hashlib.blake2b(digest_size=8)
    for part in parts:
        data = part.encode("utf-8", "surrogatepass") if isinstance(part, str) else part
        made.update(b"%d:" % len(data))
        made.update(data)
    return made.hexdigest()


class Folder:
    """Opens the folder of a report, or makes one. InputError if it holds something else than a report; a link in place of a folder of the
    report is never followed. `finish` ends the call. named: whoever calls has named this very folder, which may be a link then."""

    def __init__(self, path: Path, named: bool = True) -> None:
        self.path = path
        self.names = {"index.html"}  # of this report
        if path.exists() and not path.is_dir():
            raise InputError(f"{path}: not a folder; {ADVICE}")
        self._own = OwnFolder(path, ADVICE, below=FOLDERS, follow=named, to_disk=False)
        try:
            if os.listdir(path) and (not is_ours(self._own.head("index.html")) or (path / OF_LEADERBOARD).exists()):
                raise InputError(f"{path}: holds something else than a report; {ADVICE}")
            # First of all: who finds it knows whose folder this is.
            self._own.write("index.html", f'<meta name="generator" content="{MARK}"><title>Unfinished</title>'.encode())
            self._before = names_of(self._own.read(LIST))
            self._write_list(self._before)
        except BaseException:
            self._own.close()
            raise

    def __enter__(self) -> "Folder":
        return self

    def __exit__(self, *_: object) -> None:
        self._own.close()

    def add(self, names: Iterable[str]) -> None:
        """Makes files part of the report. They are on the list before they are there, so that the next call knows what a call that was ended
        left behind."""
        added = set(names)
        if new := added - self.names - self._before:
            self._own.append(LIST, "".join(f"{name}\n" for name in sorted(new)).encode())
        self.names |= added

    def write(self, name: str, data: str | bytes) -> None:
        """A file of the report, "data/means.csv"."""
        self.add([name])
        self._own.write(name, data if isinstance(data, bytes) else data.encode("utf-8"))

    def has(self, name: str) -> bool:
        return os.path.isfile(f"{self.path}/{name}")

    def read(self, name: str) -> bytes:
        """A file of the report; empty if it is not there."""
        return self._own.read(name) or b""

    def finish(self) -> None:
        """Removes what an earlier call wrote and is not part of the report any more."""
        for name in self._before - self.names:
            self._own.remove(name)
        self._write_list(self.names)
        for folder in FOLDERS:
            self._own.remove_empty(folder)

    def _write_list(self, names: set[str]) -> None:
        self._own.write(LIST, "".join(f"{name}\n" for name in sorted(names)).encode())


def names_of(listed: bytes | None) -> set[str]:
    """The lines of a list that are paths of files below the folder."""
    names = (listed or b"").decode("utf-8", "replace").splitlines()
    return {name for name in names if name.isprintable() and not {"", ".", ".."} & set(name.split("/"))}
