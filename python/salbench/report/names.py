# SPDX-License-Identifier: GPL-3.0-or-later
"""Names of models in figures, and of files and items."""

import hashlib
import re
from collections.abc import Iterable
from os.path import commonprefix

LONGEST = 24  # characters of a name that is shown whole
_BESIDE = 12  # characters that leave room for panels side by side


def cut(name: str) -> str:
    """Shortens a name to its beginning and end, which mostly distinguish variants."""
    return name if len(name) <= LONGEST else f"{name[:LONGEST // 2]}…{name[1 - LONGEST // 2:]}"


def short(models: Iterable[str]) -> dict[str, str]:
    """Shortened names of models, by name. Those that would be equal lose the beginning that they share; if
    that does not tell them apart, all names stay whole."""
    alike: dict[str, list[str]] = {}
    for name in dict.fromkeys(models):
        alike.setdefault(cut(name), []).append(name)
    found: dict[str, str] = {}
    for same, group in alike.items():
        shared = min(len(commonprefix(group)), min(map(len, group)) - LONGEST // 2)
        found |= {name: cut(f"…{name[shared:]}") if len(group) > 1 else same for name in group}
    return found if len(set(found.values())) == len(found) else {name: name for name in found}


def panel_rows(models: Iterable[str], panels: int) -> int:
    """Number of rows in a figure of panels that name models at their left: one, or one per panel."""
    return panels if max((len(cut(model)) for model in models), default=0) > _BESIDE else 1


def natural(name: str) -> list[tuple[int, int, str]]:
    """Sort key: item 9 before item 10."""
    return [
        (0, int(part), "") if part.isdecimal() else (1, 0, part)
        for part in re.split(r"(\d+)", str(name))
        if part
    ]


# reserved on Windows with any extension
_DEVICES = re.compile(r"(con|prn|aux|nul|com\d|lpt\d)(\.|$)", re.IGNORECASE)
_LONGEST = 200  # file systems allow 255 bytes: leaves room for extensions and for the names of pictures


def _escaped(pattern: str, text: str) -> str:
    return re.sub(pattern, lambda match: f"+{ord(match[0]):x}+", text)


def file_name(name: str, with_capitals: bool = True) -> str:
    """A file name for any item, one-to-one: every character except letters, digits and ".-_" becomes its code
    between +, and so do a "." at either end and the first letter of a device's name. Long names end with a
    digest."""
    text = _escaped(r"[^A-Za-z0-9._-]" if with_capitals else r"[^a-z0-9._-]", str(name))
    text = _escaped(r"^\.|\.$", text) or "+"
    if _DEVICES.match(text):
        text = _escaped("^.", text)
    if len(text) > _LONGEST:
        text = f"{text[:_LONGEST - 33]}~{hashlib.md5(str(name).encode('utf-8', 'surrogatepass')).hexdigest()}"
    return text


def file_names(names: Iterable[str]) -> dict[str, str]:
    """Maps names to file names that differ even without case, as on macOS and Windows: capitals become their
    codes in names that would collide."""
    alike: dict[str, list[str]] = {}
    for name in dict.fromkeys(names):
        alike.setdefault(file_name(name).lower(), []).append(name)
    return {
        name: file_name(name, with_capitals=len(group) == 1) for group in alike.values() for name in group
    }


def shape_name(item: str, view: str = "") -> str:
    """Name of an item as in the program: mesh "52", its scan 3 "52_3"."""
    return f"{item}_{view}" if view != "" else str(item)
