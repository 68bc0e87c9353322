# SPDX-License-Identifier: GPL-3.0-or-later
"""Files in the form of the Schelling study [chen2012]: NAME.val, one number per vertex, and NAME_NUMBER.pid,
the picks of a participant. C++ reads them."""

import os
from collections.abc import Iterable, Sequence

from salbench.datasets.files import below, by_name, first, left_over, match, natural_order
from salbench.datasets.records import Item, Listing
from salbench.system.errors import InputError

# Classes of SHREC'07 in the order of their meshes, twenty each. [giorgi2007]
SHREC07 = (
    "human cup glasses airplane ant chair octopus table teddy hand plier fish bird spring armadillo buste"
    " mechanic bearing vase four-legged"
).split()
PER_CLASS = 20

Folders = tuple[str, str]  # folders of values, and of picks


def listed(
    root: str, places: Sequence[tuple[str, Sequence[Folders]]], required: bool = True, shrec07: bool = False
) -> Listing:
    """Lists meshes. places: candidates, each a pattern of meshes with the folders below the root that may
    hold their values and picks. The first pattern that matches a mesh is used, with the first of its folders
    that exist. required: a set without values or without picks is an error."""
    number, meshes = first(root, [pattern for pattern, _ in places])
    folders = next(
        (both for both in places[number][1] if any(os.path.isdir(below(root, folder)) for folder in both)),
        None,
    )
    saliency: dict[str, str] = {}
    picks: dict[str, list[str]] = {}
    listing = Listing([])
    if folders is not None:
        values, picked = f"{folders[0]}/{{item}}.val", f"{folders[1]}/{{item}}_{{participant}}.pid"
        saliency = by_name(match(root, values, meshes))
        for one in match(root, picked, meshes):
            picks.setdefault(one.item, []).append(one.path)
        listing.notes += left_over(root, f"{folders[0]}/*.val", saliency.values())
        listing.notes += left_over(
            root, f"{folders[1]}/*.pid", [path for paths in picks.values() for path in paths]
        )
    for found, folder in zip((saliency, picks), folders or places[number][1][0]):
        if required and not found:
            raise InputError(
                f"{below(root, folder)}: has no ground truth of a mesh: expected are files NAME.val of values"
                " and NAME_NUMBER.pid of picks"
            )
    for name, mesh in meshes.items():
        own = picks.get(name, [])
        listing.items.append(
            Item(
                name,
                [mesh],
                category_of(name) if shrec07 else "",
                truth=name in saliency or bool(own),
                participants=len(own),
                saliency=saliency.get(name, ""),
                picks=own,
            )
        )
    if shrec07:
        listing.notes += _missing_numbers([*meshes])
    return listing


def category_of(name: str) -> str:
    """Class of a mesh named 1 to 400."""
    is_number = name.isascii() and name.isdigit() and len(name) <= 3 and name[0] != "0"
    return (
        SHREC07[(int(name) - 1) // PER_CLASS] if is_number and int(name) <= len(SHREC07) * PER_CLASS else ""
    )


def _missing_numbers(names: Sequence[str]) -> Iterable[str]:
    """Notes on missing meshes of the benchmark; none unless all items belong to it."""
    count = len(SHREC07) * PER_CLASS
    missing = sorted({*map(str, range(1, count + 1))} - {*names}, key=natural_order)
    if not missing or not all(map(category_of, names)):
        return
    numbers = [*map(int, missing)]
    starts = [number for number in numbers if number - 1 not in numbers]
    ends = [number for number in numbers if number + 1 not in numbers]
    ranges = [str(begin) if begin == end else f"{begin}-{end}" for begin, end in zip(starts, ends)]
    yield f"{len(names)} of the {count} meshes of SHREC'07 are here, without {', '.join(ranges)}"
