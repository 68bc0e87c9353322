# SPDX-License-Identifier: GPL-3.0-or-later
"""The folder that a report stands in. Pictures and figures have names with a digest of what they show: one that is there is not drawn again.
What an earlier call wrote and this one does not show goes; everything else is left alone."""

import hashlib
import os
from collections.abc import Iterable
from pathlib import Path

from salbench.pages.rendering import OF_LEADERBOARD, is_ours
from salbench.system.errors import InputError
from salbench.system.files import FolderUpdate, has_unfinished, replace_file, stored

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
    """Opens the folder of a report, or makes one. InputError if it holds something else than a report. `finish` puts the new report there; until
    then the one before stays as it was."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.names: set[str] = set()  # of this report
        if path.exists() and not path.is_dir():
            raise InputError(f"{path}: not a folder; {ADVICE}")
        if path.is_dir() and os.listdir(path) and not has_unfinished(path) and (not is_ours(path / "index.html") or (path / OF_LEADERBOARD).exists()):
            raise InputError(f"{path}: holds something else than a report; {ADVICE}")
        self._before = names_of((path / LIST).read_bytes() if (path / LIST).is_file() else b"")
        self._update = FolderUpdate(path, ADVICE)

    def __enter__(self) -> "Folder":
        return self

    def __exit__(self, *_: object) -> None:
        self._update.__exit__()

    def add(self, names: Iterable[str]) -> None:
        """Makes files part of the report, which an earlier call may have written."""
        self.names |= set(names)

    def write(self, name: str, data: str | bytes) -> None:
        """A file of the report, "data/means.csv"."""
        self.add([name])
        self._update.write(name, data if isinstance(data, bytes) else data.encode("utf-8"))

    def has(self, name: str) -> bool:
        return os.path.isfile(self._update.current(name))

    def read(self, name: str) -> bytes:
        """A file of the report; empty if it is not there."""
        return self._update.current(name).read_bytes() if self.has(name) else b""

    def finish(self) -> None:
        """Puts the files in place, and removes what an earlier call wrote and is not part of the report any more."""
        self._write_list(self._before | self.names)  # so that the next call removes what a killed one has moved
        self._update.finish(last="index.html")
        for name in self._before - self.names:
            self._update.remove(name)
        self._write_list(self.names)

    def _write_list(self, names: set[str]) -> None:
        with stored(self.path / LIST, ADVICE):
            replace_file(self.path / LIST, "".join(f"{name}\n" for name in sorted(names)).encode())


def names_of(listed: bytes) -> set[str]:
    """The lines of a list that are paths of files below the folder."""
    names = listed.decode("utf-8", "replace").splitlines()
    return {name for name in names if name.isprintable() and not {"", ".", ".."} & set(name.split("/"))}
