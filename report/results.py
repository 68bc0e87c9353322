# SPDX-License-Identifier: GPL-3.0-or-later
"""A results folder as the program writes it: its tables, run.yaml, and what of them is missing."""

import csv
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

import numpy
import pandas
import yaml

from report import metrics

NO_METRICS = ("n_points", "n_picks", "key", "content")  # columns of results.csv beside text and metrics
TEXT_COLUMNS = ("dataset", "split", "item", "class", "view", "model", "metric", "model_a", "model_b", "metric_a", "metric_b", "group",
                "node", "remark", "k_bound", "low_bound", "high_bound", "better", "kind", "verdict", "leaders", "second",
                "sentence")
DATASETS = ("meshes", "scans", "clouds")
LARGEST = 1e150  # of a usable number: squares of larger ones, and sums of squares, overflow


class Missing(Exception):
    """What an element of the report needs is not there. Its text stands where the element would."""


class Unusable(Exception):
    """The report cannot be written at all: the message is one line for the user (exit status 2)."""


@dataclass
class Results:
    """A results folder. Tables are read when first asked for; what cannot be read is Missing."""

    folder: Path
    record: dict = field(default_factory=dict)    # run.yaml with every scalar as text
    remarks: list = field(default_factory=list)   # lines of '#' at the head of run.yaml and of the tables
    unusable: list = field(default_factory=list)  # sentences on tables that hold infinite numbers
    pivoted: dict = field(default_factory=dict)   # (data set, metric) -> scores, for statistics.scores
    _tables: dict = field(default_factory=dict)

    def table(self, name, *columns):
        """The table of a CSV file with at least the columns named, or Missing."""
        if name not in self._tables:
            self._tables[name] = self._read(name)
        table = self._tables[name]
        if isinstance(table, Missing):
            raise table
        absent = [column for column in columns if column not in table]
        if absent:
            raise Missing(f"{name} has no column {', '.join(absent)}: an older version of the program wrote it; run salbench again.")
        return table

    def has(self, name):
        try:
            return not self.table(name).empty
        except Missing:
            return False

    def _read(self, name):
        path = self.folder / name
        if not path.is_file():
            return Missing(f"{name} is not in the results folder: run salbench again, to its end.")
        try:
            table, remarks, unusable = read_table(path)
        except (OSError, ValueError) as error:  # pandas' errors are ValueErrors
            return Missing(f"{name} cannot be read: {' '.join(str(error).split())}")
        self.remarks += [remark for remark in remarks if remark not in self.remarks]
        if name not in ("results.csv", "leaders.csv") and "split" in table and not table.empty:  # all splits together come first
            table = table[table["split"] == table["split"].iloc[0]].reset_index(drop=True)
        if unusable:
            self.unusable.append(f"{name} holds {unusable} number{'s' if unusable > 1 else ''} that are infinite or beyond "
                                 f"{LARGEST:g}: they count as undefined.")
        return table

    @property
    def unit(self):
        """What counts as one observation in intervals, tests and ranks: "mesh", "class" or "shape"; empty if unknown."""
        return self.option("statistics.unit") or ""

    @cached_property
    def simulated(self):
        """True if the program made the participants up: then scores say nothing about people."""
        said = any("simulated" in remark.lower() for remark in self.remarks)
        return said or self.option("dataset.participants") == "simulated"

    @cached_property
    def metrics(self):
        """name -> Metric of every metric that run.yaml or a table has, the leading ones first."""
        listed = self.record.get("metrics")
        listed = listed if isinstance(listed, dict) else {}
        found = list(listed)
        if self.has("results.csv") and "model" in self.table("results.csv"):
            found += [name for name in self.table("results.csv") if name not in TEXT_COLUMNS + NO_METRICS]
        if self.has("summary.csv") and "metric" in self.table("summary.csv"):
            found += [name for name in self.table("summary.csv")["metric"].unique() if name]
        first = metrics.leading(listed or metrics.PAPER)
        return {name: metrics.described(name, listed.get(name)) for name in dict.fromkeys(first + found)}

    @cached_property
    def leading(self):
        """The metrics that every page shows: the paper's, where the run has them."""
        listed = self.record.get("metrics")
        names = metrics.leading(listed if isinstance(listed, dict) and listed else metrics.PAPER)
        return {name: self.metrics[name] for name in names}

    def metric(self, name):
        return self.metrics.get(name) or metrics.described(name)

    @property
    def state(self):
        """"finished", "partial, 3 of 12 shapes ..." or why it is not known."""
        return text_of(self.record.get("results")) or "unknown: run.yaml is missing or was not completed"

    def option(self, path):
        """An option of the configuration as text, such as option("fpfh.radius"); None if it is not recorded."""
        value = self.record.get("configuration")
        for part in path.split("."):
            if not isinstance(value, dict) or part not in value:
                return None
            value = value[part]
        return value if isinstance(value, str) else None

    @cached_property
    def evaluated(self):
        """Names of the models whose maps another program made (salbench evaluate)."""
        value = self.record.get("evaluated") or []
        entries = value if isinstance(value, list) else [value]
        return [entry["model"] for entry in entries if isinstance(entry, dict) and "model" in entry]


def text_of(value):
    return value if isinstance(value, str) else ""


def flatten(values, prefix=""):
    """{"fpfh": {"radius": "0.01"}} -> {"fpfh.radius": "0.01"}"""
    flat = {}
    for key, value in values.items():
        if isinstance(value, dict):
            flat |= flatten(value, f"{prefix}{key}.")
        else:
            flat[f"{prefix}{key}"] = str(value)
    return flat


def number_of(value, otherwise=float("nan")):
    """A number that run.yaml holds as text; `otherwise` in place of one that is none, infinite or too large."""
    try:
        number = float(value)
    except (TypeError, ValueError):
        return otherwise
    return number if abs(number) <= LARGEST else otherwise


def head_remarks(path):
    """The lines of '#' that a file begins with, without the '#'."""
    remarks = []
    with open(path, encoding="utf-8", errors="replace") as file:
        for line in file:
            if not line.startswith("#"):
                break
            remarks.append(line[1:].strip())
    return remarks


def read_table(path):
    """A table, the remarks at its head, and how many of its numbers cannot be used: infinite ones and those beyond LARGEST.
    Text columns keep names such as "NA"; all others are float64, NaN where empty or unusable. A last line that was cut short
    is filled with NaN."""
    remarks = head_remarks(path)
    try:
        table = pandas.read_csv(path, skiprows=len(remarks), dtype=str, keep_default_na=False, encoding_errors="replace")
    except pandas.errors.EmptyDataError:
        return pandas.DataFrame(), remarks, 0
    unusable = 0
    for column in table:
        values = table[column].fillna("")
        table[column] = values if column in TEXT_COLUMNS else numbers(values)
        if column not in TEXT_COLUMNS:
            too_large = table[column].abs() > LARGEST
            unusable += int(too_large.sum())
            table[column] = table[column].mask(too_large)
    return table, remarks, unusable


def numbers(values):
    """float64 of a column of text, exact to the bit as the program printed them; NaN where it is no number."""
    try:
        return values.replace("", "nan").map(float)
    except ValueError:
        return pandas.to_numeric(values, errors="coerce")


def read_record(path):
    """run.yaml with every scalar as text: a model named NO stays one. Empty if there is no such file or it is broken."""
    try:
        record = yaml.load(path.read_text(encoding="utf-8", errors="replace"), Loader=yaml.BaseLoader)
    except (OSError, yaml.YAMLError):
        return {}
    return record if isinstance(record, dict) else {}


def read_results(folder):
    """The results in a folder, or Unusable if the folder holds none."""
    folder = Path(folder)
    if not folder.is_dir():
        raise Unusable(f"{folder}: no such folder; name the results folder of a run (salbench run ... --out OUT)")
    if not any((folder / name).is_file() for name in ("run.yaml", "results.csv", "summary.csv")):
        raise Unusable(f"{folder}: not a results folder (no run.yaml, no results.csv); name the one of salbench run")
    results = Results(folder, read_record(folder / "run.yaml"))
    if (folder / "run.yaml").is_file():
        results.remarks += head_remarks(folder / "run.yaml")
    for name in ("results.csv", "summary.csv"):
        results.has(name)  # gathers their remarks
    return results


def write_csv(table, path):
    """Floats as the shortest text that reads back to the same bits."""
    def text(value):
        if isinstance(value, (float, numpy.floating)):
            return "" if value != value else repr(float(value))
        return value
    with open(path, "w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(table.columns)
        writer.writerows([text(value) for value in row] for row in table.itertuples(index=False))
