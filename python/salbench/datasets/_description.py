# SPDX-License-Identifier: GPL-3.0-or-later
"""A description in YAML, read and checked: what is wrong is told with file, line and key. docs/data_sets.md says what the keys mean."""

from __future__ import annotations

import os
import re
from collections.abc import Callable
from dataclasses import fields
from typing import TypeVar

from salbench.datasets._cameras import wrong_with_camera
from salbench.datasets._files import read_file
from salbench.datasets._layout import (
    LISTED, SPACE, SURFACE, Cameras, Columns, Indices, Layout, Pattern, Place, Splits, TruthPlace, Values, number_text, positive_rule)
from salbench.datasets._patterns import has_viewers, has_views, one_file_per_item, wrong_with_mesh_pattern, wrong_with_truth_pattern
from salbench.datasets._section import MAX_BYTES, Section
from salbench.datasets._text import finite_number, is_number
from salbench.datasets.records import InputError

KNOWN = ("automatic", "domain", "classes", "ground_truth", "places", "values", "indices", "columns", "splits", "units", "scale", "index",
         "licence")
METRES = {"m": 1.0, "dm": 0.1, "cm": 0.01, "mm": 0.001, "um": 1e-6, "in": 0.0254, "ft": 0.3048}
LF = b"\n"
ROUNDING = 1e-9  # of shares that sum to 1
MAX_NEIGHBOURS = 100_000

Options = TypeVar("Options", Values, Indices, Columns)


def read_description(path: str) -> Layout:
    """The layout that a user's file describes."""
    data = read_file(path, MAX_BYTES)
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(f"{path}:{1 + data.count(LF, 0, error.start)}: not valid YAML: a byte that is no UTF-8") from None
    return layout_of(Section.of_text(text, path), os.path.splitext(os.path.basename(path))[0])


def layout_of(root: Section, name: str) -> Layout:
    root.reject_unknown(KNOWN)
    values, indices, columns = _values(root.child("values")), _indices(root.child("indices")), _columns(root.child("columns"))
    places = tuple(_place(place) for place in root.list("places"))
    index = root.text("index") or ""
    if index and places:
        root.fail("index", "is there beside `places`: a set is in the one form or in files of its own")
    if not places and not index:
        root.fail("places", "is missing; expected a list of places with meshes")
    for listed in root.list("places"):
        if ("neighbours" in listed) != (values.spread_along == LISTED):
            listed.fail("neighbours", "and values.spread: {along: listed} belong together")
    scale, unit_where = _unit(root)
    rule = positive_rule(values.positives)
    if rule != ("picks", 0.0) and (columns.flag or any(truth.picks for place in places for truth in place.truth)):
        root.child("values").fail("positives", f"is '{values.positives}', but there are picks: leave one of them out")
    return Layout(name, places, root.choice("classes", ("none", "folder", "shrec07"), "none"),
                  root.choice("domain", ("any", "meshes", "points"), "any"),
                  root.choice("ground_truth", ("required", "optional"), "required") == "required",
                  values, indices, columns, _splits(root), scale, unit_where, index, root.text("licence") or "")


def _names(options: type[Options]) -> list[str]:
    return [entry.name for entry in fields(options)]


def _above_0(section: Section, key: str, default: float) -> float:
    value = section.number(key, default)
    if value <= 0:
        section.fail(key, f"must be a number above 0, not {number_text(value)}")
    return value


def _words(section: Section, key: str, default: tuple[str, ...]) -> tuple[str, ...]:
    return section.words(key) if key in section else default


def _values(section: Section) -> Values:
    section.reject_unknown([*(name for name in _names(Values) if not name.startswith("spread_")), "spread"])
    new, positives = Values(), section.text("positives")
    spread = section.child("spread")
    spread.reject_unknown(("neighbours", "from", "along"))
    values = Values(section.choice("per", ("vertex", "face", "point"), new.per), section.text("column") or "",
                    _words(section, "points", new.points), _above_0(section, "max_distance", new.max_distance), section.text("unseen") or "",
                    section.text("variable") or "", _above_0(section, "scale", new.scale),
                    new.positives if positives is None else positives,
                    spread.whole("neighbours", 0), spread.number("from", new.spread_from),
                    spread.choice("along", (SPACE, SURFACE, LISTED), new.spread_along))
    if "spread" in section:
        _check_spread(section, spread, values)
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
    section.reject_unknown(_names(Indices))
    indices = Indices(section.whole("base", 0), section.text("variable") or "", section.words("cell"))
    if indices.base not in (0, 1):
        section.fail("base", f"must be between 0 and 1, not {indices.base}")
    if indices.cell and not (len(indices.cell) == 2 and all(re.fullmatch("[1-9][0-9]{0,5}", place) for place in indices.cell)):
        section.fail("cell", "must be a row and a column, from 1, such as [3, 8]")
    return indices


def _columns(section: Section) -> Columns:
    section.reject_unknown(_names(Columns))
    columns = Columns(section.words("position"), section.words("normal"), section.flag("normalise_normals", False),
                      section.choice("padding", ("none", "zeros", "copies", "any"), "none"),
                      section.choice("duplicates", ("kept", "dropped"), "kept"), section.text("density") or "", section.text("flag") or "")
    if not columns.position and (columns.density or columns.flag or columns.normal):
        section.fail("position", "is missing; expected the columns of x, y and z")
    for key in ("position", "normal"):
        if len(getattr(columns, key)) not in (0, 3):
            section.fail(key, "must be three columns, of x, y and z")
    return columns


def _pattern(section: Section, key: str, wrong: Callable[[str], str]) -> Pattern:
    text = section.text(key)
    if text is None:
        return Pattern()
    if what := wrong(text):
        section.fail(key, f"'{text}' {what}")
    return Pattern.at(text, section.where(key))


def _place(section: Section) -> Place:
    section.reject_unknown(("meshes", "needs", "root_is", "truth", "views", "neighbours"))
    meshes = _pattern(section, "meshes", wrong_with_mesh_pattern)
    if not meshes:
        section.fail("meshes", "is missing; expected a pattern such as Meshes/*")
    needs, root_is = section.text("needs") or "", section.text("root_is") or ""
    truths = []
    for truth in section.list("truth"):
        truths.append(_truth(truth))
        if not truths[-1].saliency and not truths[-1].picks:
            section.fail("truth", "names neither saliency nor picks")
    views = section.choice("views", ("averaged", "scored"), "averaged")
    if views == "scored" and not all(has_views(truth.saliency) for truth in truths):
        section.fail("views", "is 'scored', but saliency has no {view} in its pattern")
    if views == "averaged" and any(has_views(truth.saliency) and has_viewers(truth.saliency) for truth in truths):
        section.fail("views", "must be 'scored' where saliency has both {view} and {viewer}: people are told apart in each view")
    neighbours = _pattern(section, "neighbours", lambda text: wrong_with_truth_pattern(text, ()))
    return Place(meshes, tuple(truths), needs, root_is, views, neighbours)


def _truth(section: Section) -> TruthPlace:
    section.reject_unknown(("saliency", "picks", "viewers", "mask", "visible_from", "visible_from_direction"))
    saliency = _pattern(section, "saliency", lambda text: wrong_with_truth_pattern(text, ("{view}", "{viewer}")))
    picks = _pattern(section, "picks", lambda text: wrong_with_truth_pattern(text, ("{participant}",)))

    def wrong_with_mask(text: str) -> str:
        wrong = wrong_with_truth_pattern(text, ("{view}", "{viewer}"))
        if wrong or one_file_per_item(text):
            return wrong
        more = (has_viewers(text) and not has_viewers(saliency)) or (has_views(text) and not has_views(saliency))
        return "must have the {view} or {viewer} that `saliency` has, or none" if more else ""

    viewers = _pattern(section, "viewers", lambda text: wrong_with_truth_pattern(text, ("{view}", "{viewer}")))
    if viewers and not (saliency and has_viewers(viewers) and not has_viewers(saliency) and has_views(viewers) == has_views(saliency)):
        section.fail("viewers", "must have {viewer}, and {view} where saliency has it; saliency must be there, without {viewer}")
    mask = _pattern(section, "mask", wrong_with_mask)
    if mask and not saliency:
        section.fail("mask", "is there without saliency: expected a pattern of the files that it masks")
    place, direction = "visible_from", "visible_from_direction"
    if place in section and direction in section:
        section.fail(direction, "is there beside visible_from: expected one of them")
    key = direction if direction in section else place
    return TruthPlace(saliency, picks, viewers, mask, _cameras(section, key, key == direction) if key in section else Cameras())


def _cameras(section: Section, key: str, at_infinity: bool) -> Cameras:
    """[x, y, z], or these by view, or a file."""

    def camera(of: Section, name: str, words: tuple[str, ...]) -> tuple[float, float, float]:
        numbers = [number for word in words if (number := finite_number(word)) is not None]
        if len(words) != 3 or len(numbers) != 3:
            of.fail(name, "is not three finite numbers [x, y, z], a mapping of views to such, or a CSV file")
        place = numbers[0], numbers[1], numbers[2]
        if wrong := wrong_with_camera(place, at_infinity):
            of.fail(name, f"is no place to look from: {wrong}")
        return place

    where = section.where(key)
    if section.has_mapping(key):
        views = section.child(key)
        by_view = {view: camera(views, view, views.words(view)) for view in views.keys()}
        if not by_view:
            section.fail(key, "names no view")
        return Cameras(by_view, "", at_infinity, where)
    words = section.words(key)
    if len(words) == 1:
        return Cameras({}, words[0], at_infinity, where)
    return Cameras({"": camera(section, key, words)}, "", at_infinity, where)


def _unit(root: Section) -> tuple[float, str]:
    """`units: mm`, or `scale: 0.001`: lengths are shown in metres, or in whatever the scale makes of them."""
    if "units" in root and "scale" in root:
        root.fail("scale", "is there beside units: expected one of them")
    if "units" in root:
        name = root.text("units") or ""
        if name not in METRES:
            root.fail("units", f"is '{name}', expected one of {', '.join(METRES)}; or use scale")
        return METRES[name], root.where("units")
    if "scale" not in root:
        return 1.0, ""
    scale = root.number("scale", 1.0)
    if scale <= 0:
        root.fail("scale", f"must be a number above 0, not {number_text(scale)}")
    return scale, root.where("scale")


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
    section.reject_unknown(("file", "item", "split", "list", "shares", "items"))
    if sum(key in section for key in ("file", "list", "items")) != 1:
        root.fail("splits", "must have one of file (a CSV file), list (with shares), or items")
    shares, items = section.child("shares"), section.child("items")
    parts = tuple((name, _share(shares, name)) for name in shares.keys())
    listed = section.text("list") or ""
    if bool(listed) != bool(parts) or (listed and abs(sum(share for _, share in parts) - 1) > ROUNDING):
        section.fail("shares", "must name each split's share of the lines of `list`, which sum to 1")
    named = tuple((name, items.words(name), items.where(name)) for name in items.keys())
    splits = Splits(section.text("file") or "", section.text("item") or "item", section.text("split") or "split", listed, parts, named,
                    root.where("splits"))
    if not splits:
        section.fail("items", "names no split")
    return splits
