# SPDX-License-Identifier: GPL-3.0-or-later
"""The folders that conclusions read and write: of a run, or of tables of anybody's scores."""

import hashlib
import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pandas

from salbench._errors import StorageError as StorageError
from salbench._files import replace_file
from salbench.conclusions import record, tables
from salbench.conclusions.csv_file import InputError
from salbench.conclusions.metrics import Metric, of_program
from salbench.conclusions.scores import read_people, read_results, read_scores, read_smoothed
from salbench.conclusions.study import DEFAULT_SEED, Study

CONCLUDED = "conclusions.json"
SCORES = ("results.csv", "people.csv", "smoothed.csv", "constant.csv")


class Unreadable(InputError):
    """A file that was cut short, or is another one."""


@dataclass(frozen=True)
class Source:
    """Scores, as they were found."""

    study: Study
    tables: Path  # folder of the tables, unless another one is named
    remarks: list[str] = field(default_factory=list)  # at the head of every table
    notes: list[str] = field(default_factory=list)  # on what was left out of the scores
    trained: list[str] = field(default_factory=list)  # those remarks that say how a model learned
    digest: str | None = None  # of what the program wrote, if the conclusions are those that it asks for


def read_run(folder: Path, unit: str | None = None) -> Source:
    """What `salbench run` has written: results.csv, people.csv, smoothed.csv and constant.csv, by the metrics, seed and unit of run.yaml."""
    of_run = read_record(folder / "run.yaml")
    if not of_run.get("metrics"):
        raise InputError(f"{folder / 'run.yaml'}: is no record of a finished run; let `salbench run` end before its scores are concluded")
    known, configuration = of_program(), of_run.get("configuration", {})
    if unknown := [name for name, of in of_run["metrics"].items() if name not in known and not of.get("better")]:
        raise InputError(f"{folder / 'run.yaml'}: metrics.{unknown[0]} does not say which scores are better: higher or lower")
    metrics = [known.get(name) or Metric(name, of["better"] == "higher") for name, of in of_run["metrics"].items()]
    own_unit = configuration.get("statistics", {}).get("unit") or "mesh"
    results = read_results(folder / "results.csv", metrics)

    def if_there(name: str, read: Any) -> Any:
        return read(folder / name, metrics) if (folder / name).is_file() else None

    constant = if_there("constant.csv", read_results)
    study = Study(results.scores, unit or own_unit, int(configuration.get("seed") or DEFAULT_SEED), if_there("people.csv", read_people),
                  if_there("smoothed.csv", read_smoothed), constant and constant.scores.frame)
    digest = of_run.get("scores_digest") or None if study.unit == own_unit else None
    trained = [f"{model}: {how}" for model, how in trained_models(of_run).items()]
    return Source(study, folder, results.remarks + trained, digest=digest, trained=trained)


def read_record(path: Path) -> dict[str, Any]:
    """run.yaml, as record.py checks it. Throws InputError, Unreadable for what is no YAML."""
    import yaml

    try:
        found = yaml.load(path.read_text(encoding="utf-8", errors="replace"), getattr(yaml, "CBaseLoader", yaml.BaseLoader))
        return record.checked(found)
    except yaml.YAMLError as error:
        raise Unreadable(f"{path}: {' '.join(str(error).split())}") from None
    except InputError as error:
        raise InputError(f"{path}: {error}; write it as the run did, or run salbench again") from None


def trained_models(of_run: Mapping[str, Any]) -> dict[str, str]:
    """By name of a model that learned how it did: "cross-validated, 5 folds by class"."""
    models = of_run.get("configuration", {}).get("models", {})
    return {name: of["trained"] for name, of in models.items() if "trained" in of}


def read_table(path: Path, unit: str | None = None, classes: str | None = None, higher: Sequence[str] = (), lower: Sequence[str] = ()) -> Source:
    """A table of anybody's scores."""
    found = read_scores(path, higher, lower, classes)
    return Source(Study(found.scores, unit or "mesh"), Path("salbench-out") / path.stem, notes=found.notes)


def write_tables(folder: Path, made: Iterable[tuple[str, pandas.DataFrame | None]], remarks: Sequence[str]) -> list[str]:
    """A file per table, and none where there is no such table: one of an earlier run would pass for it. Returns the names of files."""
    names = []
    for name, frame in made:
        if frame is None:
            remove(folder / f"{name}.csv")
            continue
        write(folder / f"{name}.csv", tables.csv(frame, remarks))
        names.append(f"{name}.csv")
    return names


def write_document(folder: Path, document: dict[str, Any]) -> None:
    """Last of all: who finds it finds all tables that it names, and what they were when it was written."""
    files = digests(folder, (*SCORES, *document["tables"]))
    write(folder / CONCLUDED, json.dumps({**document, "files": files}, ensure_ascii=False) + "\n")


def digests(folder: Path, names: Iterable[str]) -> dict[str, str]:
    """Of the files that are there."""
    return {name: hashlib.blake2b((folder / name).read_bytes(), digest_size=16).hexdigest() for name in names if (folder / name).is_file()}


def changed(folder: Path) -> list[str]:
    """Scores and tables that somebody has changed since conclusions were drawn."""
    try:
        noted = json.loads((folder / CONCLUDED).read_text(encoding="utf-8"))["files"]
        return [name for name, digest in digests(folder, noted).items() if digest != noted[name]]
    except (OSError, ValueError, KeyError, TypeError):  # none were, or not by this version
        return []


def make(folder: Path) -> None:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise StorageError(f"{folder}: the folder cannot be created: {error.strerror}; choose another with --out") from None


def remove(path: Path) -> None:
    try:
        path.unlink(missing_ok=True)
    except OSError as error:
        raise StorageError(f"{path}: cannot be removed: {error.strerror}; choose another folder with --out") from None


def write(path: Path, text: str) -> None:
    """A file is there whole or not at all."""
    try:
        replace_file(path, text.encode("utf-8", "surrogateescape"))
    except OSError as error:
        raise StorageError(f"{path}: cannot be written: {error.strerror}; choose another folder with --out") from None
