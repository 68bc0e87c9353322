# SPDX-License-Identifier: GPL-3.0-or-later
"""`salbench import`: a data set in the HDF5 form."""

import argparse
import sys
from dataclasses import asdict

from salbench.commands.parsing import Parser
from salbench.commands.progress import Progress
from salbench.commands.running import require_data_set
from salbench.system.console import ALL_DONE, SOME_FAILED, report, warn

_MOST_SHOWN = 20  # remarks


def add_arguments(parser: Parser) -> None:
    parser.add_layout()
    parser.add_argument("--to", metavar="DIR", required=True, help="folder that the set is written to")
    parser.add_argument("--items", default="", metavar="LIST", help="only these shapes, such as 1-20,52,125")
    parser.add_argument("--split", default="", metavar="NAME", help="only this split of the data set, such as test")
    parser.add_report("neither progress nor a summary; warnings and errors only")


def carry_out(given: argparse.Namespace) -> int:
    from salbench.datasets import importing

    require_data_set(given.layout, given.data)
    with Progress(given.quiet) as progress:
        done = importing.import_set(given.layout, given.data, given.to, given.items, given.split,
                                    lambda done, shapes: progress("importing", done, shapes, ""))
    for note in done.notes:
        warn("warning", note)
    for shape in done.shapes:
        if shape.problem:
            warn("error", f"{shape.name}: {shape.problem}")
    remarks = [f"{shape.name}: {remark}" for shape in done.shapes for remark in shape.remarks]
    for line in remarks[:_MOST_SHOWN]:
        warn("warning", line)
    if len(remarks) > _MOST_SHOWN:
        warn("warning", f"{len(remarks) - _MOST_SHOWN} more remarks on rows of recordings, which --format json has")
    if not done.complete:
        print(f"\n{len(done.shapes)} shapes are done", file=sys.stderr)
        raise KeyboardInterrupt
    written, unchanged = done.count("written"), done.count("unchanged")
    document = {"layout": done.layout, "shapes": [asdict(shape) for shape in done.shapes], "written": written, "unchanged": unchanged,
                "removed": done.removed, "n_problems": done.problems}
    text = (f"{written} of {len(done.shapes)} shapes written to {given.to}, {unchanged} unchanged, {done.removed} removed, "
            f"{done.problems} with problems\n")
    report(given, "import", document, text)
    return SOME_FAILED if done.problems else ALL_DONE
