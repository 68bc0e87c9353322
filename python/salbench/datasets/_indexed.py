# SPDX-License-Identifier: GPL-3.0-or-later
"""A user's description of a set in the one form: `index: index.csv`, and what else it says of the set."""

from __future__ import annotations

import os

from salbench.datasets._files import exists
from salbench.datasets._layout import Layout
from salbench.datasets.records import InputError, Item, Listing, Source


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
    for shape, view, category, split, kind, truth, participants, viewers, _ in _core.read_index(os.fsencode(index)):
        path = os.path.join(root, "items", f"{shape}.h5")
        seen = f", view {view}" if view else ""
        listing.items.append(Item(f"{shape}_{view}" if view else shape, shape, view, category, split, kind, truth, participants, viewers,
                                  files=(Source(f"{'ground truth and shape' if truth else 'shape'} in one form{seen}", path, f"{shape}.h5"),),
                                  how={"form": path}))
    if not listing.items:
        raise InputError(f"{index}: lists no item")
    return listing
