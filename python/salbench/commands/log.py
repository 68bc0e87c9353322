# SPDX-License-Identifier: GPL-3.0-or-later
"""Prints warnings and errors of the engine, which are records of the logger "salbench", on standard error."""

import logging

from salbench.system.console import warn


class _Said(logging.Handler):
    def emit(self, record: logging.LogRecord) -> None:
        warn(record.levelname.lower(), record.getMessage())


_SAID = _Said()


def say_log() -> None:
    """Starts printing, in the same format as messages of commands."""
    logging.getLogger("salbench").addHandler(_SAID)
