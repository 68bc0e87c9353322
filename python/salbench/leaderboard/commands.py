# SPDX-License-Identifier: GPL-3.0-or-later
"""`salbench submit` and `salbench leaderboard`: from their arguments to what they write. Both return a status."""

import argparse
import csv
import io
import logging
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from salbench import _core, _run
from salbench._command_line import ALL_DONE, SOME_FAILED, Parser, report
from salbench._csv import bare
from salbench._errors import InputError, StorageError
from salbench._files import read_file, replace_file
from salbench._results import Results
from salbench.conclusions import leaders, means, tables
from salbench.leaderboard import board, folder, site, submission, texts
from salbench.leaderboard.card import read_card
from salbench.leaderboard.texts import Manifest

CONFIG = "shrec07_meshes"


def add_arguments(parser: Parser) -> None:
    """Those that both have: of a run over what has ground truth whose configuration need not be named."""
    parser.add_argument("-c", "--config", metavar="CONFIG", default=CONFIG, help=f"configuration, or the name of an installed one (default: {CONFIG})")
    parser.add_argument("--data", metavar="DIR", help="folder of the data set")
    parser.add_argument("--cache", metavar="DIR", help="folder of the artefacts (default: cache in CONFIG, or salbench-cache)")
    parser.add_argument("--split", help="only this split of the data set, such as test; '': all, where CONFIG names one")
    parser.add_argument("--reference", metavar="FILE", help="match to this histogram (CSV with a column GS of 100 bins), not to the mean over the "
                        "data set; items: to the mean over the items with ground truth")
    parser.add_count("--threads", "threads (default: all cores); results do not depend on it")
    parser.add_report("neither progress nor tables; warnings and errors only")


class _Session:
    """Runs over the data set of a command, in a scratch folder, and says on standard error what the program would."""

    def __init__(self, given: argparse.Namespace, scratch: Path) -> None:
        self.given, self.scratch = given, scratch
        self._runs = 0
        self._log = logging.getLogger("salbench")

    def run(self, *, kept: str | None = None, maps: dict[str, str] | None = None, functions: Iterable[Any] = (), silent: bool = False) -> Results:
        """silent: what there is to say of the data was said before, and failures of maps are reasons in the tables."""
        given = self.given
        self._runs += 1
        settings = _run.Settings(given.config, models="{}" if kept is None else None, kept=kept, maps=maps or {}, data=given.data, cache=given.cache,
                                 out=str(self.scratch / f"run{self._runs}"), items=b"scored", split=given.split, reference=given.reference)
        handler = logging.StreamHandler()
        handler.setFormatter(_Levels())
        self._log.addHandler(handler)
        self._log.disabled = silent
        try:
            return _run.carry_out(settings, list(functions), given.threads, not given.quiet and sys.stderr.isatty())
        except (ValueError, KeyError, FileNotFoundError) as error:
            raise InputError(str(error.args[0] if isinstance(error, KeyError) else error)) from None
        except OSError as error:
            raise StorageError(str(error)) from None
        finally:
            self._log.disabled = False
            self._log.removeHandler(handler)


class _Levels(logging.Formatter):
    def format(self, record: logging.LogRecord) -> str:
        return f"{record.levelname.lower()}: {record.getMessage()}"


def summary_of(results: Results) -> dict[str, Any]:
    """What a session did, for the document of a command."""
    record = board.record_of(results)
    data = record["data_set"]
    return {"meshes": int(data["meshes"]), "clouds": int(data.get("clouds", 0)), "models": results.scores["model"].nunique(),
            "cache": record["configuration"]["cache"],
            "computed": results.computed, "interrupted": False,
            "failed": [{"item": item, "stage": stage, "why": cause} for item, stage, cause in results.failures]}


def _failed(results: Results) -> int:
    """The status, with a line that counts what failed."""
    if not results.failures:
        return ALL_DONE
    print(f"\n{len(results.failures)} failed, each named above", file=sys.stderr)
    return SOME_FAILED


def submit(given: argparse.Namespace) -> int:
    """given: MINE and --to beside the arguments of both."""
    card_file = Path(given.mine, "card.yaml")
    card_text = read_file(card_file, texts.LONGEST_TEXT, "shorten it")
    _require_free(Path(given.to))
    card = read_card(card_text, str(card_file))
    names = None
    if len(card.trained_on) == 1:
        names = read_file(Path(given.mine, card.trained_on[0]), texts.LONGEST_LIST, "leave out all but the names")
    with _core.ScratchFolder() as name:
        session = _Session(given, Path(name))
        results = session.run(maps={card.name: given.mine})
        status = _failed(results)
        if status == ALL_DONE:
            _write_checked(Path(given.to), results, card_text, card.name, Path(name), names)
        document = {"to": None if status else given.to, "model": card.name, **summary_of(results)}
    text = "" if status else f"{given.to} can be handed in: it was checked as salbench leaderboard checks it\n"
    report(given, "submit", document, text)
    return status


def _write_checked(to: Path, results: Results, card: bytes, model: str, scratch: Path, names: bytes | None) -> None:
    """What is written is read as a maintainer reads it: a file that would be refused does not stay."""
    expected = board.expected_of(results, results._run.protocol)
    record = board.record_of(results)
    scores = io.StringIO()
    csv.writer(scores, lineterminator="\n").writerows(bare(results.folder / "results.csv"))
    maps = results.maps(model)
    manifest = Manifest(program=_core.version, commit=_core.commit, protocol=record["configuration"]["protocol"],
                        configuration=_core.digest(expected.protocol.encode()), data=expected.data, maps=len(maps),
                        stages=[f"{stage} {of['version']}" for stage, of in record["stages"].items()],
                        trained_on="" if names is None else _core.digest(names))
    made = scratch / "made.zip"
    data = submission.archive_of(card, manifest, expected.protocol, scores.getvalue().encode("utf-8", "surrogateescape"), maps, names)
    try:
        made.write_bytes(data)
    except OSError as error:
        raise StorageError(f"{scratch}: cannot be written: {error.strerror}; set TMPDIR to another") from None
    if isinstance(read := submission.read_all([made], expected, scratch)[0], str):
        raise InputError(f"{to}: would be refused, and was not written: {read}")
    try:
        to.parent.mkdir(parents=True, exist_ok=True)
        replace_file(to, data)
    except OSError as error:
        raise StorageError(f"{to}: cannot be written: {error.strerror}; choose another with --to") from None


def _require_free(to: Path) -> None:
    """Throws InputError for what is there and no archive: a map, say, or a folder."""
    if to.is_dir():
        raise InputError(f"--to {to}: is a folder; name the file to write, such as mine.zip")
    if to.exists() and not (to.is_file() and _head(to) in (b"PK", b"")):
        raise InputError(f"--to {to}: is there, and no submission; choose another")


def _head(path: Path) -> bytes:
    with open(path, "rb") as file:
        return file.read(2)


def leaderboard(given: argparse.Namespace) -> int:
    """given: FOLDER, --to and --models beside the arguments of both."""
    entries = board.archives_in(given.folder, may_be_none=bool(given.models))
    to = Path(given.to)
    folder.require_own(to)
    if to.exists() and to.samefile(given.folder):
        raise InputError(f"--to {to}: is the folder of the submissions; choose another")
    with _core.ScratchFolder() as name:
        scratch = Path(name)
        session = _Session(given, scratch)
        kept = given.models or ""
        before = session.run(kept=kept)
        expected = board.expected_of(before, before._run.protocol)
        passed = board.check_all(entries, expected, scratch, before.models, given.threads)
        made, results = board.rank(entries, passed, expected, lambda functions: session.run(kept=kept, functions=functions, silent=True),
                                   Path(given.config).stem)
        board.write_tables(made, results, scratch / "site/data")
        site.write_pages(made, scratch / "site")
        folder.publish(scratch / "site", to)
        document = {"to": given.to, "submissions": board.submissions(entries), "scores": tables.records(means.overview(made.study)),
                    "leaders": leaders.documents(made.leaders), **summary_of(results)}
        status = _failed(before)
    any_refused = any(entry.refused for entry in entries)
    report(given, "leaderboard", document, _text(made, given))
    return status or (SOME_FAILED if any_refused else ALL_DONE)


def _text(made: board.Board, given: argparse.Namespace) -> str:
    lines = [tables.aligned(means.overview(made.study)), *tables.of_truth(made.remarks), *made.sentences]
    lines += [f"refused: {entry.name}: {entry.refused}" for entry in made.of_status("refused")]
    return "\n".join([*lines, f"the leaderboard is {Path(given.to, 'index.html')}\n"])
