# SPDX-License-Identifier: GPL-3.0-or-later
"""The archives by their names, and a user's description: what each lists, and the one form of an item."""

from __future__ import annotations

import os
from importlib import import_module
from typing import TYPE_CHECKING, Any

from salbench.datasets.records import InputError, Item

if TYPE_CHECKING:
    from salbench.datasets.records import Form

ARCHIVES = {
    "3dva": "threedva",
    "gs": "gs",
    "meshmamba": "meshmamba",
    "meshmamba_textured": "meshmamba_textured",
    "princeton": "princeton",
    "sal3d": "sal3d",
    "sal3d_meshes": "sal3d_meshes",
    "sal3d_spread": "sal3d_spread",
    "saliency3d": "saliency3d",
    "zaragoza": "zaragoza",
}
NATIVE = {  # which C++ lists by itself, and on what terms their authors give them
    "automatic": "",
    "folder": "not known; ask whoever made the files",
    "hdf5": "each item's file says on what terms its source is given",
    "schelling": "not known; cite the study, and ask its authors before you pass the data on",
}
DESCRIPTION = ".yaml"


def is_description(layout: str) -> bool:
    return os.path.splitext(layout)[1].lower() == DESCRIPTION


def find(layout: str) -> Any:
    """The archive of this name, or what a user's description tells of: LAYOUT, VERSION, items(root) and read(item)."""
    from salbench.datasets.described import Archive

    if layout in ARCHIVES:
        archive = import_module(f"salbench.datasets.{ARCHIVES[layout]}")
        return archive if hasattr(archive, "read") else Archive(archive.LAYOUT, getattr(archive, "beside", None))
    if is_description(layout):
        from salbench.datasets._description import read_description

        return Archive(read_description(layout))
    from salbench.datasets._section import did_you_mean

    known = sorted({*ARCHIVES, *NATIVE})
    raise InputError(f"there is no layout '{layout}'; {did_you_mean(layout, known, 'there are: ' + ', '.join(known) + ', and your own .yaml')}")


def read(layout: str, root: str, item: Item) -> Form:
    """The one form of an item of a listing, with what is known about it."""
    archive = find(layout)
    form: Form = archive.read(item)
    form.about = about(item, form, root, archive.LAYOUT.name, archive.LAYOUT.licence)
    return form


def about(item: Item, form: Form, root: str, source: str, licence: str) -> dict[str, str]:
    """What the file of a form says of it."""
    files = "".join(f"{digest}  {os.path.relpath(path, root)}\n" for path, digest in sorted(form.digests.items()))
    return {"item": item.shape_name, "class": item.category, "split": item.split, "source": source, "source_files": files,
            "viewers": "\n".join(item.how.get("views", [])), "licence": licence}
