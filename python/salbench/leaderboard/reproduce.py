# SPDX-License-Identifier: GPL-3.0-or-later
"""`salbench reproduce`: recomputes the maps of a submission over the same data, from code and weights with
the recorded digests, and compares."""

import argparse
import datetime
import os
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas

from salbench import _core
from salbench.conclusions import folders, tables
from salbench.leaderboard import board, card, origin, submission, texts
from salbench.leaderboard.archive import read_zip, zip_of
from salbench.leaderboard.commands import run_over, summary_of
from salbench.leaderboard.submission import Submission
from salbench.runs.results import Results
from salbench.system.console import ALL_DONE, SOME_FAILED, report, warn
from salbench.system.errors import InputError, quoted
from salbench.system.files import read_file
from salbench.system.scratch import ScratchFolder
from salbench.system.types import NDArray
from salbench.system.yaml import flow_text

ROUNDING = 1e-5  # rounding of a network in single precision
_ROOM = 1000  # bytes kept free in a card for the result, of the 2 000 of a line
BIT, NEAR, DIFFERS, NOT_RUNNABLE = OUTCOMES = ("to the bit", "to rounding", "differs", "not runnable")
COLUMNS = (
    tables.text("shape", "item, and its scan or view, as maps of a submission are named"),
    tables.number(
        "difference",
        (
            "largest, of a value, over the sum of how far it lies from the median of its map, as submitted,"
            " and the mean of that"
        ),
    ),
    tables.text(
        "outcome",
        (
            f"{BIT}: the same map; {NEAR}: difference less than {ROUNDING}; {DIFFERS}; {NOT_RUNNABLE}: no map"
            " was made"
        ),
    ),
)


def reproduce(given: argparse.Namespace) -> int:
    """given: CARD, --model, --to and --by beside the arguments of a run. Returns the status."""
    file = Path(given.card)
    if given.by and not given.to:
        raise InputError("--by needs --to, the folder of the new card")
    with ScratchFolder() as scratch:
        given.cache, given.config = given.cache or os.path.join(scratch, "cache"), os.path.join(
            scratch, "configuration.yaml"
        )
        Path(given.config).write_text(submission.protocol_in(file))
        expected = board.expected_of(run_over(given, scratch, kept=""))
        read = submission.read(file, expected, scratch)
        entries = read_zip(read_file(file), expected.most_entries, expected.most_bytes)
        if given.by:  # refuses an unwritable line before anything is computed
            _with_line(file, entries, f"{given.by}{'x' * _ROOM}")
        ours = _made_again(file, read, given, scratch)
        found = compare(read.maps, ours.maps(read.card.name))
        same, outcome = int((found["outcome"] == BIT).sum()), max(found["outcome"], key=OUTCOMES.index)
        cached = sum(n for model, _, n, *_ in ours._run.models() if model == read.card.name)
        sentence = f"{outcome}: {same} of {len(found)} maps are the same to the bit" + (
            f"; {cached} were read from the cache, not computed again" if cached else ""
        )
        line = f"{datetime.date.today()}, {given.by or 'somebody'}: {sentence} (salbench {_core.version})"
        if given.to:
            to = Path(given.to)
            folders.make(to)
            folders.write_tables(to, [("reproduced", found)], folders.read_run(ours.folder).remarks)
            if given.by:
                folders.write(to, f"{read.card.name}.zip", _with_line(file, entries, line))
        document = {
            "model": read.card.name,
            "outcome": outcome,
            "reproduced_by": line,
            "maps": len(found),
            "same_maps": same,
            "to": given.to,
            **summary_of(ours),
        }
        text = (
            f"{tables.aligned(found[found['outcome'] != BIT])}\n" * (outcome != BIT)
            + f"{read.card.name}: {sentence}\n"
        )
    report(given, "reproduce", document, text)
    return SOME_FAILED if outcome in (DIFFERS, NOT_RUNNABLE) or ours.failures else ALL_DONE


def _with_line(file: Path, entries: Mapping[str, bytes], line: str) -> bytes:
    """The submission with a card that names who reproduced it."""
    text = card.with_line(entries["card.yaml"], f"{file}: with the line of --by, card.yaml", line)
    return zip_of({**entries, "card.yaml": text}.items())


def _made_again(file: Path, read: Submission, given: argparse.Namespace, scratch: str) -> Results:
    """Runs the model of a submission. Throws InputError if no map was made."""
    name, options, place = read.card.name, _options_of(read, file), Path(scratch, "model")
    place.mkdir()
    _link_files(file, read, options, Path(given.model), place)
    protocol = Path(given.config).read_text()
    given.config = str(place / f"{os.urandom(8).hex()}.yaml")  # a name that no link has
    Path(given.config).write_text(f"{protocol}models: {flow_text({name: options})}\n")
    if not given.quiet:
        command = texts.shown(str(options.get("command", "")).strip())
        warn(
            "note", f"runs, for each shape, what {file.name} names: {command or f'the built-in model {name}'}"
        )
    try:
        ours = run_over(given, scratch, kept=name, silent=True)
    except InputError as error:  # may quote the archive, and names a file of the scratch folder
        said = " ".join(texts.shown(str(error).replace(given.config, texts.MODEL)).split())[:300]
        raise _refused(file, read, f"not runnable here: {said}") from None
    if ours.failures and not any(ours.scores["model"] == name):
        raise InputError(
            f"{file}: not runnable here: {ours.failures[0].item}: {ours.failures[0].cause.splitlines()[0]}"
        )
    for failure in ours.failures:
        warn("error", f"{failure.item}: {failure.cause.splitlines()[0]}")
    return ours


def _refused(file: Path, read: Submission, why: str) -> InputError:
    return InputError(f"{file}: {why}; ask {read.card.contact or 'its authors'} for another submission")


def _options_of(read: Submission, file: Path) -> dict[str, Any]:
    """The model's entry in a configuration. Its values are texts, lists and mappings, which the program
    checks."""
    if read.manifest.made_by not in ("command", "built-in") or not read.options:
        raise _refused(
            file,
            read,
            f"not runnable: its maps came from {read.manifest.made_by or 'files'}, and it names no command",
        )
    options = texts.loaded(read.options, f"{file}: {texts.MODEL}")
    if not isinstance(options, dict):
        raise _refused(file, read, f"{texts.MODEL} has no options of a model")
    return options


def _link_files(file: Path, read: Submission, options: Mapping[str, Any], folder: Path, place: Path) -> None:
    """Finds code and weights by their digests in `folder`, and links them from `place`, where the
    configuration looks for them."""
    digests = {name: digest for digest, _, name in (line.partition(" ") for line in read.manifest.files)}
    names = list(map(str, options.get("depends") or []))
    for name in names:
        if origin.is_outside(name) or name not in digests:
            raise _refused(
                file,
                read,
                (
                    f"it depends on {quoted(name)}, which is no path below a folder, or has no digest in"
                    " submission.yaml"
                ),
            )
    layouts = list(_places(folder, names))
    most_similar = max(layouts, key=lambda paths: sum(map(os.path.isfile, paths.values())))
    advice = "name the folder of its code and weights, or the one above it, with --model"
    for name in names:
        candidates = (paths[name] for paths in layouts if paths[name].is_file())
        path = next((own for own in candidates if origin.sha256_of(own) == digests[name]), None)
        if path is None:
            path = most_similar[name]
            if not path.is_file():
                raise InputError(f"{path}: there is no such file; {advice}")
            raise InputError(
                f"{path}: its SHA-256 is {origin.sha256_of(path)}, and the submission has"
                f" {quoted(digests[name])}; {advice}"
            )
        link = place / name
        link.parent.mkdir(parents=True, exist_ok=True)
        if not os.path.lexists(link):  # "a" and "./a" name one file
            link.symlink_to(path.absolute())


def _places(folder: Path, names: Sequence[str]) -> Iterator[dict[str, Path]]:
    """Candidate locations of a submission's files, by name: in the folder or a folder in it, with or without
    leading folders that all names share."""
    parts = [Path(name).parts for name in names]
    n_shared = len(os.path.commonprefix([of_name[:-1] for of_name in parts]))
    for base in (folder, *(sorted(filter(Path.is_dir, folder.iterdir())) if folder.is_dir() else ())):
        for n in range(n_shared + 1):
            yield {name: base.joinpath(*of_name[n:]) for name, of_name in zip(names, parts)}


def compare(
    came: Mapping[str, NDArray[np.float64]], made: Mapping[str, NDArray[np.float64]]
) -> pandas.DataFrame:
    """Compares submitted and recomputed maps by shape: rows of COLUMNS."""
    rows = []
    for shape, values in came.items():
        apart = difference(values, made[shape]) if shape in made else float("nan")
        outcome = (
            NOT_RUNNABLE
            if shape not in made
            else BIT
            if np.array_equal(values, made[shape])
            else NEAR
            if apart < ROUNDING
            else DIFFERS
        )
        rows.append({"shape": shape, "difference": apart, "outcome": outcome})
    return tables.framed(COLUMNS, rows)


def difference(came: NDArray[np.float64], made: NDArray[np.float64]) -> float:
    """Column `difference`. Division by the range would make all maps with one outlier agree."""
    largest = max(np.max(np.abs(came)), np.max(np.abs(made))) or 1.0  # sums cannot overflow
    from_median = np.abs(came / largest - np.median(came / largest))
    return float(
        np.max(np.abs(came / largest - made / largest) / (from_median + (from_median.mean() or 1.0)))
    )
