# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads scores per shape from results.csv of a run, or from a user's or published table."""

import os
import re
from collections.abc import Iterable, Sequence

import numpy as np
import pandas

from salbench.conclusions.metrics import Metric, of_program
from salbench.conclusions.units import AVERAGE, DATASETS, REFERENCES, TEXTS, Floats, Scores
from salbench.system.csv import fail, read_csv, require
from salbench.system.errors import InputError, quoted, wrong_with_line

_BESIDE_SCORES = (*TEXTS, "n_points", "n_picks")
_ROUNDING = 1e-9  # tolerance beyond the range of a metric
_SMALLEST, _LARGEST = 1e-100, 1e100  # bounds for the largest score of a metric
_MOST_REMARKS = 10  # repeated in the output; a table may have one per row
_UNREADABLE = re.compile(r"[\x00-\x1f\x7f]")


def metrics_to_read(higher: Iterable[str] = (), lower: Iterable[str] = ()) -> list[Metric]:
    """The program's metrics, and user columns named by direction."""
    metrics = dict(of_program())
    for name, higher_is_better in (*((name, True) for name in higher), *((name, False) for name in lower)):
        if name in TEXTS:
            raise InputError(
                f"{'--higher' if higher_is_better else '--lower'} {name}: is a column of names, and no score;"
                " name one of numbers"
            )
        if metrics.setdefault(name, Metric(name, higher_is_better)).higher_is_better != higher_is_better:
            known = (
                "both higher and lower values"
                if name not in of_program()
                else f"{'lower' if higher_is_better else 'higher'} values"
            )
            raise InputError(
                f"{'--higher' if higher_is_better else '--lower'} {name}: {known} of it would be better; name"
                " it once, or not at all if it is a metric of the program"
            )
    return list(metrics.values())


def read_scores(
    path: str | os.PathLike[str],
    higher: Sequence[str] = (),
    lower: Sequence[str] = (),
    classes: str | os.PathLike[str] | None = None,
) -> tuple[Scores, list[str]]:
    """Reads the scores of a CSV file with a row per shape and model. Returns notes on its remarks and on
    unused columns, too.

    Columns: item, model and at least one metric; optionally dataset, view, class and split. Without
    `dataset`, rows with a view are scans and others meshes; of `lcc` the magnitude counts. higher, lower:
    further columns of scores, for which higher or lower values are better. classes: a CSV file with columns
    item and class. Throws InputError with file and line for a missing column, a score that is not a
    number, or a second row of a shape and model.
    """
    metrics = metrics_to_read(higher, lower)
    table = _read(path, metrics)
    for name in (*higher, *lower):
        if name not in table.columns:
            raise InputError(f"{table.attrs['name']}: no column '{name}'")
    class_of = {} if classes is None else read_classes(classes)
    found = scores_from(table, metrics, class_of)
    check(table, found)
    notes = _notes(table, found.metrics)
    lacking = [item for item in found.frame["item"].unique() if classes and item not in class_of]
    if lacking:
        notes.append(
            f"{classes}: has no row for {len(lacking)} of the items, such as {quoted(lacking[0])}: they keep"
            " the class that the table gives them, if any"
        )
    return found, notes


def read_results(path: str | os.PathLike[str], metrics: Sequence[Metric]) -> tuple[Scores, list[str]]:
    """Reads results.csv or constant.csv of a run, restricted to its metrics, and its remarks. May be
    empty."""
    table = _read(path, metrics)
    return scores_from(table, metrics, may_be_empty=True), table.attrs["remarks"]


def read_smoothed(path: str | os.PathLike[str], metrics: Sequence[Metric]) -> pandas.DataFrame:
    """Reads smoothed.csv of a run: `smoothing`, then the columns of its scores."""
    return _columns(_read(path, metrics), ("smoothing", *TEXTS), metrics)


def read_people(path: str | os.PathLike[str], metrics: Sequence[Metric]) -> pandas.DataFrame:
    """Reads people.csv of a run: item, class, n and a column per metric."""
    table = _read(path, metrics, "n")
    require(table, "item", "class", "n")
    return _columns(table, ("item", "class", "n"), metrics).astype({"n": int})


def _read(path: str | os.PathLike[str], metrics: Iterable[Metric], *numbers: str) -> pandas.DataFrame:
    return read_csv(path, {*numbers, *(metric.name for metric in metrics)}.__contains__)


def _columns(table: pandas.DataFrame, names: Sequence[str], metrics: Iterable[Metric]) -> pandas.DataFrame:
    """Selects these columns and the metrics; missing ones become empty. The index is the row number."""
    numbers = [metric.name for metric in metrics]
    require(table, *numbers)
    return table.reindex(columns=[*names, *numbers], fill_value="").reset_index(drop=True)


def scores_from(
    table: pandas.DataFrame,
    metrics: Sequence[Metric],
    class_of: dict[str, str] | None = None,
    may_be_empty: bool = False,
) -> Scores:
    """Scores of a table by those of the metrics that it has, in their order."""
    if not len(table) and not may_be_empty:
        raise InputError(f"{table.attrs['name']}: no scores below the names of the columns")
    require(table, "item", "model")
    if "lcc" in table:
        table = table.assign(lcc=table["lcc"].abs())
    found = tuple(metric for metric in metrics if metric.name in table)
    if not found:
        raise InputError(
            f"{table.attrs['name']}: no column is a metric; name the columns of scores with --higher or"
            f" --lower; there are {', '.join(table.columns)}"
        )
    frame = _columns(table, TEXTS, found)
    for metric in found:
        for row in np.flatnonzero(np.isinf(frame[metric.name]))[:1]:
            fail(table, row, f"{metric.name} is infinite: no score can be")
    unnamed = frame["dataset"] == ""
    frame.loc[unnamed, "dataset"] = np.where(frame.loc[unnamed, "view"] == "", "meshes", "scans")
    _check_rows(table, frame)
    if class_of:
        frame["class"] = [class_of.get(item, own) for item, own in zip(frame["item"], frame["class"])]
    return Scores(frame, found)


def _check_rows(table: pandas.DataFrame, frame: pandas.DataFrame) -> None:
    unknown = ~frame["dataset"].isin(DATASETS)
    again = frame.duplicated(["dataset", "item", "view", "model"])
    for row in np.flatnonzero(unknown | again)[:1]:
        dataset, item, view, model = frame.loc[row, ["dataset", "item", "view", "model"]]
        if unknown[row]:
            fail(table, row, f"data set '{dataset}', expected one of {', '.join(DATASETS)}")
        fail(table, row, f"a second row of item '{item}'{', view ' + view if view else ''}, model '{model}'")


def check(table: pandas.DataFrame, scores: Scores) -> None:
    """Throws InputError, with the line, for mistakes in a user's table that would make its other rows
    meaningless."""
    frame = scores.frame
    for name in TEXTS:
        spelled: dict[str, str] = {}
        for row in np.flatnonzero(~frame.duplicated(name)):
            own = frame[name][row]
            if _UNREADABLE.search(own) or (name == "model" and "," in own):
                fail(
                    table,
                    row,
                    (
                        f"{name} {own!r} has a {'comma, a ' if name == 'model' else ''}line break or another"
                        " control character: lists of names could not be read"
                    ),
                )
            if name in ("class", "split") and (wrong := wrong_with_line(own)):
                fail(table, row, f"{name} {quoted(own)} has {wrong}, which tables cannot have: rename it")
            if name not in ("item", "model"):
                continue
            if not own:
                fail(table, row, f"the row names no {name}")
            if name == "model" and own == AVERAGE:
                fail(
                    table,
                    row,
                    f"model '{AVERAGE}' is the mean over all models in per_class.csv: give it another name",
                )
            if (other := spelled.setdefault(own.strip().lstrip("0") or "0", own)) != own:
                fail(
                    table,
                    row,
                    f"{name} '{own}' is '{other}' of a row above in another spelling: give both the same",
                )
    of_class = frame[frame["class"] != ""].drop_duplicates(["item", "class"])
    for row in of_class.index[of_class.duplicated("item")][:1]:
        first = of_class.loc[of_class["item"] == frame["item"][row], "class"].iloc[0]
        fail(
            table,
            row,
            (
                f"item '{frame['item'][row]}' is of class '{frame['class'][row]}' here, and of class"
                f" '{first}' above: an item has one"
            ),
        )
    for metric in scores.metrics:
        _check_values(table, frame[metric.name].to_numpy(), metric)
    _check_coverage(table, frame, scores.metrics)


def _check_values(table: pandas.DataFrame, values: Floats, metric: Metric) -> None:
    for row in np.flatnonzero((values < metric.low - _ROUNDING) | (values > metric.high + _ROUNDING))[:1]:
        fail(
            table,
            row,
            (
                f"{metric.name} is {values[row]:g}, and can be {metric.low:g} to {metric.high:g}: is it in"
                " percent, or another metric of that name?"
            ),
        )
    sizes = np.abs(np.nan_to_num(values))
    largest = int(np.argmax(sizes)) if len(values) else 0
    if len(values) and sizes[largest] != 0 and not _SMALLEST < sizes[largest] < _LARGEST:
        fail(
            table,
            largest,
            (
                f"{metric.name} is {values[largest]:g}, the largest of all: squares of such numbers cannot be"
                " computed; give the scores in another unit"
            ),
        )


def _check_coverage(table: pandas.DataFrame, frame: pandas.DataFrame, metrics: Iterable[Metric]) -> None:
    """Refuses a model with scores on fewer than half of the shapes of a data set and split, since it would
    reduce the others to these."""
    models, names = pandas.factorize(frame["model"])
    parts, _ = pandas.factorize(frame["dataset"] + "\n" + frame["split"])
    shapes, _ = pandas.factorize(
        frame["item"] + "\n" + frame["view"] + "\n" + frame["dataset"] + "\n" + frame["split"]
    )
    part_of_shape = np.zeros(shapes.max(initial=-1) + 1, dtype=np.intp)
    part_of_shape[shapes] = parts
    competes = ~frame["model"].isin(REFERENCES).to_numpy()
    for metric in metrics:
        known = competes & frame[metric.name].notna().to_numpy()
        n = np.bincount(part_of_shape[np.unique(shapes[known])], minlength=len(parts))
        of_model = np.bincount(parts[known] * len(names) + models[known], minlength=1)
        for cell in np.flatnonzero(
            (of_model > 0) & (2 * of_model < n[np.arange(len(of_model)) // len(names)])
        )[:1]:
            part, model = divmod(int(cell), len(names))
            row = int(np.flatnonzero((parts == part) & (models == model))[0])
            fail(
                table,
                row,
                (
                    f"model '{names[model]}' has {metric.name} on {of_model[cell]} of"
                    f" {n[part]} {frame['dataset'][row]}, and models are compared on the shapes that all"
                    " have: complete its rows, or take them out"
                ),
            )


def read_classes(path: str | os.PathLike[str]) -> dict[str, str]:
    """Reads the class of each item."""
    table = read_csv(path)
    require(table, "item", "class")
    found: dict[str, str] = {}
    for row, (item, own) in enumerate(zip(table["item"], table["class"])):
        if item in found:
            fail(table, row, f"item '{item}' has a class already")
        if wrong := wrong_with_line(own):
            fail(table, row, f"class {quoted(own)} has {wrong}, which tables cannot have: rename it")
        found[item] = own
    return found


def _notes(table: pandas.DataFrame, metrics: Iterable[Metric]) -> list[str]:
    # a column without a name is the index that other programs write
    known = {"", *_BESIDE_SCORES, *(metric.name for metric in metrics)}
    left_out = [name for name in table.columns if name not in known]
    first, more = table.attrs["remarks"][:_MOST_REMARKS], len(table.attrs["remarks"]) - _MOST_REMARKS
    notes = [
        f"{table.attrs['name']}: {remark}"
        for remark in (*first, *([f"and {more} further remarks"] if more > 0 else []))
    ]
    if left_out:
        notes.append(
            f"{table.attrs['name']}: columns that are no metrics of the program were left out:"
            f" {', '.join(left_out)}; name them with --higher or --lower"
        )
    return notes
