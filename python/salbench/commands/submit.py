# SPDX-License-Identifier: GPL-3.0-or-later
"""`salbench submit`: writes a file for a leaderboard."""

import argparse

from salbench.commands.parsing import Parser


def add_arguments(parser: Parser) -> None:
    parser.add_argument(
        "mine", metavar="MINE", help="folder with card.yaml, and ITEM.val for every item with ground truth"
    )
    parser.add_argument("--to", metavar="FILE", required=True, help="file to write, such as mine.zip")
    parser.add_scoring()


def carry_out(given: argparse.Namespace) -> int:
    from salbench.leaderboard import commands

    return commands.submit(given)
