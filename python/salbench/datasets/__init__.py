# SPDX-License-Identifier: GPL-3.0-or-later
"""Data sets of others: a file per public archive, and what a description (.yaml) of one's own tells of.

Each archive has a LAYOUT, in the words of a description. Where these do not say how its files are read, it has `items(root)`, which lists
its folder and reads no shape, `read(item)`, which makes the one form of an item, and their VERSION. A new archive is one file and one row
of `ARCHIVES` in _registry.py.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from salbench.datasets._registry import ARCHIVES as ARCHIVES
from salbench.datasets._registry import NATIVE as NATIVE
from salbench.datasets._registry import find as find
from salbench.datasets._registry import is_description as is_description
from salbench.datasets._registry import read as read

if TYPE_CHECKING:
    from salbench.datasets.one_form import write
    from salbench.datasets.records import Recording

__all__ = ["Recording", "write"]
_HOMES = {"Recording": "records", "write": "one_form"}  # these need h5py or NumPy; listing does not


def __getattr__(name: str) -> Any:
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOMES[name]}"), name)


def __dir__() -> list[str]:
    return __all__
