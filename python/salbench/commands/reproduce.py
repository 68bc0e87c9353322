# SPDX-License-Identifier: GPL-3.0-or-later
"""`salbench reproduce`: recomputes the maps of a submission."""

import argparse

from salbench.commands.parsing import Parser


def add_arguments(parser: Parser) -> None:
    parser.add_argument(
        "card",
        metavar="CARD",
        help=(
            "the submission (NAME.zip), whose command is run as you: read it first (unzip -p NAME.zip"
            " model.yaml)"
        ),
    )
    parser.add_argument(
        "--model",
        metavar="DIR",
        default=".",
        help=(
            "folder with the code and weights that the command depends on, or the one above "
            "it; their digests must be those of the card (default: the present folder)"
        ),
    )
    parser.add_argument(
        "--to",
        metavar="DIR",
        help="folder for a table of maps, and with --by for the submission with a new card",
    )
    parser.add_argument(
        "--by",
        metavar="NAME",
        default="",
        help="who you are: a line of the new card says so, with what came out",
    )
    parser.add_scoring(of_submission=True)


def carry_out(given: argparse.Namespace) -> int:
    from salbench.leaderboard import reproduce

    return reproduce.reproduce(given)
