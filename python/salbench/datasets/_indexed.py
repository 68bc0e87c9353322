# SPDX-License-Identifier: GPL-3.0-or-later
"""A user's description of a set in the one form: `index: index.csv`, and what else it says of the set."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from salbench.datasets._files import exists
from salbench.datasets._layout import Layout
from salbench.datasets.records import InputError, Item, Listing, Source

if TYPE_CHECKING:
    from salbench.datasets.records import Form

_REMEDY = "put the right file there, or import the set again"


def items(layout: Layout, root: str) -> Listing:
    """The rows of the index. Its reader is the program's."""
    from salbench import _core

    if not os.path.isdir(root):
        raise InputError(f"{root}: there is no such folder")
    index = os.path.join(root, layout.index)
    if not exists(index):
        raise InputError(f"{index}: cannot be read: there is no such file")
    remark = _core.index_remark(os.fsencode(index))
    listing = Listing([], [remark] if remark else [], [index], index, licence=layout.licence, remark=remark)
    for shape, view, category, split, kind, truth, participants, viewers, _, recorded in _core.read_index(os.fsencode(index)):
        path = os.path.join(root, "items", f"{shape}.h5")
        seen = f", view {view}" if view else ""
        listing.items.append(Item(f"{shape}_{view}" if view else shape, shape, view, category, split, kind, truth, participants, viewers,
                                  recorded, files=(Source(f"{'ground truth and shape' if truth else 'shape'} in one form{seen}", path, f"{shape}.h5"),),
                                  how={"form": path}))
    if not listing.items:
        raise InputError(f"{index}: lists no item")
    return listing


def read(item: Item) -> Form:
    """The form in an item's file, with the ground truth of its view alone."""
    from salbench.datasets import one_form

    form = one_form.read(item.how["form"])
    form.truths = tuple(truth for truth in form.truths if truth.view == item.view) if item.truth else ()
    if item.truth and not form.truths:
        raise InputError(f"{item.how['form']}: has no ground truth{' of view ' * bool(item.view)}{item.view}, and index.csv says that it has")
    shape = item.shape_name
    if (named := form.about.get("item", shape)) != shape:
        raise InputError(f"{item.how['form']}: is of the item '{named}', and index.csv says that it is of '{shape}': {_REMEDY}")
    for truth in form.truths:
        require_people(item.how["form"], item, len(truth.picks), 0 if truth.viewers is None else len(truth.viewers))
    return form


def require_people(file: str, item: Item, participants: int, viewers: int) -> None:
    """Of the ground truth in a file of the one form, as the index has them."""
    for what, found, listed in (("picks of participants", participants, item.participants), ("values of viewers", viewers, item.viewers)):
        if found and listed and found != listed:  # neither is known where people are not told apart
            raise InputError(f"{file}: has {found} {what}, and index.csv says {listed}: {_REMEDY}")
