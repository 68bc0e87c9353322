# SPDX-License-Identifier: GPL-3.0-or-later
"""Models of a run, and folds of a cross-validation, without any map, so that sentences on leaders can name
the missing ones and the causes."""

import csv
import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

_NAMED = 4  # models or folds listed per cause
_LONGEST = 200  # characters of a cause


def without_maps(folder: Path, record: Mapping[str, Any]) -> dict[str, str]:
    """Maps models without any map to the cause. folder: of the results; record: its run.yaml."""
    causes: dict[str, str] = {}
    for _, model, cause in _failed_maps(record):
        causes.setdefault(model, cause)
    mapped = {model for _, model in _maps(folder)} if causes else set()
    return {model: cause for model, cause in causes.items() if model not in mapped}


def folds_without_maps(folder: Path, record: Mapping[str, Any]) -> dict[tuple[str, str], str]:
    """Maps (model, fold) to the cause, for folds without any map of trained models that have others."""
    fold_of = {
        row.get("item", ""): row.get("fold", "")
        for row in _rows(folder / "folds.csv")
        if row.get("role") == "scored"
    }
    models = record.get("configuration", {}).get("models", {})
    causes: dict[tuple[str, str], str] = {}
    for item, model, cause in _failed_maps(record):
        if item in fold_of and models.get(model, {}).get("trained"):
            causes.setdefault((model, fold_of[item]), cause)
    mapped = {(model, fold_of.get(item)) for item, model in _maps(folder)} if causes else set()
    with_maps = {model for model, _ in mapped}
    return {
        (model, fold): causes[model, fold]
        for model, fold in sorted(causes, key=lambda of: (of[0], len(of[1]), of[1]))
        if model in with_maps and (model, fold) not in mapped
    }


def sentence(folder: Path, record: Mapping[str, Any]) -> str:
    """Sentence such as "2 of 5 models have no map: A and B, because ...", and one on folds: "1 fold has no
    map: fold 0 of C, because ..."; empty if every model and fold has one."""
    models = without_maps(folder, record)
    folds = {
        f"fold {fold} of {model}": cause
        for (model, fold), cause in folds_without_maps(folder, record).items()
    }
    n_models = len({*record.get("configuration", {}).get("models", {}), *models})
    return " ".join(
        f"{count} {'has' if len(found) == 1 else 'have'} no map: {_because(found)}"
        for count, found in (
            (f"{len(models)} of {n_models} model{'s' * (n_models > 1)}", models),
            (f"{len(folds)} fold{'s' * (len(folds) > 1)}", folds),
        )
        if found
    )


def _because(causes: Mapping[str, str]) -> str:
    """Lists names with their causes; those with one kind of cause together."""
    alike: dict[str, list[str]] = {}
    for name, cause in causes.items():
        alike.setdefault(kind_of(cause), []).append(name)
    said = "; ".join(f"{_listed(names)}, because {_short(causes[names[0]])}" for names in alike.values())
    return f"{said}."


def kind_of(cause: str, item: str = "") -> str:
    """Normalises a cause: causes are equal if they differ only in item and numbers, except lines of code."""
    named = rf"|\b{re.escape(item)}\b" if item else ""
    return re.sub(rf"(?<!line )(?<![\w.])(?:\d[\d.]*{named})", "", cause)


def _failed_maps(record: Mapping[str, Any]) -> Iterator[tuple[str, str, str]]:
    """Yields item, model and cause of each map that failed."""
    for failure in record.get("failed", []):
        stage, _, model = failure["stage"].partition(".")
        if stage == "map":
            yield failure["item"], model, failure["cause"].removeprefix(f"{model}() raised ")


def _maps(folder: Path) -> Iterator[tuple[str, str]]:
    """Yields item, such as 52_3, and model of each map in the tables."""
    for row in (*_rows(folder / "costs.csv"), *_rows(folder / "results.csv")):
        view = row.get("view")
        yield f"{row.get('item', '')}{'_' * bool(view)}{view or ''}", row.get("model", "")


def _rows(table: Path) -> list[dict[str, str]]:
    if not table.is_file():
        return []
    with open(table, encoding="utf-8", errors="surrogateescape", newline="") as file:
        return list(csv.DictReader(file))


def _short(cause: str) -> str:
    # keeps only the file name of a path
    line = re.sub(r"\((?:[^()]*/)?([^/()]+, line \d+)\)$", r"(\1)", cause.partition("\n")[0].rstrip("."))
    if len(line) <= _LONGEST:
        return line
    # the end may be a remedy
    return f"{line[: _LONGEST // 4].rstrip()} ... {line[-_LONGEST * 3 // 4 :].lstrip()}"


def _listed(names: list[str]) -> str:
    cut = names if len(names) <= _NAMED + 1 else [*names[:_NAMED], f"{len(names) - _NAMED} others"]
    return cut[0] if len(cut) == 1 else f"{', '.join(cut[:-1])} and {cut[-1]}"
