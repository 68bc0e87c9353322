# SPDX-License-Identifier: GPL-3.0-or-later
"""Files below the folder of a data set, found by patterns of their names. A listing opens no shape, and
this imports no NumPy."""

from __future__ import annotations

import os
import re
from collections.abc import Collection, Iterable, Sequence
from typing import NamedTuple

from salbench.system.errors import InputError
from salbench.system.files import AnyPath, fail, read_file as read_file

MESHES, CLOUDS = (".off", ".obj", ".ply"), (".ply", ".pcd", ".xyz")
HEADER_BYTES = 1 << 16  # of a .ply file, more than its header ever has

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
    """A file that fits a pattern, and the text that its placeholders stand for; "" where the pattern has
    none."""

    path: str
    item: str = ""
    view: str = ""
    viewer: str = ""  # or {person}


def match(root: AnyPath, pattern: str, names: Collection[str] = ()) -> list[Match]:
    """Files below `root` that fit a pattern such as "RawData/{item}_{participant}.pid", in natural order.

    `*` stands for any part of one name, {participant} for digits, {view}, {viewer} and {person} for any part,
    and {item} for one of `names`, the longest that fits; without names for any part. Extensions may be in
    upper or lower case. Hidden files and folders never fit.
    """
    stem, ending = os.path.splitext(pattern)
    if _PIECES.search(ending):
        stem, ending = pattern, ""
    item = f"(?P<item>{'|'.join(map(re.escape, sorted(names, key=len, reverse=True))) or '[^/]+'})"
    made = ""
    for piece in _PIECES.split(stem):
        if piece == "{item}":  # a second one is that of the folder above
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
    """Files as deep below the root as the pattern, with their names as it has them. A folder that it names
    is entered, and not looked for."""
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
    """The number of the first of these patterns that fits meshes or point clouds, and these: names, which
    are those of their files without extension, and paths, in natural order."""
    folder = os.fspath(root)
    if not os.path.isdir(folder):
        raise InputError(f"{folder}: there is no such folder")
    for number, pattern in enumerate(patterns):
        found = [
            Match(one.path, stem(one.path))
            for one in match(root, pattern)
            if extension(one.path) in (*MESHES, *CLOUDS, extension(pattern))
        ]
        if found:
            return number, by_name(sorted(found, key=lambda one: natural_order(one.item)))
    looked_in = ", ".join(sorted({below(folder, pattern.removesuffix("/*")) for pattern in patterns}))
    raise InputError(
        f"{folder}: no .off, .obj or .ply meshes found, and no .ply, .pcd or .xyz point clouds; looked in"
        f" {looked_in}"
    )


def by_name(matches: Iterable[Match]) -> dict[str, str]:
    """The file of each item, which must be one."""
    found: dict[str, str] = {}
    for one in matches:
        if found.setdefault(one.item, one.path) != one.path:
            raise InputError(
                f"{found[one.item]} and {one.path} have the same name: rename or remove one of them"
            )
    return found


def left_over(root: AnyPath, pattern: str, used: Iterable[str]) -> list[str]:
    """A note on each file that fits and that no item has, as one with a misspelt name."""
    taken = {*used}
    return [
        f"{one.path}: belongs to no item and was left out"
        for one in match(root, pattern)
        if one.path not in taken
    ]


def natural_order(text: str) -> tuple[list[bytes | tuple[int, bytes]], bytes]:
    """A key that compares runs of digits as numbers: "2" < "10", "1_2" < "1_10". Equal but for leading
    zeros: by bytes."""
    raw = os.fsencode(text)
    key: list[bytes | tuple[int, bytes]] = []
    pieces = _DIGITS.split(raw)
    for letters, digits in zip(pieces[::2], pieces[1::2]):
        significant = digits.lstrip(b"0")
        # the 0: where digits meet another character, they compare as one
        key += [letters + b"0", (len(significant), significant)]
    return [*key, pieces[-1]], raw


def kind_of(path: str) -> str:
    """ "cloud" or "mesh", by the extension; a .ply is a cloud if its header announces no faces. One that
    cannot be read may have some."""
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
    """True of a file; a folder that cannot be looked into is an error."""
    try:
        os.stat(path)
    except (FileNotFoundError, NotADirectoryError):
        return False
    except OSError as error:
        fail(path, "looked at", error)
    return True


def list_folder(folder: str) -> list[tuple[str, bool]]:
    """Names in a folder, and whether they are folders, in the order of their bytes; nothing if it is
    missing."""
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
    """In lower case, with its dot."""
    return os.path.splitext(path)[1].lower()


def stem(path: str) -> str:
    return os.path.splitext(os.path.basename(path))[0]


def is_name(word: str) -> bool:
    """True of what a file or a group can be called, which leads nowhere else."""
    return word not in ("", ".", "..") and not {"/", "\0"} & set(word)
