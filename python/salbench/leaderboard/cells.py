# SPDX-License-Identifier: GPL-3.0-or-later
"""Texts of strangers in cells of CSV files that people open in a spreadsheet."""

_FORMULA = ("=", "+", "-", "@")


def plain(text: str) -> str:
    """What a spreadsheet would take for a formula stands behind an apostrophe."""
    return f"'{text}" if text.startswith(_FORMULA) else text
