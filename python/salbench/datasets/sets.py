# SPDX-License-Identifier: GPL-3.0-or-later
"""A data set of any layout, whoever lists it: an importer, or the program what it reads by itself."""

from __future__ import annotations

import contextlib
import functools
import os
from dataclasses import fields
from typing import Any

from salbench import _core
from salbench.datasets import _indexed, _registry, one_form
from salbench.datasets._files import read_file
from salbench.datasets._registry import ARCHIVES, NATIVE, about, find, is_description
from salbench.datasets._section import did_you_mean
from salbench.datasets.records import Form, InputError, Item, Listing

AUTOMATIC = "automatic"
LAYOUTS = tuple(sorted({*ARCHIVES, *NATIVE}))
ONE_FORM = "hdf5"

_found = functools.lru_cache(maxsize=16)(find)


def listed(layout: str, root: str) -> tuple[str, Listing]:
    """The name of the layout, of "automatic" the one that fits, and what the folder holds."""
    try:
        return _listed(layout, root)
    except InputError as error:
        others = layouts_that_fit(root) if "; looked in " in str(error) else ""
        if not others:
            raise
        raise InputError(f"{error}{others}") from None


def layouts_that_fit(root: str) -> str:
    """The end of a message on a folder that has no shapes where its layout expects them: the layouts by which it has some. No shape is read."""
    fit = []
    for layout in LAYOUTS:
        with contextlib.suppress(InputError, OSError):
            if layout != AUTOMATIC and _listed(layout, root)[1].items:
                fit.append(layout)
    return f"; {'the layout that fits' if len(fit) == 1 else 'layouts that fit'}: {', '.join(fit)}" if fit else ""


def _listed(layout: str, root: str) -> tuple[str, Listing]:
    if layout == AUTOMATIC:
        layout = _core.automatic_layout(os.fsencode(root))
    if layout not in NATIVE:
        archive = find(layout)
        return archive.LAYOUT.name, archive.items(root)
    found = _core.native_items(os.fsencode(layout), os.fsencode(root))
    known = {field.name for field in fields(Listing)}
    listing = Listing(**{key: value for key, value in found.items() if key in known})
    listing.items = [_item(row) for row in found["items"]]
    listing.licence = NATIVE[found["layout"]]
    if found["layout"] == ONE_FORM:
        listing.read.append(os.path.join(root, one_form.INDEX))
    return found["layout"], listing


def _item(row: dict[str, Any]) -> Item:
    item = Item.from_json(row)
    if "form" in row:
        item.how = {"form": row["form"]}
    return item


def shape_file(item: Item) -> str:
    """The file that the shape of an item is in."""
    return str(item.how.get("form") or item.files[0].path)


def read(layout: str, root: str, item: Item, licence: str = "") -> Form:
    """The one form of an item of a listing, with what is known about it. `licence`: of a set that the program lists."""
    if item.problem:
        raise InputError(item.problem)
    if "form" in item.how:
        return _indexed.read(item)
    if not item.native:
        return _registry.read(layout, root, item)
    form = one_form.form_of_fields(_core.native_form(os.fsencode(item.name), *native_files(item)))
    form.digests = {path: _core.xxh128(read_file(path)) for path in {file.path for file in item.files}}
    if layout not in NATIVE:
        described = _found(layout).LAYOUT
        layout, licence = described.name, described.licence
    form.about = about(item, form, root, layout, licence)
    return form


def native_files(item: Item) -> tuple[bytes, list[bytes], list[bytes]]:
    """As the program is asked for them."""
    mesh, saliency, picks = item.native_files
    return os.fsencode(mesh), [*map(os.fsencode, saliency)], [*map(os.fsencode, picks)]


def chosen(listing: Listing, items: str | list[str] | None, split: str = "") -> list[Item]:
    """Items that a user names: "1-20,52", "scored" for those with ground truth, or a list of names; None: all. "" stands for all splits."""
    if items == []:
        return []
    if items == "":
        raise InputError("items names no item")
    wanted = [*map(os.fsencode, items)] if isinstance(items, list) else None if items is None else os.fsencode(items)
    rows = [(item.name, item.shape_name, item.split, item.truth or item.recorded > 0, item.problem) for item in listing.items]
    numbers = _core.chosen_items(rows, wanted, os.fsencode(split), os.fsencode(listing.splits_where), os.fsencode(listing.no_splits))
    return [listing.items[number] for number in numbers]


def given_data(subcommand: str, given: Any) -> tuple[str, str]:
    """Layout and folder of a command line."""
    if given.layout not in LAYOUTS and not is_description(given.layout):
        hint = did_you_mean(given.layout, LAYOUTS, "name one of docs/data_sets.md, or a file NAME.yaml")
        raise InputError(f"{subcommand}: there is no layout '{given.layout}'; {hint}")
    if not given.data:
        raise InputError(f"{subcommand}: names no data set: give --data DIR")
    return given.layout, given.data
