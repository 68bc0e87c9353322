# SPDX-License-Identifier: GPL-3.0-or-later
"""The listing of a data set as C++ asks for it, as plain values. The standard library alone, and PyYAML for a user's description."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

from salbench.datasets._registry import find


def document(layout: str, root: str) -> dict[str, Any]:
    """Items, notes and files of a folder. Throws InputError, one line for the user."""
    archive = find(layout)
    listing = archive.items(root)
    facts = asdict(listing) | {"items": [item.to_json() for item in listing.items]}
    return {"layout": archive.LAYOUT.name, "version": archive.VERSION, **facts}
