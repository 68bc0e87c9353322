# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds the shapes of a data set and the ground truth that belongs to each. The first place with a mesh is taken, so the result depends on
the names in the folders alone."""

from __future__ import annotations

import copy
import os
from dataclasses import dataclass, field, replace

from salbench._errors import wrong_with_line
from salbench.datasets._files import below, extension, stem
from salbench.datasets._gaze_files import OfItem, find_gaze
from salbench.datasets._layout import LISTED, Columns, Layout, Pattern, Place, TruthPlace, Values
from salbench.datasets._patterns import (
    expected_name, files_like, filled_in, has_folder_for, has_viewers, has_views, natural_order, one_file_per_item, place_of)
from salbench.datasets._splits import Entry, read_splits, text_of_unknown
from salbench.datasets.records import InputError

MESHES, CLOUDS = (".off", ".obj", ".ply"), (".ply", ".pcd", ".xyz")

# The tracks of SHREC'07 in the order of their meshes, twenty each. [giorgi2007]
SHREC07 = ("human cup glasses airplane ant chair octopus table teddy hand plier fish bird spring armadillo buste mechanic bearing vase "
           "four-legged").split()
PER_CLASS = 20
MAX_NAMED = 5  # items in a note


@dataclass
class Candidate:
    """An item while its files are looked for."""

    name: str  # of a view that is scored with "_VIEW" behind it
    category: str
    mesh: str
    shape: str
    saliency: list[str] = field(default_factory=list)  # one, or one per view or viewer
    views: list[str] = field(default_factory=list)  # of each file of saliency, where there may be several: its view
    viewers: list[str] = field(default_factory=list)  # and its viewer
    picks: list[str] = field(default_factory=list)
    people: list[tuple[str, str, str]] = field(default_factory=list)  # files of viewers beside the saliency: path, view, viewer
    neighbours: str = ""
    gaze: OfItem | None = None
    masks: list[tuple[str, str]] = field(default_factory=list)  # one per file of saliency: path, and what to do if it is missing
    view: str = ""  # that is scored
    split: str = ""
    problem: str = ""

    def without_truth(self) -> Candidate:
        return replace(self, saliency=[], picks=[], masks=[], views=[], viewers=[], people=[])


@dataclass
class Found:
    layout: Layout
    place: Place
    entries: list[Candidate]
    truth: TruthPlace | None  # where the ground truth lies; None: nowhere
    notes: list[str] = field(default_factory=list)
    read: list[str] = field(default_factory=list)
    no_splits: str = ""
    unknown: list[Entry] = field(default_factory=list)
    values: Values = Values()  # those of the layout; not spread where lists of neighbours are missing
    remark: str = ""


def is_column_cloud(path: str, columns: Columns) -> bool:
    """True of .txt and .csv where a description says which columns hold points."""
    return bool(columns.position) and extension(path) in (".txt", ".csv")


def find(layout: Layout, root: str) -> Found:
    """The items of a data set, in natural order, and what there is to say about its folder. Reads no file but those of splits."""
    folder = os.path.normpath(root) if root else root  # "data/" is "data"
    place, meshes = _find_meshes(layout, folder)
    found = Found(layout, place, [], None, values=layout.values, remark=layout.remark)
    items: dict[str, Candidate] = {}
    for mesh in sorted(meshes, key=lambda mesh: natural_order(stem(mesh))):
        name = stem(mesh)
        if name in items:
            raise InputError(f"{below(folder, items[name].mesh)} and {below(folder, mesh)} have the same name: rename or remove one of them")
        items[name] = Candidate(name, _category(mesh, layout.classes), mesh, name)
    if layout.classes == "shrec07":
        _note_missing_numbers(items, found.notes)
    found.truth = _add_truth(found, folder, items)
    _add_neighbours(found, folder, place.neighbours, items)
    if layout.recording:
        for name, of_item in find_gaze(layout, folder, items, found.notes).items():
            items[name].gaze = of_item
    _add_splits(found, folder, items)
    for entry in items.values():
        found.entries += _views(entry) if place.views == "scored" and entry.views else [entry]
    named: dict[str, Candidate] = {}
    for entry in found.entries:
        if (other := named.setdefault(entry.name, entry)) is not entry:
            raise InputError(f"{below(folder, other.mesh)} and {below(folder, entry.mesh)} have an item {entry.name} each; rename a file")
    return found


def _is_open(place: Place, root: str) -> bool:
    return (not place.needs or os.path.isdir(os.path.join(root, place.needs))) and place.root_is in ("", os.path.basename(root))


def _is_shape(path: str, layout: Layout) -> bool:
    if is_column_cloud(path, layout.columns):
        return layout.domain != "meshes"
    known = {"any": (*MESHES, *CLOUDS), "meshes": MESHES, "points": CLOUDS}[layout.domain]
    return extension(path) in known


def _find_meshes(layout: Layout, root: str) -> tuple[Place, list[str]]:
    if not os.path.isdir(root):
        raise InputError(f"{root}: there is no such folder")
    for place in layout.places:
        if _is_open(place, root):
            meshes = [file.path for file in files_like(root, place.meshes).fit if _is_shape(file.path, layout)]
            if meshes:
                return place, meshes
    raise InputError(f"{root}: no .off, .obj or .ply meshes found, and no .ply, .pcd or .xyz point clouds; looked in "
                     f"{layout.name}: {_where_looked_for(layout, root)}")


def _where_looked_for(layout: Layout, root: str) -> str:
    """ "/data/Meshes, /data/off"; of a user's own description with its lines: "/data/off/*.off (own.yaml:3)"."""
    places, needs, names = set(), set(), set()
    for place in layout.places:
        if _is_open(place, root):
            where = f" ({place.meshes.where})" if layout.needs_truth and place.meshes.where else ""
            places.add(place_of(root, place.meshes) + where)
        elif place.needs:
            needs.add(f"{place.needs}/")
        else:
            names.add(place.root_is)
    if places:
        return ", ".join(sorted(places))
    if not needs:
        return f"{root} (is not named {' or '.join(sorted(names))})"
    return f"{root} ({'without' if len(needs) == 1 else 'with neither'} {' nor '.join(sorted(needs))} in it)"


def _benchmark_number(name: str) -> int:
    """1 to 400, or 0 for a name that is not such a number."""
    is_number = name.isascii() and name.isdigit() and len(name) <= 3 and name[0] != "0"
    return int(name) if is_number and int(name) <= len(SHREC07) * PER_CLASS else 0


def _category(mesh: str, classes: str) -> str:
    if classes == "folder":
        name = os.path.basename(os.path.dirname(mesh))
        if wrong := wrong_with_line(name):
            raise InputError(f"{os.path.dirname(mesh)}: names a class, and has {wrong}, which tables cannot have: rename the folder")
        return name
    number = _benchmark_number(stem(mesh)) if classes == "shrec07" else 0
    return SHREC07[(number - 1) // PER_CLASS] if number else ""


def _note_missing_numbers(items: dict[str, Candidate], notes: list[str]) -> None:
    """Which meshes of the benchmark are not here; nothing unless all items are meshes of the benchmark."""
    all_numbers = range(1, len(SHREC07) * PER_CLASS + 1)
    missing = [number for number in all_numbers if str(number) not in items]
    if not missing or not all(entry.category for entry in items.values()):
        return
    starts = [number for number in missing if number - 1 not in missing]
    ends = [number for number in missing if number + 1 not in missing]
    ranges = [str(first) if first == last else f"{first}-{last}" for first, last in zip(starts, ends)]
    notes.append(f"{len(items)} of the {len(all_numbers)} meshes of SHREC'07 are here, without {', '.join(ranges)}")


def _require(found: Found, root: str, pattern: Pattern) -> None:
    raise InputError(f"{found.layout.where(pattern.where)}: '{pattern}' fits no file of an item; expected are such as {place_of(root, pattern)}")


def _add_truth(found: Found, root: str, items: dict[str, Candidate]) -> TruthPlace | None:
    """Gives the items their files of the first place of ground truth that there is."""
    places, needed = found.place.truth, found.layout.needs_truth
    truth = next((place for place in places if has_folder_for(root, place.saliency) or has_folder_for(root, place.picks)), None)
    if truth is None:
        if needed and places:
            _require(found, root, places[0].saliency or places[0].picks)
        return None
    without_mesh: dict[str, str] = {}
    for pattern, kind in ((truth.saliency, "saliency"), (truth.picks, "picks")):
        added = _add_files(found, root, pattern, kind, items, without_mesh)
        if needed and pattern and not added:
            _require(found, root, pattern)
    for name in sorted(without_mesh, key=natural_order):
        found.notes.append(f"{name}: ground truth without a mesh or point cloud ({without_mesh[name]})")
    _add_masks(found, root, truth, items)
    _add_viewers(found, root, truth, items)
    return truth


def _add_files(found: Found, root: str, pattern: Pattern, kind: str, items: dict[str, Candidate], without_mesh: dict[str, str]) -> int:
    """Adds the files of one pattern to their items; how many there are. Those that belong to none are kept for a note."""
    files, one, added = files_like(root, pattern, items), one_file_per_item(pattern), 0
    for file in files.fit:
        entry = items.get(file.item)
        if entry is None:
            without_mesh.setdefault(file.item, file.path)
            continue
        of_item = getattr(entry, kind)
        if one and of_item:
            raise InputError(f"{file.path}: {file.item} has a file already, {of_item[0]}, and {found.layout.where(pattern.where)} means one: "
                             "keep one of them")
        of_item.append(file.path)
        if kind == "saliency" and not one:
            entry.views.append(file.part)
            entry.viewers.append(file.viewer)
        added += 1
    found.notes += [f"{path}: is not named {expected_name(pattern)} and was left out" for path in files.left_out]
    return added


def _add_masks(found: Found, root: str, truth: TruthPlace, items: dict[str, Candidate]) -> None:
    """Gives each file of saliency its mask. One that is missing is its item's failure."""
    pattern = truth.mask
    if not pattern:
        return
    where = found.layout.where(pattern.where)
    masks: dict[tuple[str, str, str], str] = {}
    for file in files_like(root, pattern, items).fit:
        masks.setdefault((file.item, file.part, file.viewer), file.path)
    used = set()
    for name, entry in items.items():
        for k, saliency in enumerate(entry.saliency):
            key = (name, entry.views[k] if has_views(pattern) else "", entry.viewers[k] if has_viewers(pattern) else "")
            used.add(key)
            path = masks.get(key) or below(root, filled_in(pattern, *key))
            missing = f"{path}: is missing, the mask of {saliency}: add it, or take its ground truth away ({where})"
            entry.masks.append((path, "" if key in masks else missing))
    for (name, view, viewer), file_path in sorted(masks.items(), key=lambda mask: tuple(map(os.fsencode, mask[0]))):
        if (name, view, viewer) in used:
            continue
        if found.place.views != "scored" or name not in items or not items[name].saliency:
            found.notes.append(f"{file_path}: mask without ground truth")
            continue
        expected = below(root, filled_in(truth.saliency, name, view, viewer))  # a view without ground truth, which fails
        items[name].saliency.append("")
        items[name].views.append(view)
        items[name].viewers.append(viewer)
        items[name].masks.append((file_path, f"{expected}: is missing, the ground truth of the view that {file_path} is the mask of: add it, or "
                                             f"take the mask away ({found.layout.where(truth.saliency.where)})"))


def _add_viewers(found: Found, root: str, truth: TruthPlace, items: dict[str, Candidate]) -> None:
    """Files of viewers beside the saliency. An item may have none."""
    pattern, aliases = truth.viewers, dict(found.layout.aliases)
    for file in files_like(root, pattern, {*items, *aliases}).fit:
        name = file.item if file.item in items else aliases.get(file.item, file.item)
        if name in items:
            items[name].people.append((file.path, file.part, file.viewer))
        else:
            found.notes.append(f"{file.path}: a viewer of no item")


def _add_neighbours(found: Found, root: str, pattern: Pattern, items: dict[str, Candidate]) -> None:
    """The lists that values are spread over. Where there is no folder of them, all values stay as their files have them."""
    if found.values.spread_along != LISTED:
        return
    if not has_folder_for(root, pattern):
        found.values = replace(found.values, spread_neighbours=0, spread_along=Values.spread_along)
        found.remark = found.layout.remark_unlisted
        return
    files = {file.item: file.path for file in files_like(root, pattern, items).fit}
    for name, entry in items.items():
        entry.neighbours = files.pop(name, "")
    found.notes += [f"{path}: neighbours of no item" for path in files.values()]
    if without := [name for name, entry in items.items() if not entry.neighbours]:
        found.notes.append(f"{len(without)} of {len(items)} items have no list of neighbours ({place_of(root, pattern)}), and so no ground truth: "
                           f"{_first_of(without)}")


def _add_splits(found: Found, root: str, items: dict[str, Candidate]) -> None:
    splits = found.layout.splits
    if not splits:
        return
    where = found.layout.where(splits.where)
    found.read += [below(root, file) for file in (splits.table, splits.list) if file]
    result = read_splits(root, splits, where, items)
    if result.unknown:
        found.notes.append(text_of_unknown(result.unknown))
    in_none = []
    for name, entry in items.items():
        entry.split = result.of_item.get(name, "")
        entry.problem = result.problems.get(name, "")
        if not entry.split and not entry.problem:
            in_none.append(name)
    if result.of_item and in_none:
        found.notes.append(f"{len(in_none)} of {len(items)} items are in no split ({where}): {_first_of(in_none)}")
    found.no_splits, found.unknown = result.missing, result.unknown


def _first_of(names: list[str]) -> str:
    return ", ".join(names[:MAX_NAMED]) + (", ..." if len(names) > MAX_NAMED else "")


def _views(entry: Candidate) -> list[Candidate]:
    """An item for each view, in the order of their files."""
    views = []
    for view in dict.fromkeys(entry.views):
        part = copy.copy(entry)
        part.name, part.view = f"{entry.name}_{view}", view
        files = [k for k, own in enumerate(entry.views) if own == view]
        part.saliency, part.views, part.viewers = ([column[k] for k in files] for column in (entry.saliency, entry.views, entry.viewers))
        part.masks = [entry.masks[k] for k in files if entry.masks]
        part.people = [person for person in entry.people if person[1] == view]
        if without := [k for k, path in enumerate(part.saliency) if not path]:
            part.problem, part.saliency = part.masks[without[0]][1], []
        views.append(part)
    return views
