# SPDX-License-Identifier: GPL-3.0-or-later
"""Folders that conclusions read and write: of a run, or of a user's tables of scores."""

import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import pandas

from salbench.conclusions import papers, record, tables
from salbench.conclusions.metrics import Metric, of_program
from salbench.conclusions.scores import read_people, read_results, read_scores, read_smoothed
from salbench.conclusions.study import DEFAULT_SEED, Study
from salbench.runs import conclusions_file, failed
from salbench.runs.folds import OWN_FOLDS
from salbench.system.errors import InputError, StorageError as StorageError
from salbench.system.files import read_file, replace_file, require_file, stored
from salbench.system.yaml import plain_text

CONCLUDED = conclusions_file.NAME
SCORES = ("results.csv", "people.csv", "smoothed.csv", "constant.csv")
MOST_RECORD = 1 << 26  # bytes of run.yaml, which lists each failure
ADVICE = "choose another with --out"
DEFAULT = Path("salbench-out")  # same as the program's; for users' tables by their names


class Unreadable(InputError):
    """A truncated or unexpected file."""


@dataclass(frozen=True)
class Source:
    """Scores as found in a folder or table."""

    study: Study
    tables: Path  # folder for the tables, unless another one is named
    remarks: list[str] = field(default_factory=list)  # for every table
    notes: list[str] = field(default_factory=list)  # on scores that were left out
    trained: list[str] = field(default_factory=list)  # the remarks on how models learned
    digest: str | None = None  # digest of the program's output, if its conclusions are asked for
    of_run: bool = False  # True for a run, False for a user's table
    missing: str = ""  # sentence on models without maps


def read_run(folder: Path, unit: str | None = None) -> Source:
    """Reads the output of `salbench run`: results.csv, people.csv, smoothed.csv and constant.csv, by the
    metrics, seed and unit of run.yaml."""
    of_run = read_record(folder / "run.yaml")
    if not of_run.get("metrics"):
        raise InputError(
            f"{folder / 'run.yaml'}: is no record of a finished run; let `salbench run` end before its scores"
            " are concluded"
        )
    known, configuration = of_program(), of_run.get("configuration", {})
    if unknown := [
        name for name, of in of_run["metrics"].items() if name not in known and not of.get("better")
    ]:
        raise InputError(
            f"{folder / 'run.yaml'}: metrics.{unknown[0]} does not say which scores are better: higher or"
            " lower"
        )
    metrics = [
        known.get(name) or Metric(name, of["better"] == "higher") for name, of in of_run["metrics"].items()
    ]
    own_unit = configuration.get("statistics", {}).get("unit") or "mesh"

    def read_file_of(name: str, read: Any) -> Any:
        require_file(folder / name)
        return read(folder / name, metrics)

    def read_if_there(name: str, read: Any) -> Any:
        return read_file_of(name, read) if (folder / name).is_file() else None

    scores, remarks = read_file_of("results.csv", read_results)
    scores = replace(
        scores, first_of={name: names[0] for names in of_run.get("copies", []) for name in names}
    )
    constant, smoothed = read_if_there("constant.csv", read_results), read_if_there(
        "smoothed.csv", read_smoothed
    )
    for frame in (scores.frame, constant and constant[0].frame, smoothed) if has_own_folds(of_run) else ():
        if frame is not None:
            frame["split"] = ""
    study = Study(
        scores,
        unit or own_unit,
        int(configuration.get("seed") or DEFAULT_SEED),
        read_if_there("people.csv", read_people),
        smoothed,
        constant and constant[0].frame,
        papers.of_run(of_run, remarks),
        record.chief_metric(of_run),
    )
    digest = of_run.get("scores_digest") or None if study.unit == own_unit else None
    missing = failed.without_maps(folder, of_run)
    trained = [f"{model}: {how}" for model, how in trained_models(of_run).items() if model not in missing]
    return Source(
        study,
        folder,
        remarks + trained,
        digest=digest,
        trained=trained,
        of_run=True,
        missing=failed.sentence(folder, of_run),
    )


def read_record(path: Path) -> dict[str, Any]:
    """Reads run.yaml and checks it by record.py. Throws InputError; Unreadable if it is not plain YAML."""
    import yaml

    data = (
        read_file(path, MOST_RECORD, "let `salbench run` write it again").decode("utf-8", "replace").encode()
    )
    try:
        text = plain_text(data, str(path), MOST_RECORD)
    except InputError as error:
        raise Unreadable(str(error)) from None
    try:
        return record.checked(yaml.load(text, getattr(yaml, "CBaseLoader", yaml.BaseLoader)))
    except yaml.YAMLError as error:
        raise Unreadable(f"{path}: {' '.join(str(error).split())}") from None
    except InputError as error:
        raise InputError(f"{path}: {error}; write it as the run did, or run salbench again") from None


def trained_models(of_run: Mapping[str, Any]) -> dict[str, str]:
    """Maps each trained model to its training: "cross-validated, 5 folds by class"."""
    models = of_run.get("configuration", {}).get("models", {})
    return {name: of["trained"] for name, of in models.items() if of.get("trained")}


def has_own_folds(of_run: Mapping[str, Any]) -> bool:
    """True if a model was trained on its own folds. These ignore the splits of the data set, so a table by
    split would seem to score a model on its training data."""
    return any(how.startswith(OWN_FOLDS) for how in trained_models(of_run).values())


def read_table(
    path: Path,
    unit: str | None = None,
    classes: str | None = None,
    higher: Sequence[str] = (),
    lower: Sequence[str] = (),
) -> Source:
    """Reads a user's table of scores."""
    scores, notes = read_scores(path, higher, lower, classes)
    if path.name == "results.csv" and (path.parent / "run.yaml").is_file():
        notes.append(
            f"{path}: read as a table from elsewhere, without the run's constant map, copies and seed; name the"
            " folder for the conclusions of the run"
        )
    return Source(Study(scores, unit or "mesh"), DEFAULT / path.stem, notes=notes)


def prepare(folder: Path, source: Source) -> Path:
    """Returns the folder, after removing the document of earlier conclusions. Throws InputError for the
    folder of a run with other scores, whose tables would be overwritten."""
    if (folder / "run.yaml").is_file() and not (
        source.of_run and folder.resolve() == source.tables.resolve()
    ):
        raise InputError(f"{folder}: has the tables of a run, and these scores are not its own; {ADVICE}")
    make(folder)
    remove(folder, CONCLUDED)
    return folder


def make(folder: Path) -> None:
    """Creates the folder unless it exists."""
    with stored(folder, ADVICE, "created"):
        folder.mkdir(parents=True, exist_ok=True)


def write_tables(
    folder: Path, made: Iterable[tuple[str, pandas.DataFrame | None]], remarks: Sequence[str]
) -> list[str]:
    """Writes one file per table, and removes files of tables that do not exist now: they would seem to be of
    this run. Returns the names of files."""
    names = []
    for name, frame in made:
        if frame is None:
            remove(folder, f"{name}.csv")
            continue
        write(folder, f"{name}.csv", tables.csv(frame, remarks))
        names.append(f"{name}.csv")
    return names


def write(folder: Path, name: str, content: str | bytes) -> None:
    with stored(folder / name, ADVICE):
        replace_file(
            folder / name,
            content if isinstance(content, bytes) else content.encode("utf-8", "surrogateescape"),
        )


def remove(folder: Path, name: str) -> None:
    """Removes the file if it exists."""
    with stored(folder / name, ADVICE, "removed"):
        (folder / name).unlink(missing_ok=True)


def write_document(folder: Path, document: dict[str, Any]) -> None:
    """Writes the document last: if it exists, so do all tables that it lists, with the digests that it
    gives."""
    files = {
        name: conclusions_file.digest((folder / name).read_bytes())
        for name in (*SCORES, *document["tables"])
        if (folder / name).is_file()
    }
    write(folder, CONCLUDED, json.dumps({**document, "files": files}, ensure_ascii=False) + "\n")
