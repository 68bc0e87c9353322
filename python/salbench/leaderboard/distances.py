# SPDX-License-Identifier: GPL-3.0-or-later
"""How far the models of a board are behind the best."""

from typing import Any

import pandas

from salbench.conclusions.significance import joint_interval
from salbench.leaderboard.board import Board
from salbench.pages.blocks import Cell, cell, interval
from salbench.pages.dots import LINES, Axis, Behind, Dot, Drawn, drawn

Row = dict[str, Any]
Level = tuple[str, str, str]  # data set, split, metric


def rows_of(frame: pandas.DataFrame) -> list[Row]:
    rows: list[Row] = frame.to_dict("records")
    return rows


def level_of(row: Row) -> Level:
    return row["dataset"], row.get("split", ""), row["metric"]


class Distances:
    """How far models are behind the best mean of a data set, split and metric, in figures and drawn as the report does."""

    def __init__(self, board: Board) -> None:
        self.rows: dict[Level, list[Row]] = {}
        for row in rows_of(board.tables["ranking"]):
            self.rows.setdefault(level_of(row), []).append(row)
        self._pairs = {(*level_of(row), row["model_a"], row["model_b"]): row for row in rows_of(board.tables["significance"])}
        self._lower = {row["metric"]: row["better"] == "lower" for row in rows_of(board.tables["metrics"])}
        self._references = [row for row in rows_of(board.tables["compact"]) if row["model"] in LINES and row["mean"] == row["mean"]]
        self.first = {(level.dataset, level.split, leader.metric.name): leader.models for level in board.leaders for leader in level.leaders}
        self._drawn = {level: self._draw(level, rows) for level, rows in self.rows.items()}

    def cell(self, level: Level, model: str) -> Cell:
        """The mean of the model less the best mean, whichever way the metric is better, with its interval."""
        pair = self._pair(level, model)
        if pair is None:
            return cell(None)
        difference, low, high = pair
        return cell(difference, below=interval(low, high).text, drawn=self.of(level).get(model))

    def of(self, level: Level) -> dict[str, Drawn]:
        """By ranked model."""
        dots, axis = self._drawn.get(level, ({}, None))
        return {} if axis is None else {model: Drawn(dot, axis) for model, dot in dots.items()}

    def foot(self, level: Level) -> Cell:
        axis = self._drawn.get(level, ({}, None))[1]
        return Cell("", drawn=None if axis is None else Drawn(None, axis))

    def _pair(self, level: Level, model: str) -> tuple[float, float, float] | None:
        best = self.rows[level][0]["model"]
        sign, row = (1, self._pairs[*level, model, best]) if (*level, model, best) in self._pairs else (-1, self._pairs.get((*level, best, model)))
        if row is None:
            return None
        return (sign * row["mean_difference"], *joint_interval(sign * row["mean_difference"], sign * row["t"], row["t_bound"]))

    def _draw(self, level: Level, rows: list[Row]) -> tuple[dict[str, Dot], Axis | None]:
        rows = [row for row in rows if row["mean"] == row["mean"]]
        if not rows:
            return {}, None
        sign, best = -1 if self._lower[level[2]] else 1, rows[0]["mean"]
        found = [Behind(sign * (row["mean"] - best)) for row in rows]
        for at, row in enumerate(rows[1:], 1):
            if pair := self._pair(level, row["model"]):
                found[at] = Behind(sign * pair[0], *sorted(sign * end for end in pair[1:]))
        models = [row["model"] for row in rows]
        references = [(LINES[row["model"]], sign * (row["mean"] - best)) for row in self._references if level_of(row) == level and row["model"] not in models]
        dots, axis = drawn(found, [model in self.first.get(level, ()) for model in models], references)
        return dict(zip(models, dots)), axis
