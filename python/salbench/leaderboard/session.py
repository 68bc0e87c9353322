# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs of the program that commands over submissions start, and what they say of them."""

import argparse
import logging
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from salbench import _run
from salbench._command_line import ALL_DONE, SOME_FAILED, Parser
from salbench._errors import InputError, StorageError
from salbench._results import Results
from salbench.leaderboard import board

CONFIG = "shrec07_meshes"


def add_arguments(parser: Parser, has_config: bool = True) -> None:
    """Those that all have: of a run over what has ground truth whose configuration need not be named; of a submission it is known."""
    if has_config:
        parser.add_argument("-c", "--config", metavar="CONFIG", default=CONFIG, help=f"configuration, or the name of an installed one (default: {CONFIG})")
    parser.add_argument("--data", metavar="DIR", help="folder of the data set")
    default = "cache in CONFIG, or salbench-cache" if has_config else "none: everything is computed; what is in one counts as made here"
    parser.add_argument("--cache", metavar="DIR", help=f"folder of the artefacts (default: {default})")
    parser.add_argument("--split", help="only this split of the data set, such as test; '': all, where CONFIG names one")
    parser.add_argument("--reference", metavar="FILE", help="match to this histogram (CSV with a column GS of 100 bins), not to the mean over the "
                        "data set; items: to the mean over the items with ground truth")
    parser.add_count("--threads", "threads (default: all cores); results do not depend on it")
    parser.add_report("neither progress nor tables; warnings and errors only")


class Session:
    """Runs over the data set of a command, in a scratch folder, and says on standard error what the program would."""

    def __init__(self, given: argparse.Namespace, scratch: Path) -> None:
        self.given, self.scratch = given, scratch
        self._runs = 0
        self._log = logging.getLogger("salbench")

    def run(self, *, kept: str | None = None, maps: dict[str, str] | None = None, functions: Iterable[Any] = (),
            silent: bool = False) -> Results:
        """kept: models of the configuration. silent: what there is to say of the data was said before, and failures of maps are reasons in the
        tables."""
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


def failed(results: Results) -> int:
    """The status, with a line that counts what failed."""
    if not results.failures:
        return ALL_DONE
    print(f"\n{len(results.failures)} failed, each named above", file=sys.stderr)
    return SOME_FAILED
