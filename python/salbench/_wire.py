# SPDX-License-Identifier: GPL-3.0-or-later
"""JSON between the program and the package. Strings are those of the system, whose bytes may be no UTF-8: each byte is a character of its own."""

from __future__ import annotations

import json
from typing import Any


def dumps(value: Any) -> bytes:
    return json.dumps(value, ensure_ascii=False).encode("utf-8", "surrogateescape").decode("latin-1").encode()


def loads(text: bytes) -> Any:
    return json.loads(text.decode().encode("latin-1").decode("utf-8", "surrogateescape"))
