# SPDX-License-Identifier: GPL-3.0-or-later
"""`salbench gc`: removes artefacts from a cache: those that no run of some configurations needs, or all of
some stages."""

import argparse
import os
from typing import Any

from salbench.commands.parsing import Parser
from salbench.commands.running import settings_of
from salbench.system.console import ALL_DONE, aligned, report
from salbench.system.errors import InputError, arguments_refused
from salbench.system.progress import Progress


def add_arguments(parser: Parser) -> None:
    parser.add_data_set()
    parser.add_argument("--quiet", action="store_true", help="report only problems")
    parser.add_argument(
        "configs",
        metavar="CONFIG",
        nargs="*",
        default=[],
        help="configurations whose artefacts are kept; with --stage, those that name the cache",
    )
    parser.add_argument(
        "--stage",
        default="",
        metavar="NAMES",
        help="remove exactly the artefacts of these stages: map.LS,fpfh",
    )
    parser.add_argument("--dry-run", action="store_true", help="only report what would be removed")
    parser.add_report()


def carry_out(given: argparse.Namespace) -> int:
    from salbench import _core

    if not given.configs and not (given.stage and given.cache):
        raise InputError(
            "name the configurations to keep, or stages to remove with --stage, of a --cache DIR"
        )
    kept = [settings_of(given, config, pictures="cached") for config in given.configs]
    with arguments_refused(), Progress(given.quiet) as progress:
        found = _core.collect_garbage(
            kept, os.fsencode(given.cache or ""), os.fsencode(given.stage), given.dry_run, progress
        )
    report(given, "gc", found, _text(found))
    return ALL_DONE


def _text(found: dict[str, Any]) -> str:
    stages, removed = found["stages"], "to remove" if found["dry_run"] else "removed"
    rows = [
        (
            row["stage"],
            *(number for of in (row["kept"], row["removed"]) for number in (of["files"], of["bytes"] / 1e6)),
        )
        for row in stages
    ]
    waiting = (
        f"{found['waiting']} jobs wait for what they read: everything of their stages and items was kept\n"
        if found["waiting"]
        else ""
    )
    return (
        f"{aligned(('stage', 'kept', 'MB', removed, 'MB'), rows, decimals=1)}\n{'would be removed' if found['dry_run'] else 'removed'}:"
        f" {sum(row['removed']['files'] for row in stages)} artefacts"
        f" ({sum(row['removed']['bytes'] for row in stages) / 1e6:.1f} MB),"
        f" {found['damaged']['files']} damaged files, {found['unfinished']['files']} unfinished"
        f" files\n{waiting}"
    )
