# SPDX-License-Identifier: GPL-3.0-or-later
"""`salbench submit` and `salbench leaderboard`, and the runs that `salbench reproduce` starts, too."""

import argparse
import logging
import sys
import tempfile
from collections.abc import Collection, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from salbench import _core
from salbench.conclusions import leaders, means, tables
from salbench.leaderboard import board, folder, origin, site, submission, texts, trained
from salbench.leaderboard.card import Card, read_card
from salbench.leaderboard.entry import archives_in
from salbench.leaderboard.expected import Expected
from salbench.leaderboard.texts import Manifest
from salbench.runs import run
from salbench.runs.results import Results
from salbench.runs.settings import Settings
from salbench.shapes.reference import reference_of
from salbench.system.console import ALL_DONE, SOME_FAILED, report, warn
from salbench.system.csv import read_csv
from salbench.system.errors import InputError, arguments_refused
from salbench.system.files import read_file, replace_file, stored
from salbench.system.scratch import ScratchFolder


def run_over(
    given: argparse.Namespace,
    scratch: str,
    *,
    kept: str | None = None,
    maps: Mapping[str, str] | None = None,
    functions: Mapping[str, Any] | None = None,
    silent: bool = False,
) -> Results:
    """Runs over the data set of a command, with tables in a new folder below `scratch`. kept: models of the
    configuration. silent: remarks on the data were reported before, and failed maps become reasons in the
    tables."""
    settings = Settings(
        given.config,
        models="{}" if kept is None else None,
        kept=kept,
        maps=maps or {},
        data=given.data,
        cache=given.cache,
        out=tempfile.mkdtemp(dir=scratch),
        items=b"scored",
        split=given.split,
        reference=reference_of(given.reference),
        functions=functions or {},
    )
    log = logging.getLogger("salbench")
    log.disabled = silent
    try:
        with arguments_refused():
            return run.carry_out(settings, given.threads, not given.quiet and sys.stderr.isatty())
    finally:
        log.disabled = False


def summary_of(results: Results) -> dict[str, Any]:
    """Summary of a run, for the document of a command."""
    done: dict[str, Any] = results._run.summary()
    return done | {"models": results.scores["model"].nunique()}  # includes people


def _failed(results: Results) -> int:
    """Returns the status; prints a line that counts failures."""
    if not results.failures:
        return ALL_DONE
    print(f"\n{len(results.failures)} failed, each named above", file=sys.stderr)
    return SOME_FAILED


def submit(given: argparse.Namespace) -> int:
    """given: MINE and --to beside the arguments of a run."""
    mine, to = Path(given.mine), Path(given.to)
    card_text = read_file(mine / "card.yaml", texts.LONGEST_TEXT, "shorten it")
    _require_free(to)
    card = read_card(card_text, str(mine / "card.yaml"))
    names = None
    if len(card.trained_on) == 1:
        names = read_file(mine / card.trained_on[0], texts.LONGEST_LIST, "leave out all but the names")
    has_maps = any(path.suffix.lower() == ".val" for path in mine.iterdir())
    trainings = _trainings(card) if has_maps else {seed: seed for seed in card.seeds}
    with ScratchFolder() as scratch:
        if has_maps:
            results = run_over(
                given,
                scratch,
                maps={card.name: str(mine), **{model: str(mine / seed) for seed, model in trainings.items()}},
            )
        else:
            results = _run_model(given, scratch, card)
        status = _failed(results)
        if status == ALL_DONE:
            expected, maps = board.expected_of(results), results.maps(card.name)
            known = (
                origin.of_files(mine, maps)
                if has_maps
                else origin.of_model(results.costs, results.record, card.name)
            )
            options = "" if has_maps else origin.options_text(results.record, card.name)
            manifest = replace(
                _manifest(known, results, expected, trainings.values()),
                maps=len(maps),
                map_digest=origin.digest_of(maps),
                trained_on=_core.digest(names) if names is not None else "",
                model=_core.digest(options.encode()) if options else "",
            )
            seeds = {seed: results.maps(model) for seed, model in trainings.items()}
            _write_checked(
                to,
                submission.archive_of(
                    card_text,
                    manifest,
                    expected.protocol,
                    _scores(results, card.name),
                    maps,
                    names,
                    options,
                    seeds,
                ),
                expected,
            )
            for file in filter(origin.is_outside, (line.partition(" ")[2] for line in known.files)):
                warn(
                    "note",
                    (
                        f"nobody else can reproduce the submission, since depends has {file}: put it below the"
                        " configuration's folder, and name it from there"
                    ),
                )
        document = {
            "to": None if status else given.to,
            "model": card.name,
            "unsaid": list(card.unsaid),
            **summary_of(results),
        }
    for key, why in card.unsaid.items() if status == ALL_DONE else ():
        warn("note", f"{mine / 'card.yaml'} does not say {key} ({why})")
    text = (
        "" if status else f"{given.to} can be handed in: it was checked as salbench leaderboard checks it\n"
    )
    report(given, "submit", document, text)
    return status


def _trainings(card: Card) -> dict[str, str]:
    """Names for scoring further trainings, by seed: NET-1, or a short one if that is too long for a model."""
    short = board.free_names([card.name])
    return {
        seed: next(short) if _core.wrong_with_model_name(name := f"{card.name}-{seed}") else name
        for seed in card.seeds
    }


def _run_model(given: argparse.Namespace, scratch: str, card: Card) -> Results:
    """Runs a model of the configuration and its further trainings. Uses the configuration beside the card if
    the given one has no such model and the same protocol."""
    kept, own = ",".join([card.name, *card.seeds]), Path(given.mine, trained.CONFIGURATION)
    try:
        return run_over(given, scratch, kept=kept)
    except InputError as error:
        if (
            str(own) != given.config
            and own.is_file()
            and _core.protocol(str(own)) == _core.protocol(given.config)
        ):
            return run_over(argparse.Namespace(**{**vars(given), "config": str(own)}), scratch, kept=kept)
        others = [path.name for path in Path(given.mine).iterdir() if path.suffix.lower() == ".npy"]
        unread = f" but {len(others)} files .npy, which are not read: write them as text," if others else ""
        raise InputError(
            f"{error} ({given.mine} has no map, ITEM.val,{unread} so that the model {card.name} of {given.config}"
            " was to make them; -c names another configuration)"
        ) from None


def _manifest(known: Manifest, results: Results, expected: Expected, trainings: Collection[str]) -> Manifest:
    """Completes the manifest of the maps with the run's record. trainings: further models of the run, whose
    stages are left out."""
    record = results.record
    stages = [
        f"{stage} {of['version']}"
        for stage, of in record["stages"].items()
        if stage.rpartition(".")[2] not in trainings
    ]
    return replace(
        known,
        program=_core.version,
        commit=_core.commit,
        protocol=record["configuration"]["protocol"],
        configuration=_core.digest(expected.protocol.encode()),
        data=expected.data,
        stages=stages,
    )


def _write_checked(to: Path, data: bytes, expected: Expected) -> None:
    """Writes a submission after reading it like a maintainer would, so that no file is written that would be
    refused."""
    try:
        submission.checked(data, expected)
    except InputError as error:
        raise InputError(f"{to}: would be refused, and was not written: {error}") from None
    with stored(to, "choose another with --to"):
        to.parent.mkdir(parents=True, exist_ok=True)
        replace_file(to, data)


def _scores(results: Results, model: str) -> bytes:
    """Rows of a model in results.csv."""
    table = read_csv(results.folder / "results.csv")
    text: str = table[table["model"] == model].to_csv(index=False, lineterminator="\n")
    return text.encode("utf-8", "surrogateescape")


def _require_free(to: Path) -> None:
    """Throws InputError if `to` exists and is no archive, but a map or a folder, for example."""
    if to.is_dir():
        raise InputError(f"--to {to}: is a folder; name the file to write, such as mine.zip")
    if to.exists() and not (to.is_file() and _head(to) in (b"PK", b"")):
        raise InputError(f"--to {to}: is there, and no submission; choose another")


def _head(path: Path) -> bytes:
    with open(path, "rb") as file:
        return file.read(2)


def leaderboard(given: argparse.Namespace) -> int:
    """given: FOLDER, --to and --models beside the arguments of a run."""
    entries = archives_in(given.folder, may_be_none=bool(given.models))
    to = Path(given.to)
    folder.require_own(to)
    if to.exists() and to.samefile(given.folder):
        raise InputError(f"--to {to}: is the folder of the submissions; choose another")
    with ScratchFolder() as scratch:
        kept, made = given.models or "", Path(scratch, "site")
        before = run_over(given, scratch, kept=kept)
        expected = board.expected_of(before)
        board.check_all(entries, expected, scratch, before.models)
        ranked, results = board.rank(
            entries,
            expected,
            lambda functions: run_over(given, scratch, kept=kept, functions=functions, silent=True),
            Path(given.config).stem,
        )
        board.write_tables(ranked, results, made / "data")
        site.write_pages(ranked, made)
        folder.publish(made, to)
        document = {
            "to": given.to,
            "submissions": [board.row_of(entry) for entry in entries],
            "scores": tables.records(means.overview(ranked.study)),
            "leaders": leaders.documents(ranked.leaders),
            **summary_of(results),
        }
        status = _failed(before)
    report(given, "leaderboard", document, _text(ranked, given))
    for entry in ranked.refused:
        print(f"refused: {entry.name}: {entry.refused}", file=sys.stderr)
    return status or (SOME_FAILED if ranked.refused else ALL_DONE)


def _text(ranked: board.Board, given: argparse.Namespace) -> str:
    lines = [
        tables.aligned(means.overview(ranked.study)),
        *tables.of_truth(ranked.remarks),
        *ranked.sentences,
    ]
    return "\n".join([*lines, f"the leaderboard is {Path(given.to, 'index.html')}\n"])
