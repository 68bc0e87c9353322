# SPDX-License-Identifier: GPL-3.0-or-later
"""`salbench report`: pages of a run that open from disk."""

import argparse
import os
from pathlib import Path

from salbench.commands.parsing import Parser, names_in
from salbench.system.console import ALL_DONE, report


def add_arguments(parser: Parser) -> None:
    parser.add_argument("results", metavar="OUT", help="results folder of salbench run")
    parser.add_argument("--to", metavar="DIR", help="folder of the report (default: OUT/report)")
    parser.add_argument(
        "--export",
        metavar="FILE.h5",
        nargs="+",
        action="extend",
        default=[],
        help=(
            "exports of shapes to show, with the pictures that --pictures of salbench export takes (default:"
            " OUT/shapes.h5 if it exists, else what is in the cache of the run)"
        ),
    )
    parser.add_argument(
        "--examples",
        metavar="ITEMS",
        default="",
        help="meshes to show as examples, such as 52,125 (default: chosen by score)",
    )
    parser.add_argument(
        "--mine",
        metavar="MODEL",
        default="",
        help=(
            "the model that the report is about: first and marked in every table, and "
            "compared with each other one"
        ),
    )
    parser.add_argument(
        "--metrics",
        metavar="NAMES",
        default="",
        help="metrics that pages are about, such as nss,cc (default: the first of the run)",
    )
    parser.add_argument(
        "--models",
        metavar="NAMES",
        default="",
        help="models that pages show; ranks and groups stay those among all",
    )
    parser.add_argument(
        "--picks",
        action="store_true",
        help=(
            "what participants picked as dots on pictures of the ground truth; the viewer shows it in "
            "any case"
        ),
    )
    parser.add_argument(
        "--no-viewer",
        dest="viewer",
        action="store_false",
        help=(
            "pictures alone: neither coordinates nor ground truth of the shapes, for pages that go where the"
            " data may not"
        ),
    )
    parser.add_count(
        "--processes",
        "that draw at the same time; the report does not depend on it (default: one per core)",
        default=len(os.sched_getaffinity(0)),
    )
    parser.add_report("no path; warnings and errors only")


def carry_out(given: argparse.Namespace) -> int:
    from salbench.system.scratch import ScratchFolder

    # also for Matplotlib's font list: nothing is written outside the folder of the report
    with ScratchFolder() as scratch:
        os.environ |= {"MPLCONFIGDIR": scratch, "MPLBACKEND": "Agg"}
        from salbench.report.write import write_report

        page = write_report(
            Path(given.results),
            Path(scratch),
            to=Path(given.to) if given.to else None,
            exports=given.export,
            examples=names_in(given.examples),
            processes=given.processes,
            viewer=given.viewer,
            picks=given.picks,
            mine=given.mine,
            metrics=names_in(given.metrics),
            models=names_in(given.models),
        )
    report(given, "report", {"page": str(page)}, f"{page}\n")
    return ALL_DONE
