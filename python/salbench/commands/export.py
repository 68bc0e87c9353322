# SPDX-License-Identifier: GPL-3.0-or-later
"""`salbench export`: writes a run's data on its items, as files for viewers and other programs."""

import argparse
import os

from salbench.commands.parsing import Parser
from salbench.commands.running import finished_status, settings_of_run
from salbench.system.console import report
from salbench.system.errors import arguments_refused
from salbench.system.progress import Progress


def add_arguments(parser: Parser) -> None:
    parser.add_running()
    parser.add_argument(
        "--stage",
        default="",
        metavar="NAMES",
        help="only these stages, such as scan,fpfh,map.LS; map means all of map.*",
    )
    parser.add_argument("--models", metavar="NAMES", help="only these models, such as LS,PS")
    parser.add_given_maps("also external maps, as for salbench run --maps")
    parser.add_argument(
        "--to", metavar="TO", required=True, help="HDF5 file, or folder of shapes or maps, to write"
    )
    parser.add_choice(
        "--format",
        ("h5", "ply", "maps"),
        (
            "h5 (default); ply: one shape per item; or maps: TO/MODEL/ITEM.val, one value per line, "
            "after histogram matching with --stage matched"
        ),
        dest="form",
    )
    parser.add_argument(
        "--link", action="store_true", help="link to the artefacts in the cache instead of copying them"
    )
    parser.add_argument(
        "--pictures", action="store_true", help="compute missing pictures, for reports that show shapes"
    )
    parser.add_argument(
        "--for-report",
        action="store_true",
        help="only cached data that salbench report shows, with pictures; computes no maps",
    )
    parser.add_choice(
        "--summary",
        ("text", "json"),
        "text (default), or json: a summary for programs (docs/json.md)",
        dest="format",
    )


def carry_out(given: argparse.Namespace) -> int:
    from salbench import _core

    going = _core.Run(settings_of_run(given, pictures="computed" if given.pictures else ""), [])
    with arguments_refused(), Progress(given.quiet) as progress:
        written = going.export(
            given.threads,
            progress,
            os.fsencode(given.to),
            given.form,
            os.fsencode(given.stage),
            given.link,
            given.for_report,
        )
    summary = going.summary()
    plural = "" if written == 1 else "s"
    what = {
        "h5": f"exported to {given.to}",
        "ply": f"{written} shape{plural} written to {given.to}",
        "maps": f"{written} map{plural} written to {given.to}",
    }
    report(
        given,
        "export",
        {"to": given.to, "format": given.form, "shapes": written, **summary},
        f"{what[given.form]}\n",
    )
    return finished_status(going, summary)
