# SPDX-License-Identifier: GPL-3.0-or-later
"""`salbench config`: prints the annotated configuration, which is itself valid."""

import argparse
import os

from salbench.commands.parsing import Parser
from salbench.system.console import ALL_DONE, report
from salbench.system.errors import arguments_refused


def add_arguments(parser: Parser) -> None:
    parser.add_argument(
        "config",
        metavar="CONFIG",
        nargs="?",
        help=(
            "configuration file (YAML), run.yaml of a run (its configuration and items), "
            "or the name of an installed one, such as shrec07; without it, the defaults"
        ),
    )
    parser.add_report()


def carry_out(given: argparse.Namespace) -> int:
    from salbench import _core

    with arguments_refused():
        yaml = _core.config_text(os.fsencode(given.config or ""))
    report(given, "config", {"yaml": yaml}, yaml)
    return ALL_DONE
