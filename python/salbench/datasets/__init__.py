# SPDX-License-Identifier: GPL-3.0-or-later
"""Data sets of others: a file per public archive, and what a description (.yaml) of one's own tells of.

Each archive has `items(root)`, which lists its folder and reads no shape, and `read(item)`, which makes the one form of an item. A new
archive is one file and one row of `ARCHIVES`.
"""

from __future__ import annotations

import os
from importlib import import_module
from typing import TYPE_CHECKING, Any

from salbench.datasets.records import InputError, Item, Listing

if TYPE_CHECKING:
    from salbench.datasets.one_form import write as write
    from salbench.datasets.records import Form

ARCHIVES = {
    "3dva": "threedva",
    "dutagaci": "dutagaci",
    "gs": "gs",
    "meshmamba": "meshmamba",
    "meshmamba_textured": "meshmamba_textured",
    "princeton": "princeton",
    "sal3d": "sal3d",
    "sal3d_meshes": "sal3d_meshes",
    "zaragoza": "zaragoza",
}
NATIVE = {  # which C++ lists by itself, and on what terms their authors give them
    "automatic": "",
    "folder": "not known; ask whoever made the files",
    "hdf5": "each item's file says on what terms its source is given",
    "schelling": "not known; cite the study, and ask its authors before you pass the data on",
}
DESCRIPTION = ".yaml"


def __getattr__(name: str) -> Any:
    """`write`, which needs h5py; listing does not."""
    if name != "write":
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from salbench.datasets.one_form import write

    return write


class _Described:
    """A user's description, as if it were an archive of its own."""

    def __init__(self, path: str) -> None:
        from salbench.datasets import described

        self.LAYOUT, self.VERSION, self.read = described.of_file(path), described.VERSION, described.read

    def items(self, root: str, twins: str = "refuse") -> Listing:
        from salbench.datasets import described

        return described.items(self.LAYOUT, root, twins)


def is_description(layout: str) -> bool:
    return layout.endswith(DESCRIPTION) and layout != DESCRIPTION


def find(layout: str) -> Any:
    """The archive of this name, or what a user's description tells of: LAYOUT, VERSION, items(root, twins) and read(item)."""
    if layout in ARCHIVES:
        return import_module(f"salbench.datasets.{ARCHIVES[layout]}")
    if is_description(layout):
        return _Described(layout)
    from salbench.datasets._section import did_you_mean

    known = sorted({*ARCHIVES, *NATIVE})
    raise InputError(f"there is no layout '{layout}'; {did_you_mean(layout, known, 'there are: ' + ', '.join(known) + ', and your own .yaml')}")


def read(layout: str, root: str, item: Item) -> Form:
    """The one form of an item of a listing, with what is known about it."""
    archive = find(layout)
    form: Form = archive.read(item)
    if "form" in item.how:
        return form
    folder = os.path.normpath(root)
    lines = [f"{digest}  {os.path.relpath(path, folder)}\n" for path, digest in sorted(form.digests.items())]
    form.about = {"item": item.shape or item.name, "class": item.category, "split": item.split, "source": archive.LAYOUT.name,
                  "source_files": "".join(lines), "viewers": "\n".join(item.how.get("views", [])), "licence": archive.LAYOUT.licence}
    return form
