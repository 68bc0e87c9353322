# SPDX-License-Identifier: GPL-3.0-or-later
"""`salbench reproduce`: recomputes the maps of a submission."""

import argparse

from salbench.commands.parsing import Parser


def add_arguments(parser: Parser) -> None:
    parser.add_argument(
        "card",
        metavar="CARD",
        help=(
            "submission (NAME.zip); its command runs with your permissions, so read it first (unzip -p"
            " NAME.zip model.yaml)"
        ),
    )
    parser.add_argument(
        "--model",
        metavar="DIR",
        default=".",
        help=(
            "folder with the code and weights of the command, or its parent; their digests must "
            "match the submission (default: the current folder)"
        ),
    )
    parser.add_argument(
        "--to",
        metavar="DIR",
        help="folder for a table of maps, and with --by for the submission with an updated card",
    )
    parser.add_argument(
        "--by", metavar="NAME", default="", help="your name, for a line with the result in the updated card"
    )
    parser.add_scoring(of_submission=True)


def carry_out(given: argparse.Namespace) -> int:
    from salbench.leaderboard import reproduce

    return reproduce.reproduce(given)
