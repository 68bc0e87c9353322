# SPDX-License-Identifier: GPL-3.0-or-later
"""Models of a run without any map, so that sentences on leaders can name the missing ones and the causes."""

import csv
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

_NAMED = 4  # models listed per cause
_LONGEST = 200  # characters of a cause


def without_maps(folder: Path, record: Mapping[str, Any]) -> dict[str, str]:
    """Maps models without any map to the cause. folder: of the results; record: its run.yaml."""
    causes: dict[str, str] = {}
    for failure in record.get("failed", []):
        stage, _, model = failure["stage"].partition(".")
        if stage == "map":
            causes.setdefault(model, failure["cause"].removeprefix(f"{model}() raised "))
    mapped = _models_in(folder / "costs.csv") | _models_in(folder / "results.csv") if causes else set()
    return {model: cause for model, cause in causes.items() if model not in mapped}


def sentence(folder: Path, record: Mapping[str, Any]) -> str:
    """Sentence such as "2 of 5 models have no map: A and B, because ..."; empty if every model has one."""
    found = without_maps(folder, record)
    if not found:
        return ""
    alike: dict[str, list[str]] = {}
    for model, cause in found.items():
        alike.setdefault(kind_of(cause), []).append(model)
    n_models = len({*record.get("configuration", {}).get("models", {}), *found})
    said = "; ".join(f"{_listed(models)}, because {_short(found[models[0]])}" for models in alike.values())
    have = "has" if len(found) == 1 else "have"
    return f"{len(found)} of {n_models} model{'s' * (n_models > 1)} {have} no map: {said}" + "." * (
        not said.endswith("...")
    )


def kind_of(cause: str, item: str = "") -> str:
    """Normalises a cause: causes are equal if they differ only in item and numbers, except lines of code."""
    named = rf"|\b{re.escape(item)}\b" if item else ""
    return re.sub(rf"(?<!line )(?<![\w.])(?:\d[\d.]*{named})", "", cause)


def _models_in(table: Path) -> set[str]:
    if not table.is_file():
        return set()
    with open(table, encoding="utf-8", errors="surrogateescape", newline="") as file:
        return {row.get("model", "") for row in csv.DictReader(file)}


def _short(cause: str) -> str:
    # keeps only the file name of a path
    line = re.sub(r"\((?:[^()]*/)?([^/()]+, line \d+)\)$", r"(\1)", cause.partition("\n")[0].rstrip("."))
    return line if len(line) <= _LONGEST else f"{line[:_LONGEST].rstrip()}..."


def _listed(names: list[str]) -> str:
    cut = names if len(names) <= _NAMED + 1 else [*names[:_NAMED], f"{len(names) - _NAMED} others"]
    return cut[0] if len(cut) == 1 else f"{', '.join(cut[:-1])} and {cut[-1]}"
