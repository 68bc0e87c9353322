# SPDX-License-Identifier: GPL-3.0-or-later
"""`salbench conclude`: writes every table of conclusions, from scores per shape."""

import argparse
from pathlib import Path

from salbench.commands.parsing import Parser, names_in
from salbench.system.console import ALL_DONE, report, warn


def add_arguments(parser: Parser) -> None:
    parser.add_argument(
        "scores",
        metavar="OUT|SCORES.csv",
        help="results folder of a run, or a CSV file with columns item, model, metrics, and view of scans",
    )
    parser.add_argument(
        "--classes", metavar="FILE", help="CSV file with columns item and class; only with SCORES.csv"
    )
    parser.add_argument(
        "--unit", help="unit of observation: mesh, class or shape (default: that of the run, or mesh)"
    )
    parser.add_argument(
        "--higher", default="", metavar="NAMES", help="further columns of scores, for which higher is better"
    )
    parser.add_argument(
        "--lower", default="", metavar="NAMES", help="further columns of scores, for which lower is better"
    )
    parser.add_report("no table, only warnings and errors")
    parser.add_argument(
        "--out", metavar="DIR", help="folder of the tables (default: OUT, or salbench-out/NAME)"
    )


def carry_out(given: argparse.Namespace) -> int:
    from salbench import conclusions
    from salbench.conclusions.words import observation

    source = conclusions.source_of(
        given.scores,
        given.unit,
        classes=given.classes,
        higher=names_in(given.higher),
        lower=names_in(given.lower),
    )
    for note in source.notes:
        warn("warning", note)
    concluded, folder = conclusions.conclude(source, given.out), Path(given.out or source.tables)
    scores = source.study.scores
    unit = observation(concluded["unit"], scores.datasets, scores.in_views)
    of = f"one observation per {unit}; " if unit else ""  # without scores
    text = f"{concluded['text']}{of}tables in {folder}\n"
    report(
        given,
        "conclude",
        {"results": str(folder), **{name: concluded[name] for name in ("unit", "scores", "leaders")}},
        text,
    )
    return ALL_DONE
