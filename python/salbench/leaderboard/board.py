# SPDX-License-Identifier: GPL-3.0-or-later
"""The leaderboard: checks every submission, scores those that pass in one ordinary run, and draws
conclusions.

Models are compared on the items that no ranked model was trained on. A model trained on more than a few is
listed beside the ranking, so that it excludes no items.
"""

import csv
import itertools
import shutil
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas

from salbench import _core
from salbench.conclusions import folders, leaders, means, tables, tables_of
from salbench.conclusions.leaders import LevelLeaders
from salbench.conclusions.study import Study
from salbench.conclusions.units import Scores
from salbench.conclusions.words import observation
from salbench.leaderboard import origin, submission
from salbench.leaderboard.entry import Entry
from salbench.leaderboard.expected import Expected
from salbench.leaderboard.texts import plain
from salbench.models.function import Model
from salbench.pages.names import spoken
from salbench.runs.results import Results
from salbench.system.csv import read_csv
from salbench.system.errors import InputError
from salbench.system.types import NDArray

FEWEST_UNITS = 6  # needed to name a leader: with fewer, no signed-rank test of two models reaches 0.05
MOST_SEEN = 10  # percent of the items that training of ranked models may exclude, each and together
OTHER_SCORES = "the scores that it came with are others than those computed here"
# runs the command's configuration with functions as models: commands.run_over
Run = Callable[..., Results]


@dataclass(frozen=True)
class Board:
    """Everything that the site shows."""

    entries: list[Entry]
    facts: dict[str, str]  # facts on the ranking, by label
    study: Study  # ranked models, on the items that none of them has seen
    beside: pandas.DataFrame  # the other models, on those of the same items that they have not seen
    leaders: list[LevelLeaders]
    sentences: list[str]
    protocol: str
    tables: dict[str, pandas.DataFrame]
    remarks: list[str] = field(default_factory=list)  # for every table
    # the program's models trained on the data set -> their training
    learned: dict[str, str] = field(default_factory=dict)

    @property
    def refused(self) -> list[Entry]:
        return [entry for entry in self.entries if entry.refused]

    @property
    def shown(self) -> dict[str, Entry]:
        """Submissions with scores, ranked or beside the ranking, by model."""
        return {entry.card.name: entry for entry in self.entries if not entry.refused}


def expected_of(results: Results) -> Expected:
    """Expectations from a run over the data set without submissions."""
    table, data = results.scores, results.record["data_set"]
    items = table["item"]
    points_of = items.where(table["view"] == "", items + "_" + table["view"])
    points = {name: int(n) for name, n in zip(points_of, table["n_points"])}
    if not points:
        raise InputError("no item has ground truth that it could be scored by")
    if results.record["configuration"]["dataset"]["score_on"] == "vertices":
        # n_points leaves out points that nobody saw, which maps have
        maps: Mapping[str, NDArray[np.float64]] = next(filter(len, map(results.maps, results.models)), {})
        points |= {name: len(maps[name]) for name in points if name in maps}
    split_of = dict(zip(items, table["split"])) if "split" in table else {}
    return Expected(
        results._run.protocol,
        data["digest"],
        points,
        tuple(dict.fromkeys(items)),
        data["layout"],
        data.get("splits", ""),
        split_of,
        tuple(results._run.splits),
        dict(zip(points_of, items)),
    )


def check_all(entries: list[Entry], expected: Expected, scratch: str, models: Iterable[str]) -> None:
    """Reads every archive, and records the reasons for refusals. models: names that are taken. scratch: a
    folder for maps."""
    taken = {name.lower(): "a model of the configuration" for name in models}
    for entry in entries:
        try:
            entry.read, entry.refused = submission.read(entry.file, expected, scratch), ""
        except InputError as error:
            entry.refused = str(error).removeprefix(f"{entry.file}: ")
            continue
        name = entry.card.name
        if by := taken.get(name.lower()):
            entry.refused = f"the name {name} is taken by {by}, or differs from it in capitals alone"
        else:
            taken[name.lower()] = entry.name


def model_of(maps: Mapping[str, NDArray[np.float64]]) -> Model:
    """A model that returns the map of the shape, keyed by the digest of the maps."""
    return Model(lambda shape: maps[shape.id], version=1, depends=[origin.digest_of(maps).encode()], reads=())


def free_names(taken: Iterable[str]) -> Iterator[str]:
    """Unused names of models, regardless of case: T0, T1 and so on."""
    lowered = {name.lower() for name in taken}
    return (name for number in itertools.count() if (name := f"T{number}").lower() not in lowered)


SEEDS = (
    tables.DATASET,
    tables.SPLIT,
    tables.METRIC,
    tables.MODEL,
    tables.text("seed", "of a training, as the card names it; empty: that which is ranked"),
    tables.N,
    tables.MEAN,
)


@dataclass(frozen=True)
class Trainings:
    """Repeated trainings of models. They are scored in a separate run, so that they take part in no rank,
    test or mean of the others."""

    names: dict[str, tuple[str, str]]  # name in that run -> the model, and the seed as in its card
    study: Study


def score_trainings(by_model: Mapping[str, Entry], run: Run, models: Iterable[str]) -> Trainings | None:
    """Returns None without repeated trainings. models: names that are taken."""
    trained = [
        (model, seed, maps) for model, entry in by_model.items() for seed, maps in entry.read.seeds.items()
    ]
    if not trained:
        return None
    names = {name: (model, seed) for name, (model, seed, _) in zip(free_names(models), trained)}
    functions = {name: model_of(maps) for name, (_, _, maps) in zip(names, trained)}
    return Trainings(names, folders.read_run(run(functions=functions).folder).study)


def seeds(trainings: Trainings, source: Study, board: "Board", overlap: "Overlap") -> pandas.DataFrame:
    """Means of each training over the items that its model's mean is over. source: of the run with the models
    themselves."""
    models = dict.fromkeys(model for model, _ in trainings.names.values())
    each = [(source, model, model, "") for model in models] + [
        (trainings.study, name, *of) for name, of in trainings.names.items()
    ]
    parts = []
    for study, name, model, seed in each:
        rows = means.compact(
            _part(study, overlap.left_out | overlap.beside.get(model, set()), lambda models: models == name)
        )
        parts.append({"split": "", **rows, "model": model, "seed": seed})
    return tables.framed(SEEDS, parts, board.study.in_splits)


def rank(entries: list[Entry], expected: Expected, run: Run, name: str) -> tuple[Board, Results]:
    """Scores the submissions that passed, and draws the conclusions. name: of the configuration."""
    by_model = {entry.card.name: entry for entry in entries if not entry.refused}
    results = run(functions={model: model_of(entry.read.maps) for model, entry in by_model.items()})
    source = folders.read_run(results.folder)
    _refuse_failed(by_model, results.failures, expected)
    _refuse_undefined(by_model, source.study.scores)
    trainings = (
        None
        if any(entry.refused for entry in by_model.values())
        else score_trainings(by_model, run, results.models)
    )
    if trainings:
        _refuse_trainings(by_model, source.study.scores, trainings)
    if any(entry.refused for entry in by_model.values()):
        return rank(entries, expected, run, name)
    _compare_scores(by_model, results.folder / "results.csv")
    overlap = Overlap.of(entries, expected)
    study = _part(source.study, overlap.left_out, lambda models: ~models.isin(list(overlap.beside)))
    found = [_or_too_few(level) for level in leaders.find_leaders(study)]
    sentences = [level.sentence for level in found] or [
        "No item is left that no ranked model has seen: none can be ranked."
    ]
    board = Board(
        entries,
        _facts(entries, expected, results.record, study, overlap, name),
        study,
        _beside(source.study, overlap),
        found,
        sentences + overlap.sentences(),
        expected.protocol,
        {},
        source.remarks,
        folders.trained_models(results.record),
    )
    board.tables.update(_tables(board, results))
    if trainings:
        board.tables["seeds"] = seeds(trainings, source.study, board, overlap)
    return board, results


@dataclass(frozen=True)
class Overlap:
    """Items that models were trained or tuned on."""

    items: int  # number in the data set
    ranked: dict[str, set[str]]  # items that each ranked model has seen, if any
    beside: dict[str, set[str]]

    @classmethod
    def of(cls, entries: list[Entry], expected: Expected) -> "Overlap":
        """Decides for each entry whether it is listed beside the ranking, and records the reason."""
        n = len(expected.items)
        left_out: set[str] = set()
        for entry in sorted(entries, key=lambda entry: len(entry.seen)):
            together = left_out | entry.seen
            entry.beside = ""
            if 100 * len(entry.seen) > MOST_SEEN * n:
                entry.beside = f"it has seen {len(entry.seen)} of {n} items, more than {MOST_SEEN} %"
            elif 100 * len(together) > MOST_SEEN * n:
                entry.beside = (
                    f"with what others have seen, {len(together)} of {n} items would be left out, more than"
                    f" {MOST_SEEN} %"
                )
            elif not entry.refused:
                left_out = together
        ranked, beside = (
            {entry.card.name: entry.seen for entry in entries if entry.status == status and entry.seen}
            for status in ("ranked", "beside")
        )
        return cls(n, ranked, beside)

    @property
    def left_out(self) -> set[str]:
        """Items excluded from the ranking, for all models."""
        return set().union(*self.ranked.values())

    @property
    def ranked_over(self) -> str:
        return f"{self.items - len(self.left_out)} of {self.items}"

    def sentences(self) -> list[str]:
        """Sentences on excluded items; none if no model has seen any."""
        said = []
        if self.ranked:
            said.append(
                f"The ranking is over {self.ranked_over} items: {len(self.left_out)} are left out, which"
                f" ranked models have seen: {_counts(self.ranked)}."
            )
        if self.beside:
            said.append(
                f"Beside the ranking of {self.ranked_over} items, and never named as leading, stand models"
                f" that have seen more than {MOST_SEEN} % of the items, by themselves or with others:"
                f" {_counts(self.beside)}. None is left out for their sake."
            )
        return said


def _counts(seen: dict[str, set[str]]) -> str:
    return ", ".join(f"{model} {len(items)}" for model, items in seen.items())


def _refuse_failed(
    by_model: Mapping[str, Entry], failures: Iterable[tuple[str, str, str]], expected: Expected
) -> None:
    """Refuses a model that failed on any shape, since all are compared on the same shapes."""
    for item, stage, cause in failures:
        entry = by_model.get(stage.rpartition(".")[2])
        if entry and not entry.refused and item in expected.points:
            entry.refused = f"{item}: {cause.splitlines()[0]}"


def _refuse_undefined(by_model: Mapping[str, Entry], scores: Scores) -> None:
    """Refuses a model with an undefined score on a shape where the others have one: it would exclude the
    shape for all."""
    for metric in scores.metrics:
        scored = _scored(scores, metric.name).drop(columns="HS", errors="ignore")
        for model, entry in by_model.items():
            if (
                not entry.refused
                and model in scored
                and (lost := scored.index[scored.any(axis=1) & ~scored[model]]).size
            ):
                entry.refused = f"{lost[0][1]}: its map has no {metric.name}, and those of others have"


def _scored(scores: Scores, metric: str) -> pandas.DataFrame:
    """Frame of booleans, shapes x models: True if there is a score."""
    return scores.frame.set_index(["dataset", "item", "view", "model"])[metric].unstack("model").notna()


def _refuse_trainings(by_model: Mapping[str, Entry], scores: Scores, trainings: Trainings) -> None:
    """Refuses trainings without a score where the model's own map has one: they would exclude the shape for
    all trainings."""
    for metric in scores.metrics:
        ranked, again = _scored(scores, metric.name), _scored(trainings.study.scores, metric.name)
        for name, (model, seed) in trainings.names.items():
            has = again[name] if name in again else pandas.Series(dtype=bool)
            lost = ranked.index[ranked[model] & ~has.reindex(ranked.index, fill_value=False)]
            if lost.size and not by_model[model].refused:
                by_model[model].refused = (
                    f"seeds/{seed}: its map of {lost[0][1]} has no {metric.name}, and the one that is"
                    " ranked has"
                )


def _compare_scores(by_model: Mapping[str, Entry], path: Path) -> None:
    """Compares the scores that came with a submission; they decide nothing."""
    scores = read_csv(path)
    for model, entry in by_model.items():
        try:
            theirs = list(csv.reader(entry.read.results.splitlines(keepends=True)))
        except csv.Error:
            theirs = []
        entry.remark = (
            "" if theirs == [[*scores], *scores[scores["model"] == model].values.tolist()] else OTHER_SCORES
        )


def _beside(study: Study, overlap: Overlap) -> pandas.DataFrame:
    """Rows of compact.csv for models beside the ranking, each over the ranked items that it has not seen."""
    parts = [
        means.compact(_part(study, overlap.left_out | seen, lambda models: models == model))
        for model, seen in overlap.beside.items()
    ]
    empty = means.compact(_part(study, overlap.left_out, lambda models: models != models))
    return pandas.concat([empty, *parts], ignore_index=True).assign(rank=pandas.NA, group="", best=0)


def _part(study: Study, seen: set[str], chosen: Callable[[Any], Any]) -> Study:
    """Restricts to items not in `seen`, and to some models."""

    def unseen(frame: pandas.DataFrame | None) -> pandas.DataFrame | None:
        return None if frame is None else frame[~frame["item"].isin(seen)]

    frame = study.scores.frame
    smoothed = unseen(study.smoothed)
    return replace(
        study,
        scores=study.scores.part(~frame["item"].isin(seen) & chosen(frame["model"])),
        people=unseen(study.people),
        smoothed=None if smoothed is None else smoothed[chosen(smoothed["model"])],
        constant=unseen(study.constant),
    )


def _or_too_few(level: LevelLeaders) -> LevelLeaders:
    n = max((leader.n for leader in level.leaders), default=0)
    if n >= FEWEST_UNITS or not level.leaders:
        return level
    in_views = [level.dataset] if level.leaders[0].in_views else []
    unit = observation(level.unit, [level.dataset], in_views)
    return replace(
        level,
        leaders=[],
        sentence=(
            f"On {spoken(level.dataset)}{level.of_split}, {n} units ({unit}) are too few to name who leads:"
            f" at least {FEWEST_UNITS} are needed."
        ),
    )


def _facts(
    entries: list[Entry],
    expected: Expected,
    record: dict[str, Any],
    study: Study,
    overlap: Overlap,
    name: str,
) -> dict[str, str]:
    dates = [entry.card.date for entry in entries if not entry.refused and entry.card.date]
    data, recipe = record["data_set"], record.get("ground_truth")
    return {
        "Data set": (
            f"{name}, layout {data['layout']}: {len(expected.items)} items with ground truth,"
            f" {len(expected.points)} shapes"
        ),
        "Digest of the data": expected.data,
        "Ground truth": (
            f"made from recordings of gaze: {recipe}" if recipe else "as the files of the data set have it"
        ),
        "Protocol": record["configuration"]["protocol"],
        "Digest of the configuration": _core.digest(expected.protocol.encode()),
        "Program": record["program"],
        "Date": f"{max(dates)}, of the newest submission" if dates else "no submission has one",
        "Unit of inference": observation(study.unit, study.scores.datasets, study.scores.in_views),
        "Items ranked over": overlap.ranked_over,
        "Items left out": f"{len(overlap.left_out)}, which ranked models have seen",
        "Items seen by models beside": (
            f"{len(set().union(*overlap.beside.values()))}, which cost the others nothing"
        ),
    }


# --- tables -------------------------------------------------------------------------------------------------


def row_of(entry: Entry) -> dict[str, str]:
    """Row of submissions.csv. New columns are appended at the end."""
    card, manifest = entry.card, entry.manifest
    median, p95 = (*manifest.seconds, "", "")[:2]
    return {
        "file": entry.name,
        "model": card.name,
        "status": entry.status,
        "reason": entry.refused or entry.beside,
        "remark": entry.remark,
        "date": card.date,
        "citation": card.citation,
        "licence": card.licence,
        "training_data": card.training_data,
        "test_overlap": card.overlap if card.name else "",
        "url": card.url,
        "program": manifest.program,
        "trained_on": ", ".join(card.trained_on),
        "measured": entry.measured,
        "version": card.version,
        "parameters": card.parameters,
        "code": card.code,
        "weights": card.weights,
        "training_set": card.training_set,
        "container": card.container,
        "files": ", ".join(manifest.files),
        "seeds": ", ".join(card.seeds),
        "seconds_median": median,
        "seconds_p95": p95,
        "device": card.device,
        "memory": card.memory,
        "timed": "; ".join(filter(None, (manifest.timed, card.timed))),
        "contact": card.contact,
        "reproduced_by": "; ".join(card.reproduced_by),
        "made_by": manifest.made_by,
        "function": manifest.function,
        "learned": manifest.learned,
        "ground_truth": manifest.ground_truth,
        "map_digest": manifest.map_digest,
    }


def is_of(frame: pandas.DataFrame, level: LevelLeaders) -> Any:
    """Mask of the rows of a level, for any table of levels."""
    return (frame["dataset"] == level.dataset) & (
        (frame["split"] == level.split) if "split" in frame else True
    )


def _tables(board: Board, results: Results) -> dict[str, pandas.DataFrame]:
    study = board.study
    made = {name: frame for name, frame in tables_of(study) if frame is not None}
    made["leaders"] = leaders.framed_leaders(board.leaders, study.in_splits)
    for level in board.leaders:
        if not level.leaders:
            made["compact"].loc[is_of(made["compact"], level), "best"] = 0
    if study.constant is not None:  # the constant map is a trivial baseline
        constant = means.compact(replace(study, scores=replace(study.scores, frame=study.constant)))
        made["compact"] = pandas.concat([made["compact"], constant], ignore_index=True)
    made["overlap"] = board.beside.drop(columns=["rank", "group", "best"])
    rows = [{key: plain(cell) for key, cell in row_of(entry).items()} for entry in board.entries]
    made["submissions"] = pandas.DataFrame(rows, columns=[*row_of(Entry(Path()))])  # also without submissions
    made["about"] = pandas.DataFrame({"what": list(board.facts), "is": list(board.facts.values())})
    made["metrics"] = pandas.DataFrame(
        [
            {"metric": name, "unit": of["unit"], "better": of["better"]}
            for name, of in results.record["metrics"].items()
        ]
    )
    return made


OF_THE_RUN = (
    "results.csv",
    "constant.csv",
    "people.csv",
    "smoothed.csv",
    "mean_histograms_meshes.csv",
    "mean_histograms_scans.csv",
    "mean_histograms_clouds.csv",
)


def write_tables(board: Board, results: Results, folder: Path) -> None:
    """Writes the run's scores, and all tables derived from them."""
    unmarked = ("submissions", "about", "metrics")
    folder.mkdir(parents=True)
    for name in OF_THE_RUN:
        if (results.folder / name).is_file():
            shutil.copyfile(results.folder / name, folder / name)
    texts = {
        f"{name}.csv": tables.csv(frame, () if name in unmarked else board.remarks)
        for name, frame in board.tables.items()
    }
    for name, text in (texts | {"protocol.yaml": board.protocol}).items():
        (folder / name).write_text(text, "utf-8", "surrogateescape")
