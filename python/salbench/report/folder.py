# SPDX-License-Identifier: GPL-3.0-or-later
"""The folder of a report. Names of pictures and figures contain a digest of their content: existing ones are
not drawn again, and each is written as soon as it is drawn, so an interrupted call loses nothing. Pages and
tables are moved in place at the end. Files of an earlier call that are not used any more are removed; all
other files are left alone."""

import hashlib
import os
from collections.abc import Iterable
from pathlib import Path

from salbench.pages.rendering import MARK, OF_LEADERBOARD, is_ours
from salbench.system.errors import InputError
from salbench.system.files import FolderUpdate, has_unfinished, replace_file, stored

INDEX = "index.html"
LIST = "files.txt"  # lists the files of the report, one per line
ADVICE = "choose another folder with --to"
UNFINISHED = f"""<!DOCTYPE html>
<html lang="en-GB"><head><meta charset="utf-8"><meta name="generator" content="{MARK}"><title>salbench</title></head>
<body><p>This report is not finished: the same command goes on with it.</p></body></html>
"""


def digest(*parts: str | bytes) -> str:
    """Digest of texts and bytes, delimited by their lengths, for use in file names."""
    made = hashlib.blake2b(digest_size=8)
    for part in parts:
        data = part.encode("utf-8", "surrogatepass") if isinstance(part, str) else part
        made.update(b"%d:" % len(data))
        made.update(data)
    return made.hexdigest()


class Folder:
    """Opens or creates the folder of a report. InputError if it holds something other than a report."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.names: set[str] = set()  # files of this report
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
        """Makes files part of the report; an earlier call may have written them."""
        self.names |= set(names)

    def write(self, name: str, data: str | bytes) -> None:
        """Writes a page or a table, such as "data/means.csv"."""
        self.add([name])
        self._update.write(name, data if isinstance(data, bytes) else data.encode("utf-8"))

    def begin_drawings(self) -> None:
        """Called before `put`, once `add` has all names: if this call is killed, the next one recognises its
        drawings and removes unused ones."""
        if not self.has(INDEX):
            self._replace(INDEX, UNFINISHED)
        self._write_list(self._before | self.names | {INDEX})

    def put(self, name: str, data: bytes) -> None:
        """Writes a drawing, whose name has a digest of its content."""
        self._update.put(name, data)

    def has(self, name: str) -> bool:
        return (self.path / name).is_file()

    def finish(self) -> None:
        """Moves the pages in place, and removes files of an earlier call that are no longer part of the
        report."""
        # so that the next call removes files moved by a killed one
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
    """Lines of a list that are paths of files below the folder."""
    names = listed.decode("utf-8", "replace").splitlines()
    return {name for name in names if name.isprintable() and not {"", ".", ".."} & set(name.split("/"))}
