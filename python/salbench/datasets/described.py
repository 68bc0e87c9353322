# SPDX-License-Identifier: GPL-3.0-or-later
"""Any data set that a description tells of: what its folder holds, and the one form of an item.

`items` lists folders and reads no shape: it imports the standard library alone, and PyYAML for a user's description.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from typing import TYPE_CHECKING, Any

from salbench.datasets._files import extension
from salbench.datasets._folders import MESHES, Candidate, Found, find, is_column_cloud
from salbench.datasets._gaze_files import OfItem
from salbench.datasets._layout import LISTED, Columns, Gaze, Indices, Layout, Values, described
from salbench.datasets.records import InputError, Item, Listing, Source, UnreadableError

if TYPE_CHECKING:
    from salbench.datasets.records import Form

VERSION = 2  # of what `read` makes of an item: another form for the same files is another version
HEADER_BYTES = 1 << 16

_FACES = re.compile(rb"^(element[ \t]+face[ \t]+0*[1-9]|element[ \t]+tristrips[ \t])", re.MULTILINE)


def items(layout: Layout, root: str, beside: Callable[[str], list[Source]] | None = None) -> Listing:
    """What the folder holds, in natural order. `beside`: files that belong to a shape's, such as its texture."""
    found = find(layout, root)
    native = _is_native(found)
    rows = [_item(found, entry, native) for entry in found.entries]
    if beside is not None:
        rows = [replace(row, files=(*row.files, *beside(row.files[0].path))) for row in rows]
    notes = found.notes + ([found.remark] if found.remark else [])
    listing = Listing(rows, notes, found.read, layout.splits and layout.where(layout.splits.where) or "", found.no_splits,
                      [{"split": one.split, "name": one.item, "where": one.where} for one in found.unknown], layout.scale, layout.unit_where,
                      layout.licence, layout.values.positives, found.remark)
    if layout.unit_where:
        from salbench.datasets._sizes import fail_mixed_units

        fail_mixed_units(listing)
    return listing


def read(item: Item) -> Form:
    """The one form of an item that `items` listed."""
    from salbench.datasets._truth import read_item

    path = item.files[0].path
    try:
        return _with_recording(item) if "recording" in item.how else read_item(item)
    except InputError:
        raise
    except ValueError as error:  # of C++, which may not know the file
        raise InputError(str(error) if path in str(error) else f"{path}: {error}") from None
    except MemoryError:
        raise UnreadableError(f"{path}: no memory for what its item's files hold; leave it out, or work on fewer items at a time") from None


def _with_recording(item: Item) -> Form:
    from salbench.datasets._gaze_reading import read_recording
    from salbench.datasets._truth import read_item

    told = item.how["recording"]
    form = read_item(replace(item, files=item.files[:len(item.files) - len(told["people"]) - len(told["cameras"])]))
    found = read_recording(item)
    form.recording, form.remarks, form.problems = found.recording, found.causes.lines(), found.problems
    if found.recording is None and not form.truths:
        raise InputError((found.problems or form.remarks or [f"{item.files[-1].path}: has no row of {item.name}"])[0])
    form.digests |= found.digests
    return form


@dataclass(frozen=True)
class Archive:
    """What a layout tells of, as an archive."""

    LAYOUT: Layout
    beside: Callable[[str], list[Source]] | None = None
    VERSION: int = VERSION

    def items(self, root: str) -> Listing:
        return items(self.LAYOUT, root, self.beside)

    def read(self, item: Item) -> Form:
        return read(item)


def _is_native(found: Found) -> bool:
    """True of shapes with a number per vertex and indices from 0 beside them: C++ reads them as its own layouts."""
    layout, truth = found.layout, found.truth
    plain = ((layout.values, layout.indices, layout.columns) == (Values(), Indices(), Columns()) and not layout.unit_where
             and not layout.recording)
    if truth is None or not plain:
        return plain
    one_file = all(len(entry.saliency) <= 1 and not entry.views for entry in found.entries)
    endings = extension(truth.saliency) == ".val" or not truth.saliency, extension(truth.picks) == ".pid" or not truth.picks
    return one_file and all(endings) and not truth.mask and not truth.viewers


def kind_of(path: str) -> str:
    """ "cloud" of a file that holds points alone: .pcd, .xyz and columns always do, .ply where its header announces no faces. A header that
    cannot be read announces some."""
    kind = extension(path)
    if kind != ".ply":
        return "mesh" if kind in MESHES else "cloud"
    try:
        with open(path, "rb") as file:
            header, end, _ = file.read(HEADER_BYTES).replace(b"\r", b"\n").partition(b"end_header")
    except OSError:
        return "mesh"
    return "cloud" if header.startswith(b"ply") and end and not _FACES.search(header) else "mesh"


def _item(found: Found, entry: Candidate, native: bool) -> Item:
    layout = found.layout
    in_columns = is_column_cloud(entry.mesh, layout.columns)
    unlisted = found.values.spread_along == LISTED and not entry.neighbours
    if unlisted:
        entry = entry.without_truth()
    has_columns = in_columns and not unlisted and bool(layout.columns.density or layout.columns.flag)
    problem = entry.problem or next((missing for _, missing in entry.masks if missing), "")
    by_viewer = bool(found.truth and "{viewer}" in found.truth.saliency)
    item = Item(entry.name, entry.shape, entry.view, entry.category, entry.split, "cloud" if in_columns else kind_of(entry.mesh),
                bool(entry.saliency or entry.picks or has_columns or problem), len(entry.picks),
                len(entry.saliency) if by_viewer else len(entry.people), problem=problem)
    if native:
        item.take_native(entry.mesh, entry.saliency, entry.picks)
        return item
    if problem:
        entry = replace(entry.without_truth(), neighbours="", gaze=None)
    unread = bool(problem) or unlisted
    files = [_shape_source(found, entry, item.kind, in_columns, unread)]
    how: dict[str, Any] = {"columns": _given(layout.columns)} if in_columns else {}
    if entry.neighbours:
        files.append(Source("neighbours", entry.neighbours, _titled("neighbours file", entry.neighbours)))
        how["neighbours"] = True
    if has_columns and not problem:
        how |= _nonzero(values=_given(_of_columns(found.values)))
    elif entry.saliency or entry.picks:
        how |= _nonzero(saliency=len(entry.saliency), picks=len(entry.picks), masks=bool(entry.masks), by_viewer=by_viewer,
                        views=entry.viewers if by_viewer else [person for _, _, person in entry.people], people=len(entry.people),
                        values=_given(found.values), indices=_given(layout.indices))
        files += _truth_sources(found, entry, how)
    if unread and in_columns:
        how["columns"] = _given(replace(layout.columns, density="", flag=""))
    if entry.gaze:
        item.recorded = len(entry.gaze.people)
        files += _gaze_sources(found, entry.gaze)
        own = replace(layout.recording, files=Gaze.files, cameras=Gaze.cameras)
        how |= {"gaze": _given(own), "recording": {"people": [person for _, person in entry.gaze.files], "rows_of": entry.gaze.rows_of,
                                                   "cameras": [person for _, person in entry.gaze.cameras]}}
        if layout.unit_where:
            how["recording"]["metres"] = layout.scale
    item.files, item.how = tuple(files), how
    return item


def _gaze_sources(found: Found, gaze: OfItem) -> list[Source]:
    """Files of recordings, and then those of their cameras."""
    how = described(found.layout.recording, files=Gaze.files, cameras=Gaze.cameras)
    rows = f", rows of {gaze.rows_of}" if found.layout.recording.item else ""
    files = [Source(f"gaze {k}{f' of {person}' if person else ''}{rows}{how}", path, _titled("gaze", path)) for k, (path, person) in enumerate(gaze.files)]
    return files + [Source(f"cameras {k}{f' of {person}' if person else ''}", path, _titled("cameras", path))
                    for k, (path, person) in enumerate(gaze.cameras)]


def _of_columns(values: Values) -> Values:
    """Those that also count where the ground truth stands beside a point cloud."""
    return Values(positives=values.positives, spread_neighbours=values.spread_neighbours, spread_from=values.spread_from,
                  spread_along=values.spread_along)


def _given(options: Any) -> dict[str, Any]:
    """Options that are not at their defaults, as JSON has them."""
    defaults = asdict(type(options)())
    return {key: list(value) if isinstance(value, tuple) else value for key, value in asdict(options).items() if value != defaults[key]}


def _nonzero(**entries: Any) -> dict[str, Any]:
    return {key: value for key, value in entries.items() if value}


def _titled(kind: str, path: str) -> str:
    return f"{kind} {path.rpartition('/')[2]}"


def _shape_source(found: Found, entry: Candidate, kind: str, in_columns: bool, unread: bool) -> Source:
    """unread: the ground truth that may stand in the same file is left out."""
    name = f"{'point cloud' if kind == 'cloud' else 'mesh'} file"
    how = ""
    if in_columns:
        how = described(found.layout.columns, **({"density": "", "flag": ""} if unread else {}))
        how += described(_of_columns(found.values))
    view = f", view {entry.view}" if entry.view else ""
    return Source(f"{name} {extension(entry.mesh)}{how}{view}", entry.mesh, _titled(name, entry.mesh))


def _truth_sources(found: Found, entry: Candidate, how: dict[str, Any]) -> list[Source]:
    """Files of saliency, masks, picks and viewers. How they are read is part of their names."""
    layout, files = found.layout, []
    for k, path in enumerate(entry.saliency):
        viewer = f", {how['views'][k]}" if how.get("by_viewer") else ""
        name = f"saliency of viewer {k}{viewer}" if viewer else f"saliency file {k}" if len(entry.saliency) > 1 else "saliency file"
        numbered = ", rows by their numbers" if layout.values.column and layout.values.per != "point" else ""
        files.append(Source(f"{name}{described(found.values)}{numbered}", path, _titled("saliency file", path)))
    files += [Source(f"mask {k}", path, _titled("mask", path)) for k, (path, _) in enumerate(entry.masks)]
    hides = entry.saliency and (entry.masks or layout.values.unseen or layout.values.per != "vertex")
    for k, path in enumerate(entry.picks):
        files.append(Source(f"picks {k}{described(layout.indices)}{' of what was seen' if hides else ''}", path, _titled("picks", path)))
    files += [Source(f"saliency of viewer {k}, {viewer}{described(found.values)}, beside the shape's", path, _titled("saliency file", path))
              for k, (path, _, viewer) in enumerate(entry.people)]
    return files
