# SPDX-License-Identifier: GPL-3.0-or-later
"""Several shape files of one name, such as a.off and a.ply: which of them is the item."""

from __future__ import annotations

import os
from collections.abc import Sequence

from salbench.datasets._files import extension, stem
from salbench.datasets.records import InputError

TWINS = ("refuse", "off", "obj", "ply", "pcd", "xyz")


def _names(files: Sequence[str]) -> str:
    """ "a.off and a.ply"; with their folders where these alone differ."""
    in_one_folder = len({os.path.dirname(file) for file in files}) == 1
    return " and ".join(os.path.basename(file) if in_one_folder else file for file in files)


def without_twins(files: Sequence[str], kept: str, notes: list[str]) -> dict[str, str]:
    """Item -> its file, in the order of the first of each name. Of several, the one with the extension `kept`; a note tells how many were
    left out. An error names all that are still twins."""
    by_name: dict[str, list[str]] = {}
    for file in files:
        by_name.setdefault(stem(file), []).append(file)
    left_out, refused, hint = 0, [], ""
    for name, same in by_name.items():
        if len(same) == 1:
            continue
        extensions = [extension(file)[1:] for file in same]
        if kept != "refuse" and extensions.count(kept) == 1:
            left_out += len(same) - 1
            by_name[name] = [same[extensions.index(kept)]]
        else:
            hint = hint or next((one for one in extensions if extensions.count(one) == 1), "")
            refused.append(_names(same))
    if refused:
        advice = (f"say which extension counts, such as dataset.twins: {hint}, or keep one of each" if hint else
                  "an item has one file: rename or remove the others")
        raise InputError(f"{os.path.dirname(files[0])}: several files of one name: {', '.join(refused)}; {advice}")
    if left_out:
        notes.append(f"files left out, as there is a .{kept} file of the same name: {left_out}")
    return {name: same[0] for name, same in by_name.items()}
