# SPDX-License-Identifier: GPL-3.0-or-later
"""Things that a user asks for by their names."""

import os
from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import Any, TypeVar

from salbench import _core

T = TypeVar("T")


class ByName(Mapping[str, T]):
    """Each is made when it is asked for. Another name is a KeyError that says what was probably meant.

    what: such as "map by LS of an item called", for that message.
    """

    def __init__(self, what: str, names: Iterable[str], make: Callable[[str], T]) -> None:
        self._what, self._names, self._make = what, dict.fromkeys(names), make

    def __getitem__(self, name: str) -> T:
        if name not in self._names:
            _core.fail_unknown(self._what, os.fsencode(str(name)), [*map(os.fsencode, self._names)])
        return self._make(name)

    def __contains__(self, name: object) -> bool:
        return name in self._names

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)

    def __repr__(self) -> str:
        return f"{self._what}: {', '.join(self._names)}"


def names_of(items: Iterable[Any]) -> list[str]:
    """Of a sequence of items, which may be numbers."""
    if isinstance(items, bytes) or not hasattr(items, "__iter__"):
        raise ValueError(f"items must be a text such as '1-20,52', or a sequence of names, not {items!r}")
    return [str(name) for name in items]
