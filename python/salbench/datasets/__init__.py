# SPDX-License-Identifier: GPL-3.0-or-later
"""Data sets of others: a file per public archive, and what a description (.yaml) of one's own tells of.

Each archive has a LAYOUT, in the words of a description. Where these do not say how its files are read, it has `items(root)`, which lists
its folder and reads no shape, `read(item)`, which makes the one form of an item, and their VERSION. A new archive is one file and one row
of `ARCHIVES` in _registry.py.
"""

from typing import TYPE_CHECKING, Any

from salbench.datasets._registry import ARCHIVES as ARCHIVES
from salbench.datasets._registry import NATIVE as NATIVE
from salbench.datasets._registry import find as find
from salbench.datasets._registry import is_description as is_description
from salbench.datasets._registry import read as read

if TYPE_CHECKING:
    from salbench.datasets.one_form import write

__all__ = ["write"]


def __getattr__(name: str) -> Any:
    """`write`, which needs h5py; listing does not."""
    if name != "write":
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from salbench.datasets.one_form import write

    return write


def __dir__() -> list[str]:
    return __all__
