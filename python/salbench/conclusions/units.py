# SPDX-License-Identifier: GPL-3.0-or-later
"""Scores by unit of inference: the one place that decides the unit of observation, and the shapes that models
are compared on.

Views of a mesh share its geometry and participants: intervals that treat them as independent are too narrow.
By default a unit is therefore a mesh, and its score the mean over its scans.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
import pandas
from numpy.typing import NDArray

from salbench._core import models_about
from salbench.conclusions.metrics import Metric

Floats = NDArray[np.float64]
Numbers = NDArray[np.intp]

# a mesh with its scans, or a cloud; a class of shapes; a single mesh, scan or cloud
UNITS = ("mesh", "class", "shape")
DATASETS = ("meshes", "scans", "clouds")  # in the order of the tables
# People, chance and the constant map: models are measured against them, and they do not compete.
REFERENCES = tuple(name for name, about in models_about.items() if about.is_reference)
# mean over the competitors, unit by unit, so that its interval is over units; reserved name
AVERAGE = "Avg"
TEXTS = ("dataset", "split", "item", "class", "view", "model")


@dataclass(frozen=True)
class Scores:
    """A row per shape and model: the columns TEXTS, "" if empty, and one per metric, NaN if undefined.
    first_of: maps each item with copies, equal in shape and ground truth, to the first of them."""

    frame: pandas.DataFrame
    metrics: tuple[Metric, ...]
    first_of: Mapping[str, str] = field(default_factory=dict)

    @cached_property
    def in_splits(self) -> bool:
        """True if tables of these scores have a column `split`."""
        return bool((self.frame["split"] != "").any())

    @cached_property
    def datasets(self) -> list[str]:
        """Data sets with rows."""
        return [dataset for dataset in DATASETS if (self.frame["dataset"] == dataset).any()]

    @cached_property
    def in_views(self) -> set[str]:
        """Data sets whose shapes are views of others."""
        return datasets_in_views(self.frame)

    def without_copies(self, items: pandas.Series) -> pandas.Series:
        """Replaces each copy by the first of them."""
        return items.map(lambda item: self.first_of.get(item, item)) if self.first_of else items

    def part(self, rows: Any) -> "Scores":
        """Selects rows."""
        return replace(self, frame=self.frame[rows])


@dataclass(frozen=True)
class UnitScores:
    """Scores of some models on the same units, without gaps."""

    models: Numbers  # indices in Level.models of the columns of `values`
    units: Numbers  # indices of its rows among the units of the level
    values: Floats  # units x models: means over the shapes of a unit
    n_shapes: int  # in each unit
    # resamples x models: their means, if used for ranks
    resampled: Floats = field(default_factory=lambda: np.empty((0, 0)))

    @property
    def n(self) -> int:
        return len(self.units)


class Level:
    """Scores of one data set, or of one of its splits or classes: arrays by shape, model and metric."""

    def __init__(
        self,
        scores: Scores,
        dataset: str,
        unit: str,
        split: str = "",
        constant: pandas.DataFrame | None = None,
    ) -> None:
        """scores: only of this data set, split and class. split: as in tables; empty for several, or none.
        constant: scores of the constant map on these and other shapes."""
        rows = scores.frame
        if unit == "class":
            rows = rows[rows["class"] != ""]  # shapes without a class belong to no such unit
        self.dataset, self.split, self.metrics = dataset, split, scores.metrics
        models, names = pandas.factorize(rows["model"])
        self.models: list[str] = list(names)
        views = rows["item"] + "\n" + rows["view"]  # no name has a line feed
        items = scores.without_copies(rows["item"])
        units, _ = pandas.factorize(
            {"mesh": items, "class": rows["class"], "shape": items + "\n" + rows["view"]}[unit]
        )
        self.copies = _copies(scores.first_of, rows["item"])
        self.in_views = dataset in scores.in_views
        numbers, known = pandas.factorize(views)
        place, self.unit_of_shape = _places(numbers, units)
        shapes = place[numbers]
        # by shape: equal for copies that count once within their class
        self._once = np.empty_like(place)
        self._once[shapes] = (
            pandas.factorize(rows["class"] + "\n" + items + "\n" + rows["view"])[0]
            if unit == "class"
            else numbers
        )
        self.is_reference = np.array([model in REFERENCES for model in self.models], dtype=bool)
        # contiguous per metric
        values = np.full((len(self.metrics), len(self.unit_of_shape), len(self.models)), np.nan)
        for number, metric in enumerate(self.metrics):
            values[number, shapes, models] = rows[metric.name]
        self.values = values.transpose(1, 2, 0)  # shapes x models x metrics
        self.defined = (~np.isnan(values)).transpose(1, 2, 0)
        self.is_scored = self.defined.any(axis=0)  # models x metrics
        others = self.is_reference[:, None] | ~self.is_scored
        # shapes x metrics: scores of the constant map
        self.constant = np.full((len(place), len(self.metrics)), np.nan)
        if constant is not None:
            rows = constant[constant["dataset"] == dataset]
            found = known.get_indexer(rows["item"] + "\n" + rows["view"])
            self.constant[place[found[found >= 0]]] = rows[[metric.name for metric in self.metrics]].to_numpy(
                dtype=float
            )[found >= 0]
        # shapes x metrics: True if all competitors have a score
        self._common = (self.defined | others).all(axis=1)

    def find(self, model: str) -> int | None:
        """Index of a model; None if it has no row."""
        return self.models.index(model) if model in self.models else None

    def scored(self, metric: int) -> Numbers:
        """Models with at least one score of the metric."""
        return np.flatnonzero(self.is_scored[:, metric])

    def competitors(self, metric: int) -> Numbers:
        """Scored models without references."""
        return np.flatnonzero(self.is_scored[:, metric] & ~self.is_reference)

    def n_missing(self, metric: int) -> Numbers:
        """Number of shapes, by model, that some other model has a score for and this one has not."""
        defined = self.defined[:, :, metric]
        missing: Numbers = defined.any(axis=1).sum() - defined.sum(axis=0)
        return missing

    def at_chance(self, metric: int) -> Floats:
        """Scores of the competitors, units x models, on all shapes that some model is scored on. A missing
        score becomes that of RS on the shape, or else the metric's value for uninformative maps; NaN if that
        is unknown, too."""
        models, values = self.competitors(metric), self.values[:, :, metric]
        kept = np.flatnonzero(self.defined[:, :, metric].any(axis=1))
        chance = np.full(len(values), np.nan) if (place := self.find("RS")) is None else values[:, place]
        chance = np.where(np.isnan(chance), self.metrics[metric].chance, chance)
        return self._by_unit(np.where(np.isnan(values), chance[:, None], values)[:, models], kept)[1]

    def compared(self, metric: int, models: Sequence[int] | Numbers) -> UnitScores:
        """Scores of some models on the shapes that they and all competitors are scored on.

        All means, tests and ranks thus use the same shapes, and a model gains nothing by failing on hard
        ones. References may have fewer scores: they exclude no shapes.
        """
        return self._averaged(metric, models, self._common[:, metric])

    def beside(self, metric: int, models: Sequence[int] | Numbers, baseline: Floats) -> Floats:
        """`compared` with the baseline as a last column, on the shapes where it is known: units x models + 1.
        baseline: one score per shape."""
        kept = self._common[:, metric] & self.defined[:, models, metric].all(axis=1) & ~np.isnan(baseline)
        return self._by_unit(
            np.column_stack([self.values[:, models, metric], baseline]), np.flatnonzero(kept)
        )[1]

    def averaged(
        self, metric: int, models: Sequence[int] | Numbers, required: Sequence[int] | Numbers = ()
    ) -> UnitScores:
        """Scores of some models on the shapes that they and those of `required` are scored on."""
        return self._averaged(
            metric, models, self.defined[:, np.asarray(required, dtype=np.intp), metric].all(axis=1)
        )

    def groups(
        self, metric: int, sets: Sequence[Sequence[int] | Numbers], with_all: bool = True
    ) -> list[tuple[list[int], UnitScores]]:
        """`compared` for each set of models, grouped by shapes: the places of the sets, and the scores of all
        models in them. Sets without missing scores, mostly all, are thus computed together. with_all: False:
        `averaged`."""
        shapes = self._common[:, metric] if with_all else np.ones(len(self.values), dtype=bool)
        kept = (self.defined[:, :, metric] & shapes[:, None]).T.copy()  # models x shapes
        places: dict[bytes, list[int]] = {}
        for place, models in enumerate(sets):
            places.setdefault(kept[np.asarray(models)].all(axis=0).tobytes(), []).append(place)
        return [
            (
                group,
                self._averaged(metric, np.unique(np.concatenate([sets[place] for place in group])), shapes),
            )
            for group in places.values()
        ]

    def pairs(
        self,
        metric: int,
        a: Numbers,
        b: Numbers,
        of: Callable[[Floats], Mapping[str, Any]],
        with_all: bool = True,
    ) -> dict[str, Floats]:
        """Returns n, n_shapes and the result of `of` for differences a - b, units x pairs, by pair of models.
        As arrays, since a frame per metric and group of pairs costs more than the computation."""
        found: dict[str, Floats] = {}
        for places, scores in self.groups(metric, list(np.column_stack([a, b])), with_all):
            of_a, of_b = (
                scores.values[:, np.searchsorted(scores.models, models[places])] for models in (a, b)
            )
            for name, values in dict(of(of_a - of_b), n=scores.n, n_shapes=scores.n_shapes).items():
                found.setdefault(name, np.empty(len(a)))[places] = values
        return found

    def _averaged(
        self, metric: int, models: Sequence[int] | Numbers, shapes: NDArray[np.bool_]
    ) -> UnitScores:
        models = np.asarray(models, dtype=np.intp)
        kept = np.flatnonzero(shapes & self.defined[:, models, metric].all(axis=1))
        if len(kept) == 0 or len(models) == 0:
            return UnitScores(models, np.empty(0, dtype=np.intp), np.empty((0, len(models))), 0)
        return UnitScores(models, *self._by_unit(self.values[:, models, metric], kept), len(kept))

    def _by_unit(self, values: Floats, shapes: Numbers) -> tuple[Numbers, Floats]:
        """Units of some shapes, and the means over these: units x columns. Copies within a class share the
        weight of one shape."""
        units, unit = np.unique(self.unit_of_shape[shapes], return_inverse=True)
        once = self._once[shapes]
        weights = 1 / np.bincount(once)[once]
        k = values.shape[1]
        # bincount adds shape by shape: another order would round differently, which can break ties
        cells = (unit[:, None] * k + np.arange(k)).ravel()
        sums = np.bincount(cells, (values[shapes] * weights[:, None]).ravel()).reshape(-1, k)
        return units, sums / np.bincount(unit, weights)[:, None]


def datasets_in_views(rows: pandas.DataFrame) -> set[str]:
    """Data sets among these rows whose shapes are views of others, as scans are."""
    return set(rows.loc[rows["view"] != "", "dataset"])


def _copies(first_of: Mapping[str, str], items: pandas.Series) -> list[list[str]]:
    """Groups of these items that count as one observation."""
    groups: dict[str, list[str]] = {}
    for item in items[items.isin(list(first_of))].unique():
        groups.setdefault(first_of[item], []).append(item)
    return [group for group in groups.values() if len(group) > 1]


def levels(scores: Scores, unit: str, constant: pandas.DataFrame | None = None) -> list[Level]:
    """Levels with scores: meshes, scans, clouds, each followed by its splits. constant: as in Level."""
    found = []
    for dataset in DATASETS:
        part = scores.part(scores.frame["dataset"] == dataset)
        found += with_splits(part, part.frame["split"].unique(), dataset, unit, constant)
    return [level for level in found if level.models]


def with_splits(
    scores: Scores, splits: Sequence[str], dataset: str, unit: str, constant: pandas.DataFrame | None = None
) -> list[Level]:
    """Level of all scores of a data set, followed by those of its splits. splits: of all rows of the data
    set."""
    if len(splits) < 2:
        return [Level(scores, dataset, unit, "".join(splits), constant)]
    of_splits = (
        Level(scores.part(scores.frame["split"] == split), dataset, unit, split, constant)
        for split in splits
        if split
    )
    return [Level(scores, dataset, unit, "", constant), *of_splits]


def _places(shapes: Numbers, units: Numbers) -> tuple[Numbers, Numbers]:
    """Position of each shape when sorted by unit, and the unit at each position. By row: shapes, units."""
    unit_of_shape = np.zeros(shapes.max(initial=-1) + 1, dtype=np.intp)
    unit_of_shape[shapes] = units
    order = np.argsort(unit_of_shape, kind="stable")
    place = np.empty_like(order)
    place[order] = np.arange(len(order))
    return place, unit_of_shape[order]
