# SPDX-License-Identifier: GPL-3.0-or-later
"""A submission: one ZIP archive with the maps of a model, its card, and the protocol that its scores were made by.

An archive is read and checked by a process of its own with limits on time and memory. It answers with its texts, and writes the values of the
maps to a scratch file as they are: no name from inside an archive becomes that of a file.
"""

import contextlib
import io
import itertools
import os
import re
import resource
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np

from salbench import _core, _limits
from salbench._errors import InputError, StorageError, message, quoted
from salbench._files import read_file
from salbench._npy import read_npy
from salbench._types import NDArray
from salbench._workers import Question, Worker, ask_all
from salbench._yaml import plain_text
from salbench.leaderboard import origin, texts, training
from salbench.leaderboard.archive import read_zip, zip_of
from salbench.leaderboard.card import Card, read_card
from salbench.leaderboard.expected import NAMES, OPTIONAL, Expected
from salbench.leaderboard.texts import Manifest

_OVERHEAD = 1 << 20  # of an archive: its directory, and headers
_MOST_UNKNOWN, _MOST_UNKNOWN_ENTRIES = 1 << 30, 1 << 17  # bytes and entries of an archive of data that is not known yet
_NOTHING = "damaged: the process that reads it sent nothing that can be used"
_MOST_TEXTS = 1 << 24  # bytes: the rows of results.csv are many
_TEXTS = (*NAMES, *OPTIONAL)  # which the process that reads sends


@dataclass(frozen=True)
class Submission:
    card: Card  # with the items that its list of training shapes has, and the digest of that
    manifest: Manifest
    results: str  # results.csv as it came
    maps: Mapping[str, NDArray[np.float64]]  # by the name of the shape, from the scratch file
    seeds: Mapping[str, Mapping[str, NDArray[np.float64]]]  # those of further trainings, by their names
    options: str = ""  # entry of the model in a configuration, where the program made the maps


def archive_of(card: bytes, manifest: Manifest, configuration: str, results: bytes, maps: Mapping[str, NDArray[np.float64]],
               trained_on: bytes | None = None, options: str = "", seeds: Mapping[str, Mapping[str, NDArray[np.float64]]] = MappingProxyType({})) -> bytes:
    named = [*zip(NAMES, (manifest.text().encode(), card, configuration.encode(), results))]
    named += [] if trained_on is None else [(texts.LIST, trained_on)]
    named += [(texts.MODEL, options.encode())] if options else []
    folders = {"maps": maps, **{f"seeds/{seed}": of for seed, of in seeds.items()}}
    return zip_of([*named, *((f"{folder}/{item}.npy", npy_of(values)) for folder, of in folders.items()
                             for item, values in sorted(of.items(), key=lambda row: os.fsencode(row[0])))])


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
    name = "configuration.yaml"
    if _core.digest(configuration) != manifest.configuration:
        raise InputError(f"{name} is not what submission.yaml has the digest of")
    text = plain_text(configuration, name, texts.LONGEST_TEXT)
    if text != expected.protocol:  # another version of the program may write further options, at their defaults
        text = protocol_of(configuration, name)
    for mine, other in itertools.zip_longest(expected.protocol.splitlines(), text.splitlines(), fillvalue=""):
        if mine != other:
            raise InputError(f"another protocol: it has {quoted(other)}, the leaderboard {quoted(mine)}")
    if manifest.data != expected.data:
        raise InputError(f"other data: their digest is {quoted(manifest.data)}, expected {expected.data}")


def _checked(data: bytes, expected: Expected) -> tuple[Card, Manifest, dict[str, bytes], dict[str, NDArray[np.float64]]]:
    files = read_zip(data, expected.most_entries, expected.most_bytes)
    maps = {name: files.pop(name) for name in list(files) if name.startswith(("maps/", "seeds/")) and name.endswith(".npy")}
    for name in files:
        if name not in _TEXTS:
            raise InputError(f"the file {quoted(name)} is no part of a submission")
    for name in NAMES:
        if name not in files:
            raise InputError(f"has no {name}")
    manifest = texts.read_manifest(files["submission.yaml"], "submission.yaml")
    card = read_card(files["card.yaml"], "card.yaml")
    _check_protocol(files["configuration.yaml"], manifest, expected)
    for item in card.test_overlap:
        if item not in expected.items:
            raise InputError(f"card.yaml: test_overlap has {quoted(item)}, but there is no such item with ground truth; leave it out")
    training.seen(card, files.get(texts.LIST), manifest.trained_on, expected)
    _check_options(files.get(texts.MODEL), manifest, card)
    found: dict[str, NDArray[np.float64]] = {}
    for folder in folders_of(card):
        found |= _maps_in(folder, maps, expected)
    for name in maps:
        if name not in found:
            raise InputError(f"{quoted(name)}: there is no such item with ground truth" if name.startswith("maps/") else
                             f"{quoted(name)}: card.yaml has no such seed, or there is no such item with ground truth")
    own = {item: found[f"maps/{item}.npy"] for item in expected.points}
    if manifest.map_digest and origin.digest_of(own) != manifest.map_digest:
        raise InputError("the maps are not what submission.yaml has the digest of")
    return card, manifest, files, found


def folders_of(card: Card) -> list[str]:
    """Folders of maps in an archive, the model's own first."""
    return ["maps", *(f"seeds/{seed}" for seed in card.seeds)]


def _maps_in(folder: str, maps: Mapping[str, bytes], expected: Expected) -> dict[str, NDArray[np.float64]]:
    names = {item: f"{folder}/{item}.npy" for item in expected.points}
    missing = [item for item, name in names.items() if name not in maps]
    if missing:
        of_seed = "" if folder == "maps" else f"{folder} "
        raise InputError(f"{of_seed}has no map of {len(missing)} of {len(expected.points)} items, such as {missing[0]}")
    return {name: map_of(maps[name], name, expected.points[item]) for item, name in names.items()}


def _check_options(options: bytes | None, manifest: Manifest, card: Card) -> None:
    if options is None and manifest.model:
        raise InputError(f"has no {texts.MODEL}, of which submission.yaml has the digest")
    if options is not None:
        if _core.digest(options) != manifest.model:
            raise InputError(f"{texts.MODEL} is not what submission.yaml has the digest of")
        text = plain_text(options, texts.MODEL, texts.LONGEST_TEXT)
        images = re.findall("@(sha256:[0-9a-f]{64})", text)
        if images and card.container not in ("", "none") and card.container.partition("@")[2] not in images:
            raise InputError(f"card.yaml: container is {quoted(card.container)}, and the command runs another image: {images[0]}")


def answer(path: str, expected: Expected, maps: str) -> dict[str, str]:
    """In a process of its own: the texts of an archive, by name. The values of its maps go to the file `maps` as they are."""
    _begin(path, expected.most_memory)
    try:
        data = read_file(path, expected.most_bytes + _OVERHEAD, "it is more than its shapes need")
        card, _, files, values = _checked(data, expected)
    except MemoryError:
        if 0 <= resource.getrlimit(resource.RLIMIT_AS)[1] < expected.most_memory:
            raise StorageError(f"the limit on memory is less than the {expected.most_memory} bytes that reading it may take; raise it (ulimit -v)") from None
        raise InputError(f"needs more than the {expected.most_memory} bytes of memory that a submission has") from None
    try:
        with open(maps, "wb") as file:
            for folder in folders_of(card):
                for item in expected.points:
                    file.write(values[f"{folder}/{item}.npy"].data)
    except OSError as error:
        raise StorageError(f"{os.path.dirname(maps)}: cannot be written: {error.strerror}; set TMPDIR to another") from None
    return {name: files[name].decode("utf-8", "surrogateescape") for name in _TEXTS if name in files}


def read_texts(path: str) -> dict[str, str]:
    """In a process of its own, before the data are known: the texts of an archive, by name."""
    _begin(path, 2 * _MOST_UNKNOWN)
    data = read_file(path, _MOST_UNKNOWN, "it is more than is read of an archive of unknown data")
    return {name: text.decode("utf-8", "surrogateescape") for name, text in read_zip(data, _MOST_UNKNOWN_ENTRIES, _MOST_TEXTS, _TEXTS).items()}


def _begin(path: str, memory: int) -> None:
    """What an archive makes a library print is for no terminal."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)
    os.dup2(nowhere, 2)
    _limits.limit(_limits.seconds_for([path]), memory)


# --- asked for -----------------------------------------------------------------------------------------------------------------------------------


def read_all(paths: Sequence[Path], expected: Expected, scratch: Path, threads: int | None = None) -> list[Submission | str]:
    """Reads archives from anybody, each by a process of its own, and checks all of them but their scores: what each is, or why it is refused.
    scratch: a folder for the maps. Throws StorageError where that takes none."""
    found: list[Submission | str] = [""] * len(paths)

    def take(number: int, said: Any, problem: str) -> None:
        try:
            found[number] = _taken(said, problem.removeprefix(f"{paths[number]}: "), files[number], expected)
        except InputError as reason:
            found[number] = str(reason)

    files = [str(scratch / f"{number}.maps") for number in range(len(paths))]
    questions = [_question("answer", path, expected, file) for path, file in zip(paths, files)]
    if not ask_all(questions, take, threads, alone=True):
        raise KeyboardInterrupt
    return found


def refusal_of(data: bytes, expected: Expected, scratch: Path, threads: int | None = None) -> str:
    """Why a leaderboard would refuse an archive that was made here; empty: it would not. scratch: as for `read_all`. Throws StorageError."""
    made = scratch / "made.zip"
    try:
        made.write_bytes(data)
    except OSError as error:
        raise StorageError(f"{scratch}: cannot be written: {error.strerror}; set TMPDIR to another") from None
    read = read_all([made], expected, scratch, threads)[0]
    return read if isinstance(read, str) else ""


def texts_of(path: Path) -> dict[str, str]:
    """The texts of an archive from anybody, by name, before the data that it is of are known. Throws InputError."""
    try:
        with contextlib.closing(Worker()) as worker:
            said = worker.ask(_question("read_texts", path))
    except (InputError, MemoryError) as error:
        raise InputError(f"{path}: {_line(message(error).removeprefix(f'{path}: '))}") from None
    if not isinstance(said, dict):
        raise InputError(f"{path}: {_NOTHING}")
    return {name: text for name, text in said.items() if name in _TEXTS and isinstance(text, str)}


def _question(function: str, path: Path, *arguments: Any) -> Question:
    return Question(f"{__name__}:{function}", (str(path), *arguments), str(path), [str(path)])


def _line(said: str) -> str:
    return texts.line(said, "damaged: what the process that reads it says")


def _taken(said: Any, problem: str, maps: str, expected: Expected) -> Submission:
    if problem:
        raise InputError(_line(problem))
    try:
        return _received(said, maps, expected)
    except InputError:
        raise
    except (OSError, ValueError, KeyError, TypeError, AttributeError, RecursionError):
        raise InputError(_NOTHING) from None


def _received(said: dict[str, Any], file: str, expected: Expected) -> Submission:
    """An archive may have taken the process over: what it sent is looked at once more."""
    card, manifest = read_card(said["card.yaml"].encode(), "card.yaml"), texts.read_manifest(said["submission.yaml"].encode(), "submission.yaml")
    n = sum(expected.points.values())
    if os.path.getsize(file) != 8 * n * len(folders_of(card)):
        raise InputError("damaged: its maps were not sent whole")
    values = np.memmap(file, np.float64, "r")
    ends = np.cumsum([0, *expected.points.values()])
    maps, *others = ({item: values[at + first:at + end] for item, first, end in zip(expected.points, ends, ends[1:])} for at in range(0, len(values), n))
    seeds = dict(zip(card.seeds, others))
    names = said[texts.LIST].encode("utf-8", "surrogateescape") if texts.LIST in said else None
    seen = training.seen(card, names, manifest.trained_on, expected) - set(card.test_overlap)
    card = replace(card, test_overlap=(*card.test_overlap, *(item for item in expected.items if item in seen)),
                   trained_on=(*card.trained_on, manifest.trained_on) if names is not None else card.trained_on)
    return Submission(card, manifest, str(said["results.csv"]), maps, seeds, str(said.get(texts.MODEL, "")))
