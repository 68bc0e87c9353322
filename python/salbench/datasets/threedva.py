# SPDX-License-Identifier: GPL-3.0-or-later
"""Gaze of people on rendered meshes: fixation densities per vertex from three views of each of 32 meshes, and
which vertices each view shows. Each view is scored by itself, on its visible vertices. [lavoue2018]

Published: https://perso.liris.cnrs.fr/guillaume.lavoue/data/saliency/
Seen: the names of its folders and files, none of the files.
Assumed: a number per line. Both hidden vertices and visible ones that nobody looked at have density 0; the
masks distinguish them. The second arrangement has no masks, and -1 for hidden; its views are averaged. The
published densities are not negative. People: PerSubjectFixations/NAME_VIEW.csv.Tnn.result has one number per
vertex, for each of 19 people (not seen; as a public re-analysis reads them). They are used for HS and
reliability per view; the ground truth stays the published density. Files of `hand-35K` begin with `hand_`.
Cannot answer: who looked where, without these files.
"""

import os

from salbench.datasets.files import below, first, left_over, match
from salbench.datasets.records import Item, Listing, Shape
from salbench.system.errors import InputError

VERSION = 1
LICENCE = "not known, the files were not seen; ask the authors"

MESHES = ("3DModels-Simplif/*", "3DModels-Simplif-up/*")  # the same meshes, upright
MAPS = "FixationMaps/{item}_{view}norm.txt"
MASKS = "CentricityAndVisibilityMaps/{item}_{view}_visibility.txt"
PEOPLE = "PerSubjectFixations/{item}_{view}.csv.T{viewer}.result"
AVERAGED = ("Meshes/*", "FixationMaps/{item}_{view}.txt")
ALIASES = {"hand": "hand-35K"}  # in files of people


def items(root: str) -> Listing:
    number, meshes = first(root, [*MESHES, AVERAGED[0]])
    listing = Listing([])
    if number == len(MESHES):
        for name, mesh in meshes.items():
            maps = [one.path for one in match(root, AVERAGED[1], meshes) if one.item == name]
            listing.items.append(Item(name, [mesh, *maps], truth=bool(maps)))
        listing.notes += left_over(
            root, "FixationMaps/*.txt", [path for item in listing.items for path in item.files]
        )
    else:
        _list_views(root, meshes, listing)
    if not any(item.truth for item in listing.items):
        raise InputError(
            f"{below(root, 'FixationMaps')}: has no fixation map of a mesh: expected are files"
            " NAME_VIEWnorm.txt"
        )
    return listing


def _list_views(root: str, meshes: dict[str, str], listing: Listing) -> None:
    maps, masks = (
        {(one.item, one.view): one.path for one in match(root, pattern, meshes)} for pattern in (MAPS, MASKS)
    )
    people: dict[tuple[str, str], list[str]] = {}
    for one in match(root, PEOPLE, [*meshes, *ALIASES]):
        name = one.item if one.item in meshes else ALIASES[one.item]
        people.setdefault((name, one.view), []).append(one.path)
    for name, mesh in meshes.items():
        views = [view for item, view in maps if item == name]
        masked = sorted((view for item, view in masks if item == name and view not in views), key=os.fsencode)
        for view in [*views, *masked] if views else []:
            files = [
                files.get((name, view)) or below(root, pattern.format(item=name, view=view))
                for files, pattern in ((maps, MAPS), (masks, MASKS))
            ]
            item = Item(
                f"{name}_{view}",
                [mesh],
                shape=name,
                view=view,
                viewers=len(own := people.get((name, view), [])),
            )
            if (name, view) not in masks:
                item.problem = (
                    f"{files[1]}: is missing, the mask of {files[0]}: add it, or take its ground truth away"
                )
            elif (name, view) not in maps:
                item.problem = (
                    f"{files[0]}: is missing, the ground truth of the view that {files[1]} is the mask of:"
                    " add it, or take the mask away"
                )
            else:
                item.files = [mesh, *files, *own]
            listing.items.append(item)
        if not views:
            listing.items.append(Item(name, [mesh], truth=False))
    listing.notes += left_over(root, "FixationMaps/*norm.txt", maps.values()) + left_over(
        root, PEOPLE, [path for own in people.values() for path in own]
    )


def read(item: Item) -> Shape:
    import numpy as np

    from salbench.datasets import reading

    mesh, *files = item.files
    found = reading.shape(mesh)
    n = len(found.points)
    if not files:
        return found
    if not item.view:
        found.ground_truth = reading.mean([reading.values(path, n, unseen=-1) for path in files])
        return found
    saliency, seen, *people = files
    found.ground_truth = np.where(reading.mask(seen, n), reading.values(saliency, n, unseen=-1), np.nan)
    if len(people) > 1:  # leave-one-out needs two
        maps = np.stack([reading.values(path, n, unseen=-1) for path in people])
        found.viewers = np.where(np.isnan(found.ground_truth), np.nan, maps)
    return found
