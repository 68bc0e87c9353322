# SPDX-License-Identifier: GPL-3.0-or-later
"""The program's tables as data frames: the same doubles, and names as texts whatever they look like."""

import os
from collections.abc import Callable
from functools import cached_property, partial
from pathlib import Path
from typing import TYPE_CHECKING

from salbench._errors import InputError

if TYPE_CHECKING:
    import pandas


def remarks_of(path: str | os.PathLike[str]) -> list[str]:
    """The lines of '#' that a file begins with, without the '#'."""
    remarks = []
    with open(path, encoding="utf-8", errors="replace") as file:
        for line in file:
            if not line.startswith("#"):
                break
            remarks.append(line[1:].strip())
    return remarks


def read(path: str | os.PathLike[str], type_of: Callable[[str], str | None] | None = None, errors: str = "surrogateescape") -> "pandas.DataFrame":
    """The one reader of tables that the program or this package has written; conclusions.csv_file reads those of anybody, strictly.

    Texts are as they stand in the file, "" where it has none; numbers are the same doubles, NaN where it has none. type_of: of a column
    by its name, whatever is in it, as conclusions.type_of declares it by default; None: what pandas makes of it. errors: for bytes that
    are not UTF-8. Throws InputError for what is no such table.
    """
    import pandas

    from salbench import conclusions

    type_of = type_of or partial(conclusions.type_of, Path(path).stem)
    above = len(remarks_of(path))
    try:
        types = {name: type_of(name) for name in pandas.read_csv(path, skiprows=above, nrows=0, encoding_errors=errors)}
        frame = pandas.read_csv(path, skiprows=above, dtype={name: type for name, type in types.items() if type}, keep_default_na=False,
                                na_values=[""], float_precision="round_trip", encoding_errors=errors)
    except (TypeError, ValueError) as error:  # as pandas raises them
        raise InputError(f"{os.fspath(path)}: {' '.join(str(error).split())}") from None
    return frame.fillna(dict.fromkeys((name for name, type in types.items() if type == "str"), ""))


class Tables:
    """The tables that conclusions have, by the names of their files."""

    def _table(self, name: str) -> "pandas.DataFrame":
        raise NotImplementedError

    @cached_property
    def leaders(self) -> "pandas.DataFrame":
        """Who leads by each metric and how sure, and in sentences."""
        return self._table("leaders")

    @cached_property
    def compact(self) -> "pandas.DataFrame":
        """Mean, half interval, rank and group of each model by each metric, as a paper has them."""
        return self._table("compact")

    @cached_property
    def summary(self) -> "pandas.DataFrame":
        """Mean of each model by each metric, with its 95 % intervals: Student's, and of the bootstrap by unit [efron1987]."""
        return self._table("summary")

    @cached_property
    def ranking(self) -> "pandas.DataFrame":
        """Ranks with their intervals, and letters of groups: models without one in common differ [mogstad2024]."""
        return self._table("ranking")

    @cached_property
    def significance(self) -> "pandas.DataFrame":
        """Every pair of models: paired differences, signed-rank tests [wilcoxon1945], corrected for all pairs [holm1979]."""
        return self._table("significance")

    @cached_property
    def agreement(self) -> "pandas.DataFrame":
        """How far the rankings by two metrics agree [kendall1945]."""
        return self._table("ranking_agreement")

    @cached_property
    def per_class(self) -> "pandas.DataFrame":
        """Means and intervals by class of the items; empty without classes."""
        return self._table("per_class")

    @cached_property
    def human_share(self) -> "pandas.DataFrame":
        """Scores as a share of what people reach; empty without the model HS."""
        return self._table("human_share")
