# SPDX-License-Identifier: GPL-3.0-or-later
"""The folder that a report stands in: what an earlier call wrote there goes, but for drawings that still show the same
(kept.py); everything else is left alone."""

import shutil
from pathlib import Path
from typing import Any

from salbench.conclusions.csv_file import InputError
from salbench.pages.rendering import MARK, is_ours
from salbench.report.kept import LEDGER, Kept, Set, within, write

FOLDERS = ("figures", "data", "shapes", "pictures", "static")
LIST = "files.txt"  # of the files of the report, one per line


class Folder:
    """Opens the folder of a report, or makes one. InputError if it holds something else than a report. `finish` ends the call."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.names: set[str] = set()
        try:
            if path.exists() and not path.is_dir():
                raise InputError(f"{path}: not a folder; choose another with --to")
            if path.is_dir() and any(path.iterdir()):
                if not is_ours(path / "index.html"):
                    raise InputError(f"{path}: holds something else than a report; choose another folder with --to")
                if not (path / LIST).is_file():
                    remove_older(path)
            for folder in FOLDERS:
                (path / folder).mkdir(parents=True, exist_ok=True)
            self.kept = Kept(path)
            listed = set(read_list(path))
            remove(path, listed - self.kept.names)
            write(path / LIST, "".join(f"{name}\n" for name in sorted((listed & self.kept.names) | {LEDGER})).encode())
            self.file("index.html").write_text(f'<meta name="generator" content="{MARK}"><title>Unfinished</title>')
        except OSError as error:
            raise InputError(f"{path}: cannot be written: {error.strerror}; choose another folder with --to") from None

    def file(self, name: str) -> Path:
        """The path of a file of the report, "data/means.csv", to be written now. It is on the list before it is there, so that
        the next call knows what a call that was ended left behind."""
        if name not in self.names:
            self.names.add(name)
            with open(self.path / LIST, "a", encoding="utf-8") as names:
                names.write(f"{name}\n")
        path = self.path / name
        path.parent.mkdir(exist_ok=True)
        return path

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
        """Removes what is not part of the report any more, and halves that an ended call left of what is."""
        self.names.add(LEDGER)
        for name in self.names:
            (self.path / f"{name}.part").unlink(missing_ok=True)
        self.kept.finish()
        remove(self.path, (set(read_list(self.path)) | self.kept.names) - self.names)
        write(self.path / LIST, "".join(f"{name}\n" for name in sorted(self.names)).encode())


def read_list(path: Path) -> list[str]:
    try:
        return [name for name in (path / LIST).read_text(encoding="utf-8", errors="replace").splitlines() if within(name)]
    except FileNotFoundError:
        return []


def remove(path: Path, names: set[str]) -> None:
    """Removes files of the report, but for index.html and the ledger, and folders that are then empty."""
    for name in names:
        if name not in ("index.html", LEDGER):
            for file in (path / name, path / f"{name}.part"):
                if file.is_file():
                    file.unlink()
    for folder in sorted((entry for name in FOLDERS for entry in (path / name).glob("**/")), reverse=True):
        if folder not in [path / name for name in FOLDERS] and not any(folder.iterdir()):
            folder.rmdir()


def remove_older(path: Path) -> None:
    """An older version wrote the report, without a list: all of these folders was its own."""
    for folder in FOLDERS:
        shutil.rmtree(path / folder, ignore_errors=True)
    for page in path.glob("*.html"):
        if page.name != "index.html" and is_ours(page):
            page.unlink()
