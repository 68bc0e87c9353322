# SPDX-License-Identifier: GPL-3.0-or-later
"""The program's tables as data frames: the same doubles, and names as texts whatever they look like."""

import io
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import pandas

NAMES = ("item", "view", "class", "split", "model", "model_a", "model_b", "group")


def read(text: str) -> "pandas.DataFrame":
    """A table from the text of its file, whose remarks stand above it."""
    import pandas

    while text.startswith("#"):
        text = text.partition("\n")[2]
    return pandas.read_csv(io.StringIO(text), dtype=dict.fromkeys(NAMES, str), keep_default_na=False, na_values=[""],
                           float_precision="round_trip")
