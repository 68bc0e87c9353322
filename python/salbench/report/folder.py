# SPDX-License-Identifier: GPL-3.0-or-later
"""The folder that a report stands in: what an earlier call wrote there goes, but for drawings that still show the same
(kept.py); everything else is left alone."""

import os
from pathlib import Path
from typing import Any

from salbench._errors import InputError
from salbench._files import OwnFolder
from salbench.pages.rendering import MARK, is_ours
from salbench.report.kept import LEDGER, Kept, Set, within

FOLDERS = ("figures", "data", "shapes", "pictures", "static")
LIST = "files.txt"  # of the files of the report, one per line
ADVICE = "choose another folder with --to"


class Folder:
    """Opens the folder of a report, or makes one; one call at a time has it. InputError if it holds something else than a report, or a
    link where a folder of the report is expected. `finish` ends the call. named: whoever calls has named this very folder, which may be a
    link then."""

    def __init__(self, path: Path, named: bool = True) -> None:
        self.path = path
        self.names: set[str] = set()
        if path.exists() and not path.is_dir():
            raise InputError(f"{path}: not a folder; {ADVICE}")
        self._own = OwnFolder(path, ADVICE, below=FOLDERS, follow=named, to_disk=False)
        try:
            self._begin()
        except BaseException:
            self._own.close()
            raise

    def _begin(self) -> None:
        is_new = not os.listdir(self.path)
        if not is_new and not is_ours(self._own.head("index.html")):
            raise InputError(f"{self.path}: holds something else than a report; {ADVICE}")
        for folder in FOLDERS:
            self._own.require_folder(folder)
        self.names.add("index.html")  # first of all: who finds it knows whose folder this is
        self._own.write("index.html", f'<meta name="generator" content="{MARK}"><title>Unfinished</title>'.encode())
        listed = self._listed()
        if listed is None and not is_new:
            self._remove_older()
        self.kept = Kept(self._own)
        before = listed or set()
        self._remove(before - self.kept.names)
        self._write_list((before & self.kept.names) | {LEDGER, "index.html"})

    def __enter__(self) -> "Folder":
        return self

    def __exit__(self, *_: object) -> None:
        self._own.close()

    def write(self, name: str, data: str | bytes) -> None:
        """A file of the report, "data/means.csv". It is on the list before it is there, so that the next call knows what a call that was
        ended left behind."""
        if name not in self.names:
            self.names.add(name)
            self._own.append(LIST, f"{name}\n".encode())
        self._own.write(name, data if isinstance(data, bytes) else data.encode("utf-8"))

    def read(self, name: str) -> bytes | None:
        """A file of the report; None if it is not there."""
        return self._own.read(name)

    def find(self, key: str) -> Set | None:
        """The set of files with this key that an earlier call left whole, now part of this report; or None."""
        found = self.kept.find(key)
        if found:
            self.names.update(found.names)
        return found

    def add(self, key: str, names: list[str], facts: Any) -> Set:
        """Notes a set of files that were written now, in whichever process."""
        self.names.update(names)
        return self.kept.add(key, names, facts)

    def finish(self) -> None:
        """Removes what is not part of the report any more."""
        self.names.add(LEDGER)
        self.kept.finish()
        self._remove(((self._listed() or set()) | self.kept.names) - self.names)
        for name in self.names:
            self._own.remove(f"{name}.part")  # of version 1.0, ended in the middle of it
        self._write_list(self.names)

    def _listed(self) -> set[str] | None:
        """None if there is no list."""
        data = self._own.read(LIST)
        return None if data is None else {name for name in data.decode("utf-8", "replace").splitlines() if within(name)}

    def _write_list(self, names: set[str]) -> None:
        self._own.write(LIST, "".join(f"{name}\n" for name in sorted(names)).encode())

    def _remove(self, names: set[str]) -> None:
        """Removes files of the report, but for index.html and the ledger, and folders that are then empty."""
        for name in names - {"index.html", LEDGER}:
            self._own.remove(name)
            self._own.remove(f"{name}.part")
        for folder in FOLDERS:
            self._own.remove_empty(folder)

    def _remove_older(self) -> None:
        """An older version wrote the report, without a list: all of these folders was its own."""
        for folder in FOLDERS:
            self._own.remove_empty(folder, with_files=True)
        for page in self.path.glob("*.html"):
            if page.name != "index.html" and is_ours(self._own.head(page.name)):
                self._own.remove(page.name)
