# SPDX-License-Identifier: GPL-3.0-or-later
"""The section `recording` of a description: which files hold people's gaze, and in which columns and units."""

from __future__ import annotations

from dataclasses import replace

from salbench.datasets._layout import METRES, Gaze
from salbench.datasets._section import Section
from salbench.datasets._text import finite_number

KINDS = {"point": "3 columns, of x, y and z", "direction": "3 columns, of x, y and z, or 2, of azimuth and elevation", "pixel": "2 columns, of x and y"}
_WIDTHS = {"point": (3,), "origin": (3,), "direction": (2, 3), "pixel": (2,)}
_BELONG = (("origin", "direction"), ("pixel", "cameras"), ("cameras", "pixel"), ("frame", "pixel"), ("delay_ms", "pixel"), ("valid_is", "valid"))


def read_gaze(section: Section, metres: float | None) -> Gaze:
    """metres: in a unit of the shapes; None: no unit is named."""
    columns = section.child("columns")
    gaze = Gaze(**section.options(Gaze, "length"))
    if not gaze.files:
        section.fail("files", "is missing; expected a pattern such as gaze/{item}_{person}.csv")
    for key in ("item", "person"):
        if (f"{{{key}}}" in gaze.files) == bool(getattr(gaze, key)):
            what = "is there beside" if getattr(gaze, key) else "is missing, and so is"
            columns.fail(key, f"{what} {{{key}}} in `files`: expected one of them")
    kinds = [kind for kind in KINDS if getattr(gaze, kind)]
    if len(kinds) != 1:
        columns.fail("", f"names {' and '.join(kinds) or 'no gaze'}: expected one of {', '.join(KINDS)}")
    for key, widths in _WIDTHS.items():
        if (width := len(getattr(gaze, key))) not in (0, *widths):
            columns.fail(key, f"must be {KINDS.get(key, KINDS['point'])}, not {width}")
    if gaze.direction and not gaze.origin:
        columns.fail("direction", "is there without `origin`, the place of the eye")
    _check_companions(section, columns, gaze)
    if not (gaze.time or gaze.duration):
        columns.fail("time", "is missing; without it, each row needs a `duration`")
    if gaze.valid_is and finite_number(gaze.valid_is) is None:
        section.fail("valid_is", f"is '{gaze.valid_is}', not a finite number")
    return replace(gaze, length=_length(section, metres))


def _check_companions(section: Section, columns: Section, gaze: Gaze) -> None:
    for key, other in _BELONG:
        if getattr(gaze, key) and not getattr(gaze, other) and not (key == "origin" and gaze.point):
            (columns if key in columns else section).fail(key, f"is there without `{other}`")


def _length(section: Section, metres: float | None) -> float:
    """ "mm", of shapes whose unit is named, or a number."""
    text = section.text("length")
    if text is None:
        return 1.0
    if text in METRES:
        if metres is None:
            section.fail("length", f"is '{text}', but the unit of the shapes is not known: add `units`, or give a number that lengths are multiplied by")
        return METRES[text] / metres
    factor = finite_number(text)
    if factor is None or factor <= 0:
        section.fail("length", f"is '{text}', expected one of {', '.join(METRES)}, or a number above 0")
    assert factor is not None
    return factor
