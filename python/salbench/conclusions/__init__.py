# SPDX-License-Identifier: GPL-3.0-or-later
"""Conclusions from scores: how good each model is, which differ, which is best, and how sure that is.

Scores and tables are frames (units.Scores for scores). Each table is a function of a Study and a row of
TABLES. A new statistic needs a file with its columns and function, and a row here. Only folders.py reads and
writes files.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import pandas

from salbench._version import __version__
from salbench.conclusions import (
    agreement,
    chance,
    classes,
    equivalents,
    folders,
    leaders,
    means,
    people,
    power,
    published,
    shares,
    significance,
    smoothing,
    tables,
    words,
)
from salbench.conclusions.study import Study
from salbench.conclusions.tables import Column
from salbench.conclusions.units import TEXTS, UNITS
from salbench.runs import conclusions_file
from salbench.system.csv import REMARKS
from salbench.system.errors import InputError


@dataclass(frozen=True)
class Table:
    """A table: the file NAME.csv."""

    name: str
    make: Callable[[Study], pandas.DataFrame]
    columns: Sequence[Column] = ()
    needs: str = ""  # field of the study that the table requires

    def of(self, study: Study) -> pandas.DataFrame | None:
        """None if the study lacks what the table needs."""
        return self.make(study) if not self.needs or getattr(study, self.needs) is not None else None


TABLES = (
    Table("chance", chance.chance, chance.COLUMNS, needs="constant"),
    Table("summary", means.summary, means.SUMMARY),
    Table("ranking", means.ranking, means.RANKING),
    Table("ranking_agreement", agreement.agreement, agreement.COLUMNS),
    Table("significance", significance.significance, significance.COLUMNS),
    Table("per_class", classes.per_class, classes.COLUMNS),
    Table("human_share", shares.human_share, shares.COLUMNS),
    Table("compact", means.compact, means.COMPACT),
    Table("leaders", leaders.leaders, leaders.COLUMNS),
    Table("power", power.power, power.COLUMNS),
    Table("human_curve", people.human_curve, people.CURVE, needs="people"),
    Table("human_curve_by_mesh", people.human_curve_by_mesh, people.CURVE_BY_MESH, needs="people"),
    Table("human_curve_differences", people.human_curve_differences, people.DIFFERENCES, needs="people"),
    Table("human_equivalents", equivalents.human_equivalents, equivalents.COLUMNS, needs="people"),
    Table("human_reliability", people.human_reliability, people.RELIABILITY, needs="people"),
    Table("smoothing", smoothing.smoothing, smoothing.COLUMNS, needs="smoothed"),
    Table("published", published.published, published.COLUMNS, needs="published"),
)


_DECLARED = {table.name: {column.name: column.type for column in table.columns} for table in TABLES}
_OF_RUNS = {
    **dict.fromkeys((*TEXTS, "node", "of", "person", "left_out", "role", "key"), "str"),
    **dict.fromkeys(("n_points", "n_picks", "fold", "shapes"), "int64"),
}


def type_of(table: str, column: str) -> str:
    """Type of a column of TABLE.csv, whatever its content: as declared for conclusions, and for texts and
    counts of the tables of a run. All other columns are numbers except remarks, and so are all columns of a
    table whose columns are models."""
    declared = _DECLARED.get(table, {} if table.startswith("mean_histograms") else _OF_RUNS)
    return declared.get(column, "str" if column == REMARKS else "float64")


def source_of(scores: str, unit: str | None = None, **columns: Any) -> folders.Source:
    """Reads the folder of a run, or a user's table of scores, also as results.csv in a folder. columns: as
    for folders.read_table; only for tables."""
    if unit is not None and unit not in UNITS:
        raise InputError(f"--unit {unit}: must be one of {', '.join(UNITS)}")
    path = Path(scores)
    if (path / "run.yaml").is_file():
        source = folders.read_run(path, unit)
    elif path.is_dir():
        if not (path / "results.csv").exists():
            raise InputError(f"{path}: holds no run.yaml: name the folder of a run, or a CSV file")
        source = replace(folders.read_table(path / "results.csv", unit, **columns), tables=path)
    else:
        source = folders.read_table(path, unit, **columns)
    check_unit(source.study)
    return source


def check_unit(study: Study) -> None:
    """Throws InputError if the unit leaves no observations."""
    classes = study.scores.frame["class"]
    if study.unit == "class" and len(classes) and not (classes != "").any():
        raise InputError(
            "unit class: no item has a class; name them in a column `class`, or with --classes, or take the"
            " unit mesh"
        )


def _without_class(study: Study) -> list[str]:
    """Sentence on items that a unit of classes leaves out."""
    classes = study.scores.frame.drop_duplicates("item")["class"]
    lacking = int((classes == "").sum()) if study.unit == "class" else 0
    return [f"{lacking} of {len(classes)} items have no class, and take no part."] if lacking else []


def tables_of(study: Study) -> Iterator[tuple[str, pandas.DataFrame | None]]:
    """Yields the name and frame of each table; None if the study lacks what it needs."""
    return ((table.name, table.of(study)) for table in TABLES)


def table_of(study: Study, name: str) -> pandas.DataFrame:
    """Returns a table by name; without rows if the study lacks what it needs."""
    made = _table(name).of(study)
    return empty(name) if made is None else made


def empty(name: str) -> pandas.DataFrame:
    """Returns an empty frame with the columns and types of a table."""
    return tables.framed(_table(name).columns, (), in_splits=False)


def _table(name: str) -> Table:
    return next(table for table in TABLES if table.name == name)


def conclude(source: folders.Source, out: str | None = None, of: str | None = None) -> dict[str, Any]:
    """Writes every table, and last the document that lists them, conclusions.json. of: digest of the scores'
    inputs, for a run that asks for its conclusions and holds the folder meanwhile."""
    folder = folders.prepare(source.tables if out is None else Path(out), source)
    names = folders.write_tables(folder, tables_of(source.study), source.remarks)
    overview, found = means.overview(source.study), leaders.find_leaders(source.study)
    said = [
        *tables.of_truth(source.remarks),
        *filter(None, [source.missing]),
        *source.trained,
        *([words.NO_SCORES] if source.study.scores.frame.empty else []),
        *(level.sentence for level in found),
        *_without_class(source.study),
        *words.without_rank(source.study.scores.frame["model"]),
        *published.sentences(source.study),
    ]
    document = {
        "format": conclusions_file.FORMAT,
        "version": __version__,
        "of": of or source.digest,
        "unit": source.study.unit,
        "scores": tables.records(overview),
        "leaders": leaders.documents(found),
        "text": tables.aligned(overview) + "\n" + "".join(f"{line}\n" for line in said),
        "tables": names,
    }
    folders.write_document(folder, document)
    return document


def conclude_if_missing(folder: Path) -> None:
    """Draws the conclusions of a run that wrote only its scores, or whose tables have changed since they were
    written."""
    if conclusions_file.read_if_whole(folder) is None:
        conclude(source_of(str(folder)))
