# SPDX-License-Identifier: GPL-3.0-or-later
"""`salbench import`: converts a data set to the HDF5 form."""

import argparse
import sys

from salbench.commands.parsing import Parser
from salbench.commands.running import require_data_set
from salbench.system.console import ALL_DONE, SOME_FAILED, report, warn
from salbench.system.progress import Progress


def add_arguments(parser: Parser) -> None:
    parser.add_layout()
    parser.add_argument("--to", metavar="DIR", required=True, help="folder to write the set to")
    parser.add_argument("--items", default="", metavar="LIST", help="only these shapes, such as 1-20,52,125")
    parser.add_argument(
        "--split", default="", metavar="NAME", help="only this split of the data set, such as test"
    )
    parser.add_report("no progress and no summary, only warnings and errors")


def carry_out(given: argparse.Namespace) -> int:
    from salbench.datasets import importing, samples

    require_data_set(given.layout, given.data)
    with Progress(given.quiet) as progress:
        done = importing.import_set(
            given.layout,
            given.data,
            given.to,
            given.items,
            given.split,
            lambda done, shapes: progress("importing", done, shapes, ""),
        )
    for note in done.notes:
        warn("warning", note)
    for shape in done.shapes:
        if shape.problem:
            more = f" (and {len(shape.problems)} more problems)" if shape.problems else ""
            warn("error", f"{shape.name}: {shape.problem}{more}")
    for line in samples.summed(fault for shape in done.shapes for fault in shape.faults):
        warn("warning", line)
    if not done.complete:
        print(f"\n{len(done.shapes)} shapes are done", file=sys.stderr)
        raise KeyboardInterrupt
    written, unchanged = done.count("written"), done.count("unchanged")
    shapes = [
        {
            "name": shape.name,
            "outcome": shape.outcome,
            "problem": shape.problem,
            "remarks": [*shape.problems, *map(str, shape.faults)],
        }
        for shape in done.shapes
    ]
    document = {
        "layout": done.layout,
        "shapes": shapes,
        "written": written,
        "unchanged": unchanged,
        "removed": done.removed,
        "n_problems": done.problems,
    }
    text = (
        f"{written} of {len(done.shapes)} shapes written to {given.to}, {unchanged} unchanged,"
        f" {done.removed} removed, {done.problems} with problems\n"
    )
    report(given, "import", document, text)
    return SOME_FAILED if done.problems else ALL_DONE
