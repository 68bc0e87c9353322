# SPDX-License-Identifier: GPL-3.0-or-later
"""conclusions.json in a folder of results. It is written last and removed first, so its presence implies that
of all tables. Reading it needs none of the libraries behind the conclusions."""

import contextlib
import hashlib
import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from salbench import _core
from salbench.system.files import read_file

NAME = "conclusions.json"
FORMAT = 1
MOST = 1 << 26  # bytes
# missing, or of another version
_UNUSABLE = (OSError, ValueError, KeyError, TypeError, AttributeError, RecursionError)


def digest(data: bytes, as_of: str = "xxh128:") -> str:
    """Digest of a table. as_of: a recorded digest; version 1.0 used another kind."""
    return (
        "xxh128:" + _core.xxh128(data)
        if as_of.startswith("xxh128:")
        else hashlib.blake2b(data, digest_size=16).hexdigest()
    )


def read_if_whole(folder: Path, of: str | None = None) -> dict[str, Any] | None:
    """Returns the document if all tables are unchanged. of: also requires these scores and the present
    format."""
    with contextlib.suppress(*_UNUSABLE):
        document: dict[str, Any] = json.loads(read_file(folder / NAME, MOST))
        is_of_them = of is None or (document["format"], document["of"]) == (FORMAT, of)
        if is_of_them and all(_is_as_noted(folder, name, document["files"]) for name in document["tables"]):
            return document
    return None


def changed(folder: Path) -> list[str]:
    """Scores and tables that have changed since conclusions were drawn."""
    with contextlib.suppress(*_UNUSABLE):
        noted = json.loads(read_file(folder / NAME, MOST))["files"]
        return [name for name in noted if (folder / name).is_file() and not _is_as_noted(folder, name, noted)]
    return []


def _is_as_noted(folder: Path, name: str, noted: Mapping[str, str]) -> bool:
    return name == os.path.basename(name) and digest(read_file(folder / name), noted[name]) == noted[name]
