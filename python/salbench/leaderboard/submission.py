# SPDX-License-Identifier: GPL-3.0-or-later
"""A submission: one ZIP archive with the maps of a model, its card, and the protocol that its scores were
made by.

Archives come from anybody. What is read of one is bounded by what the data set needs, and no name from an
archive becomes that of a file.
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
# bytes and entries of an archive of data that is not known yet
_MOST_UNKNOWN, _MOST_UNKNOWN_ENTRIES = 1 << 30, 1 << 17
Maps = Mapping[str, NDArray[np.float64]]  # by the name of the shape


@dataclass(frozen=True)
class Submission:
    card: Card = Card()  # with the items that its list of training shapes has, and the digest of that
    manifest: Manifest = Manifest()
    results: str = ""  # results.csv as it came
    maps: Maps = field(default_factory=dict)
    # maps of further trainings, by the name of the training
    seeds: Mapping[str, Maps] = field(default_factory=dict)
    options: bytes = b""  # entry of the model in a configuration, where the program made the maps


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
    """The map in a file .npy of float32 or float64: (n), (n, 1) or (1, n)."""
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


# Options that 1.x wrote and no score depends on any more: submissions of format 2 have them.
_WITHOUT_SCORES = re.compile(r"^fitting:\n(?:  .*\n)*|^  twins: refuse\n", re.MULTILINE)


def protocol_of(configuration: bytes) -> str:
    """The protocol as this version writes it. Throws InputError for what is more, or none."""
    name = "configuration.yaml"
    text = plain_text(configuration, name, texts.LONGEST_TEXT)
    if "models" in {line.partition(":")[0] for line in text.splitlines()}:
        raise InputError(f"{name} has models, expected the protocol alone")
    try:
        return _core.protocol(_WITHOUT_SCORES.sub("", text), name)
    except ValueError as error:  # which may repeat what stands there
        raise InputError(" ".join(texts.shown(str(error)).split())[:300]) from None


def _check_protocol(configuration: bytes, manifest: Manifest, expected: Expected) -> None:
    if _core.digest(configuration) != manifest.configuration:
        raise InputError("configuration.yaml is not what submission.yaml has the digest of")
    # another version of the program may write further options, at their defaults
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
    """Takes the maps of a folder out of the files."""
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
    """Reads and checks an archive from anybody. Throws InputError for an archive that a leaderboard
    refuses."""
    files = read_zip(data, expected.most_entries, expected.most_bytes)
    for name in NAMES:
        if name not in files:
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
    """Reads an archive from anybody, and puts its maps into a file below the folder `scratch`: maps of
    many archives take more memory than there is. Throws InputError for an archive that a leaderboard
    refuses."""
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
    """The protocol of an archive from anybody, before the data that it is of are known. Throws InputError."""
    with _named(path):
        data = read_file(path, _MOST_UNKNOWN, "it is more than is read of an archive of unknown data")
        files = read_zip(data, _MOST_UNKNOWN_ENTRIES, _MOST_UNKNOWN, only="configuration.yaml")
        if not files:
            raise InputError("has no configuration.yaml")
        return protocol_of(files["configuration.yaml"])


@contextlib.contextmanager
def _named(path: Path) -> Iterator[None]:
    """Errors begin with the name of the archive. A defect that it leads to is one of them: the others are
    still read."""
    try:
        yield
    except StorageError:
        raise
    except Exception as error:
        raise InputError(f"{path}: {texts.shown(message(error).removeprefix(f'{path}: '))}") from None
