# SPDX-License-Identifier: GPL-3.0-or-later
"""The program's tables as data frames: the same doubles, and names as texts whatever they look like."""

import io
from functools import cached_property
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import pandas

NAMES = ("item", "view", "class", "split", "model", "model_a", "model_b", "group")


def read(text: str) -> "pandas.DataFrame":
    """A table from the text of its file, whose remarks stand above it."""
    import pandas

    while text.startswith("#"):
        text = text.partition("\n")[2]
    return pandas.read_csv(io.StringIO(text), dtype=dict.fromkeys(NAMES, str), keep_default_na=False, na_values=[""],
                           float_precision="round_trip")


class Tables:
    """The tables that conclusions have, by the names of their files."""

    def _text(self, name: str) -> str:
        raise NotImplementedError

    def _table(self, name: str) -> "pandas.DataFrame":
        return read(self._text(name))

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
