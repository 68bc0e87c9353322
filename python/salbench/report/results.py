# SPDX-License-Identifier: GPL-3.0-or-later
"""A results folder as written by the program: its tables, run.yaml, and missing parts."""

from collections.abc import Collection, Iterable, Mapping, Sequence
from contextlib import suppress
from functools import cached_property
from os import PathLike
from typing import Any, TypeAlias

import pandas

from salbench import conclusions
from salbench.conclusions import folders, papers
from salbench.conclusions.metrics import PAPERS, leading_metrics
from salbench.conclusions.record import chief_metric
from salbench.conclusions.tables import of_all
from salbench.conclusions.units import TEXTS
from salbench.pages.blocks import Missing
from salbench.report import metrics
from salbench.report.metrics import Metric
from salbench.runs import conclusions_file
from salbench.runs.results import Results
from salbench.system.csv import read_csv, remarks_above
from salbench.system.errors import InputError, StorageError
from salbench.system.files import require_file

NO_METRICS = (*TEXTS, "n_points", "n_picks", "key", "content")  # columns of results.csv that are not metrics
Frame: TypeAlias = pandas.DataFrame
Row = Mapping[Any, Any]  # a table row, by column
NO_MODELS = ("", "Avg")  # other values in columns of models
CONCLUDED = {table.name for table in conclusions.TABLES}
OF_RUNS = {
    "results": ("dataset", "item", "class", "view", "model"),
    "mean": ("bin_left",),
    "costs": ("dataset", "item", "view", "model", "seconds", "processor_seconds", "input_seconds"),
    "folds": ("fold", "item", "role"),
    "training": ("model", "fold", "shapes", "seconds"),
    "gaze": (
        "item",
        "class",
        "person",
        "samples",
        "lost",
        "fixations",
        "hits",
        "snapped",
        "missed",
        "seconds",
        "tracked",
        "left_out",
    ),
}
LARGEST = 1e150  # usable number: squares of larger ones, and sums of squares, overflow


class Shown(Results):
    """The results of a folder as shown on pages. Unreadable files are Missing; conclusions are drawn only if
    their tables are missing."""

    def __init__(
        self,
        folder: str | PathLike[str],
        mine: str = "",
        metrics: Sequence[str] = (),
        models: Sequence[str] = (),
    ) -> None:
        """mine: the model that the report is about; empty: none. metrics: on the pages; none: the leading
        ones. models: on the pages; none: all."""
        super().__init__(folder)
        self.mine, self.wanted_metrics, self.wanted_models = mine, metrics, models
        self.remarks: list[str] = []  # from run.yaml and the tables
        self.unusable: list[str] = []  # sentences on tables with infinite numbers
        self.wide: dict[str, Frame] = {}  # data set -> scores by shape, for statistics.scores
        self._known: dict[str, Frame | Missing] = {}
        if not (self.folder / "summary.csv").is_file():
            with suppress(InputError, StorageError, OSError):  # otherwise every page names the missing tables
                self._conclude()
        if (self.folder / "run.yaml").is_file():
            with (
                suppress(OSError),
                open(self.folder / "run.yaml", encoding="utf-8", errors="replace") as file,
            ):
                self._note(remarks_above(file)[0])
        for name in ("results", "summary"):
            self.has(name)  # collects their remarks

    @cached_property
    def record(self) -> dict[str, Any]:
        """run.yaml; empty if it is missing or broken, which pages report."""
        record: dict[str, Any] = {}
        if (self.folder / "run.yaml").is_file():
            with suppress(folders.Unreadable, OSError):
                record = folders.read_record(self.folder / "run.yaml")
        for model in record.get("configuration", {}).get("models", {}).values():
            model.pop("training", None)  # names of all shapes, which no page shows
        return record

    def table(self, name: str) -> Frame:
        """All columns of NAME.csv; raises Missing."""
        if name not in self._known:
            try:
                self._known[name] = self._read(name)
            except Missing as missing:
                self._known[name] = missing
        table = self._known[name]
        if isinstance(table, Missing):
            raise table
        return table

    def has(self, name: str) -> bool:
        try:
            return not self.table(name).empty
        except Missing:
            return False

    def rows(self, name: str, dataset: str, metric: str) -> Frame:
        """Rows of NAME.csv for a data set and metric, in their order."""
        table = self.table(name)
        return table[(table["dataset"] == dataset) & (table["metric"] == metric)].reset_index(drop=True)

    def _read(self, name: str) -> Frame:
        """Reads a table with all numbers as float64; infinite ones and those beyond LARGEST become NaN."""
        file, path = f"{name}.csv", self.folder / f"{name}.csv"
        if not path.is_file():
            raise Missing(f"{file} is not in the results folder: {self._why_absent(name)}.")
        try:
            if self._is_under_way():
                raise Missing(
                    f"{file} may be of an earlier run, since the last one has not ended: run it again."
                )
            require_file(path)
            table = read_csv(
                path, lambda column: conclusions.type_of(name, column) != "str", errors="replace"
            )
        except (OSError, InputError) as error:
            raise Missing(f"{file} cannot be read: {' '.join(str(error).split())}") from None
        if absent := [column for column in columns_of(name) if column not in table]:
            again = "conclude" if name in CONCLUDED else "run"
            raise Missing(
                f"{file} has no column {', '.join(absent)}: an older version of the program wrote it; run"
                f" salbench {again} again."
            )
        self._note(table.attrs["remarks"])
        table.attrs = {}  # the file's name does not matter for a figure's digest
        if name not in ("results", "leaders"):
            table = of_all(table)
        for column in {"model", "model_a", "model_b"} & set(table if self.wanted_models else ()):
            table = table[table[column].isin([*self.wanted_models, *NO_MODELS])]
        numbers = table.select_dtypes("number")
        is_unusable = numbers.abs() > LARGEST
        if unusable := int(is_unusable.to_numpy().sum()):
            self.unusable.append(
                f"{file} holds {unusable} number{'s' if unusable > 1 else ''} that are infinite or beyond "
                f"{LARGEST:g}: they count as undefined."
            )
        return table.assign(**numbers.mask(is_unusable)).reset_index(drop=True)

    def _why_absent(self, name: str) -> str:
        """Reason why a table is not there, or what writes it."""
        has_ended = self.is_of_table or bool(self.record.get("results"))
        takes_people = any(table.name == name and table.needs == "people" for table in conclusions.TABLES)
        if has_ended and takes_people and not (self.folder / "people.csv").is_file():
            return (
                "it takes people.csv, which a run writes if HS is among its models and people are told apart"
            )
        if self.is_of_table and name not in CONCLUDED:
            return (
                "a run writes it, `salbench conclude` does not: report the folder of the run, if there is one"
            )
        return "run salbench again, to its end"

    def _note(self, remarks: Iterable[str]) -> None:
        self.remarks += [remark for remark in remarks if remark not in self.remarks]

    @property
    def of_these(self) -> str:
        """Addition to sentences on the best if pages do not show all models."""
        return " of the models shown" if self.wanted_models else ""

    def mine_first(self, rows: list[Any]) -> list[Any]:
        """Moves rows with your own model, or pairs with it, to the front."""
        return sorted(
            rows, key=lambda row: self.mine not in (row.get("model"), row.get("model_a"), row.get("model_b"))
        )

    @cached_property
    def unit(self) -> str:
        """Unit of observation in intervals, tests and ranks: "mesh", "class" or "shape"; empty if unknown."""
        concluded = conclusions_file.read_if_whole(self.folder) or {}
        return concluded.get("unit") or self.option("statistics.unit") or ""

    @cached_property
    def simulated(self) -> bool:
        """True if participants are simulated: scores then say nothing about people."""
        said = any(remark.startswith("SIMULATED") for remark in self.remarks)
        return said or self.option("dataset.participants") == "simulated"

    @cached_property
    def reported(self) -> dict[tuple[str, ...], list[Row]]:
        """Numbers from papers for the data set of this run and its metrics, with the same preprocessing of
        maps: by data set, split, class and metric."""
        found: dict[tuple[str, ...], list[Row]] = {}
        for row in papers.of_run(self.record, ["SIMULATED"] if self.simulated else self.remarks).to_dict(
            "records"
        ):
            found.setdefault((row["dataset"], row["split"], row["class"], row["metric"]), []).append(row)
        return found

    @cached_property
    def in_splits(self) -> bool:
        """True if items have splits."""
        try:
            return "split" in self.table("summary")
        except Missing:
            return False

    def split_of(self, dataset: str) -> str:
        """Split of the tables of a data set; empty: all items."""
        try:
            table = self.table("summary")
        except Missing:
            return ""
        if "split" not in table:
            return ""
        splits = table.loc[table["dataset"] == dataset, "split"]
        return str(splits.iloc[0]) if len(splits) else ""

    @cached_property
    def metrics(self) -> dict[str, Metric]:
        """Every metric of run.yaml or a table by name, in the order of run.yaml, which is that of the table
        of metrics."""
        listed = self.record.get("metrics", {})
        found = list(listed)
        if self.has("results"):
            found += [name for name in self.table("results") if name not in NO_METRICS]
        if self.has("summary"):
            found += [name for name in self.table("summary")["metric"].unique() if name]
        entries = listed
        if not listed and self.has("compact"):
            compact = self.table("compact")
            entries = {name: {"better": better} for name, better in zip(compact["metric"], compact["better"])}
        return {name: metrics.described(name, entries.get(name)) for name in dict.fromkeys(found or PAPERS)}

    @cached_property
    def leading(self) -> dict[str, Metric]:
        """Metrics that every page shows: the requested ones, or the paper's if the run has them. If none of
        these has a score, the leading ones of those that have."""
        if self.wanted_metrics:
            return {name: self.metric(name) for name in self.wanted_metrics}
        found = leading_metrics(self.record.get("metrics") or PAPERS, chief_metric(self.record))
        scored: Collection[str] = found
        if self.has("results"):
            scored = list(self.table("results").dropna(axis="columns", how="all"))
        elif self.has("summary"):
            summary = self.table("summary")
            scored = set(summary.loc[summary["n"] > 0, "metric"])
        if not any(name in scored for name in found):
            found = leading_metrics(name for name in self.metrics if name in scored) or found
        return {name: self.metric(name) for name in found}

    def metric(self, name: str) -> Metric:
        return self.metrics.get(name) or metrics.described(name)

    @property
    def is_of_table(self) -> bool:
        """True for conclusions from a user's table of scores, which no run made."""
        return not (self.folder / "run.yaml").exists() and (self.folder / conclusions_file.NAME).is_file()

    @property
    def state(self) -> str:
        """State of the run: "finished", "partial, 3 of 12 shapes ...", or why it is unknown."""
        return self.record.get("results") or (
            "run.yaml is missing or unreadable, or says that a run is under way or was ended before its end"
        )

    @property
    def failed_jobs(self) -> list[dict[str, str]]:
        """Failed jobs in run.yaml: item, stage and cause of each."""
        return [
            {key: entry.get(key, "") for key in ("item", "stage", "cause")}
            for entry in self.record.get("failed", [])
        ]

    def option(self, path: str) -> str | None:
        """Option of the configuration as text, such as option("fpfh.radius"); None if not recorded."""
        value = self.record.get("configuration")
        for part in path.split("."):
            if not isinstance(value, dict) or part not in value:
                return None
            value = value[part]
        return value if isinstance(value, str) else None

    def told_of(self, model: str) -> str:
        """Description in the record of a user's model; empty if unknown."""
        if model in self.evaluated:
            return "maps that another program made"
        entry = self.record.get("configuration", {}).get("models", {}).get(model) or {}
        said = (
            f"the command {entry['command']}"
            if "command" in entry
            else (
                "a function of Python"
                if "function" in entry
                else f"a variant of {entry['model']}"
                if "model" in entry
                else ""
            )
        )
        return ", ".join(
            filter(None, (entry.get("description", said).rstrip("."), self.trained.get(model, "")))
        )

    @cached_property
    def given_maps(self) -> list[dict[str, str]]:
        """Entries of run.yaml for models whose maps come from another program (salbench run --maps)."""
        given = self.record.get("evaluated", {})
        return [one for one in (given if isinstance(given, list) else [given]) if "model" in one]

    @cached_property
    def evaluated(self) -> list[str]:
        """Names of these models."""
        return [one["model"] for one in self.given_maps]


def columns_of(name: str) -> Iterable[str]:
    """Columns that a table must have."""
    return list(conclusions.empty(name)) if name in CONCLUDED else OF_RUNS.get(name.partition("_")[0], ())


def flatten(values: Mapping[str, Any], prefix: str = "") -> dict[str, str]:
    """Flattens a dict: {"fpfh": {"radius": "0.01"}} -> {"fpfh.radius": "0.01"}."""
    flat: dict[str, str] = {}
    for key, value in values.items():
        if isinstance(value, dict):
            flat |= flatten(value, f"{prefix}{key}.")
        else:
            flat[f"{prefix}{key}"] = str(value)
    return flat


def number_of(value: Any, otherwise: float = float("nan")) -> float:
    """Parses a number of run.yaml; `otherwise` for other text, and for infinite or too large numbers."""
    try:
        number = float(value)
    except (TypeError, ValueError):
        return otherwise
    return number if abs(number) <= LARGEST else otherwise
