# SPDX-License-Identifier: GPL-3.0-or-later
"""The folder that a report stands in. Pictures and figures have names with a digest of what they show: one
that is there is not drawn again, and one that is drawn is there at once, so that a call which is ended has
not drawn in vain. Pages and tables wait until all are made. What an earlier call wrote and this one does
not show goes; everything else is left alone."""

import hashlib
import os
from collections.abc import Iterable
from pathlib import Path

from salbench.pages.rendering import MARK, OF_LEADERBOARD, is_ours
from salbench.system.errors import InputError
from salbench.system.files import FolderUpdate, has_unfinished, replace_file, stored

INDEX = "index.html"
LIST = "files.txt"  # of the files of the report, one per line
ADVICE = "choose another folder with --to"
UNFINISHED = f"""<!DOCTYPE html>
<html lang="en-GB"><head><meta charset="utf-8"><meta name="generator" content="{MARK}"><title>salbench</title></head>
<body><p>This report is not finished: the same command goes on with it.</p></body></html>
"""


def digest(*parts: str | bytes) -> str:
    """Digest of texts and bytes, told apart by their lengths, as a part of file names."""
    made = hashlib.blake2b(digest_size=8)
    for part in parts:
        data = part.encode("utf-8", "surrogatepass") if isinstance(part, str) else part
        made.update(b"%d:" % len(data))
        made.update(data)
    return made.hexdigest()


class Folder:
    """Opens the folder of a report, or makes one. InputError if it holds something else than a report."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.names: set[str] = set()  # of this report
        if path.exists() and not path.is_dir():
            raise InputError(f"{path}: not a folder; {ADVICE}")
        if (
            path.is_dir()
            and os.listdir(path)
            and not has_unfinished(path)
            and (not is_ours(path / INDEX) or (path / OF_LEADERBOARD).exists())
        ):
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
        """A page or a table, "data/means.csv"."""
        self.add([name])
        self._update.write(name, data if isinstance(data, bytes) else data.encode("utf-8"))

    def begin_drawings(self) -> None:
        """From now on `put` is called, for names that `add` was told: the next call finds them to be of a
        report, and removes what it does not show."""
        if not self.has(INDEX):
            self._replace(INDEX, UNFINISHED)
        self._write_list(self._before | self.names | {INDEX})

    def put(self, name: str, data: bytes) -> None:
        """A drawing, whose name has a digest of what it shows."""
        self._update.put(name, data)

    def has(self, name: str) -> bool:
        return (self.path / name).is_file()

    def finish(self) -> None:
        """Puts the pages in place, and removes what an earlier call wrote and is not part of the report
        any more."""
        # so that the next call removes what a killed one has moved
        self._write_list(self._before | self.names)
        self._update.finish(last=INDEX)
        for name in self._before - self.names:
            self._update.remove(name)
        self._write_list(self.names)

    def _write_list(self, names: set[str]) -> None:
        self._replace(LIST, "".join(f"{name}\n" for name in sorted(names)))

    def _replace(self, name: str, text: str) -> None:
        with stored(self.path / name, ADVICE):
            replace_file(self.path / name, text.encode())


def names_of(listed: bytes) -> set[str]:
    """The lines of a list that are paths of files below the folder."""
    names = listed.decode("utf-8", "replace").splitlines()
    return {name for name in names if name.isprintable() and not {"", ".", ".."} & set(name.split("/"))}
