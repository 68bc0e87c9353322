# SPDX-License-Identifier: GPL-3.0-or-later
"""Files below the folder of a data set, found by name patterns. Opens no shapes and imports no NumPy."""

from __future__ import annotations

import os
import re
from collections.abc import Collection, Iterable, Sequence
from typing import NamedTuple

from salbench.system.errors import InputError, quoted
from salbench.system.files import AnyPath, fail, read_file as read_file

MESHES, CLOUDS = (".off", ".obj", ".ply"), (".ply", ".pcd", ".xyz")
HEADER_BYTES = 1 << 16  # of a .ply file; longer than any header

_PLACEHOLDERS = {
    "*": "[^/]*",
    "{item}": "",
    "{participant}": "[0-9]+",
    "{view}": "(?P<view>[^/]+)",
    "{viewer}": "(?P<viewer>[^/]+)",
    "{person}": "(?P<viewer>[^/]+)",
}
_PIECES = re.compile("(" + "|".join(map(re.escape, _PLACEHOLDERS)) + ")")
_DIGITS = re.compile(rb"([0-9]+)")
_FACES = re.compile(rb"^(element[ \t]+face[ \t]+0*[1-9]|element[ \t]+tristrips[ \t])", re.MULTILINE)


class Match(NamedTuple):
    """A file that matches a pattern, and the text of each placeholder; "" for placeholders that the pattern
    lacks."""

    path: str
    item: str = ""
    view: str = ""
    viewer: str = ""  # also for {person}


def match(root: AnyPath, pattern: str, names: Collection[str] = ()) -> list[Match]:
    """Files below `root` that match a pattern such as "RawData/{item}_{participant}.pid", in natural order.

    `*` matches any part of one name, {participant} digits, {view}, {viewer} and {person} any part, and {item}
    the longest of `names` that fits, or any part if there are no names. Extensions match in upper and lower
    case. Hidden files and folders never match. Throws InputError for other words in braces.
    """
    for word in re.findall("{[A-Za-z_]+}", pattern):
        if word not in _PLACEHOLDERS:
            raise InputError(
                f"the pattern {quoted(pattern)} has {word}, expected some of {', '.join(_PLACEHOLDERS)}"
            )
    stem, ending = os.path.splitext(pattern)
    if _PIECES.search(ending):
        stem, ending = pattern, ""
    item = f"(?P<item>{'|'.join(map(re.escape, sorted(names, key=len, reverse=True))) or '[^/]+'})"
    made = ""
    for piece in _PIECES.split(stem):
        if piece == "{item}":  # a second {item} repeats the first
            made += "(?P=item)" if item in made else item
        else:
            made += _PLACEHOLDERS.get(piece, re.escape(piece))
    fits = re.compile(f"{made}(?i:{re.escape(ending)})", re.DOTALL).fullmatch
    found = [
        Match(path, **fit.groupdict())
        for path, name in _candidates(os.fspath(root), pattern)
        if (fit := fits(name))
    ]
    return sorted(found, key=lambda one: natural_order(one.path))


def _candidates(root: str, pattern: str) -> list[tuple[str, str]]:
    """Files at the depth of the pattern, with the names that they have there. Folders that the pattern names
    literally are opened without a listing."""
    places = [(root, "")]
    for depth, name in enumerate(names := pattern.split("/"), 1):
        if depth < len(names) and not _PIECES.search(name):
            places = [(below(path, name), f"{text}{name}/") for path, text in places]
        else:
            places = [
                (os.path.join(path, entry), f"{text}{entry}{'/' * is_folder}")
                for path, text in places
                for entry, is_folder in list_folder(path)
                if is_folder == (depth < len(names)) and not entry.startswith(".")
            ]
    return places


def first(root: AnyPath, patterns: Sequence[str]) -> tuple[int, dict[str, str]]:
    """Finds the first pattern that matches meshes or point clouds. Returns its index, and names (file names
    without extension) with paths, in natural order."""
    folder = os.fspath(root)
    if not os.path.isdir(folder):
        if os.path.exists(folder):
            raise InputError(f"{folder}: is a file, where a folder is expected")
        start = "" if os.path.isabs(folder) else f" in {os.getcwd()}"
        raise InputError(f"{folder}: there is no such folder{start}")
    for number, pattern in enumerate(patterns):
        found = [
            Match(one.path, stem(one.path))
            for one in match(root, pattern)
            if extension(one.path) in {*MESHES, *CLOUDS, extension(pattern)} - {""}
        ]
        if found:
            return number, by_name(sorted(found, key=lambda one: natural_order(one.item)))
    looked_in = ", ".join(sorted({below(folder, pattern.removesuffix("/*")) for pattern in patterns}))
    raise InputError(
        f"{folder}: no .off, .obj or .ply meshes found, and no .ply, .pcd or .xyz point clouds; looked in"
        f" {looked_in}"
    )


def by_name(matches: Iterable[Match]) -> dict[str, str]:
    """Maps each item to its only file."""
    found: dict[str, str] = {}
    for one in matches:
        if found.setdefault(one.item, one.path) != one.path:
            raise InputError(
                f"{found[one.item]} and {one.path} have the same name: rename or remove one of them"
            )
    return found


def left_over(root: AnyPath, pattern: str, used: Iterable[str]) -> list[str]:
    """Notes on files that match but belong to no item, such as misspelt names."""
    taken = {*used}
    return [
        f"{one.path}: belongs to no item and was left out"
        for one in match(root, pattern)
        if one.path not in taken
    ]


def natural_order(text: str) -> tuple[list[bytes | tuple[int, bytes]], bytes]:
    """Sort key that compares runs of digits as numbers: "2" < "10", "1_2" < "1_10". Ties, such as leading
    zeros: by bytes."""
    raw = os.fsencode(text)
    key: list[bytes | tuple[int, bytes]] = []
    pieces = _DIGITS.split(raw)
    for letters, digits in zip(pieces[::2], pieces[1::2]):
        significant = digits.lstrip(b"0")
        # the 0 compares digits with other characters as one character
        key += [letters + b"0", (len(significant), significant)]
    return [*key, pieces[-1]], raw


def kind_of(path: str) -> str:
    """ "cloud" or "mesh", by extension; a .ply is a cloud if its header announces no faces. Unreadable files
    count as meshes."""
    kind, header = extension(path), b""
    if kind == ".ply" and os.path.isfile(path) and os.access(path, os.R_OK):
        with open(path, "rb") as file:
            header = file.read(HEADER_BYTES).replace(b"\r", b"\n")
    is_points = (
        header.startswith(b"ply")
        and b"end_header" in header
        and not _FACES.search(header.partition(b"end_header")[0])
    )
    return "mesh" if kind in MESHES and not is_points else "cloud"


def exists(path: str) -> bool:
    """True if the path is a file. A folder without permission is an error."""
    try:
        os.stat(path)
    except (FileNotFoundError, NotADirectoryError):
        return False
    except OSError as error:
        fail(path, "looked at", error)
    return True


def list_folder(folder: str) -> list[tuple[str, bool]]:
    """Names in a folder, each with True if it is a folder, in byte order; empty if the folder is missing."""
    try:
        with os.scandir(folder) as entries:
            return sorted(
                ((entry.name, entry.is_dir()) for entry in entries), key=lambda entry: os.fsencode(entry[0])
            )
    except (FileNotFoundError, NotADirectoryError):
        return []
    except OSError as error:
        fail(folder, "listed", error)


def below(root: str, path: str) -> str:
    return os.path.normpath(os.path.join(root, path))


def extension(path: str) -> str:
    """Extension in lower case, with its dot."""
    return os.path.splitext(path)[1].lower()


def stem(path: str) -> str:
    return os.path.splitext(os.path.basename(path))[0]


def is_name(word: str) -> bool:
    """True if a file or a group can have this name: a single component that leads nowhere else."""
    return word not in ("", ".", "..") and not {"/", "\0"} & set(word)
