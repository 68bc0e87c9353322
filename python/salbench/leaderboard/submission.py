# SPDX-License-Identifier: GPL-3.0-or-later
"""A submission: one ZIP archive with the maps of a model, its card, and the protocol that its scores were made by.

An archive is read and checked by another process (`python -c "...worker()"`) with limits on time, memory and bytes. It sends a line of JSON and
the values of the maps, which go to a scratch file as they are: no name from inside an archive becomes that of a file.
"""

import io
import itertools
import json
import os
import resource
import subprocess
import sys
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from salbench import _core, _limits
from salbench._errors import InputError, StorageError, quoted
from salbench._files import read_file
from salbench._npy import read_npy
from salbench._processes import FROM_OUTSIDE, end_with_parent, leave_interrupts_to_parent, start, text_of_signal
from salbench._types import NDArray
from salbench.leaderboard import texts, training
from salbench.leaderboard.archive import Refused, read_zip, zip_of
from salbench.leaderboard.expected import NAMES, Expected as Expected
from salbench.leaderboard.texts import Card, Manifest

_SECONDS = 120  # of processor time, and five times that by the clock
_OVERHEAD = 1 << 20  # of an archive: its directory, and headers
_LONGEST_HEAD = 1 << 26  # what the process sends before the maps
_START = "import sys; sys.path.insert(0, sys.argv[1]); from salbench.leaderboard.submission import worker; worker()"
_SENT = ("submission.yaml", "card.yaml", "results.csv", texts.LIST)  # by the process that reads


@dataclass(frozen=True)
class Submission:
    card: Card  # with the items that its list of training shapes has, and the digest of that
    program: str  # version that wrote it
    results: str  # results.csv as it came
    digest: str  # of the maps
    maps: Mapping[str, NDArray[np.float64]]  # by the name of the shape, from the scratch file


def archive_of(card: bytes, manifest: Manifest, configuration: str, results: bytes, maps: Mapping[str, NDArray[np.float64]],
               trained_on: bytes | None = None) -> bytes:
    named = zip(NAMES, (manifest.text().encode(), card, configuration.encode(), results))
    listed = [] if trained_on is None else [(texts.LIST, trained_on)]
    return zip_of([*named, *listed, *((f"maps/{item}.npy", npy_of(values)) for item, values in sorted(maps.items(), key=lambda row: os.fsencode(row[0])))])


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
        raise Refused(f"{name}: not a .npy file that can be read: {error}") from None
    if len(values) != points:
        raise Refused(f"{name}: {len(values)} values, but the shape has {points} points")
    for bad in np.flatnonzero(~np.isfinite(values))[:1]:
        raise Refused(f"{name}: value {bad} (0-based) is {values[bad]}, expected a finite number")
    return values


def _check_protocol(configuration: bytes, manifest: Manifest, expected: Expected) -> None:
    name = "configuration.yaml"
    if _core.digest(configuration) != manifest.configuration:
        raise Refused(f"{name} is not what submission.yaml has the digest of")
    text = texts.require_plain(configuration, name)
    if text != expected.protocol:  # another version of the program may write further options, at their defaults
        if "models" in {line.partition(":")[0] for line in text.splitlines()}:
            raise Refused(f"{name} has models, expected the protocol alone")
        try:
            text = _core.protocol(text, name)
        except ValueError as error:  # which may repeat what stands there
            raise Refused(" ".join(texts.shown(str(error)).split())[:300]) from None
    for mine, other in itertools.zip_longest(expected.protocol.splitlines(), text.splitlines(), fillvalue=""):
        if mine != other:
            raise Refused(f"another protocol: it has {quoted(other)}, the leaderboard {quoted(mine)}")
    if manifest.data != expected.data:
        raise Refused(f"other data: their digest is {quoted(manifest.data)}, expected {expected.data}")


def _checked(data: bytes, expected: Expected) -> tuple[Card, Manifest, dict[str, bytes], dict[str, NDArray[np.float64]]]:
    files = read_zip(data, len(expected.points) + len(NAMES) + 2, expected.most_bytes)
    maps = {name: files.pop(name) for name in list(files) if name.startswith("maps/") and name.endswith(".npy")}
    for name in files:
        if name not in (*NAMES, texts.LIST):
            raise Refused(f"the file {quoted(name)} is no part of a submission")
    for name in NAMES:
        if name not in files:
            raise Refused(f"has no {name}")
    manifest = texts.read_manifest(files["submission.yaml"], "submission.yaml")
    if manifest.format != texts.FORMAT:
        raise Refused(f"submission.yaml: format is {quoted(manifest.format)}, expected {texts.FORMAT}")
    card = texts.read_card(files["card.yaml"], "card.yaml")
    _check_protocol(files["configuration.yaml"], manifest, expected)
    for item in card.test_overlap:
        if item not in expected.items:
            raise Refused(f"card.yaml: test_overlap has {quoted(item)}, but there is no such item with ground truth; leave it out")
    training.seen(card, files.get(texts.LIST), manifest.trained_on, expected)
    found = {}
    for name, content in maps.items():
        item = name[len("maps/"):-len(".npy")]
        if item not in expected.points:
            raise Refused(f"{quoted(name)}: there is no such item with ground truth")
        found[item] = map_of(content, name, expected.points[item])
    missing = [item for item in expected.points if item not in found]
    if missing:
        raise Refused(f"has no map of {len(missing)} of {len(expected.points)} items, such as {missing[0]}")
    return card, manifest, files, found


def worker() -> None:
    """Reads what to do from standard input; writes a line of JSON and the values of the maps."""
    given = json.load(sys.stdin)
    end_with_parent(given["parent"])
    leave_interrupts_to_parent()
    expected = Expected(**given["expected"])
    memory = expected.most_memory
    # One second more of processor time is a signal that is told from those of others.
    for kind, most, hard in ((resource.RLIMIT_CPU, _SECONDS, _SECONDS + 1), (resource.RLIMIT_AS, memory, memory),
                             (resource.RLIMIT_FSIZE, 2 * expected.most_bytes, 2 * expected.most_bytes), (resource.RLIMIT_CORE, 0, 0), (resource.RLIMIT_NPROC, 0, 0)):
        _limits.lower(kind, most, hard)
    maps: dict[str, NDArray[np.float64]] = {}
    try:
        data = read_file(given["path"], expected.most_bytes + _OVERHEAD, "it is more than its shapes need")
        _, _, files, maps = _checked(data, expected)
        head = {name: files[name].decode("utf-8", "surrogateescape") for name in _SENT if name in files} | {"maps": list(maps)}
    except Refused as reason:
        head = {"refused": str(reason)}
    except InputError as error:  # the file, whose name the table has
        head = {"refused": str(error).removeprefix(f"{given['path']}: ")}
    except MemoryError:
        if _limits.most_memory() < memory:
            raise
        head = {"refused": f"needs more than the {memory} bytes of memory that a submission has"}
    line = json.dumps(head).encode()
    sys.stdout.buffer.write(line + b" " * (-(len(line) + 1) % 8) + b"\n")  # what follows is aligned
    for values in maps.values():
        sys.stdout.buffer.write(values.tobytes())


# --- asked for -----------------------------------------------------------------------------------------------------------------------------------


_at_work: set[subprocess.Popen[bytes]] = set()


def end_all() -> None:
    """Ends the processes that read; what they were asked is refused."""
    while _at_work:
        _at_work.pop().kill()


class NotRead(StorageError):
    """The process that reads was ended by somebody else: the archive is not to blame."""


def read(path: Path, expected: Expected, scratch: Path) -> Submission:
    """Reads an archive from anybody and checks all of it but its scores; scratch is a file to be written. Throws Refused, NotRead after a second
    try, and StorageError where the scratch file takes no maps."""
    try:
        try:
            return _read(path, expected, scratch)
        except NotRead:
            return _read(path, expected, scratch)
    except OSError as error:
        if isinstance(error, StorageError):
            raise
        raise StorageError(f"{scratch.parent}: cannot be written: {error.strerror}; set TMPDIR to another") from None


def _read(path: Path, expected: Expected, scratch: Path) -> Submission:
    given = json.dumps({"path": str(path), "expected": asdict(expected), "parent": os.getpid()}).encode()
    with open(scratch, "wb") as out:
        process = start(_START, stdout=out, stderr=subprocess.DEVNULL)
        _at_work.add(process)
        in_time = True
        try:
            process.communicate(given, timeout=5 * _SECONDS)
        except subprocess.TimeoutExpired:
            in_time = False
        finally:
            process.kill()
            process.wait()
            by_others = in_time and process in _at_work and -process.returncode in FROM_OUTSIDE
            _at_work.discard(process)
    with open(scratch, "rb") as file:
        head = file.readline(_LONGEST_HEAD)
        begin = file.tell()
    if by_others:
        raise NotRead(f"was not read: the process that reads it was ended from outside, twice ({text_of_signal(process.returncode)}); run it again")
    ended = ", and was ended by a limit or a fault" if process.returncode else ""
    try:
        try:
            said = json.loads(head)
            if "refused" in said:
                raise Refused(texts.line(said["refused"], "damaged: what the process that reads it says"))
            return _received(said, scratch, begin, expected)
        except (ValueError, KeyError, TypeError, AttributeError, RecursionError):
            raise Refused(f"damaged: the process that reads it sent nothing that can be used{ended}") from None
    except Refused:
        if process.returncode:
            _require_room(scratch, expected)
        raise


def _require_room(scratch: Path, expected: Expected) -> None:
    """Throws OSError or NotRead where the process that reads had neither the room nor the memory that it may need: it could not say so."""
    with open(scratch, "ab") as file:
        os.posix_fallocate(file.fileno(), 0, expected.most_bytes)
    if _limits.most_memory() < expected.most_memory:
        raise NotRead(f"was not read: the limit on memory is less than the {expected.most_memory} bytes that reading it may take; raise it (ulimit -v)")


def _received(said: dict[str, Any], scratch: Path, begin: int, expected: Expected) -> Submission:
    """An archive may have taken the process over: what it sent is looked at once more."""
    items, n = said["maps"], sum(expected.points.values())
    if sorted(items) != sorted(expected.points) or scratch.stat().st_size != begin + 8 * n:
        raise Refused("damaged: its maps were not sent whole")
    values = np.memmap(scratch, np.float64, "r", begin)
    ends = np.cumsum([0, *(expected.points[item] for item in items)])
    maps = {item: values[first:end] for item, first, end in zip(items, ends, ends[1:])}
    card, manifest = texts.read_card(said["card.yaml"].encode(), "card.yaml"), texts.read_manifest(said["submission.yaml"].encode(), "submission.yaml")
    names = said[texts.LIST].encode("utf-8", "surrogateescape") if texts.LIST in said else None
    seen = training.seen(card, names, manifest.trained_on, expected) - set(card.test_overlap)
    card = replace(card, test_overlap=(*card.test_overlap, *(item for item in expected.items if item in seen)),
                   trained_on=(*card.trained_on, manifest.trained_on) if names is not None else card.trained_on)
    return Submission(card, manifest.program, str(said["results.csv"]), _core.digest(values.tobytes()), maps)
