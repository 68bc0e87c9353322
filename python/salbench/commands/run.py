# SPDX-License-Identifier: GPL-3.0-or-later
"""`salbench run`: computes missing results, writes the tables, and draws conclusions from the scores."""

import argparse
import contextlib
import shlex
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING

from salbench.commands.parsing import Parser
from salbench.commands.running import finished_status, settings_of_run
from salbench.runs import outcome
from salbench.system.console import DEFECT, aligned, report, warn
from salbench.system.errors import arguments_refused
from salbench.system.processes import ends_at_once
from salbench.system.progress import Progress

if TYPE_CHECKING:
    from salbench import _core

# key of run.yaml for the completeness, such as "partial, 3 of 6 shapes have all scores"
_RESULTS = "results: "


def add_arguments(parser: Parser) -> None:
    parser.add_running()
    parser.add_output()
    parser.add_argument(
        "--models", metavar="NAMES", help="only these models of the configuration, such as LS,PS"
    )
    parser.add_given_maps(
        "also score external maps: a folder with ITEM.val (52.val for a mesh, 52_3.val for its scan 3; one"
        " value per line) or ITEM.npy, or an HDF5 file with data sets ITEM; over all items with ground truth"
        " unless --items is given"
    )
    parser.add_report()


def carry_out(given: argparse.Namespace) -> int:
    from salbench import _core

    going = _core.Run(settings_of_run(given, out=given.out, shard=given.shard), [])
    with arguments_refused(), ends_at_once():
        going.cache  # plans the run
    with contextlib.suppress(KeyboardInterrupt), Progress(given.quiet) as progress:
        going.carry_out(given.threads, progress)
    found, summary = outcome.of(going), going.summary()  # also after a signal: for finished jobs
    shown = outcome.Outcome() if summary["interrupted"] else found
    document = {
        "results": going.output,
        "protocol": going.protocol_name,
        "simulated": going.simulated,
        "shard": going.shard or None,
        "scores": shown.scores,
        "leaders": shown.leaders,
        "maps": [
            {"model": model, "computed": computed, "read": read}
            for model, computed, read, *_ in going.models()
        ],
        **summary,
    }
    report(given, "run", document, "" if summary["interrupted"] else _text(going, shown))
    if found.missing:
        warn("warning", f"no conclusions: {found.missing}")
    if found.failure:
        warn(
            "error",
            (
                f"{going.output}: the scores are there, but no conclusions from them: {found.failure}; "
                f"salbench conclude {shlex.quote(going.output)} tries again"
            ),
        )
    if summary["interrupted"]:
        _say_state(going)
        raise KeyboardInterrupt
    status = DEFECT if found.failure else finished_status(going, summary)
    if summary["failed"] and going.scores and (missing := _missing(going)):
        print(missing, file=sys.stderr)
    return status


def _missing(going: "_core.Run") -> str:
    """Sentence on models without a map, with causes; empty if all have one, or the package that reads the
    record is missing."""
    from salbench.runs import failed

    with contextlib.suppress(ModuleNotFoundError):
        from salbench.conclusions import folders

        return failed.sentence(Path(going.output), folders.read_record(Path(going.output, "run.yaml")))
    return ""


def _text(going: "_core.Run", shown: outcome.Outcome) -> str:
    if going.shard:
        return (
            f"shard {going.shard}: {going.inputs_text}, {outcome.computed_text(going)}; when all shards are"
            " done, the same line without --shard writes the tables\n"
        )
    rows = [
        (model, computed, read, _span(first, last)) for model, computed, read, first, last in going.models()
    ]
    return (
        shown.text + aligned(("maps of", "computed now", "read", "from"), rows) + f"{outcome.places(going)}\n"
        f"to write a report: salbench report {shlex.quote(going.output)}\n"
    )


def _span(first: float, last: float) -> str:
    """Times of the first and the last map that was read from the cache; "" if none was."""
    if first > last:
        return ""
    ends = [time.strftime("%Y-%m-%d %H:%M", time.localtime(at)) for at in (first, last)]
    return " to ".join(dict.fromkeys(ends))


def _say_state(going: "_core.Run") -> None:
    """Prints the state of an interrupted run from run.yaml; a share has no such line."""
    if going.shard:
        return
    for line in (
        (Path(going.output) / "run.yaml").read_text(encoding="utf-8", errors="surrogateescape").splitlines()
    ):
        if line.startswith(_RESULTS):
            print(f"\n{going.output}: {line.removeprefix(_RESULTS)}", file=sys.stderr)
