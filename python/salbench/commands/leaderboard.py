# SPDX-License-Identifier: GPL-3.0-or-later
"""`salbench leaderboard`: checks and scores submissions, and writes a site that ranks them."""

import argparse

from salbench.commands.parsing import Parser


def add_arguments(parser: Parser) -> None:
    parser.add_argument("folder", metavar="FOLDER", help="folder of the submissions (NAME.zip)")
    parser.add_argument("--to", metavar="DIR", required=True, help="folder of the site")
    parser.add_argument(
        "--models",
        metavar="NAMES",
        help=(
            "also these models of the configuration, such as LS,PS (default: only people and chance); "
            "with them FOLDER may be empty"
        ),
    )
    parser.add_scoring()


def carry_out(given: argparse.Namespace) -> int:
    from salbench.leaderboard import commands

    return commands.leaderboard(given)
