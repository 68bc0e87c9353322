# SPDX-License-Identifier: GPL-3.0-or-later
"""What each shape scored, and its place among all others."""

from salbench.conclusions.units import DATASETS
from salbench.pages.blocks import Missing
from salbench.report import statistics
from salbench.report.exports import Shape
from salbench.report.names import natural
from salbench.report.results import Shown


class Scores:
    """Scores and ranks of all shapes under the leading metrics, looked up by shape: read once for all pages."""

    def __init__(self, results: Shown) -> None:
        self.metrics = results.leading
        self.wide, self.ranks = {}, {}
        for dataset in DATASETS:
            for metric, of in self.metrics.items():
                try:
                    wide = statistics.scores(results, dataset, metric)
                except Missing:
                    continue
                ranks = statistics.ranks(wide, of)
                self.wide[dataset, metric] = wide.to_dict("index")
                self.ranks[dataset, metric] = (ranks.to_dict("index"), wide.notna().sum().to_dict())

    def of(self, dataset: str, metric: str, item: str, view: str = "") -> dict[str, tuple[float, float, int]]:
        """model -> (score, rank, number of ranked shapes) of the models that the shape has rows of."""
        row = self.wide.get((dataset, metric), {}).get((item, view), {})
        ranks, counts = self.ranks.get((dataset, metric), ({}, {}))
        return {model: (value, ranks[item, view][model], counts[model]) for model, value in row.items()}

    def best(self, dataset: str, metric: str, item: str, view: str = "") -> set[str]:
        """The models with the best score of the shape."""
        found = self.of(dataset, metric, item, view)
        return self.metrics[metric].best({model: value for model, (value, _, _) in found.items()})

    def pieces(self, shape: Shape, model: str, when: str = "") -> list[tuple[str, bool]]:
        """The scores of a map as text, and whether each is the best of the shape. when: of what that picture shows, "before" or "after"
        matching, alone."""
        found = []
        for metric, of in self.metrics.items():
            if when not in ("", of.pictured):
                continue
            key = (shape.dataset, metric, shape.item, shape.view)
            value = self.of(*key).get(model, (float("nan"),))[0]
            found.append(("–" if value != value else f"{value:.2f}".replace("-", "−"), model in self.best(*key)))
        return found

    def dataset_of(self, item: str) -> str:
        """Of a mesh or point cloud that has scores."""
        clouds = any(dataset == "clouds" and (item, "") in rows for (dataset, _), rows in self.wide.items())
        return "clouds" if clouds else "meshes"

    def views(self, item: str) -> list[str]:
        found = {key[1] for (dataset, _), rows in self.wide.items() if dataset == "scans" for key in rows if key[0] == item}
        return sorted(found, key=natural)
