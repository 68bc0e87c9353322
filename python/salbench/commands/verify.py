# SPDX-License-Identifier: GPL-3.0-or-later
"""`salbench verify`: reads every artefact of caches, and recomputes a sample of them."""

import argparse
import os
from typing import Any

from salbench.commands.parsing import Parser
from salbench.commands.running import settings_of
from salbench.system.console import ALL_DONE, SOME_FAILED, report, write_output
from salbench.system.errors import InputError, arguments_refused
from salbench.system.progress import Progress

_MOST_SAMPLED = 2**31 - 1


def add_arguments(parser: Parser) -> None:
    parser.add_data_set()
    parser.add_argument("--quiet", action="store_true", help="report only problems")
    parser.add_argument(
        "configs", metavar="CONFIG", nargs="*", default=[], help="configuration files; none with --cache"
    )
    parser.add_argument(
        "--deep", action="store_true", help="also recompute a sample of the cached jobs, and compare"
    )
    parser.add_count("--sample", "size of the sample (default: 20)", most=_MOST_SAMPLED)
    parser.add_report()
    for name in ("--deep", "--data"):
        parser.add_rule(name, "requires", "CONFIG")
    for name in ("--sample", "--items", "--split", "--reference"):
        parser.add_rule(name, "requires", "--deep")


def carry_out(given: argparse.Namespace) -> int:
    if not given.configs and not given.cache:
        raise InputError("name a configuration, or a cache with --cache DIR")
    found: dict[str, Any] = {"caches": [], "samples": [], "interrupted": False}
    try:
        with arguments_refused():
            _check(given, found)
    except KeyboardInterrupt:
        _report(given, found | {"interrupted": True})
        raise
    _report(given, found)
    return (
        SOME_FAILED if any(checked["faults"] for checked in found["caches"] + found["samples"]) else ALL_DONE
    )


def _check(given: argparse.Namespace, found: dict[str, Any]) -> None:
    """Checks each cache once, and a sample of each configuration."""
    from salbench import _core

    seen = set()
    if not given.configs:
        found["caches"].append(_check_cache(given, given.cache))
    for config in given.configs:
        settings = settings_of(given, config, pictures="cached")
        cache = _core.cache_of(settings)
        if os.path.realpath(cache) not in seen:
            seen.add(os.path.realpath(cache))
            found["caches"].append(_check_cache(given, cache))
        if given.deep:
            found["samples"].append(_check_sample(given, _core.verify_sample(settings, given.sample or 20)))


def _check_cache(given: argparse.Namespace, cache: str) -> dict[str, Any]:
    from salbench import _core

    with Progress(given.quiet) as progress:
        checked = _core.verify_cache(os.fsencode(cache), progress)
    n_bad, others = len(checked["faults"]), checked["other_files"]
    _say(
        given,
        checked,
        (
            f"{checked['cache']}: {checked['artefacts']} artefacts, {checked['bytes'] / 1e6:.1f} MB:"
            f" {n_bad} bad"
            f"{'; run again, which computes what was damaged, or gc' if n_bad else ''}{f'; {others} other files, left alone' if others else ''}\n"
        ),
    )
    return checked


def _check_sample(given: argparse.Namespace, checked: dict[str, Any]) -> dict[str, Any]:
    _say(
        given,
        checked,
        (
            f"{checked['configuration']}: {checked['jobs']} of its jobs computed again:"
            f" {len(checked['faults'])} came out otherwise\n"
        ),
    )
    return checked


def _say(given: argparse.Namespace, checked: dict[str, Any], summary: str) -> None:
    """Prints the result of a check immediately, since the next one may take long or fail."""
    if given.format == "text":
        write_output(
            "".join(f"{fault['file']}: {fault['what']}\n" for fault in checked["faults"])
            + ("" if given.quiet else summary)
        )


def _report(given: argparse.Namespace, found: dict[str, Any]) -> None:
    report(given, "verify", found, "")
