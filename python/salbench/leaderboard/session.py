# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs that commands over submissions start, and what they say of them."""

import argparse
import logging
import sys
import tempfile
from collections.abc import Mapping
from typing import Any

from salbench.runs import run
from salbench.runs.results import Results
from salbench.runs.settings import Settings
from salbench.system.console import ALL_DONE, SOME_FAILED
from salbench.system.errors import arguments_refused


def run_over(given: argparse.Namespace, scratch: str, *, kept: str | None = None, maps: Mapping[str, str] | None = None,
             functions: Mapping[str, Any] | None = None, silent: bool = False) -> Results:
    """A run over the data set of a command, with its tables in a new folder below `scratch`. kept: models of the configuration. silent: what there
    is to say of the data was said before, and failures of maps are reasons in the tables."""
    settings = Settings(given.config, models="{}" if kept is None else None, kept=kept, maps=maps or {}, data=given.data, cache=given.cache,
                        out=tempfile.mkdtemp(dir=scratch), items=b"scored", split=given.split, reference=given.reference, functions=functions or {})
    log = logging.getLogger("salbench")
    log.disabled = silent
    try:
        with arguments_refused():
            return run.carry_out(settings, given.threads, not given.quiet and sys.stderr.isatty())
    finally:
        log.disabled = False


def summary_of(results: Results) -> dict[str, Any]:
    """What a run did, for the document of a command."""
    done: dict[str, Any] = results._run.summary()
    return done | {"models": results.scores["model"].nunique()}  # people among them


def failed(results: Results) -> int:
    """The status, with a line that counts what failed."""
    if not results.failures:
        return ALL_DONE
    print(f"\n{len(results.failures)} failed, each named above", file=sys.stderr)
    return SOME_FAILED
