# SPDX-License-Identifier: GPL-3.0-or-later
"""Names of files as a description has them, such as "RawData/{item}_{participant}.pid".

    *              any characters of one name
    {item}         name of the item that the file belongs to
    {participant}  digits
    {view}, {viewer}, {person}  any characters of one name

A name that begins with a dot is hidden and fits no pattern. Extensions may be in upper or lower case. Paths are relative, with '/' between
names. A pattern is matched name by name from the root, each name by an expression of its own.
"""

from __future__ import annotations

import functools
import os
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

from salbench.datasets._files import below, list_folder
from salbench.datasets.records import InputError

STANDS_FOR = {"*": "*", "{item}": "NAME", "{participant}": "NUMBER", "{view}": "VIEW", "{viewer}": "VIEWER", "{person}": "PERSON"}
PARTS = ("{participant}", "{view}", "{viewer}", "{person}")
MAX_PER_NAME = 3  # placeholders; matching tries all their lengths
_GROUPS = {"{participant}": ("part", "[0-9]+"), "{view}": ("part", ".+"), "{viewer}": ("viewer", ".+"), "{person}": ("viewer", ".+")}

_PIECES = re.compile(r"(\*|\{item\}|\{participant\}|\{view\}|\{viewer\}|\{person\})")
_DIGITS = re.compile(rb"([0-9]+)")


@dataclass(frozen=True)
class FoundFile:
    path: str
    item: str  # what {item} stands for; "" if the pattern has none
    part: str  # what {participant} or {view} stands for
    viewer: str = ""  # {viewer}, or {person} of a recording


@dataclass
class FoundFiles:
    fit: list[FoundFile] = field(default_factory=list)  # in natural order of the paths
    left_out: list[str] = field(default_factory=list)  # end as the pattern does, but do not fit it


def natural_order(text: str) -> tuple[list[bytes | tuple[int, bytes]], bytes]:
    """A key that compares runs of digits as numbers: "2" < "10", "1_2" < "1_10". Equal but for leading zeros: by bytes."""
    raw = os.fsencode(text)
    key: list[bytes | tuple[int, bytes]] = []
    pieces = _DIGITS.split(raw)
    for letters, digits in zip(pieces[::2], pieces[1::2]):
        significant = digits.lstrip(b"0")
        key += [letters + b"0", (len(significant), significant)]  # the 0: where digits meet another character, they compare as one
    return [*key, pieces[-1]], raw


def pieces_of(name: str) -> list[str]:
    return [piece for piece in _PIECES.split(name) if piece]


Captured = tuple[str, str, str]  # item, part, viewer


@functools.lru_cache(1 << 12)
def _expression(pattern: str, items: frozenset[str], item: str) -> re.Pattern[str]:
    """Of one name. {item} is what a folder above was, or one of the items, the longest first; anything where there are none."""
    groups = _GROUPS | {"{item}": ("item", "|".join(map(re.escape, sorted(items, key=len, reverse=True))) or ".+")}
    made = ""
    for place, piece in enumerate(pieces_of(pattern)):
        if piece == "{item}" and (item or "(?P<item" in made):
            made += re.escape(item) if item else "(?P=item0)"
        elif piece in groups:
            name, of = groups[piece]
            made += f"(?P<{name}{0 if name == 'item' else place}>{of})"
        else:
            made += ".*" if piece == "*" else re.escape(piece)
    return re.compile(made, re.DOTALL)


def _fits(pattern: str, name: str, items: frozenset[str], captured: Captured) -> Captured | None:
    """What a name that fits captures, each placeholder taking as much as it can: as an item where that is possible, else as anything."""
    for known in (items, frozenset[str]()):
        if fit := _expression(pattern, known, captured[0]).fullmatch(name):
            taken = dict(zip(("item", "part", "viewer"), captured)) | {key.rstrip("0123456789"): text for key, text in fit.groupdict().items()}
            return taken["item"], taken["part"], taken["viewer"]
    return None


def _folders(root: str, pattern: str, items: frozenset[str]) -> list[tuple[str, Captured]]:
    """The folders that files of a pattern may be in, with what their names captured."""
    folders: list[tuple[str, Captured]] = [(root, ("", "", ""))]
    for name in pattern.split("/")[:-1]:
        pieces = pieces_of(name)
        found = []
        for folder, captured in folders:
            if len(pieces) == 1 and pieces[0] not in STANDS_FOR:
                found.append((below(folder, name), captured))
                continue
            for entry, is_folder in list_folder(folder):
                if is_folder and not entry.startswith(".") and (fit := _fits(name, entry, items, captured)):
                    found.append((os.path.join(folder, entry), fit))
        folders = found
    return folders


def files_like(root: str, pattern: str, items: Iterable[str] = ()) -> FoundFiles:
    """Files below the root that fit. {item} is an item wherever the name can be read so, the longest first, and any other text elsewhere.
    Lists folders and reads no file."""
    found = FoundFiles()
    if not pattern:
        return found
    last, known = pattern.split("/")[-1], frozenset(items)
    ending = "" if (end := pieces_of(last)[-1]) in STANDS_FOR else end
    for folder, captured in _folders(root, pattern, known):
        same: dict[str, str] = {}
        for name, is_folder in list_folder(folder):
            if is_folder or name.startswith("."):
                continue
            path, plain = os.path.join(folder, name), _with_extension_of(ending, name)
            if fit := _fits(last, plain, known, captured):
                found.fit.append(FoundFile(path, *fit))
                if ending and same.setdefault(plain, path) != path:
                    raise InputError(f"{same[plain]} and {path} differ by case alone: keep one of them")
            elif ending and plain.endswith(ending):
                found.left_out.append(path)
    found.fit.sort(key=lambda file: natural_order(file.path))
    found.left_out.sort(key=natural_order)
    return found


def _with_extension_of(ending: str, name: str) -> str:
    """The name with its extension as the pattern has it, of which it may be another spelling."""
    wanted = ending[ending.rfind("."):] if "." in ending else ""
    return name[:-len(wanted)] + wanted if wanted and name[-len(wanted):].lower() == wanted.lower() else name


def has_folder_for(root: str, pattern: str) -> bool:
    """True if a folder exists that a file of this pattern could be in."""
    return bool(pattern) and any(os.path.isdir(folder) for folder, _ in _folders(root, pattern, frozenset()))


def one_file_per_item(pattern: str) -> bool:
    return not any(part in pattern for part in PARTS)


def has_viewers(pattern: str) -> bool:
    return "{viewer}" in pattern


def has_views(pattern: str) -> bool:
    return "{view}" in pattern


def filled_in(pattern: str, item: str, view: str, viewer: str) -> str:
    """The pattern with these in place of {item}, {view}, and {viewer} or {person}."""
    return "".join({"{item}": item, "{view}": view, "{viewer}": viewer, "{person}": viewer}.get(piece, piece) for piece in pieces_of(pattern))


def expected_name(pattern: str) -> str:
    """"NAME_NUMBER.pid" for "RawData/{item}_{participant}.pid"."""
    return "".join(STANDS_FOR.get(piece, piece) for piece in pieces_of(pattern.split("/")[-1]))


def place_of(root: str, pattern: str) -> str:
    """The pattern below the root, as a user reads it: its folder if every file in that is wanted."""
    path = below(root, pattern)
    return os.path.dirname(path) if os.path.basename(path) == "*" else path


def _wrong_with(text: str) -> str:
    if not text:
        return "is empty"
    for name in text.split("/"):
        if not name:
            return "must be relative to the folder of the data set, without an empty name in it"
        pieces = pieces_of(name)
        if any(brace in piece for piece in pieces if piece not in STANDS_FOR for brace in "{}"):
            return "has braces around something other than item, participant, view, viewer or person"
        if sum(piece in STANDS_FOR for piece in pieces) > MAX_PER_NAME:
            return f"has more than {MAX_PER_NAME} placeholders in one name"
    return ""


def wrong_with_mesh_pattern(text: str) -> str:
    """"" for a pattern of meshes, which has no placeholder but *."""
    return "must have * where the names of meshes differ, and no braces" if "{" in text else _wrong_with(text)


def wrong_with_truth_pattern(text: str, parts: Sequence[str]) -> str:
    """"" for a pattern of files that belong to items, which may have some of `parts`. It has {item}, unless that is one of these."""
    if wrong := _wrong_with(text):
        return wrong
    if "{item}" not in text and "{item}" not in parts:
        return "must have {item} in place of the name of the item"
    return next((f"cannot have {part} here" for part in PARTS if part in text and part not in parts), "")
