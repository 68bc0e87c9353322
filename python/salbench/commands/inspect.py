# SPDX-License-Identifier: GPL-3.0-or-later
"""`salbench inspect`: what a data set has in a folder, and what is wrong with it."""

import argparse

from salbench.commands.parsing import Parser


def add_arguments(parser: Parser) -> None:
    parser.add_layout()
    parser.add_argument("--against", metavar="LAYOUT2", help="also name shapes that are near copies of some of this data set (in --against-data), or "
                        "of the same one: whatever their names, scale, pose and meshing")
    parser.add_argument("--against-data", metavar="DIR", help="folder of that data set (default: that of --data)")
    parser.add_report()


def carry_out(given: argparse.Namespace) -> int:
    from salbench.datasets import inspecting

    return inspecting.command(given)
