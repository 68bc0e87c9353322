# SPDX-License-Identifier: GPL-3.0-or-later
"""Provenance of maps, recorded by the run that made them: for submission.yaml, and for reproduction."""

import hashlib
import os
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas

from salbench import _core
from salbench.leaderboard.texts import LONGEST_TEXT, Manifest, values_of
from salbench.system.errors import InputError, quoted
from salbench.system.files import open_regular, read_file
from salbench.system.types import NDArray
from salbench.system.yaml import flow_text

MADE = "made.yaml"  # record of the run, beside maps of a function
_KEPT = ("made_by", "function", "learned", "map_digest", "seconds", "timed")  # its fields of a Manifest
_TIMED = {
    "command": (
        "wall time of one answer of the command, with the files that it is given and writes, and its start;"
        " with {list} the first alone has that"
    ),
    "function": "wall time of one call of the function, without training and loading",
    "built-in": "wall time of the map, its inputs at hand",
}
_MOST_WEIGHTS = 1 << 40  # bytes of a file


def of_model(costs: pandas.DataFrame, record: Mapping[str, Any], name: str) -> Manifest:
    """Provenance of a model of a run. costs: its costs.csv; record: its run.yaml."""
    options = record["configuration"]["models"].get(name) or {}
    made_by = next((kind for kind in ("command", "function") if options.get(kind)), "built-in")
    seconds, recipe = costs.loc[costs["model"] == name, "seconds"].dropna(), record.get("ground_truth")
    return Manifest(
        made_by=made_by,
        timed=_TIMED[made_by] if len(seconds) else "",
        learned=options.get("trained", ""),
        function=options.get("function", ""),
        ground_truth=flow_text(recipe, sort_keys=True) if recipe else "",
        files=_files_of_command(record, name, options) if made_by == "command" else (),
        seconds=[f"{seconds.quantile(share):.4g}" for share in (0.5, 0.95)] if len(seconds) else (),
    )


def options_text(record: Mapping[str, Any], name: str) -> str:
    """Entry of a model in the configuration of a run."""
    return "".join(
        f"{key}: {flow_text(value)}\n"
        for key, value in (record["configuration"]["models"].get(name) or {}).items()
    )


def _files_of_command(record: Mapping[str, Any], name: str, options: Mapping[str, Any]) -> list[str]:
    """Lines of SHA-256 and file name. Throws InputError if a file has changed since the run: the maps are of
    the former one."""
    used = (record.get("command_files") or {}).get(name) or {}
    lines = []
    for file in options.get("depends") or []:
        beside = Path(record.get("configuration_folder") or ".", file)
        data = read_file(beside if beside.exists() else Path(file), _MOST_WEIGHTS, "leave it out")
        if _core.digest(data) != used.get(file):
            raise InputError(f"{file}: changed while its maps were made; call it again")
        lines.append(f"{hashlib.sha256(data).hexdigest()} {file}")
    return lines


def is_outside(file: str) -> bool:
    """True for a file of `depends` that `reproduce` looks for in no folder of others."""
    return file.startswith("/") or ".." in Path(file).parts


def sha256_of(path: Path) -> str:
    """SHA-256 as `sha256sum` prints it. Throws InputError."""
    with open_regular(path) as file:
        return hashlib.file_digest(file, "sha256").hexdigest()  # type: ignore[arg-type]  # typeshed's BinaryIO has no readinto


def digest_of(maps: Mapping[str, NDArray[np.float64]]) -> str:
    """Digest of maps, in the order of their names."""
    ordered = sorted(maps, key=os.fsencode)
    return _core.digest(b"".join(np.ascontiguousarray(maps[item], "<f8").tobytes() for item in ordered))


# --- beside maps of a function ------------------------------------------------------------------------------


def made_text(known: Manifest, maps: Mapping[str, NDArray[np.float64]]) -> str:
    whole = replace(known, map_digest=digest_of(maps))
    return "# Written with the maps: how they came about. `salbench submit` hands it on.\n" + "".join(
        f"{key}: {flow_text(getattr(whole, key))}\n" for key in _KEPT if getattr(whole, key)
    )


def of_files(folder: Path, maps: Mapping[str, NDArray[np.float64]]) -> Manifest:
    """Provenance of maps in files. Throws InputError if the record belongs to other maps."""
    file = folder / MADE
    if not file.is_file():
        return Manifest(made_by="files")
    values = values_of(read_file(file, LONGEST_TEXT, "delete it"), str(file), _KEPT, ("seconds",))
    known = Manifest(**values)
    if known.map_digest != digest_of(maps):
        raise InputError(
            f"{file}: was written with other maps than those beside it ({quoted(known.map_digest)} is not"
            f" {digest_of(maps)}); write them together (Results.write_submission), or delete it"
        )
    return known
