# SPDX-License-Identifier: GPL-3.0-or-later
"""What earlier calls drew into the folder of a report: sets of files by the key of what they show. A set is believed only where
all of its files are there and have the digest that was noted after they were written."""

import hashlib
import json
import os
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from types import ModuleType
from typing import Any

Facts = dict[str, Any]  # what else pages need to know of a set
LEDGER = "kept.txt"  # a line of JSON per set: key, digest, names of its files, what else pages need to know of it


def digest(*parts: str | bytes) -> str:
    """Of texts and bytes, told apart by their lengths."""
    made = hashlib.blake2b(digest_size=16)
    for part in parts:
        data = part.encode("utf-8", "surrogatepass") if isinstance(part, str) else part
        made.update(b"%d:" % len(data))
        made.update(data)
    return made.hexdigest()


def digest_of_code(*modules: ModuleType) -> str:
    """Of the source files of modules: drawings of other code are drawn again."""
    texts = []
    for module in modules:
        with open(str(module.__file__), "rb") as file:
            texts.append(file.read())
    return digest(*texts)


@dataclass(frozen=True)
class Set:
    key: str
    digest: str
    names: list[str]
    facts: Any

    def line(self) -> str:
        return json.dumps([self.key, self.digest, self.names, self.facts], sort_keys=True) + "\n"


def write(path: Path, data: bytes) -> None:
    """Bytes as a file that is there whole or not at all."""
    part = path.with_name(path.name + ".part")
    part.write_bytes(data)
    os.replace(part, path)


def within(name: str) -> bool:
    """True of a path that does not lead out of the folder."""
    path = PurePosixPath(name)
    return not path.is_absolute() and ".." not in path.parts and "\0" not in name


def read_ledger(path: Path) -> dict[str, Set]:
    """key -> Set of the lines that can be read: the last one of a call that was ended may be cut short."""
    found: dict[str, Set] = {}
    try:
        lines = path.read_text(encoding="utf-8", errors="replace").splitlines()
    except FileNotFoundError:
        return found
    for line in lines:
        try:
            one = Set(*json.loads(line))
            if isinstance(one.key, str) and all(within(name) for name in one.names):
                found[one.key] = one
        except (TypeError, ValueError):
            continue
    return found


class Kept:
    """The sets of one folder: those of before, found by key, and those of this call."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.before = read_ledger(folder / LEDGER)
        self.used: dict[str, Set] = {}

    @property
    def names(self) -> set[str]:
        """Every file of the sets of before."""
        return {name for one in self.before.values() for name in one.names}

    def find(self, key: str) -> Set | None:
        """The set of this key whose files are as they were written, or None."""
        one = self.before.get(key)
        if one is None or self._digest(one.names) != one.digest:
            return None
        self.used[key] = one
        return one

    def add(self, key: str, names: list[str], facts: Any) -> Set:
        """Notes files that were written now; the set as a later call will read it."""
        one = Set(key, self._digest(names), list(names), facts)
        self.used[key] = one
        with open(self.folder / LEDGER, "a", encoding="utf-8") as file:
            file.write(one.line())
        return Set(*json.loads(one.line()))

    def finish(self) -> None:
        """Only the sets of this call are on the ledger, in an order that does not depend on when they were drawn."""
        write(self.folder / LEDGER, "".join(sorted(one.line() for one in self.used.values())).encode())

    def _digest(self, names: Iterable[str]) -> str:
        """Empty if one of them cannot be read."""
        parts: list[str | bytes] = []
        for name in names:
            try:
                parts += [name, (self.folder / name).read_bytes()]
            except OSError:
                return ""
        return digest(*parts)
