# SPDX-License-Identifier: GPL-3.0-or-later
"""Metrics as shown on pages."""

import math
from collections.abc import Hashable, Iterable, Mapping
from dataclasses import dataclass
from typing import TypeVar

from salbench.conclusions.metrics import label_of, lower_is_better
from salbench.conclusions.samples import ROUNDING

_READ = {
    "histogram": "matched map",
    "none": "map as it is",
    "raw": "raw map",
    "shifted": "raw map, shifted to 0",
}
Key = TypeVar("Key", bound=Hashable)


@dataclass(frozen=True)
class Metric:
    """A column of the tables, as run.yaml describes it."""

    name: str
    label: str
    unit: str = "1"
    lower: bool = False  # lower values are better
    # preprocessing of its maps: "histogram", "none", "raw", "shifted"; empty if run.yaml has none
    matching: str = ""

    @property
    def maps(self) -> str:
        """Preprocessing of maps, in words; empty if unknown."""
        return {
            "histogram": "matched",
            "none": "as they are",
            "raw": "raw",
            "shifted": "raw, shifted to 0",
        }.get(self.matching, "")

    @property
    def below(self) -> str:
        """Text below the label in tables; none for matched maps, the default in the paper."""
        return "" if self.matching in ("", "histogram") else f"maps {self.maps}"

    @property
    def pictured(self) -> str:
        """The picture closest to the maps that are scored: "before" or "after" histogram matching."""
        return "after" if self.matching in ("", "histogram") else "before"

    def best(self, scores: Mapping[Key, float | None]) -> set[Key]:
        """Keys of the best scores, which every page and table sets in bold. Several for ties; none if no
        score is finite."""
        known = {key: value for key, value in scores.items() if value is not None and math.isfinite(value)}
        top = (min if self.lower else max)(known.values(), default=0)
        return {key for key, value in known.items() if abs(value - top) <= ROUNDING * abs(top)}


def labels_with_maps(metrics: Iterable[Metric]) -> str:
    """Labels grouped by preprocessing of the maps, such as "AUC, NSS of the matched map; CC of the map as it
    is"."""
    labels: dict[str, list[str]] = {}
    for metric in metrics:
        labels.setdefault(_READ.get(metric.matching, ""), []).append(metric.label)
    return "; ".join(", ".join(of) + (f" of the {read}" if read else "") for read, of in labels.items())


def described(name: str, entry: Mapping[str, str] | None = None) -> Metric:
    """Metric of the program or of a table. entry: {"unit": ..., "better": ..., "matching": ...} of run.yaml,
    if it has one."""
    entry = entry or {}
    lower = entry["better"] == "lower" if entry.get("better") else lower_is_better(name)
    return Metric(name, label_of(name), entry.get("unit") or "1", lower, entry.get("matching", ""))
