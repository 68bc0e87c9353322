# SPDX-License-Identifier: GPL-3.0-or-later
"""The folder that a report stands in. What an earlier call wrote there goes, but for drawings that still show the same; everything else is
left alone."""

import hashlib
import json
import os
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import Any

from salbench._errors import InputError
from salbench._files import OwnFolder
from salbench.pages.rendering import MARK, OF_LEADERBOARD, is_ours

FOLDERS = ("figures", "data", "shapes", "pictures", "static")
LIST = "files.txt"  # of the files of the report, one per line
LEDGER = "kept.txt"  # of drawings: a line of JSON per set of files
ADVICE = "choose another folder with --to"
Facts = dict[str, Any]  # what else pages need to know of a drawing


def digest(*parts: str | bytes) -> str:
    """Of texts and bytes, told apart by their lengths."""
    made = hashlib.blake2b(digest_size=16)
    for part in parts:
        data = part.encode("utf-8", "surrogatepass") if isinstance(part, str) else part
        made.update(b"%d:" % len(data))
        made.update(data)
    return made.hexdigest()


@dataclass(frozen=True)
class Drawn:
    """A set of files, found by the key of what they show. It is believed only where all of them have the digest of when they were written."""

    key: str
    digest: str
    names: list[str]
    facts: Any

    def line(self) -> str:
        return json.dumps([self.key, self.digest, self.names, self.facts], sort_keys=True) + "\n"


def within(name: str) -> bool:
    """True of a path of a file in the folder."""
    return name == str(PurePosixPath(name)) and name not in ("", ".") and not name.startswith("/") and ".." not in name.split("/") and "\0" not in name


def read_ledger(data: bytes) -> dict[str, Drawn]:
    """By key, of the lines that can be read: the last one of a call that was ended may be cut short."""
    found: dict[str, Drawn] = {}
    for line in data.decode("utf-8", "replace").splitlines():
        try:
            one = Drawn(*json.loads(line))
            if isinstance(one.key, str) and all(within(name) for name in one.names):
                found[one.key] = one
        except (TypeError, ValueError, RecursionError):
            continue
    return found


class Folder:
    """Opens the folder of a report, or makes one; one call at a time has it. InputError if it holds something else than a report, or a
    link where a folder of the report is expected. `finish` ends the call. named: whoever calls has named this very folder, which may be a
    link then."""

    def __init__(self, path: Path, named: bool = True) -> None:
        self.path = path
        self.names = {"index.html", LEDGER}  # of this report
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
        if not is_new and (not is_ours(self._own.head("index.html")) or (self.path / OF_LEADERBOARD).exists()):
            raise InputError(f"{self.path}: holds something else than a report; {ADVICE}")
        for folder in FOLDERS:
            self._own.require_folder(folder)
        # First of all: who finds it knows whose folder this is.
        self._own.write("index.html", f'<meta name="generator" content="{MARK}"><title>Unfinished</title>'.encode())
        listed, ledger = self._own.read(LIST), self._own.read(LEDGER)
        if listed is None and not is_new:
            self._remove_older()
        self._before, self._drawn = read_ledger(ledger or b""), dict[str, Drawn]()
        if ledger is None:
            self._own.write(LEDGER, b"")
        kept = {name for one in self._before.values() for name in one.names}
        before = names_of(listed)
        self._remove(before - kept)
        self._write_list((before & kept) | self.names)

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

    def find(self, key: str) -> Drawn | None:
        """The files with this key that an earlier call left whole, now part of this report; or None."""
        one = self._before.get(key)
        if one is None or self._digest(one.names) != one.digest:
            return None
        self.names.update(one.names)
        self._drawn[key] = one
        return one

    def add(self, key: str, names: list[str], facts: Any) -> Facts:
        """Notes files that were written now, in whichever process. The facts, as a later call will read them."""
        self.names.update(names)
        self._drawn[key] = one = Drawn(key, self._digest(names), list(names), facts)
        self._own.append(LEDGER, one.line().encode())
        found: Facts = json.loads(one.line())[-1]
        return found

    def finish(self) -> None:
        """Removes what is not part of the report any more. The ledger's order does not depend on when things were drawn."""
        self._own.write(LEDGER, "".join(sorted(one.line() for one in self._drawn.values())).encode())
        before = {name for one in self._before.values() for name in one.names} | names_of(self._own.read(LIST))
        self._remove(before - self.names)
        for name in self.names:
            self._own.remove(f"{name}.part")  # of version 1.0, ended in the middle of it
        self._write_list(self.names)

    def _digest(self, names: list[str]) -> str:
        """Empty if one of them cannot be read."""
        parts: list[str | bytes] = []
        for name in names:
            data = self.read(name)
            if data is None:
                return ""
            parts += [name, data]
        return digest(*parts)

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


def names_of(listed: bytes | None) -> set[str]:
    return {name for name in (listed or b"").decode("utf-8", "replace").splitlines() if within(name)}
