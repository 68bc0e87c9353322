# SPDX-License-Identifier: GPL-3.0-or-later
"""`salbench report`: writes pages of a run that open from disk."""

import argparse
import os
from pathlib import Path

from salbench.commands.parsing import Parser, names_in
from salbench.system.console import ALL_DONE, report
from salbench.system.errors import InputError
from salbench.system.progress import Progress


_WORDS = ("shapes", "models", "metrics", "views")  # keys of --figure


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
            "exports of shapes to show, made by salbench export --pictures (default: OUT/shapes.h5 if it"
            " exists, otherwise the cache of the run)"
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
            "the model that the report is about: first and highlighted in every table, and "
            "compared with every other one"
        ),
    )
    parser.add_argument(
        "--metrics",
        metavar="NAMES",
        default="",
        help="metrics to show, such as nss,cc (default: the leading ones of the run)",
    )
    parser.add_argument(
        "--models", metavar="NAMES", default="", help="models to show; ranks and groups stay those among all"
    )
    parser.add_argument(
        "--picks",
        action="store_true",
        help=(
            "show picks of participants, or their fixations without those of people who are left out, as dots"
            " on pictures of the ground truth; the viewer always shows them"
        ),
    )
    parser.add_argument(
        "--no-viewer",
        dest="viewer",
        action="store_false",
        help=(
            "only pictures, without coordinates and ground truth of the shapes, for publication where the"
            " data may not be published"
        ),
    )
    parser.add_argument(
        "--figure",
        metavar="KEY=VALUE",
        nargs="+",
        action="extend",
        default=[],
        help=(
            "write one figure for print instead, figure.pdf and figure.svg (default: in OUT): a row for each of"
            " shapes=9,52_3 with its ground truth and maps; models=LS,MINE and metrics=nss (default: all, and the"
            " leading ones); views=9:30:10, azimuth and elevation of the camera of a mesh or point cloud in degrees"
        ),
    )
    parser.add_count(
        "--processes",
        "processes that draw (default: one per core); the report does not depend on it",
        default=len(os.sched_getaffinity(0)),
    )
    parser.add_report("no progress and no path, only warnings and errors")


def carry_out(given: argparse.Namespace) -> int:
    from salbench.system.scratch import ScratchFolder

    os.environ["MPLBACKEND"] = "Agg"  # Matplotlib cannot be imported with a wrong one
    with ScratchFolder() as scratch, Progress(given.quiet) as progress:
        page = (
            _figure(given, Path(scratch), progress)
            if given.figure
            else _report(given, Path(scratch), progress)
        )
    report(given, "report", {"page": str(page)}, f"{page}\n")
    return ALL_DONE


def _report(given: argparse.Namespace, scratch: Path, progress: Progress) -> Path:
    from salbench.report.write import write_report

    return write_report(
        Path(given.results),
        scratch,
        to=Path(given.to) if given.to else None,
        exports=given.export,
        examples=names_in(given.examples),
        processes=given.processes,
        viewer=given.viewer,
        picks=given.picks,
        mine=given.mine,
        metrics=names_in(given.metrics),
        models=names_in(given.models),
        told=progress,
    )


def _figure(given: argparse.Namespace, scratch: Path, progress: Progress) -> Path:
    from salbench.report.one_figure import write_figure

    words = dict(word.replace(", ", ",").partition("=")[::2] for word in given.figure)
    if unknown := [word for word in words if word not in _WORDS]:
        raise InputError(f"--figure {unknown[0]}: expected {', '.join(f'{word}=...' for word in _WORDS)}")
    if not words.get("shapes"):
        raise InputError("--figure: names no shapes, such as shapes=9,52")
    return write_figure(
        Path(given.results),
        scratch,
        Path(given.to or given.results),
        **{word: names_in(words[word]) for word in _WORDS[:3] if word in words},
        views=dict(map(_view, names_in(words.get("views", "")))),
        picks=given.picks,
        processes=given.processes,
        told=progress,
    )


def _view(text: str) -> tuple[str, tuple[float, float]]:
    """Parses SHAPE:AZIMUTH:ELEVATION."""
    name, *angles = text.rsplit(":", 2)
    try:
        azimuth, elevation = map(float, angles)
    except ValueError:
        raise InputError(f"--figure views={text}: expected SHAPE:AZIMUTH:ELEVATION, in degrees") from None
    azimuth -= 360 if 180 < azimuth <= 360 else 0
    if not (abs(azimuth) <= 180 and abs(elevation) <= 89):
        raise InputError(
            f"--figure views={text}: expected an azimuth of -180 to 360, an elevation of -89 to 89"
        )
    return name, (azimuth, elevation)
