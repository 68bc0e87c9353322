# SPDX-License-Identifier: GPL-3.0-or-later
"""Items in the one form: the file of each, against what the index says of it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from salbench.datasets.records import InputError, Item

if TYPE_CHECKING:
    from salbench.datasets.records import Form

_REMEDY = "put the right file there, or import the set again"


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
