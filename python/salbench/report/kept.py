# SPDX-License-Identifier: GPL-3.0-or-later
"""What earlier calls drew into the folder of a report: sets of files by the key of what they show. A set is believed only where
all of its files are there and have the digest that was noted after they were written."""

import hashlib
import json
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import PurePosixPath
from types import ModuleType
from typing import Any

from salbench._files import OwnFolder

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


def within(name: str) -> bool:
    """True of a path of a file in the folder."""
    return name == str(PurePosixPath(name)) and name not in ("", ".") and not name.startswith("/") and ".." not in name.split("/") and "\0" not in name


def read_ledger(data: bytes) -> dict[str, Set]:
    """key -> Set of the lines that can be read: the last one of a call that was ended may be cut short."""
    found: dict[str, Set] = {}
    for line in data.decode("utf-8", "replace").splitlines():
        try:
            one = Set(*json.loads(line))
            if isinstance(one.key, str) and all(within(name) for name in one.names):
                found[one.key] = one
        except (TypeError, ValueError, RecursionError):
            continue
    return found


class Kept:
    """The sets of one folder: those of before, found by key, and those of this call."""

    def __init__(self, folder: OwnFolder) -> None:
        self.folder = folder
        data = folder.read(LEDGER)
        self.before = read_ledger(data or b"")
        if data is None:
            folder.write(LEDGER, b"")
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
        self.folder.append(LEDGER, one.line().encode())
        return Set(*json.loads(one.line()))

    def finish(self) -> None:
        """Only the sets of this call are on the ledger, in an order that does not depend on when they were drawn."""
        self.folder.write(LEDGER, "".join(sorted(one.line() for one in self.used.values())).encode())

    def _digest(self, names: Iterable[str]) -> str:
        """Empty if one of them cannot be read."""
        parts: list[str | bytes] = []
        for name in names:
            data = self.folder.read(name)
            if data is None:
                return ""
            parts += [name, data]
        return digest(*parts)
