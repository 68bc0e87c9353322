# SPDX-License-Identifier: GPL-3.0-or-later
"""A description in YAML, read and checked: what is wrong is told with file, line and key. docs/data_sets.md says what the keys mean."""

from __future__ import annotations

import os
from typing import Any

from salbench.datasets._files import read_file
from salbench.datasets._gaze_description import read_gaze
from salbench.datasets._layout import (
    LISTED, METRES, SURFACE, Columns, Gaze, Indices, Layout, Place, Splits, TruthPlace, Values, number_text, positive_rule)
from salbench.datasets._patterns import has_viewers, has_views, one_file_per_item
from salbench.datasets._section import MAX_BYTES, Section
from salbench.datasets._text import finite_number, is_number
from salbench.datasets.records import InputError

SECTIONS = ("places", "values", "indices", "columns", "recording", "splits", "units")
LF = b"\n"
ROUNDING = 1e-9  # of shares that sum to 1
MAX_NEIGHBOURS = 100_000


def read_description(path: str) -> Layout:
    """The layout that a user's file describes."""
    data = read_file(path, MAX_BYTES)
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(f"{path}:{1 + data.count(LF, 0, error.start)}: not valid YAML: a byte that is no UTF-8") from None
    return layout_of(Section.of_text(text, path), os.path.splitext(os.path.basename(path))[0])


def layout_of(root: Section, name: str) -> Layout:
    own = root.options(Layout, *SECTIONS)
    values, indices, columns = _values(root.child("values")), _indices(root.child("indices")), _columns(root.child("columns"))
    places = tuple(_place(place) for place in root.list("places"))
    if not places:
        root.fail("places", "is missing; expected a list of places with meshes")
    for listed in root.list("places"):
        if ("neighbours" in listed) != (values.spread_along == LISTED):
            listed.fail("neighbours", "and values.spread: {along: listed} belong together")
    unit_where = _unit(root, own)
    recording = Gaze()
    if "recording" in root:
        if any(place.views == "scored" for place in places):
            root.fail("recording", "is there beside `views: scored`: it is of shapes, whose files are named here")
        recording = read_gaze(root.child("recording"), own["scale"] if "units" in root else None)
    rule = positive_rule(values.positives)
    if rule != ("picks", 0.0) and (columns.flag or any(truth.picks for place in places for truth in place.truth)):
        root.child("values").fail("positives", f"is '{values.positives}', but there are picks: leave one of them out")
    return Layout(name, places, values=values, indices=indices, columns=columns, recording=recording, splits=_splits(root),
                  unit_where=unit_where, **own)


def _values(section: Section) -> Values:
    values = Values(**section.options(Values))
    if "spread" in section:
        _check_spread(section, section.child("spread"), values)
    if values.per == "point" and not values.column:
        section.fail("column", "is missing; values per point stand beside coordinates: expected a column")
    if len(values.points) != 3:
        section.fail("points", "must be three columns, of x, y and z")
    if values.unseen and not is_number(values.unseen.encode()):
        section.fail("unseen", f"is '{values.unseen}', not a number or nan")
    if positive_rule(values.positives) is None:
        section.fail("positives", f"is '{values.positives}', not picks, above mean, or a share such as top 20%")
    return values


def _check_spread(section: Section, spread: Section, values: Values) -> None:
    if "neighbours" not in spread:
        section.fail("spread", "needs neighbours: how many a point adds to")
    if not 1 <= values.spread_neighbours <= MAX_NEIGHBOURS:
        spread.fail("neighbours", f"must be between 1 and {MAX_NEIGHBOURS}, not {values.spread_neighbours}")
    if not 0 < values.spread_from <= 1:
        spread.fail("from", f"must be a share above 0 and at most 1, not {number_text(values.spread_from)}")
    if values.per == "face" or (values.per == "point" and values.spread_along == SURFACE):
        section.fail("spread", f"is there with values per {values.per}, which have no neighbours along {values.spread_along}")


def _indices(section: Section) -> Indices:
    indices = Indices(**section.options(Indices))
    if indices.base not in (0, 1):
        section.fail("base", f"must be between 0 and 1, not {indices.base}")
    return indices


def _columns(section: Section) -> Columns:
    columns = Columns(**section.options(Columns))
    if not columns.position and (columns.density or columns.flag or columns.normal):
        section.fail("position", "is missing; expected the columns of x, y and z")
    for key in ("position", "normal"):
        if len(getattr(columns, key)) not in (0, 3):
            section.fail(key, "must be three columns, of x, y and z")
    return columns


def _place(section: Section) -> Place:
    found = section.options(Place, "truth")
    if "meshes" not in found:
        section.fail("meshes", "is missing; expected a pattern such as Meshes/*")
    place = Place(**found, truth=tuple(_truth(truth) for truth in section.list("truth")))
    saliency = [truth.saliency for truth in place.truth]
    if place.views == "scored" and not all(map(has_views, saliency)):
        section.fail("views", "is 'scored', but saliency has no {view} in its pattern")
    by_person = [*saliency, *(truth.viewers for truth in place.truth)]
    if place.views == "averaged" and any(has_views(one) and has_viewers(one) for one in by_person):
        section.fail("views", "must be 'scored' where saliency or viewers has both {view} and {viewer}: people are told apart in each view")
    return place


def _truth(section: Section) -> TruthPlace:
    truth = TruthPlace(**section.options(TruthPlace))
    saliency, viewers, mask = truth.saliency, truth.viewers, truth.mask
    if not saliency and not truth.picks:
        section.fail("", "names neither saliency nor picks")
    if viewers and not (saliency and has_viewers(viewers) and not has_viewers(saliency) and has_views(viewers) == has_views(saliency)):
        section.fail("viewers", "must have {viewer}, and {view} where saliency has it; saliency must be there, without {viewer}")
    if mask and not one_file_per_item(mask) and ((has_viewers(mask) and not has_viewers(saliency)) or (has_views(mask) and not has_views(saliency))):
        section.fail("mask", f"'{mask}' must have the {{view}} or {{viewer}} that `saliency` has, or none")
    if mask and not saliency:
        section.fail("mask", "is there without saliency: expected a pattern of the files that it masks")
    return truth


def _unit(root: Section, own: dict[str, Any]) -> str:
    """`units: mm`, or `scale: 0.001`: lengths are shown in metres, or in whatever the scale makes of them. Where that is written."""
    if "units" not in root:
        return root.where("scale") if "scale" in root else ""
    if "scale" in root:
        root.fail("scale", "is there beside units: expected one of them")
    name = root.text("units") or ""
    if name not in METRES:
        root.fail("units", f"is '{name}', expected one of {', '.join(METRES)}; or use scale")
    own["scale"] = METRES[name]
    return root.where("units")


def _share(shares: Section, split: str) -> float:
    """"80%" or "0.8"."""
    text = shares.text(split) or ""
    percent = text.endswith("%")
    share = finite_number(text.removesuffix("%"))
    if share is None or not 0 < share <= (100 if percent else 1):
        shares.fail(split, "is not a share of the lines, such as 80% or 0.8")
    return share / 100 if percent else share


def _splits(root: Section) -> Splits:
    if "splits" not in root:
        return Splits()
    section = root.child("splits")
    given = section.options(Splits, "shares", "items")
    if sum(key in section for key in ("file", "list", "items")) != 1:
        root.fail("splits", "must have one of file (a CSV file), list (with shares), or items")
    shares, items = section.child("shares"), section.child("items")
    parts = tuple((name, _share(shares, name)) for name in shares.keys())
    listed = given.get("list", "")
    if bool(listed) != bool(parts) or (listed and abs(sum(share for _, share in parts) - 1) > ROUNDING):
        section.fail("shares", "must name each split's share of the lines of `list`, which sum to 1")
    named = tuple((name, items.words(name), items.where(name)) for name in items.keys())
    splits = Splits(**given, shares=parts, named=named, where=root.where("splits"))
    if not splits:
        section.fail("items", "names no split")
    return splits
