# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects that users request by name."""

import os
from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import TYPE_CHECKING, Any, NoReturn, TypeVar

from salbench import _core

if TYPE_CHECKING:
    import pandas

T = TypeVar("T")


class ByName(Mapping[str, T]):
    """Values are created on access. Unknown names raise a KeyError with a suggestion.

    what: for that message, such as "map by LS of an item called".
    """

    def __init__(self, what: str, names: Iterable[str], make: Callable[[str], T]) -> None:
        self._what, self._names, self._make = what, dict.fromkeys(names), make

    def __getitem__(self, name: str) -> T:
        if name not in self._names:
            fail_unknown(self._what, name, self._names)
        return self._make(name)

    def __contains__(self, name: object) -> bool:
        return name in self._names

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)

    def __repr__(self) -> str:
        return f"{self._what}: {', '.join(self._names)}"


class Rows(list[T]):
    """Rows of a table of the program, in its order."""

    def frame(self) -> "pandas.DataFrame":
        """The rows as a data frame, by name."""
        import pandas

        return pandas.DataFrame(self).set_index("name")

    def _repr_html_(self) -> str:
        return str(self.frame().to_html())


def fail_unknown(what: str, name: object, known: Iterable[str]) -> NoReturn:
    """Throws an error for an unknown name, which may not be UTF-8."""
    if not isinstance(name, str) and str(name) in known:
        raise KeyError(f"there is no {what} {name!r}: names are texts, such as '{name}'")
    _core.fail_unknown(what, os.fsencode(str(name)), [*map(os.fsencode, known)])


def names_of(items: Iterable[Any]) -> list[str]:
    """Names from a sequence of items, which may be numbers."""
    names = None if isinstance(items, bytes) or not hasattr(items, "__iter__") else list(items)
    if names is None or any(
        isinstance(name, bytes) or (hasattr(name, "__len__") and not isinstance(name, str)) for name in names
    ):
        raise ValueError(
            "items must be a text such as '1-20,52', or a sequence of names, not"
            f" {items if names is None else names!r:.200}"
        )
    return [str(name) for name in names]
