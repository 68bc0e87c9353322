# SPDX-License-Identifier: GPL-3.0-or-later
"""A submission: one ZIP archive with the maps of a model, its card, and the protocol of its scores.

Archives are untrusted: reading is bounded by the needs of the data set, and no name from an archive becomes a
file name.
"""

import contextlib
import io
import itertools
import os
import re
import tempfile
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from types import MappingProxyType

import numpy as np

from salbench import _core
from salbench.leaderboard import origin, texts
from salbench.leaderboard.archive import read_zip, zip_of
from salbench.leaderboard.card import Card, read_card
from salbench.leaderboard.expected import NAMES, OPTIONAL, Expected, trained_on
from salbench.leaderboard.texts import Manifest
from salbench.system.errors import InputError, StorageError, message, quoted
from salbench.system.files import read_file, stored
from salbench.system.npy import read_npy
from salbench.system.types import NDArray
from salbench.system.yaml import plain_text

_OVERHEAD = 1 << 20  # bytes of an archive: its directory, and headers
# bounds on bytes and entries while the data are unknown
_MOST_UNKNOWN, _MOST_UNKNOWN_ENTRIES = 1 << 30, 1 << 17
Maps = Mapping[str, NDArray[np.float64]]  # by shape name


@dataclass(frozen=True)
class Submission:
    card: Card = Card()  # with the items on its list of training shapes, and the digest of the list
    manifest: Manifest = Manifest()
    results: str = ""  # results.csv as submitted
    maps: Maps = field(default_factory=dict)
    # maps of further trainings, by training
    seeds: Mapping[str, Maps] = field(default_factory=dict)
    options: bytes = b""  # entry of the model in a configuration, if the program made the maps


def archive_of(
    card: bytes,
    manifest: Manifest,
    configuration: str,
    results: bytes,
    maps: Maps,
    trained_on: bytes | None = None,
    options: str = "",
    seeds: Mapping[str, Maps] = MappingProxyType({}),
) -> bytes:
    entries = [*zip(NAMES, (manifest.text().encode(), card, configuration.encode(), results))]
    entries += [] if trained_on is None else [(texts.LIST, trained_on)]
    entries += [(texts.MODEL, options.encode())] if options else []
    for folder, in_folder in {
        "maps": maps,
        **{f"seeds/{seed}": maps for seed, maps in seeds.items()},
    }.items():
        entries += [
            (f"{folder}/{item}.npy", npy_of(in_folder[item])) for item in sorted(in_folder, key=os.fsencode)
        ]
    return zip_of(entries)


def npy_of(values: NDArray[np.float64]) -> bytes:
    made = io.BytesIO()
    np.save(made, np.ascontiguousarray(values, dtype="<f8"), allow_pickle=False)
    return made.getvalue()


# --- read, where nothing is trusted -------------------------------------------------------------------------


def map_of(data: bytes, name: str, points: int) -> NDArray[np.float64]:
    """Reads a map from .npy data in float32 or float64: (n), (n, 1) or (1, n)."""
    try:
        values = (
            read_npy(data, ("<f8", "<f4"), "neither float32 nor float64, little-endian")
            .astype(np.float64, copy=False)
            .ravel()
        )
    except InputError as error:
        raise InputError(f"{name}: not a .npy file that can be read: {error}") from None
    if len(values) != points:
        raise InputError(f"{name}: {len(values)} values, but the shape has {points} points")
    for bad in np.flatnonzero(~np.isfinite(values))[:1]:
        raise InputError(f"{name}: value {bad} (0-based) is {values[bad]}, expected a finite number")
    return values


# Options of 1.x without effect on scores; submissions of format 2 have them.
_WITHOUT_SCORES = re.compile(r"^fitting:\n(?:  .*\n)*|^  twins: refuse\n", re.MULTILINE)


def protocol_of(configuration: bytes) -> str:
    """The protocol as this version writes it. Throws InputError for other content."""
    name = "configuration.yaml"
    text = plain_text(configuration, name, texts.LONGEST_TEXT)
    if "models" in {line.partition(":")[0] for line in text.splitlines()}:
        raise InputError(f"{name} has models, expected the protocol alone")
    try:
        return _core.protocol(_WITHOUT_SCORES.sub("", text), name)
    except ValueError as error:  # the message may quote untrusted text
        raise InputError(" ".join(texts.shown(str(error)).split())[:300]) from None


def _check_protocol(configuration: bytes, manifest: Manifest, expected: Expected) -> None:
    if _core.digest(configuration) != manifest.configuration:
        raise InputError("configuration.yaml is not what submission.yaml has the digest of")
    # other versions of the program may write further options, at their defaults
    is_same = configuration == expected.protocol.encode()
    text = expected.protocol if is_same else protocol_of(configuration)
    for mine, other in itertools.zip_longest(expected.protocol.splitlines(), text.splitlines(), fillvalue=""):
        if mine != other:
            raise InputError(f"another protocol: it has {quoted(other)}, the leaderboard {quoted(mine)}")
    if manifest.data != expected.data:
        raise InputError(f"other data: their digest is {quoted(manifest.data)}, expected {expected.data}")


def _check_options(options: bytes, manifest: Manifest, card: Card) -> None:
    if manifest.model != (_core.digest(options) if options else ""):
        raise InputError(
            f"{texts.MODEL} is not what submission.yaml has the digest of"
            if options
            else f"has no {texts.MODEL}, of which submission.yaml has the digest"
        )
    images = re.findall("@(sha256:[0-9a-f]{64})", plain_text(options, texts.MODEL, texts.LONGEST_TEXT))
    if images and card.container not in ("", "none") and card.container.partition("@")[2] not in images:
        raise InputError(
            f"card.yaml: container is {quoted(card.container)}, and the command runs another image:"
            f" {images[0]}"
        )


def _maps_in(folder: str, files: dict[str, bytes], expected: Expected) -> Maps:
    """Moves the maps of a folder out of `files`."""
    missing = [item for item in expected.points if f"{folder}/{item}.npy" not in files]
    if missing:
        of_seed = "" if folder == "maps" else f"{folder} "
        raise InputError(
            f"{of_seed}has no map of {len(missing)} of {len(expected.points)} items, such as {missing[0]}"
        )
    return {
        item: map_of(files.pop(name := f"{folder}/{item}.npy"), name, n)
        for item, n in expected.points.items()
    }


def checked(data: bytes, expected: Expected) -> Submission:
    """Reads and checks an untrusted archive. Throws InputError for an archive that a leaderboard refuses."""
    files = read_zip(data, expected.most_entries, expected.most_bytes)
    for name in NAMES:
        if name not in files:
            if any(file.endswith(f"/{name}") for file in files):
                raise InputError("has a folder around its files: send the file that salbench submit wrote")
            raise InputError(f"has no {name}")
    manifest, card = texts.read_manifest(files["submission.yaml"]), read_card(files["card.yaml"], "card.yaml")
    _check_protocol(files["configuration.yaml"], manifest, expected)
    for item in card.test_overlap:
        if item not in expected.items:
            raise InputError(
                f"card.yaml: test_overlap has {quoted(item)}, but there is no such item with ground truth;"
                " leave it out"
            )
    options, names = files.get(texts.MODEL, b""), files.get(texts.LIST)
    _check_options(options, manifest, card)
    seen = trained_on(card, names, manifest.trained_on, expected) - set(card.test_overlap)
    maps = _maps_in("maps", files, expected)
    seeds = {seed: _maps_in(f"seeds/{seed}", files, expected) for seed in card.seeds}
    for name in files:
        if name not in (*NAMES, *OPTIONAL):
            why = (
                ": there is no such item with ground truth, or card.yaml has no such seed"
                if name.endswith(".npy")
                else ""
            )
            raise InputError(f"the file {quoted(name)} is no part of a submission{why}")
    if manifest.map_digest and origin.digest_of(maps) != manifest.map_digest:
        raise InputError("the maps are not what submission.yaml has the digest of")
    card = replace(
        card,
        test_overlap=(*card.test_overlap, *(item for item in expected.items if item in seen)),
        trained_on=card.trained_on if names is None else (*card.trained_on, manifest.trained_on),
    )
    return Submission(
        card, manifest, files["results.csv"].decode("utf-8", "surrogateescape"), maps, seeds, options
    )


def read(path: Path, expected: Expected, scratch: str) -> Submission:
    """Reads an untrusted archive, and moves its maps into a file below the folder `scratch`, since maps of
    many archives do not fit into memory. Throws InputError for an archive that a leaderboard refuses."""
    with _named(path):
        found = checked(
            read_file(path, expected.most_bytes + _OVERHEAD, "it is more than its shapes need"), expected
        )
        trainings = [found.maps, *found.seeds.values()]
        with stored(scratch, "set TMPDIR to another"), tempfile.TemporaryFile(dir=scratch) as file:
            for values in (maps[shape] for maps in trainings for shape in expected.points):
                file.write(values.data)
            file.flush()
            rows = np.memmap(file, np.float64, "r").reshape(len(trainings), -1)
        ends = np.cumsum([*expected.points.values()])[:-1]
        maps, *others = (dict(zip(expected.points, np.split(row, ends))) for row in rows)
        return replace(found, maps=maps, seeds=dict(zip(found.seeds, others)))


def protocol_in(path: Path) -> str:
    """Protocol of an untrusted archive, before its data are known. Throws InputError."""
    with _named(path):
        data = read_file(path, _MOST_UNKNOWN, "it is more than is read of an archive of unknown data")
        files = read_zip(data, _MOST_UNKNOWN_ENTRIES, _MOST_UNKNOWN, only="configuration.yaml")
        if not files:
            raise InputError("has no configuration.yaml")
        return protocol_of(files["configuration.yaml"])


@contextlib.contextmanager
def _named(path: Path) -> Iterator[None]:
    """Prefixes errors with the name of the archive. Unexpected exceptions count as errors of this archive, so
    that others are still read."""
    try:
        yield
    except StorageError:
        raise
    except Exception as error:
        raise InputError(f"{path}: {texts.shown(message(error).removeprefix(f'{path}: '))}") from None
