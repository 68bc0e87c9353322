# SPDX-License-Identifier: GPL-3.0-or-later
"""Statistics of scores per shape: means, significant differences, the leading models, and uncertainties."""

import math
from collections.abc import Iterable
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from salbench import _core
from salbench.runs.tables import Tables, shown

if TYPE_CHECKING:
    import pandas

    from salbench.conclusions.study import Study
    from salbench.conclusions.units import Scores

__all__ = ["Conclusions", "conclude"]
_TEXTS = ("item", "model", "dataset", "view", "class", "split")


class Conclusions(Tables):
    """Conclusions from scores, as data frames with the columns of docs/data_dictionary.md.

    Each is computed on first access; all use the same units, shapes and resamples.
    """

    def __init__(self, study: "Study") -> None:
        self._study = study

    def _table(self, name: str) -> "pandas.DataFrame":
        from salbench import conclusions

        return conclusions.table_of(self._study, name)

    def __repr__(self) -> str:
        from salbench.conclusions.words import observation

        scores = self._study.scores
        return (
            f"Conclusions: {scores.frame['model'].nunique()} models by"
            f" {', '.join(metric.name for metric in scores.metrics)}; one observation per"
            f" {observation(self._study.unit, scores.datasets, scores.in_views)}"
        )

    def _repr_html_(self) -> str:
        return shown(self, repr(self))


def _text(value: Any) -> str:
    """Cell as in a CSV file: empty for missing values, 3 for the 3.0 of an integer column that pandas made
    float."""
    if value is None or (isinstance(value, float) and math.isnan(value)) or str(value) == "<NA>":
        return ""
    if isinstance(value, float) and value.is_integer():
        return str(int(value))
    return str(value)


def _columns(table: "pandas.DataFrame", named: set[str]) -> "pandas.DataFrame":
    """Texts and numbers of a table, as in a file; other columns are left out unless they are named. The index
    is the position."""
    import pandas
    from pandas.api.types import is_numeric_dtype

    columns: dict[str, Any] = {}
    names = [str(name) for name in table.columns]
    for i, name in enumerate(names):
        if names.count(name) > 1:
            raise ValueError(f"table has two columns '{name}'")
        values = table.iloc[:, i]
        if name in _TEXTS:
            columns[name] = pandas.Series([_text(value) for value in values], dtype=object)
        elif name in named or is_numeric_dtype(values.dtype):
            try:
                columns[name] = values.to_numpy(dtype=np.float64, na_value=np.nan)
            except OverflowError:
                raise ValueError(f"table has a number in column '{name}' that a double cannot hold") from None
    found = pandas.DataFrame(columns)
    found.attrs["name"] = "table"
    return found


def conclude(
    table: "pandas.DataFrame",
    unit: str = "mesh",
    seed: int = 2016,
    metrics: Iterable[str] | None = None,
    *,
    higher_is_better: Iterable[str] = (),
    lower_is_better: Iterable[str] = (),
    threads: int | None = 1,
) -> Conclusions:
    """Computes intervals, paired tests, ranks and groups from a table of scores per shape: `Results.scores`,
    or your own.

    Parameters
    ----------
    table : pandas.DataFrame
        A row per shape and model. Columns: item, model and at least one metric; optionally dataset ("meshes",
        "scans", "clouds"), view and class. Without `dataset`, rows with a view are scans and others meshes.
    unit : str
        Unit of observation: "mesh", with its scans averaged; "class"; "shape".
    seed : int
        Seed of the resamples; the default is that of the command `salbench conclude`.
    metrics : sequence of str, optional
        Columns to use. Default: all known metrics.
    higher_is_better, lower_is_better : sequence of str
        Further columns of scores, beside the metrics of the program.
    threads : int or None, default 1
        Number of threads; None: all cores that the process may use. The tables do not depend on it.

    Returns
    -------
    Conclusions
        A frame for each table of conclusions: leaders, summary, ranking, significance, ...

    Raises
    ------
    KeyError
        A name among `metrics`, `higher_is_better`, `lower_is_better` that is not a column.
    ValueError
        A table with missing columns, infinite or impossible scores, two rows of a shape and model, or names
        that are empty or spelled in two ways; the message names the row by its position.

    References
    ----------
    [efron1987], [wilcoxon1945], [holm1979], [mogstad2024], [piepho2004]

    Examples
    --------
    >>> import pandas
    >>> import salbench
    >>> scores = pandas.DataFrame({"item": list("abcdef") * 2, "model": ["A"] * 6 + ["B"] * 6,
    ...                            "auc": [.7, .8, .75, .9, .8, .7, .6, .7, .7, .8, .7, .65]})
    >>> found = salbench.stats.conclude(scores)
    >>> found.ranking[["model", "rank"]].values.tolist()
    [['A', 1], ['B', 2]]
    """
    from salbench.conclusions import check_unit
    from salbench.conclusions.study import Study
    from salbench.conclusions.units import UNITS

    chosen = None if metrics is None else _names("metrics", metrics)
    higher, lower = _names("higher_is_better", higher_is_better), _names("lower_is_better", lower_is_better)
    if not hasattr(table, "columns"):
        raise ValueError(f"table must be a pandas.DataFrame, not {type(table).__name__}")
    if chosen == []:
        raise ValueError("metrics names no column: name some, or leave it out")
    named = [*(chosen or ()), *higher, *lower]
    columns = _columns(table, set(named))
    for name in named:
        if name not in columns:
            _core.fail_unknown("column", name, list(columns))
    for needed in ("item", "model"):
        if needed not in columns:
            raise ValueError(f"table must have a column '{needed}'")
    scores = _scores(columns, chosen, higher, lower)
    workers = _core.thread_count(threads, "threads")
    if str(unit) not in UNITS:
        raise ValueError(f"unit must be one of {', '.join(UNITS)}, not '{unit}'")
    study = Study(scores, str(unit), _core.whole_number(seed, "seed", 0, 2**64 - 1), threads=workers)
    check_unit(study)
    return Conclusions(study)


def _scores(
    table: "pandas.DataFrame", chosen: list[str] | None, higher: list[str], lower: list[str]
) -> "Scores":
    """Scores by all known metrics, or by the selected ones."""
    from salbench.conclusions.scores import check, metrics_to_read, scores_from

    known = metrics_to_read(higher, lower)
    if not any(metric.name in table.columns for metric in known):
        raise ValueError(
            "table must have a column that is a metric of the program, or is named in higher_is_better or"
            " lower_is_better"
        )
    scores = scores_from(table, known)
    if chosen is not None:
        by_name = {metric.name: metric for metric in scores.metrics}
        for name in chosen:
            if name not in by_name:
                raise ValueError(
                    f"metrics: '{name}' is no metric of the program: name it in higher_is_better or"
                    " lower_is_better"
                )
        scores = replace(scores, metrics=tuple(by_name[name] for name in chosen))
    check(table, scores)
    return scores


def _names(argument: str, names: Iterable[str]) -> list[str]:
    if isinstance(names, str):
        return [names]
    given = list(names) if isinstance(names, Iterable) else None
    if given is None or not all(isinstance(name, str) for name in given):
        raise ValueError(f"{argument} must be names of columns")
    return given


def __dir__() -> list[str]:
    return sorted(__all__)
