# SPDX-License-Identifier: GPL-3.0-or-later
"""`salbench import`: a data set in the HDF5 form."""

import argparse

from salbench.commands.parsing import Parser


def add_arguments(parser: Parser) -> None:
    parser.add_layout()
    parser.add_argument("--to", metavar="DIR", required=True, help="folder that the set is written to")
    parser.add_argument("--items", default="", metavar="LIST", help="only these shapes, such as 1-20,52,125")
    parser.add_argument("--split", default="", metavar="NAME", help="only this split of the data set, such as test")
    parser.add_report("neither progress nor a summary; warnings and errors only")


def carry_out(given: argparse.Namespace) -> int:
    from salbench.datasets import importing

    return importing.command(given)
