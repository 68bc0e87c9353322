# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs that commands over submissions start, and what they say of them."""

import argparse
import logging
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from salbench.runs import run
from salbench.runs.results import Results
from salbench.runs.settings import Settings
from salbench.system.console import ALL_DONE, SOME_FAILED
from salbench.system.errors import arguments_refused


class Session:
    """Runs over the data set of a command, in a scratch folder."""

    def __init__(self, given: argparse.Namespace, scratch: Path) -> None:
        self.given, self.scratch = given, scratch
        self._runs = 0
        self._log = logging.getLogger("salbench")

    def run(self, *, kept: str | None = None, maps: dict[str, str] | None = None, functions: Mapping[str, Any] | None = None,
            silent: bool = False) -> Results:
        """kept: models of the configuration. silent: what there is to say of the data was said before, and failures of maps are reasons in the
        tables."""
        given = self.given
        self._runs += 1
        settings = Settings(given.config, models="{}" if kept is None else None, kept=kept, maps=maps or {}, data=given.data, cache=given.cache,
                            out=str(self.scratch / f"run{self._runs}"), items=b"scored", split=given.split, reference=given.reference,
                            functions=functions or {})
        self._log.disabled = silent
        try:
            with arguments_refused():
                return run.carry_out(settings, given.threads, not given.quiet and sys.stderr.isatty())
        finally:
            self._log.disabled = False


def summary_of(results: Results) -> dict[str, Any]:
    """What a session did, for the document of a command."""
    record = results.record
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
