# SPDX-License-Identifier: GPL-3.0-or-later
"""A submission: one ZIP archive with the maps of a model, its card, and the protocol that its scores were made by.

Archives of strangers are read by the pool of workers, which bounds time and memory. A worker writes the values of the maps to a scratch file: no
name from an archive becomes that of a file.
"""

import io
import itertools
import os
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np

from salbench import _core
from salbench.leaderboard import origin, texts, training
from salbench.leaderboard.archive import read_zip, zip_of
from salbench.leaderboard.card import Card, read_card
from salbench.leaderboard.expected import NAMES, OPTIONAL, Expected
from salbench.leaderboard.texts import Manifest
from salbench.system.errors import InputError, StorageError, quoted
from salbench.system.files import read_file
from salbench.system.npy import read_npy
from salbench.system.types import NDArray
from salbench.system.workers import Question, ask_all, asked
from salbench.system.yaml import plain_text

_OVERHEAD = 1 << 20  # bytes of an archive: its directory, and headers
_MOST_UNKNOWN, _MOST_UNKNOWN_ENTRIES = 1 << 30, 1 << 17  # bytes and entries of an archive of data that is not known yet
Maps = Mapping[str, NDArray[np.float64]]  # by the name of the shape


@dataclass(frozen=True)
class Submission:
    card: Card  # with the items that its list of training shapes has, and the digest of that
    manifest: Manifest
    results: str  # results.csv as it came
    maps: Maps
    seeds: Mapping[str, Maps]  # maps of further trainings, by the name of the training
    options: bytes = b""  # entry of the model in a configuration, where the program made the maps


def archive_of(card: bytes, manifest: Manifest, configuration: str, results: bytes, maps: Maps, trained_on: bytes | None = None, options: str = "",
               seeds: Mapping[str, Maps] = MappingProxyType({})) -> bytes:
    entries = [*zip(NAMES, (manifest.text().encode(), card, configuration.encode(), results))]
    entries += [] if trained_on is None else [(texts.LIST, trained_on)]
    entries += [(texts.MODEL, options.encode())] if options else []
    folders = {"maps": maps, **{f"seeds/{seed}": values for seed, values in seeds.items()}}
    return zip_of([*entries, *((f"{folder}/{item}.npy", npy_of(values)) for folder, in_folder in folders.items()
                               for item, values in sorted(in_folder.items(), key=lambda row: os.fsencode(row[0])))])


def npy_of(values: NDArray[np.float64]) -> bytes:
    made = io.BytesIO()
    np.save(made, np.ascontiguousarray(values, dtype="<f8"), allow_pickle=False)
    return made.getvalue()


# --- read, where nothing is trusted -----------------------------------------------------------------------------------------------------------


def map_of(data: bytes, name: str, points: int) -> NDArray[np.float64]:
    """The map in a file .npy of float32 or float64: (n), (n, 1) or (1, n)."""
    try:
        values = read_npy(data, ("<f8", "<f4"), "neither float32 nor float64, little-endian").astype(np.float64).ravel()
    except InputError as error:
        raise InputError(f"{name}: not a .npy file that can be read: {error}") from None
    if len(values) != points:
        raise InputError(f"{name}: {len(values)} values, but the shape has {points} points")
    for bad in np.flatnonzero(~np.isfinite(values))[:1]:
        raise InputError(f"{name}: value {bad} (0-based) is {values[bad]}, expected a finite number")
    return values


# Options that 1.x wrote and no score depends on any more: submissions of format 2 have them.
_WITHOUT_SCORES = re.compile(r"^fitting:\n(?:  .*\n)*|^  twins: refuse\n", re.MULTILINE)


def protocol_of(configuration: bytes, name: str) -> str:
    """The protocol as this version writes it. Throws InputError for what is more, or none."""
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
    is_same = configuration == expected.protocol.encode()  # another version of the program may write further options, at their defaults
    text = expected.protocol if is_same else protocol_of(configuration, "configuration.yaml")
    for mine, other in itertools.zip_longest(expected.protocol.splitlines(), text.splitlines(), fillvalue=""):
        if mine != other:
            raise InputError(f"another protocol: it has {quoted(other)}, the leaderboard {quoted(mine)}")
    if manifest.data != expected.data:
        raise InputError(f"other data: their digest is {quoted(manifest.data)}, expected {expected.data}")


def _check_options(options: bytes, manifest: Manifest, card: Card) -> None:
    if manifest.model != (_core.digest(options) if options else ""):
        raise InputError(f"{texts.MODEL} is not what submission.yaml has the digest of" if options else
                         f"has no {texts.MODEL}, of which submission.yaml has the digest")
    images = re.findall("@(sha256:[0-9a-f]{64})", plain_text(options, texts.MODEL, texts.LONGEST_TEXT))
    if images and card.container not in ("", "none") and card.container.partition("@")[2] not in images:
        raise InputError(f"card.yaml: container is {quoted(card.container)}, and the command runs another image: {images[0]}")


def _maps_in(folder: str, files: dict[str, bytes], expected: Expected) -> Maps:
    """Takes the maps of a folder out of the files."""
    missing = [item for item in expected.points if f"{folder}/{item}.npy" not in files]
    if missing:
        of_seed = "" if folder == "maps" else f"{folder} "
        raise InputError(f"{of_seed}has no map of {len(missing)} of {len(expected.points)} items, such as {missing[0]}")
    return {item: map_of(files.pop(name := f"{folder}/{item}.npy"), name, n) for item, n in expected.points.items()}


def checked(data: bytes, expected: Expected) -> Submission:
    """What is in an archive from anybody. Throws InputError for one that a leaderboard refuses."""
    files = read_zip(data, expected.most_entries, expected.most_bytes)
    for name in NAMES:
        if name not in files:
            raise InputError(f"has no {name}")
    manifest, card = texts.read_manifest(files["submission.yaml"], "submission.yaml"), read_card(files["card.yaml"], "card.yaml")
    _check_protocol(files["configuration.yaml"], manifest, expected)
    for item in card.test_overlap:
        if item not in expected.items:
            raise InputError(f"card.yaml: test_overlap has {quoted(item)}, but there is no such item with ground truth; leave it out")
    options, names = files.get(texts.MODEL, b""), files.get(texts.LIST)
    _check_options(options, manifest, card)
    seen = training.seen(card, names, manifest.trained_on, expected) - set(card.test_overlap)
    maps = _maps_in("maps", files, expected)
    seeds = {seed: _maps_in(f"seeds/{seed}", files, expected) for seed in card.seeds}
    for name in files:
        if name not in (*NAMES, *OPTIONAL):
            why = ": there is no such item with ground truth, or card.yaml has no such seed" if name.endswith(".npy") else ""
            raise InputError(f"the file {quoted(name)} is no part of a submission{why}")
    if manifest.map_digest and origin.digest_of(maps) != manifest.map_digest:
        raise InputError("the maps are not what submission.yaml has the digest of")
    card = replace(card, test_overlap=(*card.test_overlap, *(item for item in expected.items if item in seen)),
                   trained_on=card.trained_on if names is None else (*card.trained_on, manifest.trained_on))
    return Submission(card, manifest, files["results.csv"].decode("utf-8", "surrogateescape"), maps, seeds, options)


# --- in the pool of workers -------------------------------------------------------------------------------------------------------------------


def read_all(paths: Sequence[Path], expected: Expected, scratch: Path, threads: int | None = None) -> list[Submission | str]:
    """Reads archives from anybody and checks all of them but their scores: what each is, or why it is refused. scratch: a folder for the maps.
    Throws StorageError where that takes none."""
    found: list[Submission | str] = [""] * len(paths)

    def take(number: int, read: Any, problem: str) -> None:
        found[number] = texts.shown(problem.removeprefix(f"{paths[number]}: ")) if problem else _with_maps(read, files[number], expected)

    files = [str(scratch / f"{number}.maps") for number in range(len(paths))]
    questions = [_question("answer", path, expected, file) for path, file in zip(paths, files)]
    if not ask_all(questions, take, threads):
        raise KeyboardInterrupt
    return found


def answer(path: str, expected: Expected, maps: str) -> Submission:
    """An archive without its maps, whose values go to the file `maps`, by training and shape."""
    read = checked(read_file(path, expected.most_bytes + _OVERHEAD, "it is more than its shapes need"), expected)
    try:
        with open(maps, "wb") as file:
            for values in (trained[item] for trained in (read.maps, *read.seeds.values()) for item in expected.points):
                file.write(values.data)
    except OSError as error:
        raise StorageError(f"{os.path.dirname(maps)}: cannot be written: {error.strerror}; set TMPDIR to another") from None
    return replace(read, maps={}, seeds={})


def _with_maps(read: Submission, file: str, expected: Expected) -> Submission:
    ends = np.cumsum([*expected.points.values()])
    rows = np.memmap(file, np.float64, "r").reshape(-1, ends[-1])
    maps, *others = ({item: row[end - n:end] for (item, n), end in zip(expected.points.items(), ends)} for row in rows)
    return replace(read, maps=maps, seeds=dict(zip(read.card.seeds, others)))


def protocol_in(path: Path) -> str:
    """The protocol of an archive from anybody, before the data that it is of are known. Throws InputError."""
    try:
        protocol: str = asked(_question("answer_protocol", path))
    except InputError as error:
        raise InputError(f"{path}: {texts.shown(str(error).removeprefix(f'{path}: '))}") from None
    return protocol


def answer_protocol(path: str) -> str:
    data = read_file(path, _MOST_UNKNOWN, "it is more than is read of an archive of unknown data")
    files = read_zip(data, _MOST_UNKNOWN_ENTRIES, _MOST_UNKNOWN)
    if "configuration.yaml" not in files:
        raise InputError("has no configuration.yaml")
    return protocol_of(files["configuration.yaml"], "configuration.yaml")


def _question(function: str, path: Path, *arguments: Any) -> Question:
    return Question(f"{__name__}:{function}", (str(path), *arguments), str(path), [str(path)])


def refusal_of(data: bytes, expected: Expected) -> str:
    """Why a leaderboard would refuse an archive that was made here; empty: it would not."""
    try:
        checked(data, expected)
    except InputError as error:
        return str(error)
    return ""
