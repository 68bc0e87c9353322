# SPDX-License-Identifier: GPL-3.0-or-later
"""Warnings of the stages as records of logging."""

import logging


def say(records: list[tuple[int, bytes]]) -> None:
    """Logs each (level, text)."""
    log = logging.getLogger("salbench")
    for level, text in records:
        log.log(level, "%s", text.decode(errors="backslashreplace"))
