# SPDX-License-Identifier: GPL-3.0-or-later
"""Converts arguments to settings of a run, and a run to an exit status."""

import argparse
import os
import sys
from collections import Counter
from typing import TYPE_CHECKING, Any

from salbench.system.console import ALL_DONE, DEFECT, SOME_FAILED
from salbench.system.errors import InputError

if TYPE_CHECKING:
    from salbench import _core
    from salbench.runs.settings import Settings


def settings_of(given: argparse.Namespace, config: str, **others: Any) -> "Settings":
    """Settings of a configuration with the arguments of `add_data_set` and further ones of the subcommand.
    Empty texts count as missing."""
    from salbench.runs.settings import Settings
    from salbench.shapes.reference import reference_of

    return Settings(
        path=config,
        data=given.data,
        cache=given.cache,
        items=os.fsencode(given.items) or None,
        split=given.split,
        reference=reference_of(given.reference),
        **others,
    )


def settings_of_run(given: argparse.Namespace, **others: Any) -> "Settings":
    """Settings from the arguments of `add_running`, `add_given_maps` and --models."""
    return settings_of(
        given,
        given.config,
        kept=given.models or None,
        maps={given.name: given.maps} if given.maps else {},
        matched=given.matched,
        keep_going=given.keep_going,
        **others,
    )


def require_data_set(layout: str, data: str | None) -> None:
    """Throws InputError if arguments of `add_layout` name no data set."""
    from salbench.datasets.sets import require_layout

    require_layout(layout)
    if not data:
        raise InputError("no data set is named: give --data DIR")


def finished_status(going: "_core.Run", summary: dict[str, Any]) -> int:
    """Exit status; prints a line that counts failures."""
    stages = Counter(failure["stage"] for failure in summary["failed"])
    if problems := len(going.problems()):
        stages["data set"] = problems
    if not stages:
        return ALL_DONE
    counts = ", ".join(f"{count} {stage}" for stage, count in sorted(stages.items()))
    print(f"\n{stages.total()} failed, each named above: {counts}", file=sys.stderr)
    return DEFECT if going.has_defect() else SOME_FAILED
