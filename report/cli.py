# SPDX-License-Identifier: GPL-3.0-or-later
"""scripts/report OUT [--to DIR] [--export FILE.h5 ...] [--compare OUT2]: the report of a results folder. It is installed
as salbench-report."""

import argparse
import os
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent  # of the checkout; installed: PREFIX/share/salbench
INSTALLED = not (ROOT / "scripts").exists()
NAME = "salbench-report" if INSTALLED else "scripts/report"
PROGRAM = ROOT.parent.parent / "bin/salbench" if INSTALLED else ROOT / "build/release/salbench"


def arguments(argv):
    parser = argparse.ArgumentParser(
        prog=NAME,
        description="Turns the results folder of a run into a report: HTML pages that open from disk. Pictures and the "
                    "viewer are made of what exports hold: salbench pictures CONFIG --items 1,2,3, then salbench export "
                    "CONFIG --items 1,2,3 --to OUT/shapes.h5.",
        epilog="Exit status: 0 written; 2 unusable arguments or folders.")
    parser.add_argument("results", metavar="OUT", help="results folder of salbench run or evaluate")
    parser.add_argument("--to", metavar="DIR", help="folder of the report (default: OUT/report); nothing else is written")
    parser.add_argument("--export", metavar="FILE.h5", nargs="+", action="extend",
                        help="exports that hold shapes to show (default: OUT/shapes.h5 if it exists)")
    parser.add_argument("--compare", metavar="OUT2", help="results folder of another run, laid beside this one")
    parser.add_argument("--examples", metavar="ITEMS", default="",
                        help="meshes to show as examples, such as 52,125 (default: chosen by score)")
    parser.add_argument("--program", metavar="FILE", default=str(PROGRAM),
                        help="the built program, asked for the configuration of both protocols (default: %(default)s)")
    parser.add_argument("--processes", metavar="N", type=int, default=cores(),
                        help="that draw at the same time; the report does not depend on it (default: one per core)")
    return parser.parse_args(argv)


def cores():
    return len(os.sched_getaffinity(0))


def protocols(program):
    """protocol -> complete configuration as `salbench config` prints it; empty if the program is not built."""
    import yaml

    found = {}
    for protocol in ("published", "text"):
        with tempfile.NamedTemporaryFile("w", suffix=".yaml") as file:
            file.write(f"protocol: {protocol}\n")
            file.flush()
            try:
                printed = subprocess.run([program, "config", file.name], stdout=subprocess.PIPE, text=True, timeout=60,
                                         stderr=subprocess.DEVNULL, check=True).stdout
                found[protocol] = yaml.load(printed, Loader=yaml.BaseLoader)
            except (OSError, subprocess.SubprocessError, yaml.YAMLError):
                continue
    return found


def main(argv=None):
    options = arguments(argv)
    with tempfile.TemporaryDirectory() as scratch:  # Matplotlib's font list: nothing is written outside --to
        os.environ["MPLCONFIGDIR"] = scratch
        from report.results import Unusable
        from report.write import write_report

        try:
            path = write_report(options, protocols(options.program))
        except Unusable as error:
            print(f"{NAME}: {error}", file=sys.stderr)
            return 2
    print(path)
    return 0
