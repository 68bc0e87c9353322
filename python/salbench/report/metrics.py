# SPDX-License-Identifier: GPL-3.0-or-later
"""Metrics as pages show them."""

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
    lower: bool = False  # better
    # of the maps that it reads: "histogram", "none", "raw", "shifted"; empty if run.yaml does not say
    matching: str = ""

    @property
    def maps(self) -> str:
        """Which maps it reads, in words; empty where nobody said."""
        return {
            "histogram": "matched",
            "none": "as they are",
            "raw": "raw",
            "shifted": "raw, shifted to 0",
        }.get(self.matching, "")

    @property
    def below(self) -> str:
        """What stands below the label in tables: the paper's metrics read matched maps, which goes without
        saying."""
        return "" if self.matching in ("", "histogram") else f"maps {self.maps}"

    @property
    def pictured(self) -> str:
        """The picture of a map that is nearest to what it reads: "before" or "after" histogram matching."""
        return "after" if self.matching in ("", "histogram") else "before"

    def best(self, scores: Mapping[Key, float | None]) -> set[Key]:
        """The keys of the best scores: what every page and table sets in bold. Several where scores tie;
        none where no score is a finite number."""
        known = {key: value for key, value in scores.items() if value is not None and math.isfinite(value)}
        top = (min if self.lower else max)(known.values(), default=0)
        return {key for key, value in known.items() if abs(value - top) <= ROUNDING * abs(top)}


def labels_with_maps(metrics: Iterable[Metric]) -> str:
    """ "AUC, NSS of the matched map; CC of the map as it is": the labels, by what they read of a map."""
    labels: dict[str, list[str]] = {}
    for metric in metrics:
        labels.setdefault(_READ.get(metric.matching, ""), []).append(metric.label)
    return "; ".join(", ".join(of) + (f" of the {read}" if read else "") for read, of in labels.items())


def described(name: str, entry: Mapping[str, str] | None = None) -> Metric:
    """entry: {"unit": ..., "better": ..., "matching": ...} of run.yaml, if it has one."""
    entry = entry or {}
    lower = entry["better"] == "lower" if entry.get("better") else lower_is_better(name)
    return Metric(name, label_of(name), entry.get("unit") or "1", lower, entry.get("matching", ""))
